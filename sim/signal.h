// The signals that a rig records, and the instruments that read them.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "sim/quantity.h"
#include "sim/vocabulary.h"

namespace axisfit {

/// Outputs of the model: what an instrument can read. Definitions in the table below.
enum class Signal {
  position,
  velocity,
  acceleration,
  tachometer,
  motor_current,
  preamplifier_voltage,
  motor_voltage,
  drive_force,
  load_position,
};

inline constexpr std::size_t kSignals = 9;

struct SignalInfo {
  Signal signal;
  std::string_view name;  ///< in files
  std::string_view unit;
  std::string_view meaning;
};

inline constexpr std::array<SignalInfo, kSignals> kSignalTable{{
    {Signal::position, "position", "m", "r_g y2, from the encoder on the motor shaft"},
    {Signal::velocity, "velocity", "m/s", "y1, arm velocity"},
    {Signal::acceleration, "acceleration", "m/s^2", "y1', from an accelerometer on the arm"},
    {Signal::tachometer, "tachometer", "V", "K_t y3"},
    {Signal::motor_current, "motor_current", "A", "y6"},
    {Signal::preamplifier_voltage, "V_c", "V", "preamplifier output after its limiter, (2)"},
    {Signal::motor_voltage, "V_m", "V", "motor voltage after its limiter, (3)"},
    {Signal::drive_force, "drive_force", "N", "motor torque as a force at the rack"},
    {Signal::load_position, "load_position", "m", "y0, from a scale or second encoder on the arm"},
}};

constexpr std::size_t index_of(Signal signal) { return static_cast<std::size_t>(signal); }

constexpr const SignalInfo& info(Signal signal) { return kSignalTable[index_of(signal)]; }

/// As it is called on the joint.
inline SignalInfo info(Signal signal, Vocabulary vocabulary) {
  const SignalInfo& entry = info(signal);
  return {signal, words_on(vocabulary, entry.name), unit_on(vocabulary, entry.unit),
          words_on(vocabulary, entry.meaning)};
}

inline std::optional<Signal> signal_by_name(std::string_view name, Vocabulary vocabulary) {
  for (const SignalInfo& entry : kSignalTable)
    if (words_on(vocabulary, entry.name) == name) return entry.signal;
  return std::nullopt;
}

/// A linear instrument: reading = gain * true value + bias, the bias in the signal's unit; the
/// reading follows the truth with the time constant `lag` and comes `delay` later, both in seconds,
/// and by `drift` more for every second since the first sample: its clock is slow.
template <class T>
struct Instrument {
  T gain{1.0};
  T bias{0.0};
  T lag{0.0};
  T delay{0.0};
  T drift{0.0};
};

template <class T>
using Instruments = std::array<Instrument<T>, kSignals>;

}  // namespace axisfit
