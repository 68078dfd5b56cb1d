// One instance of an FMU: what the functions of both versions of the standard share.
#pragma once

#include <algorithm>
#include <cstddef>
#include <exception>
#include <functional>
#include <initializer_list>
#include <string>

#include "exports/fmu/axis_unit.h"

namespace axisfit {

/// Why a function does nothing that the standard has for others.
inline constexpr const char* kUnsupported =
    "this is a unit for co-simulation, all variables of which are real numbers";

/// Where an instance is in the standard's state machine.
enum class Phase { instantiated, initializing, stepping, terminated };

class FmuInstance {
 public:
  /// Told of every error, in words.
  using Log = std::function<void(const std::string& message)>;

  /// The axis of a folder with resources. Throws std::runtime_error where it cannot be read, or is
  /// not that of the token, which tells one description of a model from another.
  FmuInstance(const std::string& resources, const std::string& token, Log log);

  /// Does something in one of the phases. Whether it could: else the reason was logged.
  template <class Do>
  bool attempt(const char* function, std::initializer_list<Phase> phases, Do&& act) noexcept {
    try {
      if (std::find(phases.begin(), phases.end(), phase_) == phases.end())
        return fail(function, "it must not be called now");
      act(*this);
      return true;
    } catch (const std::exception& error) {
      return fail(function, error.what());
    }
  }
  /// Says that it cannot be done.
  bool fail(const char* function, const std::string& why) noexcept;

  AxisUnit unit;
  void enter(Phase phase) { phase_ = phase; }
  void reset();

  /// Takes the state, into one that was taken before if there is one.
  void take(void*& state);
  void restore(const void* state);

 private:
  Log log_;
  Phase phase_ = Phase::instantiated;
};

// States that were taken.
void free_state(void*& state);
std::size_t size_of_state(const void* state);
/// Throws unless there is room for it.
void write_state(const void* state, char* bytes, std::size_t size);
void* read_state(const char* bytes, std::size_t size);

/// The path that a "file:" URI names, or that path itself.
std::string path_of_uri(const std::string& uri);

}  // namespace axisfit
