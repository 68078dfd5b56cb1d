#include "exports/fmu/instance.h"

#include <charconv>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "exports/fmu/axis_text.h"

namespace axisfit {
namespace {

struct FmuState {
  Phase phase;
  std::vector<char> unit;
};

Model<double> model_in(const std::string& resources, const std::string& token) {
  const std::string path = resources + "/axis.txt";
  std::ifstream in(path);
  std::string of_model;
  if (!in || !std::getline(in, of_model)) throw std::runtime_error(path + " cannot be read");
  if (of_model != token)
    throw std::runtime_error("the token " + token + " is not that of this FMU, " + of_model);
  return read_axis_text(in);
}

}  // namespace

FmuInstance::FmuInstance(const std::string& resources, const std::string& token, Log log)
    : unit(model_in(resources, token)), log_(std::move(log)) {}

bool FmuInstance::fail(const char* function, const std::string& why) noexcept {
  try {
    if (log_) log_(std::string(function) + ": " + why);
  } catch (const std::exception&) {  // there is nobody left to tell
  }
  return false;
}

void FmuInstance::reset() {
  unit.reset();
  phase_ = Phase::instantiated;
}

void FmuInstance::take(void*& state) {
  auto taken = std::make_unique<FmuState>(FmuState{phase_, unit.snapshot()});
  if (state != nullptr)
    *static_cast<FmuState*>(state) = std::move(*taken);
  else
    state = taken.release();
}

void FmuInstance::restore(const void* state) {
  const FmuState& taken = *static_cast<const FmuState*>(state);
  unit.restore(taken.unit);
  phase_ = taken.phase;
}

void free_state(void*& state) {
  delete static_cast<FmuState*>(state);
  state = nullptr;
}

std::size_t size_of_state(const void* state) {
  return 1 + static_cast<const FmuState*>(state)->unit.size();
}

void write_state(const void* state, char* bytes, std::size_t size) {
  if (size < size_of_state(state)) throw std::runtime_error("there is no room for the state");
  const FmuState& taken = *static_cast<const FmuState*>(state);
  *bytes = static_cast<char>(taken.phase);
  std::ranges::copy(taken.unit, bytes + 1);
}

void* read_state(const char* bytes, std::size_t size) {
  if (size == 0 || *bytes < 0 || *bytes > static_cast<char>(Phase::terminated))
    throw std::runtime_error("this is no state of the axis");
  return new FmuState{static_cast<Phase>(*bytes), {bytes + 1, bytes + size}};
}

std::string path_of_uri(const std::string& uri) {
  std::string rest = uri;
  if (!rest.starts_with("file:")) return uri;
  rest.erase(0, 5);
  if (rest.starts_with("//")) rest.erase(0, rest.find('/', 2));  // with the name of a host
  std::string path;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    unsigned char byte = 0;
    const char* hex = rest.data() + i + 1;
    if (rest[i] == '%' && i + 2 < rest.size() &&
        std::from_chars(hex, hex + 2, byte, 16).ptr == hex + 2) {
      path += static_cast<char>(byte);
      i += 2;
    } else {
      path += rest[i];
    }
  }
  return path;
}

}  // namespace axisfit
