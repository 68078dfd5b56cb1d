#include "init/columns/names.h"

#include <algorithm>
#include <iterator>
#include <span>
#include <string_view>
#include <utility>

namespace axisfit {
namespace {

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
    {"volts", motor_voltage, 5},
    {"applied", motor_voltage, 4},
    {"spannung", motor_voltage, 6},
    {"timestamp", time, 9},
    {"millis", time, 7},
    {"micros", time, 7},
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
    {"power", command, 3},
    {"throttle", command, 3},
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
    {"omega", velocity, 6},
    {"qvel", velocity, 6},
    {"theta", position, 5},
    {"phi", position, 5},
    {"qpos", position, 6},
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
    {"y", position, 3},
    {"z", position, 3},
    {"q", position, 4},
    {"s", position, 2},
    {"v", velocity, 4},
    {"a", acceleration, 4},
    {"i", current, 4},
    {"f", force, 3},
    {"u", command, 4},
};

constexpr std::string_view kSetpointWords[]{
    "set",      "cmd",      "command",    "commanded",   "ref",     "target", "desired", "demand",
    "setpoint", "sollwert", "soll",       "reference",   "nominal", "goal",   "qg",      "vorgabe",
    "planned",  "plan",     "trajectory", "feedforward", "dem",     "des",    "qdes",    "sp",
    "0x6062",   "0x607a",   "0x606b",     "0x60ff",      "0x6071",  "0x6074"};
constexpr std::string_view kMeasuredWords[]{"actual",   "act",      "ist", "meas",
                                            "measured", "feedback", "fb",  "present"};
constexpr std::string_view kIgnoredWords[]{
    "error",      "err",     "fehler",   "deviation",   "diff",   "lag",
    "abweichung", "schlepp", "residual", "status",      "index",  "sample",
    "simulated",  "noise",   "temp",     "temperature", "enable", "enabled",
    "freigabe",   "limit",   "max",      "min",         "mode",   "anlage"};
constexpr std::string_view kMotorWords[]{"motor", "rotor"};
constexpr std::string_view kLoadWords[]{"load",    "link", "joint", "output", "arm",
                                        "abtrieb", "last", "scale", "linear"};
constexpr std::string_view kDutyWords[]{"duty", "pwm", "power", "throttle", "dutycycle"};
constexpr std::string_view kTurningWords[]{"torque", "tau",   "drehmoment", "trq",   "angle",
                                           "winkel", "theta", "phi",        "omega", "drehzahl"};
constexpr std::string_view kRawWords[]{"raw", "adc", "roh", "rohwert"};
constexpr std::string_view kWatts[]{"w", "watt", "watts", "kw"};
/// They say nothing of the axis.
constexpr std::string_view kPlainWords[]{
    "value",   "wert", "filtered", "filt",   "smoothed", "axis",    "achse", "drive", "signal",
    "channel", "data", "state",    "states", "sensor",   "encoder", "rms",   "total"};

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
  std::string unknown_unit{};  ///< in brackets, no unit of the kind
};

/// What stands in the brackets of a name, and what stands before.
std::optional<std::pair<std::string, std::string>> bracketed(const std::string& name) {
  for (const auto& [open, close] : {std::pair('[', ']'), std::pair('(', ')')}) {
    const std::size_t from = name.find(open), to = name.find(close, from);
    if (from != std::string::npos && to != std::string::npos)
      return std::pair(name.substr(0, from), name.substr(from + 1, to - from - 1));
  }
  return std::nullopt;
}

/// Whether an ending may begin there: at a sign, or at a capital inside.
bool is_border(const std::string& name, std::size_t at) {
  const auto is_lower = [](char c) { return c >= 'a' && c <= 'z'; };
  return std::string_view(" _/,.-").find(name[at]) != std::string_view::npos ||
         (name[at] >= 'A' && name[at] <= 'Z' && is_lower(name[at - 1]));
}

/// A unit of the kind in brackets, or as the longest ending of the name that is one.
SplitName split(const std::string& name, Kind kind) {
  const auto brackets = bracketed(name);
  if (brackets) {
    const auto& [before, inside] = *brackets;
    std::string unit = unit_meant(kind, inside);
    if (!unit.empty()) return {before, std::move(unit)};
  }
  constexpr std::size_t kLongest = 24;  // of a unit; names may be of any length
  for (std::size_t at = std::max(kLongest, name.size()) - kLongest; at < name.size(); ++at) {
    if (at == 0 || !is_border(name, at)) continue;
    const bool is_sign = name[at] < 'A' || name[at] == '_';
    if (std::string unit = unit_in(kind, name.substr(is_sign ? at + 1 : at)); !unit.empty())
      return {name.substr(0, at), std::move(unit)};
  }
  // Not the number of an element, as in "q(:,2)".
  const bool is_text = brackets && std::ranges::any_of(brackets->second, [](char c) {
                         return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
                       });
  return is_text ? SplitName{name, {}, brackets->second} : SplitName{name, {}};
}

/// The kind that a unit alone tells, of a name that says no more than "set" or "z".
std::optional<Kind> kind_of_unit(const std::string& name) {
  for (const Kind kind : {position, velocity, acceleration, current, force})
    if (const std::string unit = split(name, kind).unit; !unit.empty() && !is_part_of_rating(unit))
      return kind;
  return std::nullopt;
}

/// The same of a name that says nothing else, such as "spindle_turns": of a motion, since what else
/// has such a unit is rare, and by more than one letter.
std::optional<Kind> kind_of_long_unit(const std::string& name) {
  for (const Kind kind : {position, velocity, acceleration})
    if (const SplitName parts = split(name, kind); parts.unit.size() > 1 && !is_raw(parts.unit))
      return kind;
  return std::nullopt;
}

Side side_of(const std::vector<std::string>& words) {
  return has_word(words, kLoadWords)    ? Side::load
         : has_word(words, kMotorWords) ? Side::motor
                                        : Side::unsaid;
}

/// What is left when the words that were understood are taken away.
std::vector<std::string> axis_in(const std::vector<std::string>& words, const Word* known) {
  std::vector<std::string> left;
  for (const std::string& word : words) {
    const std::vector<std::string> one{word};
    const auto is_among = [&](std::span<const std::string_view> list) {
      return has_word(one, list);
    };
    const bool is_known = known != nullptr && word.find(known->text) != std::string::npos &&
                          (word == known->text || known->text.size() >= kLongWord);
    if (!is_known && !is_among(kSetpointWords) && !is_among(kMeasuredWords) &&
        !is_among(kMotorWords) && !is_among(kLoadWords) && !is_among(kDutyWords) &&
        !is_among(kRawWords) && !is_among(kPlainWords))
      left.push_back(word);
  }
  return left;
}

/// Of a time whose name is its unit: what a microcontroller counts.
std::string unit_of_clock(const std::vector<std::string>& words) {
  for (const std::string& word : words)
    if (word == "millis" || word == "micros") return unit_in(time, word);
  return {};
}

/// What a name says if its unit is one of that kind. Nothing where that does not go together.
std::optional<ColumnGuess> guess_as(Kind kind, const std::string& name) {
  const SplitName parts = split(name, kind);
  const std::vector<std::string> words = words_of(parts.name);
  if (words.empty() || has_word(words, kIgnoredWords)) return std::nullopt;
  const Word* word = known_word(words);
  const bool is_setpoint = has_word(words, kSetpointWords);
  const bool is_measured = has_word(words, kMeasuredWords);
  ColumnGuess guess;
  guess.is_setpoint = is_setpoint;
  guess.is_measured = is_measured;
  if (word != nullptr) {
    guess.kind = word->kind;
    guess.rank = word->rank;
    if (word->text == "power" && (!parts.unknown_unit.empty() || has_word(words, kWatts)))
      return std::nullopt;
  } else if (const auto told = is_setpoint || is_measured ? kind_of_unit(name) : std::nullopt) {
    guess.kind = *told;
    guess.rank = 2;
  } else if (const auto ending = kind_of_long_unit(name)) {
    guess.kind = *ending;
    guess.rank = 1;
  } else if (is_setpoint) {
    guess.kind = words.front() == "qg" || words.front() == "qdes" ? position : command;
    guess.rank = 2;
  } else {
    return std::nullopt;
  }
  const Kind meant = guess.kind;
  if (meant == kind) {
    guess.unit = parts.unit;
    guess.unknown_unit = parts.unknown_unit;
    if (kind == time && guess.unit.empty()) guess.unit = unit_of_clock(words);
  } else if (!parts.unit.empty() && kind == motor_voltage &&
             (meant == velocity || meant == position || meant == command)) {
    // A voltage that stands for something.
    guess.kind = meant == velocity && is_setpoint  ? set_velocity
                 : is_setpoint || meant == command ? command
                                                   : motor_voltage;
    guess.unit = parts.unit;
  } else {
    return std::nullopt;
  }
  guess.is_duty = guess.kind == command && has_word(words, kDutyWords) &&
                  (guess.unit.empty() || is_part_of_rating(guess.unit));
  guess.turns = has_word(words, kTurningWords);
  guess.side = side_of(words);
  guess.axis = axis_in(words, word);
  if (is_measured) guess.rank += 3;
  constexpr int kOfUnit = 20, kOfCounts = 2, kOfRaw = -4;
  if (!guess.unit.empty()) guess.rank += is_raw(guess.unit) ? kOfCounts : kOfUnit;
  if (has_word(words, kRawWords)) guess.rank += kOfRaw;
  return guess;
}

}  // namespace

std::optional<ColumnGuess> guess_column(const std::string& name) {
  // Symbols of the paper, whose case matters.
  for (const auto& [symbol, kind] :
       {std::pair("V_c", preamplifier_voltage), std::pair("V_m", motor_voltage)}) {
    const SplitName parts = split(name, kind);
    if (parts.name != symbol) continue;
    ColumnGuess guess;
    guess.kind = kind;
    guess.unit = parts.unit;
    guess.rank = 9;
    return guess;
  }
  // The word is looked for in what is no unit: the s of "Weg_s" is none, nor the a of "pos_a [mm]".
  static constexpr Kind kInOrder[]{time,    position, velocity,      acceleration, tachometer,
                                   current, force,    motor_voltage, command};
  std::optional<ColumnGuess> best;
  for (const Kind kind : kInOrder)
    if (auto guess = guess_as(kind, name); guess && (!best || guess->rank > best->rank))
      best = std::move(guess);
  return best;
}

std::optional<ChannelGuess> guess_channel(const std::string& name) {
  static constexpr std::string_view kTemperatures[]{"temp", "temperature", "temperatur"};
  static constexpr std::string_view kSupplies[]{"supply", "vsupply", "vbat", "vbus",
                                                "bus",    "ubus",    "vdc",  "udc",
                                                "dclink", "battery", "akku", "zwischenkreis"};
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
  static constexpr std::string_view kPressures[]{"pressure", "press", "druck"};
  static constexpr std::string_view kUnitsOfPressure[]{"mbar", "bar", "hPa", "kPa",
                                                       "MPa",  "Pa",  "psi"};
  if (is_among(kPressures))
    for (const std::string_view unit : kUnitsOfPressure)
      if (ends_with_unit(plain(std::string(unit))))
        return ChannelGuess{"pressure", std::string(unit)};
  if (!is_among(kSupplies)) return std::nullopt;
  const std::string unit = split(name, Kind::motor_voltage).unit;
  return ChannelGuess{"supply", unit.empty() ? "V" : unit};
}

}  // namespace axisfit
