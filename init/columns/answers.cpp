#include "init/columns/answers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <variant>

#include "base/plain_text.h"
#include "base/units.h"

namespace axisfit {
namespace {

struct Answerable {
  std::string_view name;
  Kind kind;
  bool is_setpoint = false;
  bool is_duty = false;
};

/// As jobs call them on either joint, and as one may call them besides.
constexpr Answerable kAnswerable[]{{"time", Kind::time},
                                   {"position", Kind::position},
                                   {"position_reference", Kind::position, true},
                                   {"load_position", Kind::load_position},
                                   {"velocity", Kind::velocity},
                                   {"acceleration", Kind::acceleration},
                                   {"force", Kind::force},
                                   {"torque", Kind::force},
                                   {"drive_force", Kind::force},
                                   {"drive_torque", Kind::force},
                                   {"current", Kind::current},
                                   {"motor_current", Kind::current},
                                   {"command", Kind::command},
                                   {"duty", Kind::command, false, true},
                                   {"supply", Kind::supply},
                                   {"set_velocity", Kind::set_velocity},
                                   {"tachometer", Kind::tachometer},
                                   {"preamplifier_voltage", Kind::preamplifier_voltage},
                                   {"V_c", Kind::preamplifier_voltage},
                                   {"motor_voltage", Kind::motor_voltage},
                                   {"V_m", Kind::motor_voltage}};

std::optional<double> number_in(std::string_view text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  if (text.empty() || std::from_chars(text.data(), end, value).ptr != end) return std::nullopt;
  return value;
}

/// Takes a factor, or a divisor, which is a number behind the last sign, off a unit.
std::optional<double> take_factor(std::string& unit) {
  const std::size_t sign = unit.find_last_of("*/");
  if (sign == std::string::npos) return 1.0;
  const auto number = number_in(std::string_view(unit).substr(sign + 1));
  if (!number) return 1.0;
  if (!(std::abs(*number) > 0.0) || !std::isfinite(*number)) return std::nullopt;
  const double factor = unit[sign] == '/' ? 1.0 / *number : *number;
  unit.resize(sign);
  return factor;
}

}  // namespace

ColumnAnswer read_answer(const std::string& text) {
  const auto refuse = [&](const std::string& problem) {
    return std::runtime_error(
        fmt::format("--column {}: {}; write SIGNAL=COLUMN:UNIT, such as position=3:mm, "
                    "position=\"Geber [Ink]:um/8\" or force=Torque:N*0.2",
                    sanitized(text), problem));
  };
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals + 1 == text.size())
    throw refuse("the signal or the column is missing");
  const std::string signal = text.substr(0, equals);
  const auto* const known = std::ranges::find(kAnswerable, signal, &Answerable::name);
  if (known == std::end(kAnswerable))
    throw refuse(fmt::format("there is no signal '{}', but {}", sanitized(signal),
                             fmt::join(answerable_signals(), ", ")));
  ColumnAnswer answer;
  answer.kind = known->kind;
  answer.is_setpoint = known->is_setpoint;
  answer.is_duty = known->is_duty;
  const std::size_t last = text.rfind(':'),
                    colon = last == std::string::npos || last < equals ? std::string::npos : last;
  answer.column = text.substr(equals + 1, std::min(colon, text.size()) - equals - 1);
  if (answer.column.empty()) throw refuse("the column is missing");
  if (colon == std::string::npos) return answer;
  answer.unit = text.substr(colon + 1);
  const auto factor = take_factor(answer.unit);
  if (!factor) throw refuse("the factor must be a number other than zero");
  answer.factor = *factor;
  if (const std::string meant = unit_meant(answer.kind, answer.unit); !meant.empty()) {
    answer.unit = meant;
    return answer;
  }
  const auto conversion = unit_factor(answer.unit, si_unit(answer.kind));
  if (const auto* problem = std::get_if<UnitError>(&conversion)) throw refuse(problem->message);
  return answer;
}

double read_rate(const std::string& text) {
  const std::size_t end = std::min(text.find_first_not_of("0123456789.+-eE"), text.size());
  std::size_t unit = end;
  while (unit < text.size() && text[unit] == ' ') ++unit;
  const auto number = number_in(std::string_view(text).substr(0, end));
  const auto factor =
      unit_factor(unit < text.size() ? std::string_view(text).substr(unit) : "Hz", "Hz");
  const double rate =
      number && std::holds_alternative<double>(factor) ? *number * std::get<double>(factor) : 0.0;
  constexpr double kLeast = 1e-3, kMost = 1e8;
  if (!(rate >= kLeast && rate <= kMost))
    throw std::runtime_error(fmt::format(
        "--rate {}: write how many samples a second there are, such as \"1 kHz\" or 500Hz",
        sanitized(text)));
  return rate;
}

std::vector<std::string_view> answerable_signals() {
  std::vector<std::string_view> names;
  for (const Answerable& signal : kAnswerable) names.push_back(signal.name);
  return names;
}

}  // namespace axisfit
