// What the name of a recorded column says of it: which quantity, in which unit, of which axis.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "init/columns/units.h"

namespace axisfit {

/// On which side of the gear something is measured, as far as its name says.
enum class Side { unsaid, motor, load };

struct ColumnGuess {
  Kind kind = Kind::command;
  bool is_setpoint =
      false;         ///< what was asked for, not what was measured: a reference, a set value
  std::string unit;  ///< of stored_unit(); empty where the name does not say
  int rank = 0;      ///< the surer the higher, among columns of one kind
  bool is_measured = false;  ///< the name says so: "actual", "ist"
  bool is_duty = false;      ///< a part of a supply: "pwm", "duty", "power"
  bool turns = false;        ///< the name is that of an angle or a torque: "theta", "tau"
  Side side = Side::unsaid;
  /// The words that are left: of which axis it is, such as {"0"} of "Motor 0 Position [mm]".
  std::vector<std::string> axis{};
  std::string unknown_unit{};  ///< what stands in brackets and is no unit of the kind
};

/// Nothing for a name that says nothing. Understands English and German words, the short symbols of
/// the trade, and units in brackets, behind a slash or as an ending: "Time [ms]", "pos_mm",
/// "Istposition", "iq", "set_velocity_v", "a (m/s^2)", "velocityRadPerSec", "z_act/mm".
std::optional<ColumnGuess> guess_column(const std::string& name);

/// A column beside an axis that may act on it.
struct ChannelGuess {
  std::string name;  ///< "temperature", "supply" or "pressure"
  std::string unit;  ///< as a job writes it
};

/// Whether a name is that of a temperature, of the voltage of a supply, or of a pressure with its
/// unit: "motor temperature", "T2 [degC]", "bus voltage [V]", "chamber pressure [bar]".
std::optional<ChannelGuess> guess_channel(const std::string& name);

}  // namespace axisfit
