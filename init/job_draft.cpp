#include "init/job_draft.h"

#include <algorithm>
#include <filesystem>

#include "fit/data/noise.h"
#include "fit/data/recording_check.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;

}  // namespace

std::optional<Signal> signal_of(Kind kind) {
  switch (kind) {
    case Kind::position:
      return Signal::position;
    case Kind::velocity:
      return Signal::velocity;
    case Kind::acceleration:
      return Signal::acceleration;
    case Kind::tachometer:
      return Signal::tachometer;
    case Kind::current:
      return Signal::motor_current;
    case Kind::preamplifier_voltage:
      return Signal::preamplifier_voltage;
    case Kind::motor_voltage:
      return Signal::motor_voltage;
    case Kind::force:
      return Signal::drive_force;
    case Kind::load_position:
      return Signal::load_position;
    default:
      return std::nullopt;
  }
}

const GuessedColumn& DraftRecording::input_column() const {
  return *guess.find(input->kind, input->is_setpoint);
}

GuessedColumn& DraftRecording::input_column() {
  return *guess.find(input->kind, input->is_setpoint);
}

std::vector<double> DraftRecording::driving() const {
  std::vector<double> values = input_column().values;
  for (double& x : values) x *= input->gain;
  return values;
}

bool DraftRecording::has_measured_input() const {
  const GuessedColumn& column = input_column();
  return !column.is_setpoint && (column.kind == Kind::current || column.kind == Kind::force ||
                                 column.kind == Kind::motor_voltage);
}

bool DraftRecording::drives_in_newtons() const {
  return input->key == std::string_view("drive_force");
}

const QuantityEntry& JobDraft::quantity(std::string_view name) const {
  return quantity_list(vocabulary())[quantity_index(name)];
}

void DraftRecording::keep_samples(std::size_t first, std::size_t count) {
  const auto keep = [&](std::vector<double>& values) {
    values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(first));
    values.resize(count);
  };
  keep(guess.time.values);
  for (GuessedColumn& c : guess.columns) keep(c.values);
}

std::string JobDraft::say(std::string_view text) const {
  return std::string(words_on(vocabulary(), text));
}

std::string JobDraft::relative(const std::string& path) const {
  const fs::path near = fs::proximate(fs::absolute(path), fs::absolute(request.folder));
  const bool far = near.generic_string().starts_with("../../../");
  return (far ? fs::absolute(path) : near).lexically_normal().generic_string();
}

bool JobDraft::is_measured(const GuessedColumn& c) const {
  const auto signal = signal_of(c.kind);
  return signal && !c.idle && !c.is_setpoint && !c.is_constant() &&
         has_signal(*signal, structure) && !(is_force_driven() && c.kind == Kind::force);
}

bool JobDraft::is_rounded_away(const GuessedColumn& position,
                               const RecordingGuess& recording) const {
  return !is_direct() && recording.find(Kind::velocity) &&
         noise_from_differences(position.values) < resolution_of(position.values);
}

}  // namespace axisfit
