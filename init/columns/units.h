// What a recording can hold, and in which units: those of base/units, and the few that no database
// has, because only the machine tells their size.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/vocabulary.h"

namespace axisfit {

/// What a recording can hold. As the signals (sim/signal.h), and what drives an axis, supplies or
/// clocks it.
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
  load_position,  ///< of a scale or second encoder on the load
  supply,         ///< the voltage that a duty is a part of
};
inline constexpr int kKinds = 13;

/// The SI unit in which a job takes the kind on that joint; "V" for a command.
std::string_view si_unit(Kind kind, Joint joint = Joint::prismatic);

/// A unit that recordings are stored in.
struct StoredUnit {
  std::string text;     ///< "mm/s", "counts", "%"
  std::string written;  ///< what a job writes for it: a unit that base/units knows
  double factor = 1.0;  ///< by which a job multiplies the values besides
  /// Whose motions and forces it measures; none: those of either, as A and s, or nobody knows, as
  /// of counts.
  std::optional<Joint> joint{};
  double size = 1.0;        ///< in the SI unit of that joint, or of a prismatic one
  bool is_assumed = false;  ///< only the machine tells the size: counts, parts of a rating
};

/// What base/units converts for the kind, on either joint, and besides "counts", "counts/s", "g"
/// (of gravity), "%" and "0.1%" (of a rating). Of a command, the volts in which a job treats it;
/// "1" is a whole duty. Nothing for other texts.
std::optional<StoredUnit> stored_unit(Kind kind, std::string_view text);

/// The unit that a piece of a name may be, as one knows it: "mm" for "MM", "rad/s" for "RadPerSec",
/// "rpm" for "1/min". Empty where it is none.
std::string unit_in(Kind kind, std::string_view piece);

/// A unit as somebody wrote it, of stored_unit(): as it is where that is a unit, or what one means
/// by it, as "rpm" by "1/min". Empty where it is none.
std::string unit_meant(Kind kind, std::string_view text);

/// The usual unit of about this size; of either joint where none is given. Nothing where there is
/// none.
std::optional<StoredUnit> unit_of_size(Kind kind, double size, std::optional<Joint> joint);

/// Whether it is a part of a rating, such as per cent of the rated torque.
bool is_part_of_rating(std::string_view unit);

/// Whether it counts steps of unknown size.
bool is_raw(std::string_view unit);

/// Lower case, with typographical signs as a keyboard has them.
std::string plain(std::string_view text);

/// The words of a name in lower case: split at '_', blanks and the like, before capitals inside,
/// and before and after numbers: "q1" is two, an object of CiA 402 such as "0x6064" one.
std::vector<std::string> words_of(std::string_view name);

}  // namespace axisfit
