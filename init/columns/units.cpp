#include "init/columns/units.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <utility>
#include <variant>

#include "base/units.h"
#include "fit/data/recording_check.h"

namespace axisfit {
namespace {

using enum Kind;

/// The usual units of a kind, most usual first, each with its other writings, all as plain() and
/// without spaces, '^' and brackets.
struct UsualUnit {
  std::string_view text;
  std::vector<std::string_view> writings;
};

const std::vector<UsualUnit>& usual_units(Kind kind) {
  static const std::vector<UsualUnit> kTime{{"s", {"sec", "secs", "second", "seconds", "sekunden"}},
                                            {"ms", {"msec", "millis", "milliseconds"}},
                                            {"us", {"usec", "micros", "microseconds"}},
                                            {"ns", {"nsec", "nanos", "nanoseconds"}},
                                            {"min", {}}};
  static const std::vector<UsualUnit> kPosition{
      {"m", {"meter", "meters", "metre", "metres"}},
      {"mm", {"millimeters", "millimetres"}},
      {"um", {"micron", "microns"}},
      {"cm", {}},
      {"inch", {"inches"}},
      {"rad", {"rads", "radian", "radians"}},
      {"deg", {"degs", "degree", "degrees", "grad"}},
      {"rev", {"revs", "revolutions", "rotations", "turn", "turns", "u", "umdr"}},
      {"mrad", {}},
      {"counts",
       {"count", "cnt", "cnts", "tick", "ticks", "inc", "incs", "inkr", "ink", "inkremente",
        "increments", "pulses", "pulse"}}};
  static const std::vector<UsualUnit> kVelocity{
      {"m/s", {"mps", "meters/s"}},
      {"mm/s", {"mmps", "mms"}},
      {"um/s", {}},
      {"cm/s", {"cmps"}},
      {"m/min", {}},
      {"mm/min", {"mmpm"}},
      {"km/h", {"kmh"}},
      {"inch/s", {"in/s", "inches/s"}},
      {"rad/s", {"radps", "rads", "rads/s", "radians/s"}},
      {"deg/s", {"dps", "degps", "degrees/s", "grad/s"}},
      {"rpm", {"1/min", "u/min", "r/min", "rev/min", "min-1", "upm", "rotations/min"}},
      {"rev/s", {"rps", "r/s", "u/s", "turns/s", "revs/s", "revps", "rotations/s"}},
      {"counts/s", {"inc/s", "ink/s", "inkr/s", "cnt/s", "pulses/s", "ticks/s"}}};
  static const std::vector<UsualUnit> kAcceleration{{"m/s^2", {"mps2", "m/s/s", "m/s**2", "ms2"}},
                                                    {"g", {}},
                                                    {"mm/s^2", {"mmps2"}},
                                                    {"rad/s^2", {"radps2", "rad/s/s"}},
                                                    {"deg/s^2", {}},
                                                    {"rev/s^2", {"turns/s2", "rotations/s2"}}};
  // Drives give torque and current in parts of their rating, too.
  static const std::vector<UsualUnit> kCurrent{{"A", {"amp", "amps", "ampere", "amperes", "arms"}},
                                               {"mA", {"milliamps"}},
                                               {"%", {"percent", "prozent", "pct"}},
                                               {"0.1%", {"promille", "permille", "1/1000"}}};
  static const std::vector<UsualUnit> kForce{{"N", {"newton", "newtons"}},
                                             {"kN", {}},
                                             {"mN", {}},
                                             {"N m", {"nm", "newtonmeters", "newtonmetres"}},
                                             {"N mm", {"nmm"}},
                                             {"mN m", {"mnm"}},
                                             {"%", {"percent", "prozent", "pct"}},
                                             {"0.1%", {"promille", "permille", "1/1000"}}};
  static const std::vector<UsualUnit> kVolts{{"V", {"volt", "volts"}}, {"mV", {"millivolts"}}};
  static const std::vector<UsualUnit> kCommand{{"V", {"volt", "volts"}},
                                               {"mV", {}},
                                               {"A", {"amp", "amps"}},
                                               {"mA", {}},
                                               {"N", {}},
                                               {"N m", {"nm"}},
                                               {"%", {"percent", "prozent", "pct"}}};
  switch (kind) {
    case time:
      return kTime;
    case position:
    case load_position:
      return kPosition;
    case velocity:
      return kVelocity;
    case acceleration:
      return kAcceleration;
    case current:
      return kCurrent;
    case force:
      return kForce;
    case command:
      return kCommand;
    default:
      return kVolts;
  }
}

/// A unit that base/units does not have, or has for something else: g is a gram there.
std::optional<StoredUnit> own_unit(Kind kind, std::string_view text) {
  struct Own {
    std::string_view text;
    double size;
  };
  constexpr double kGravity = 9.80665;
  // A count has the size of a micrometre, or a microradian, until somebody says it.
  static constexpr Own kOwn[]{{"counts", 1e-6}, {"counts/s", 1e-6}, {"g", kGravity},
                              {"%", 1.0},       {"0.1%", 0.1},      {"1", 1.0}};
  const auto* const own = std::ranges::find(kOwn, text, &Own::text);
  if (own == std::end(kOwn)) return std::nullopt;
  const bool suits = text == "counts"     ? kind == position || kind == load_position
                     : text == "counts/s" ? kind == velocity
                     : text == "g"        ? kind == acceleration
                     : text == "1"        ? kind == command
                                          : kind == current || kind == force || kind == command;
  if (!suits) return std::nullopt;
  StoredUnit unit{std::string(text), std::string(si_unit(kind)), own->size, {}, own->size};
  if (text == "g") unit.joint = Joint::prismatic;
  unit.is_assumed = text != "g";
  return unit;
}

std::optional<double> factor_of(std::string_view text, std::string_view si_unit) {
  const auto factor = unit_factor(text, si_unit);
  const auto* found = std::get_if<double>(&factor);
  return found ? std::optional(*found) : std::nullopt;
}

/// Words for operators, and the writings of the table: "RadPerSec" is "rad/s".
std::string with_operators(std::string_view piece) {
  const std::vector<std::string> words = words_of(piece);
  const auto is_word = [&](std::string_view word) { return std::ranges::count(words, word) > 0; };
  if (!is_word("per") && !is_word("squared") && !is_word("sq")) return {};
  std::string text;
  for (const std::string& word : words)
    text += word == "per"                                            ? "/"
            : word == "squared" || word == "sq"                      ? "2"
            : word == "sec" || word == "second" || word == "seconds" ? "s"
            : word == "minute"                                       ? "min"
            : word == "radians"                                      ? "rad"
            : word == "degrees"                                      ? "deg"
            : word == "meters" || word == "metres"                   ? "m"
                                                                     : word;
  return text;
}

}  // namespace

std::string plain(std::string_view text) {
  static constexpr std::pair<std::string_view, std::string_view> kSigns[]{
      {"\u00B2", "2"}, {"\u00B5", "u"},  {"\u03BC", "u"},  {"\u00B0", "deg"},
      {"\u00B7", " "}, {"\u00E4", "ae"}, {"\u00F6", "oe"}, {"\u00FC", "ue"}};
  std::string result;
  while (!text.empty()) {
    const auto* sign =
        std::ranges::find_if(kSigns, [&](const auto& s) { return text.starts_with(s.first); });
    if (sign != std::end(kSigns)) {
      result += sign->second;
      text.remove_prefix(sign->first.size());
      continue;
    }
    result += static_cast<char>(std::tolower(static_cast<unsigned char>(text.front())));
    text.remove_prefix(1);
  }
  return result;
}

std::vector<std::string> words_of(std::string_view name) {
  std::vector<std::string> words{""};
  char before = ' ';
  const auto is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  for (const char c : name) {
    const auto u = static_cast<unsigned char>(c);
    const bool letter = std::isalnum(u) != 0 || u >= 0x80;
    const bool is_object = words.back().starts_with("0x");
    const bool ends_word =
        std::islower(static_cast<unsigned char>(before)) != 0 || (is_digit(before) && !is_object);
    const bool new_word = (std::isupper(u) != 0 && ends_word) ||
                          (is_digit(c) && std::isalpha(static_cast<unsigned char>(before)) != 0 &&
                           !is_object && words.back() != "0");
    if ((!letter || new_word) && !words.back().empty()) words.emplace_back();
    if (letter) words.back() += c;
    before = c;
  }
  for (std::string& word : words) word = plain(word);
  std::erase(words, "");
  return words;
}

std::string_view si_unit(Kind kind, Joint joint) {
  switch (kind) {
    case time:
      return "s";
    case position:
    case load_position:
      return unit_on(joint, "m");
    case velocity:
      return unit_on(joint, "m/s");
    case acceleration:
      return unit_on(joint, "m/s^2");
    case current:
      return "A";
    case force:
      return unit_on(joint, "N");
    default:
      return "V";
  }
}

std::optional<StoredUnit> stored_unit(Kind kind, std::string_view text) {
  if (text.empty()) return std::nullopt;
  if (auto own = own_unit(kind, text)) return own;
  StoredUnit unit{std::string(text), std::string(text)};
  for (const Joint joint : kJoints) {
    const auto size = factor_of(text, si_unit(kind, joint));
    if (!size) continue;
    unit.size = *size;
    if (si_unit(kind, Joint::prismatic) != si_unit(kind, Joint::revolute)) unit.joint = joint;
    return unit;
  }
  if (kind != command) return std::nullopt;
  // A job treats a command as volts, whatever it is.
  for (const std::string_view of : {"A", "N", "N m"})
    if (const auto size = factor_of(text, of)) {
      unit.written = "V";
      unit.factor = unit.size = *size;
      return unit;
    }
  return std::nullopt;
}

std::string unit_in(Kind kind, std::string_view piece) {
  std::string text;
  for (const char c : plain(piece))
    if (std::string_view(" ^[](){}").find(c) == std::string_view::npos) text += c == '_' ? '/' : c;
  while (text.starts_with('/') || text.starts_with(',')) text.erase(0, 1);
  if (text.ends_with("/sec")) text.resize(text.size() - 2);
  const std::string spoken = with_operators(piece);
  for (const UsualUnit& unit : usual_units(kind)) {
    std::string known = plain(unit.text);
    std::erase(known, '^');
    std::erase(known, ' ');
    const auto is_written = [&](const std::string& candidate) {
      return candidate == unit.text || candidate == known ||
             std::ranges::count(unit.writings, std::string_view(candidate)) > 0;
    };
    if (is_written(text) || (!spoken.empty() && is_written(spoken))) return std::string(unit.text);
  }
  return {};
}

std::string unit_meant(Kind kind, std::string_view text) {
  std::string usual = unit_in(kind, text);
  const bool is_unit = stored_unit(kind, text).has_value();
  // MN is no mN.
  const bool differs_in_case_alone = std::ranges::equal(
      usual, text,
      [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); });
  return is_unit && (usual.empty() || differs_in_case_alone) ? std::string(text) : usual;
}

std::optional<StoredUnit> unit_of_size(Kind kind, double size, std::optional<Joint> joint) {
  if (!(size > 0.0)) return std::nullopt;
  for (const UsualUnit& usual : usual_units(kind)) {
    auto unit = stored_unit(kind, usual.text);
    if (unit->is_assumed || (joint && unit->joint && unit->joint != joint)) continue;
    if (std::abs(std::log(size / unit->size)) < kSameUnit) return unit;
  }
  return std::nullopt;
}

bool is_part_of_rating(std::string_view unit) { return unit.ends_with('%'); }

bool is_raw(std::string_view unit) { return unit.starts_with("counts"); }

}  // namespace axisfit
