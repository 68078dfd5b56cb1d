// What the name of a recorded column says of it: which quantity, in which unit.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/signal.h"

namespace axisfit {

/// What a recording can hold. As the signals (sim/signal.h), and what drives an axis or clocks it.
enum class Kind {
  time,
  set_velocity,  ///< a voltage that commands a velocity
  command,       ///< of unknown kind
  position,
  velocity,
  acceleration,
  tachometer,
  current,
  preamplifier_voltage,
  motor_voltage,
  force,
};

struct ColumnGuess {
  Kind kind = Kind::command;
  bool is_setpoint =
      false;         ///< what was asked for, not what was measured: a reference, a set value
  std::string unit;  ///< as a job writes it; empty where the name does not say
  int rank = 0;      ///< the surer the higher, among columns of one kind
};

/// Nothing for a name that says nothing. Understands English and German words, the short symbols of
/// the trade, and units in brackets, behind a slash or as an ending: "Time [ms]", "pos_mm",
/// "Istposition", "iq", "set_velocity_v", "a (m/s^2)".
std::optional<ColumnGuess> guess_column(const std::string& name);

/// A column beside an axis that may act on it.
struct ChannelGuess {
  std::string name;  ///< "temperature" or "supply"
  std::string unit;  ///< as a job writes it
};

/// Whether a name is that of a temperature or of the voltage of a supply: "motor temperature",
/// "T2 [degC]", "bus voltage [V]".
std::optional<ChannelGuess> guess_channel(const std::string& name);

/// The SI unit in which a job for a prismatic joint takes the kind; "V" for a command.
std::string_view si_unit(Kind kind);

/// A unit that recordings of a kind are stored in, and its size in the SI unit. Angles count as the
/// metres that a job for a prismatic joint wants: a radian is one.
struct StoredUnit {
  std::string_view text;
  double size;
  /// What a job has to write for it, where `text` is not of the kind's dimension: unit and factor.
  std::string_view written = text;
  double factor = 1.0;
};

/// Whether it is a part of a rating, such as per cent of the rated torque.
bool is_part_of_rating(std::string_view unit);

/// Whether it is a unit of angles, or of their rates.
bool is_of_angles(const StoredUnit& unit);

/// The units of a kind, most usual first.
const std::vector<StoredUnit>& stored_units(Kind kind);

/// The one whose text this is; null where there is none.
const StoredUnit* stored_unit(Kind kind, std::string_view text);

/// The one of about this size; null where there is none. At best one of angles, or of what is none.
const StoredUnit* unit_of_size(Kind kind, double size, bool of_angles = false);

}  // namespace axisfit
