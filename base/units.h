// Conversion of the unit texts that users write, such as "mm/s" or "kg·m²", to the unit a quantity
// is computed in.
#pragma once

#include <string>
#include <string_view>
#include <variant>

namespace axisfit {

enum class UnitProblem {
  unknown,           ///< no such unit, or not a plain product of powers of units
  wrong_dimension,   ///< a unit, but of another kind of quantity
  not_proportional,  ///< a scale with its own zero or a logarithm, such as degC
};

struct UnitError {
  UnitProblem problem;
  std::string message;  ///< for the user: what is wrong and what to write instead
};

/// The factor f > 0 such that a value x in `unit` is the value f * x in `si_unit`: for example
/// 0.001 for "mm/s" and "m/s".
///
/// Products are written with a space, '*', '.', '-' or '·', powers as m^2, m2 or m²; "N s/m" is
/// (N s)/m. Besides the units of udunits2 there are deg, rev and the customary products without a
/// space: Nm, Nmm, Nms, Ns, Vs, As, Ah, Ws and Wh. Numbers are refused ("10 mm"), except for the 1
/// of "1/s".
///
/// A radian in `si_unit` may be left out in `unit` ("V s" for "V s/rad", "1/s" for "rad/s"). Apart
/// from that radians must agree, so that neither Hz passes for rad/s nor rpm for Hz.
///
/// Safe to call from several threads. Throws std::invalid_argument when `si_unit` itself is not a
/// unit (a programming error) and std::runtime_error when the unit database is not installed.
std::variant<double, UnitError> unit_factor(std::string_view unit, std::string_view si_unit);

/// Whether values in `si_unit` are plain numbers: true for "1" and "V/V", false for "rad".
/// Throws like unit_factor.
bool is_dimensionless(std::string_view si_unit);

/// "0.56 ohm": a number with its unit, which is left out of plain numbers.
std::string with_unit(std::string number, std::string_view si_unit);
/// The same, with all digits that the value needs.
std::string with_unit(double value, std::string_view si_unit);

}  // namespace axisfit
