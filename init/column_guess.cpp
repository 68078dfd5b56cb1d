#include "init/column_guess.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numbers>
#include <span>

#include "fit/data/recording_check.h"

namespace axisfit {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0, kGravity = 9.80665;

/// Lower case, with typographical signs as a keyboard has them.
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

/// Other writings of the units in the tables below. Spaces, '^' and brackets are gone, and '_' is
/// '/'.
std::string_view usual_writing(Kind kind, std::string_view text) {
  struct Writing {
    Kind kind;
    std::string_view written, usual;
  };
  using enum Kind;
  static constexpr Writing kWritings[]{{time, "sec", "s"},
                                       {time, "secs", "s"},
                                       {time, "second", "s"},
                                       {time, "seconds", "s"},
                                       {time, "sekunden", "s"},
                                       {time, "msec", "ms"},
                                       {time, "millis", "ms"},
                                       {time, "milliseconds", "ms"},
                                       {time, "usec", "us"},
                                       {time, "micros", "us"},
                                       {time, "microseconds", "us"},
                                       {position, "micron", "um"},
                                       {position, "degree", "deg"},
                                       {position, "degrees", "deg"},
                                       {position, "cnt", "counts"},
                                       {position, "cnts", "counts"},
                                       {position, "ticks", "counts"},
                                       {position, "inc", "counts"},
                                       {position, "incs", "counts"},
                                       {position, "inkr", "counts"},
                                       {position, "ink", "counts"},
                                       {position, "inkremente", "counts"},
                                       {position, "increments", "counts"},
                                       {position, "pulses", "counts"},
                                       {position, "pulse", "counts"},
                                       {position, "grad", "deg"},
                                       {position, "u", "rev"},
                                       {position, "umdr", "rev"},
                                       {position, "turns", "rev"},
                                       {velocity, "mps", "m/s"},
                                       {velocity, "mmps", "mm/s"},
                                       {velocity, "mms", "mm/s"},
                                       {velocity, "kmh", "km/h"},
                                       {velocity, "mmpm", "mm/min"},
                                       {velocity, "dps", "deg/s"},
                                       {velocity, "degps", "deg/s"},
                                       {velocity, "radps", "rad/s"},
                                       {velocity, "rads", "rad/s"},
                                       {velocity, "inc/s", "counts/s"},
                                       {velocity, "ink/s", "counts/s"},
                                       {velocity, "inkr/s", "counts/s"},
                                       {velocity, "cnt/s", "counts/s"},
                                       {velocity, "pulses/s", "counts/s"},
                                       {velocity, "1/min", "rpm"},
                                       {velocity, "u/min", "rpm"},
                                       {velocity, "r/min", "rpm"},
                                       {velocity, "rev/min", "rpm"},
                                       {velocity, "min-1", "rpm"},
                                       {velocity, "grad/s", "deg/s"},
                                       {acceleration, "mps2", "m/s^2"},
                                       {acceleration, "m/s2", "m/s^2"},
                                       {acceleration, "m/s/s", "m/s^2"},
                                       {acceleration, "ms2", "m/s^2"},
                                       {acceleration, "m/s**2", "m/s^2"},
                                       {acceleration, "mmps2", "mm/s^2"},
                                       {acceleration, "mm/s2", "mm/s^2"},
                                       {acceleration, "rad/s2", "rad/s^2"},
                                       {acceleration, "radps2", "rad/s^2"},
                                       {acceleration, "deg/s2", "deg/s^2"},
                                       {current, "amp", "A"},
                                       {current, "amps", "A"},
                                       {current, "arms", "A"},
                                       {current, "percent", "%"},
                                       {current, "prozent", "%"},
                                       {current, "promille", "0.1%"},
                                       {current, "per mille", "0.1%"},
                                       {current, "1/1000", "0.1%"},
                                       {force, "nm", "N m"},
                                       {force, "percent", "%"},
                                       {force, "prozent", "%"},
                                       {force, "promille", "0.1%"},
                                       {force, "permille", "0.1%"},
                                       {force, "1/1000", "0.1%"},
                                       {tachometer, "volt", "V"},
                                       {tachometer, "volts", "V"},
                                       {motor_voltage, "volt", "V"},
                                       {motor_voltage, "volts", "V"},
                                       {command, "volt", "V"},
                                       {command, "volts", "V"},
                                       {command, "amps", "A"},
                                       {command, "percent", "%"}};
  for (const Writing& w : kWritings)
    if (w.kind == kind && w.written == text) return w.usual;
  return text;
}

/// The unit that a piece of a name may be, as it stands in the tables; empty where it is none.
std::string unit_in(Kind kind, std::string_view piece) {
  std::string text;
  for (const char c : plain(piece))
    if (std::string_view(" ^[](){}").find(c) == std::string_view::npos) text += c == '_' ? '/' : c;
  while (text.starts_with('/') || text.starts_with(',')) text.erase(0, 1);
  const std::string usual(usual_writing(kind, text));
  for (const StoredUnit& unit : stored_units(kind)) {
    std::string known = plain(unit.text);
    std::erase(known, '^');
    std::erase(known, ' ');
    if (usual == unit.text || usual == known) return std::string(unit.text);
  }
  return {};
}

/// The words of a name: at '_', blanks and the like, and before capitals inside.
std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words{""};
  char before = ' ';
  for (const char c : name) {
    const auto u = static_cast<unsigned char>(c);
    const bool letter = std::isalnum(u) != 0 || u >= 0x80;
    const bool new_word = std::isupper(u) != 0 && std::islower(static_cast<unsigned char>(before));
    if ((!letter || new_word) && !words.back().empty()) words.emplace_back();
    if (letter) words.back() += c;
    before = c;
  }
  for (std::string& word : words) word = plain(word);
  std::erase(words, "");
  return words;
}

struct Word {
  std::string_view text;
  Kind kind;
  int rank;
};

// Long words are also found inside of others ("Istposition", "motorstrom"). Short ones stand alone.
constexpr std::size_t kLongWord = 4;
using enum Kind;
constexpr Word kWords[]{
    {"tacho", tachometer, 9},
    {"acceleration", acceleration, 9},
    {"beschleunigung", acceleration, 9},
    {"accelerometer", acceleration, 9},
    {"accel", acceleration, 8},
    {"velocity", velocity, 9},
    {"geschwindigkeit", velocity, 9},
    {"drehzahl", velocity, 8},
    {"speed", velocity, 8},
    {"position", position, 9},
    {"encoder", position, 7},
    {"displacement", position, 8},
    {"stroke", position, 7},
    {"angle", position, 5},
    {"winkel", position, 5},
    {"current", current, 8},
    {"strom", current, 8},
    {"geber", position, 6},
    {"scale", position, 5},
    {"massstab", position, 6},
    {"lageist", position, 9},
    {"lagesoll", position, 9},
    {"lage", position, 7},
    {"velo", velocity, 8},
    {"moment", force, 6},
    {"torque", force, 7},
    {"drehmoment", force, 7},
    {"force", force, 8},
    {"kraft", force, 8},
    {"voltage", motor_voltage, 6},
    {"spannung", motor_voltage, 6},
    {"timestamp", time, 9},
    {"time", time, 9},
    {"zeit", time, 9},
    {"command", command, 5},
    {"setpoint", command, 4},
    {"sollwert", command, 4},
    {"stellgroesse", command, 6},
    {"distance", position, 6},
    {"acc", acceleration, 8},
    {"vel", velocity, 8},
    {"pos", position, 8},
    {"weg", position, 8},
    {"enc", position, 6},
    {"cmd", command, 5},
    {"pwm", command, 4},
    {"load", command, 4},
    {"effort", force, 5},
    {"duty", command, 3},
    {"control", command, 3},
    {"input", command, 3},
    {"iq", current, 7},
    {"amps", current, 6},
    {"qm", position, 6},
    {"vir", command, 6},
    {"tau", force, 5},
    {"uq", motor_voltage, 5},
    {"trq", force, 6},
    {"frc", force, 6},
    {"dq", velocity, 5},
    {"qd", velocity, 5},
    {"qdot", velocity, 5},
    {"xdot", velocity, 5},
    {"dx", velocity, 5},
    {"ddq", acceleration, 5},
    {"qdd", acceleration, 5},
    {"ddx", acceleration, 5},
    // Kollmorgen's loops: PL.FB, VL.CMD.
    {"pl", position, 6},
    {"vl", velocity, 6},
    {"il", current, 6},
    // CiA 402
    {"0x6062", position, 9},
    {"0x6064", position, 9},
    {"0x607a", position, 9},
    {"0x606b", velocity, 9},
    {"0x606c", velocity, 9},
    {"0x60ff", velocity, 9},
    {"0x6071", force, 7},
    {"0x6074", force, 7},
    {"0x6077", force, 9},
    {"0x6078", current, 9},
    {"t", time, 5},
    {"x", position, 3},
    {"q", position, 4},
    {"s", position, 2},
    {"v", velocity, 4},
    {"a", acceleration, 4},
    {"i", current, 4},
    {"f", force, 3},
    {"u", command, 4},
};

constexpr std::string_view kSetpointWords[]{
    "set",    "cmd",      "command",  "commanded", "ref",        "target",      "desired",
    "demand", "setpoint", "sollwert", "soll",      "reference",  "nominal",     "goal",
    "qg",     "vorgabe",  "planned",  "plan",      "trajectory", "feedforward", "dem",
    "0x6062", "0x607a",   "0x606b",   "0x60ff",    "0x6071",     "0x6074"};
constexpr std::string_view kMeasuredWords[]{"actual",   "act",      "ist", "meas",
                                            "measured", "feedback", "fb"};
constexpr std::string_view kIgnoredWords[]{
    "error",      "err",     "fehler",   "deviation",   "diff",   "lag",
    "abweichung", "schlepp", "residual", "status",      "index",  "sample",
    "simulated",  "noise",   "temp",     "temperature", "enable", "enabled",
    "freigabe",   "limit",   "max",      "min",         "mode",   "anlage"};

/// Whether one of the words is among these, or begins with one as German compounds do.
bool has_word(const std::vector<std::string>& words, std::span<const std::string_view> list) {
  return std::ranges::any_of(words, [&](const std::string& word) {
    return std::ranges::any_of(list, [&](std::string_view known) {
      const bool compound = known == "soll" || known == "ist" || known == "schlepp";
      return word == known || (compound && word.starts_with(known) && word.size() > 6) ||
             (known == "soll" && word.starts_with("lagesoll"));
    });
  });
}

const Word* known_word(const std::vector<std::string>& words) {
  const Word* best = nullptr;
  for (const Word& known : kWords) {
    const bool found = std::ranges::any_of(words, [&](const std::string& word) {
      return word == known.text ||
             (known.text.size() >= kLongWord && word.find(known.text) != std::string::npos);
    });
    if (found && (best == nullptr || known.rank > best->rank)) best = &known;
  }
  return best;
}

/// What is left of a name when its unit is taken off, and the unit.
struct SplitName {
  std::string name, unit;
};

/// A unit of the kind in brackets, or as the longest ending of the name that is one.
SplitName split(const std::string& name, Kind kind) {
  for (const auto& [open, close] : {std::pair('[', ']'), std::pair('(', ')')}) {
    const std::size_t from = name.find(open), to = name.find(close, from);
    if (from == std::string::npos || to == std::string::npos) continue;
    if (std::string unit = unit_in(kind, name.substr(from + 1, to - from - 1)); !unit.empty())
      return {name.substr(0, from), std::move(unit)};
  }
  for (std::size_t at = 1; at < name.size(); ++at) {
    if (std::string_view(" _/,.-").find(name[at]) == std::string_view::npos) continue;
    if (std::string unit = unit_in(kind, name.substr(at + 1)); !unit.empty())
      return {name.substr(0, at), std::move(unit)};
  }
  return {name, {}};
}

}  // namespace

std::optional<ColumnGuess> guess_column(const std::string& name) {
  // Symbols of the paper, whose case matters.
  for (const auto& [symbol, kind] :
       {std::pair("V_c", preamplifier_voltage), std::pair("V_m", motor_voltage)}) {
    const SplitName parts = split(name, kind);
    if (parts.name == symbol) return ColumnGuess{kind, false, parts.unit, 9};
  }
  // The word is looked for in what is no unit: the s of "Weg_s" is none, nor the a of "pos_a [mm]".
  static constexpr Kind kKinds[]{time,    position, velocity,      acceleration, tachometer,
                                 current, force,    motor_voltage, command};
  std::optional<ColumnGuess> best;
  for (const Kind kind : kKinds) {
    const SplitName parts = split(name, kind);
    const std::vector<std::string> words = words_of(parts.name);
    if (words.empty() || has_word(words, kIgnoredWords)) continue;
    const Word* word = known_word(words);
    const bool is_setpoint = has_word(words, kSetpointWords);
    if (word == nullptr && !is_setpoint) continue;
    const Kind meant = word == nullptr ? (words.front() == "qg" ? position : command) : word->kind;
    ColumnGuess guess{meant, is_setpoint, {}, word == nullptr ? 2 : word->rank};
    if (meant == kind) {
      guess.unit = parts.unit;
    } else if (!parts.unit.empty() && kind == motor_voltage &&
               (meant == velocity || meant == position || meant == command)) {
      // A voltage that stands for something.
      guess.kind = meant == velocity && is_setpoint  ? set_velocity
                   : is_setpoint || meant == command ? command
                                                     : motor_voltage;
      guess.unit = parts.unit;
    } else {
      continue;
    }
    if (has_word(words, kMeasuredWords)) guess.rank += 3;
    if (!guess.unit.empty()) guess.rank += 20;
    if (!best || guess.rank > best->rank) best = guess;
  }
  return best;
}

std::optional<ChannelGuess> guess_channel(const std::string& name) {
  static constexpr std::string_view kTemperatures[]{"temp", "temperature", "temperatur"};
  static constexpr std::string_view kSupplies[]{
      "supply", "bus", "vbus", "ubus", "vdc", "udc", "dclink", "battery", "akku", "zwischenkreis"};
  const std::vector<std::string> words = words_of(name);
  const auto is_among = [&](std::span<const std::string_view> list) {
    return std::ranges::any_of(words, [&](const std::string& word) {
      return std::ranges::find(list, word) != list.end();
    });
  };
  const auto ends_with_unit = [&](const std::string& unit) {
    const std::string text = plain(name);
    return text.ends_with("[" + unit + "]") || text.ends_with("(" + unit + ")") ||
           text.ends_with("_" + unit);
  };
  if (is_among(kTemperatures) || ends_with_unit("degc"))
    return ChannelGuess{"temperature", ends_with_unit("k") ? "K" : "degC"};
  if (!is_among(kSupplies)) return std::nullopt;
  const std::string unit = split(name, motor_voltage).unit;
  return ChannelGuess{"supply", unit.empty() ? "V" : unit};
}

std::string_view si_unit(Kind kind) {
  switch (kind) {
    case time:
      return "s";
    case position:
      return "m";
    case velocity:
      return "m/s";
    case acceleration:
      return "m/s^2";
    case current:
      return "A";
    case force:
      return "N";
    default:
      return "V";
  }
}

const std::vector<StoredUnit>& stored_units(Kind kind) {
  static const std::vector<StoredUnit> kTime{
      {"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}, {"min", 60.0}};
  static const std::vector<StoredUnit> kPosition{
      {"m", 1.0},
      {"mm", 1e-3},
      {"um", 1e-6},
      {"cm", 1e-2},
      {"inch", 0.0254},
      {"rad", 1.0, "m", 1.0},
      {"deg", kDegree, "m", kDegree},
      {"rev", 2.0 * kPi, "m", 2.0 * kPi},
      {"counts", 1e-6, "m", 1e-6},
  };
  static const std::vector<StoredUnit> kVelocity{
      {"m/s", 1.0},
      {"mm/s", 1e-3},
      {"um/s", 1e-6},
      {"m/min", 1.0 / 60.0},
      {"mm/min", 1e-3 / 60.0},
      {"km/h", 1.0 / 3.6},
      {"rad/s", 1.0, "m/s", 1.0},
      {"deg/s", kDegree, "m/s", kDegree},
      {"rpm", kPi / 30.0, "m/s", kPi / 30.0},
      {"counts/s", 1e-6, "m/s", 1e-6},
  };
  static const std::vector<StoredUnit> kAcceleration{
      {"m/s^2", 1.0},
      {"g", kGravity, "m/s^2", kGravity},
      {"mm/s^2", 1e-3},
      {"rad/s^2", 1.0, "m/s^2", 1.0},
      {"deg/s^2", kDegree, "m/s^2", kDegree},
  };
  // Drives give torque and current in parts of their rating, too.
  static const std::vector<StoredUnit> kCurrent{
      {"A", 1.0}, {"mA", 1e-3}, {"%", 1.0, "A", 1.0}, {"0.1%", 0.1, "A", 0.1}};
  static const std::vector<StoredUnit> kForce{{"N", 1.0},
                                              {"kN", 1e3},
                                              {"N m", 1.0, "N", 1.0},
                                              {"N mm", 1e-3, "N", 1e-3},
                                              {"%", 1.0, "N", 1.0},
                                              {"0.1%", 0.1, "N", 0.1}};
  static const std::vector<StoredUnit> kVolts{{"V", 1.0}, {"mV", 1e-3}};
  static const std::vector<StoredUnit> kCommand{{"V", 1.0},           {"mV", 1e-3},
                                                {"A", 1.0, "V", 1.0}, {"mA", 1e-3, "V", 1e-3},
                                                {"N", 1.0, "V", 1.0}, {"%", 1.0, "V", 1.0}};
  switch (kind) {
    case time:
      return kTime;
    case position:
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

bool is_part_of_rating(std::string_view unit) { return unit.ends_with('%'); }

bool is_of_angles(const StoredUnit& unit) {
  return std::ranges::any_of(std::array{"rad", "deg", "rev", "rpm"},
                             [&](const char* start) { return unit.text.starts_with(start); });
}

const StoredUnit* stored_unit(Kind kind, std::string_view text) {
  const auto& list = stored_units(kind);
  const auto at = std::ranges::find(list, text, &StoredUnit::text);
  return at == list.end() ? nullptr : &*at;
}

const StoredUnit* unit_of_size(Kind kind, double size, bool of_angles) {
  const StoredUnit* other = nullptr;
  for (const StoredUnit& unit : stored_units(kind)) {
    if (!(size > 0.0) || std::abs(std::log(size / unit.size)) >= kSameUnit) continue;
    if (is_of_angles(unit) == of_angles) return &unit;
    if (other == nullptr) other = &unit;
  }
  return other;
}

}  // namespace axisfit
