// Rounding to decimal digits.
#pragma once

#include <fmt/format.h>

#include <charconv>
#include <string>

namespace axisfit {

/// A value as one reads it when it is printed with so many significant digits. Of any size: the
/// standard library's stod() takes the smallest numbers for out of range.
inline double round_to_digits(double value, int digits) {
  const std::string text = fmt::format("{:.{}g}", value, digits);
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

/// "34 %", with so many significant digits, or all before the point where that are more.
inline std::string percent(double value, int digits = 2) {
  std::string text = fmt::format("{:.{}g}", value, digits);
  if (text.find("e+") != std::string::npos) text = fmt::format("{:.0f}", value);
  return text + " %";
}

}  // namespace axisfit
