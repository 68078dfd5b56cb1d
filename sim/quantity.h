// The description of one scalar of the model: the only place that has its name, unit and range.
// Reading, bounds, tables, CSV headers and JSON use it.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace axisfit {

/// Standard value of a quantity that has none: whoever describes an axis must give it.
inline constexpr double kRequired = std::numeric_limits<double>::quiet_NaN();

/// The unit of the command, which depends on the drive: "N/U" stands for "N/V" or "N/A".
inline constexpr std::string_view kCommandUnit = "U";

/// When the model makes use of a quantity.
enum class UsedBy {
  every_axis,
  velocity_loop,   ///< drive: velocity_loop
  electric_drive,  ///< drive: velocity_loop or current_source
  force_source,    ///< drive: force_source, motor_current or rated_force
  motor_constant,  ///< drive: one whose motor current is known
  armature,        ///< drive: velocity_loop or motor_voltage
  controller,      ///< closed_loop
  backlash,        ///< transmission: backlash
  rigid,           ///< transmission: rigid
  motor,           ///< needed unless what drives a rigid transmission is a force
};

struct Quantity {
  std::string_view symbol;           ///< the paper's, for example "B_a"
  std::string_view unit;             ///< SI, for example "N s/m"; "1" when dimensionless
  std::string_view meaning;          ///< a few words
  double lower;                      ///< smallest value that makes sense, in `unit`
  double upper;                      ///< largest
  double default_value = kRequired;  ///< value when not given
  UsedBy used_by = UsedBy::every_axis;
  /// Of an effect: gives it its shape (a period, a speed scale), not its strength. An effect whose
  /// strengths are all zero is as good as absent, whatever its shape.
  bool shape = false;
  /// Of an effect: a value that an ordinary motion shows, in `unit`; for tests and benchmarks.
  double typical = std::numeric_limits<double>::quiet_NaN();
  /// The channel of the axis, by its place, to which it is related: `unit` is then per unit of
  /// that, and the axis has the quantity if it has the channel.
  std::optional<std::size_t> channel = std::nullopt;

  constexpr Quantity typically(double value) const {
    Quantity copy = *this;
    copy.typical = value;
    return copy;
  }
  constexpr Quantity of_channel(std::size_t place) const {
    Quantity copy = *this;
    copy.channel = place;
    return copy;
  }
};

/// "effect.symbol", or the symbol alone for the axis itself.
inline std::string full_name(std::string_view group, const Quantity& quantity) {
  std::string name(group);
  if (!name.empty()) name += '.';
  return name.append(quantity.symbol);
}

}  // namespace axisfit
