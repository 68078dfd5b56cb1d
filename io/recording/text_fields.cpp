#include "io/recording/text_fields.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <limits>

#include "base/units.h"

namespace axisfit {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

bool equals(std::string_view text, std::string_view lower_case) {
  return text.size() == lower_case.size() && lower(text) == lower_case;
}

bool is_missing_word(std::string_view text) {
  constexpr std::array<std::string_view, 10> kWords{"nan",  "-nan", "na", "n/a", "#n/a",
                                                    "null", "none", "-",  "--",  "(null)"};
  return text.size() <= 6 &&
         std::ranges::any_of(kWords, [&](std::string_view word) { return equals(text, word); });
}

/// Takes as many digits as there are, at most `most`, off the front.
std::optional<int> take_digits(std::string_view& text, std::size_t least, std::size_t most) {
  std::size_t count = 0;
  while (count < text.size() && count < most && is_digit(text[count])) ++count;
  if (count < least) return std::nullopt;
  int value = 0;
  std::from_chars(text.data(), text.data() + count, value);
  text.remove_prefix(count);
  return value;
}

bool take(std::string_view& text, std::string_view any_of) {
  if (text.empty() || any_of.find(text.front()) == std::string_view::npos) return false;
  text.remove_prefix(1);
  return true;
}

/// Days since 1970-01-01.
std::optional<double> take_date(std::string_view& text) {
  const auto year = take_digits(text, 4, 4);
  if (!year || !take(text, "-/")) return std::nullopt;
  const auto month = take_digits(text, 1, 2);
  if (!month || !take(text, "-/")) return std::nullopt;
  const auto day = take_digits(text, 1, 2);
  if (!day) return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year(*year),
                                         std::chrono::month(static_cast<unsigned>(*month)),
                                         std::chrono::day(static_cast<unsigned>(*day))};
  if (!date.ok()) return std::nullopt;
  return static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count());
}

/// Seconds since midnight.
std::optional<double> take_time_of_day(std::string_view& text) {
  const auto hours = take_digits(text, 1, 2);
  if (!hours || *hours > 23 || !take(text, ":")) return std::nullopt;
  const auto minutes = take_digits(text, 2, 2);
  if (!minutes || *minutes > 59) return std::nullopt;
  if (!take(text, ":")) return std::nullopt;  // hours and minutes alone clock nothing
  const auto whole = take_digits(text, 2, 2);
  if (!whole || *whole > 60) return std::nullopt;
  double fraction = 0.0, place = 1.0;
  if (text.size() > 1 && (text[0] == '.' || text[0] == ',') && is_digit(text[1]))
    for (text.remove_prefix(1); !text.empty() && is_digit(text.front()); text.remove_prefix(1))
      if (place < 1e15) fraction = 10.0 * fraction + (text.front() - '0'), place *= 10.0;
  return 3600.0 * *hours + 60.0 * *minutes + *whole + fraction / place;
}

/// Seconds that local time is ahead of UTC; zero where nothing is said.
std::optional<double> take_offset(std::string_view& text) {
  if (take(text, "Zz") || text.empty()) return 0.0;
  const double sign = text.front() == '-' ? -1.0 : 1.0;
  if (!take(text, "+-")) return std::nullopt;
  const auto hours = take_digits(text, 2, 2);
  if (!hours) return std::nullopt;
  take(text, ":");
  const auto minutes = take_digits(text, 2, 2);
  return sign * (3600.0 * *hours + 60.0 * minutes.value_or(0));
}

FieldKind number(std::string_view text, double& value) {
  const char* const end = text.data() + text.size();
  const auto [stop, code] = std::from_chars(text.data(), end, value);
  if (code == std::errc::invalid_argument || stop != end) return FieldKind::text;
  if (code == std::errc::result_out_of_range) return FieldKind::out_of_range;
  if (std::isfinite(value)) return FieldKind::number;
  return std::isnan(value) ? FieldKind::missing : FieldKind::infinite;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") + 1 - begin);
}

bool split_fields(std::string_view line, char separator, std::vector<std::string>& fields) {
  fields.clear();
  const bool blanks = separator == ' ';
  std::string_view rest = blanks ? trimmed(line) : line;
  if (blanks && rest.empty()) return true;
  for (bool more = true; more;) {
    const std::size_t start = rest.find_first_not_of(separator == '\t' ? " " : " \t");
    std::string text;
    if (start != std::string_view::npos && rest[start] == '"') {
      std::size_t at = start + 1;
      for (; at < rest.size(); ++at) {
        if (rest[at] == '"' && (at + 1 == rest.size() || rest[at + 1] != '"')) break;
        if (rest[at] == '"') ++at;
        text += rest[at];
      }
      const std::string_view behind = at < rest.size() ? rest.substr(at + 1) : std::string_view();
      const std::size_t end = blanks ? behind.find_first_of(" \t") : behind.find(separator);
      if (at >= rest.size() || !trimmed(behind.substr(0, end)).empty()) {
        fields.emplace_back(trimmed(rest));
        return false;
      }
      more = end != std::string_view::npos;
      rest = more ? behind.substr(end + 1) : std::string_view();
      text = trimmed(text);
    } else {
      const std::size_t end = blanks ? rest.find_first_of(" \t") : rest.find(separator);
      more = end != std::string_view::npos;
      text = trimmed(rest.substr(0, end));
      rest = more ? rest.substr(end + 1) : std::string_view();
    }
    if (blanks) rest = trimmed(rest);
    fields.push_back(std::move(text));
  }
  return true;
}

std::optional<double> parse_time(std::string_view text) {
  if (text.size() < 7 || !is_digit(text.front())) return std::nullopt;
  std::string_view rest = text;
  const auto days = take_date(rest);
  if (days) {
    if (!take(rest, "Tt ")) return std::nullopt;
  } else {
    rest = text;
  }
  const auto seconds = take_time_of_day(rest);
  if (!seconds) return std::nullopt;
  const auto offset = take_offset(rest);
  if (!offset || !rest.empty()) return std::nullopt;
  return days.value_or(0.0) * 86400.0 + *seconds - *offset;
}

FieldKind read_field(std::string_view field, char decimal, double& value) {
  const auto none = [&](FieldKind kind) {
    value = std::numeric_limits<double>::quiet_NaN();
    return kind;
  };
  std::string_view text = trimmed(field);
  if (text.empty() || is_missing_word(text)) return none(FieldKind::missing);
  const std::string_view whole = text;
  // from_chars takes no plus sign, though it is common in hand-made files.
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  FieldKind kind = number(text, value);
  if (kind == FieldKind::text && decimal != '.') {
    const std::size_t mark = text.find(decimal);
    if (mark != std::string_view::npos && text.find('.') == std::string_view::npos) {
      std::string with_point(text);
      with_point[mark] = '.';
      kind = number(with_point, value);
    }
  }
  if (kind == FieldKind::number) return kind;
  if (kind != FieldKind::text) return none(kind);
  if (const auto time = parse_time(whole)) {
    value = *time;
    return FieldKind::number;
  }
  if (equals(whole, "true") || equals(whole, "false")) {
    value = equals(whole, "true") ? 1.0 : 0.0;
    return FieldKind::number;
  }
  return none(FieldKind::text);
}

std::string_view without_brackets(std::string_view text) {
  text = trimmed(text);
  constexpr std::string_view kOpen = "([<{", kClose = ")]>}";
  if (text.size() < 2) return text;
  const std::size_t kind = kOpen.find(text.front());
  return kind != std::string_view::npos && text.back() == kClose[kind]
             ? trimmed(text.substr(1, text.size() - 2))
             : text;
}

bool is_unit(std::string_view text) {
  constexpr std::size_t kLongest = 20;
  constexpr std::array<std::string_view, 22> kTrade{
      "inc", "incs",         "ink",    "inkr",  "inkr.",  "count", "counts", "cts",
      "cnt", "digit",        "digits", "lsb",   "rpm",    "u/min", "1/min",  "r/min",
      "%",   "\xE2\x80\xB0", "rev",    "pulse", "pulses", "1"};
  const std::string_view unit = without_brackets(text);
  if (std::ranges::find(kTrade, lower(unit)) != kTrade.end()) return true;
  if (unit.empty() || unit.size() > kLongest) return false;
  const auto found = unit_factor(unit, "m");
  const auto* const problem = std::get_if<UnitError>(&found);
  return problem == nullptr || problem->problem != UnitProblem::unknown;
}

}  // namespace axisfit
