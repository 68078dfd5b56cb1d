#include "io/config/key.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include "base/units.h"

namespace axisfit {
namespace {

/// "1e-5", "0.02", "1000", "1e6"
std::string short_number(double value) {
  if (value == 0.0) return "0";
  char buffer[32];
  const char* end =
      std::to_chars(std::begin(buffer), std::end(buffer), value, std::chars_format::scientific).ptr;
  const char* e = std::find(static_cast<const char*>(buffer), end, 'e');
  const int exponent = std::stoi(std::string(e + 1, end));
  if (exponent >= -2 && exponent <= 3) return fmt::format("{}", value);
  return fmt::format("{}e{}", std::string_view(buffer, static_cast<std::size_t>(e - buffer)),
                     exponent);
}

/// "5 ms" for 0.005 s: with the thousandth of a unit where that is easier to read.
std::string readable(double value, std::string_view unit) {
  const bool takes_prefix = unit == "s" || unit == "m/s";
  if (takes_prefix && value != 0.0 && std::abs(value) < 1.0)
    return fmt::format("{} m{}", short_number(1000.0 * value), unit);
  return with_unit(short_number(value), unit);
}

std::string range_text(double lower, double upper) {
  if (lower == -kUnlimited && upper == kUnlimited) return "";
  if (upper == kUnlimited) return ">= " + short_number(lower);
  if (lower == -kUnlimited) return "<= " + short_number(upper);
  if (lower == -upper) return "+-" + short_number(upper);
  return fmt::format("{} .. {}", short_number(lower), short_number(upper));
}

/// How a table says which axes have a quantity.
std::string used_by_text(UsedBy used_by) {
  switch (used_by) {
    case UsedBy::every_axis:
    case UsedBy::controller:
      return "";
    case UsedBy::velocity_loop:
      return "`velocity_loop`";
    case UsedBy::electric_drive:
      return "`velocity_loop`, `current_source`";
    case UsedBy::force_source:
      return "`force_source`, `motor_current`, `rated_force`";
    case UsedBy::motor_constant:
      return "`velocity_loop`, `current_source`, `motor_voltage`";
    case UsedBy::armature:
      return "`velocity_loop`, `motor_voltage`";
    case UsedBy::backlash:
      return "`backlash`";
    case UsedBy::rigid:
      return "`rigid`";
    case UsedBy::motor:
      return "`backlash`, or a drive whose command is no force";
  }
  return "";
}

/// value_text() of each form.
struct ValueText {
  std::string operator()(const Text&) const { return "text"; }
  std::string operator()(const Boolean&) const { return "`true` or `false`"; }
  std::string operator()(const Integer& integer) const {
    return integer.upper == Integer().upper
               ? fmt::format("whole number from {}", integer.lower)
               : fmt::format("whole number, {} .. {}", integer.lower, integer.upper);
  }
  std::string operator()(const NumberWithUnit& amount) const {
    if (!amount.description.empty()) return amount.description;
    const std::string range = range_text(amount.lower, amount.upper);
    const std::string unit = is_dimensionless(amount.unit) ? "number" : amount.unit;
    return range.empty() ? unit : unit + ", " + range;
  }
  std::string operator()(const Bounds& bounds) const {
    return fmt::format("[lower, upper], {}{}", bounds.of.description.empty() ? "" : "each ",
                       (*this)(bounds.of));
  }
  std::string operator()(const Choice& choice) const {
    std::vector<std::string> names = choice.names();
    for (std::string& name : names) name = '`' + name + '`';
    const std::string last = names.back();
    names.pop_back();
    return names.empty() ? last : fmt::format("{} or {}", fmt::join(names, ", "), last);
  }
  std::string operator()(const Map& map) const {
    // A small map is told at once, a large one has a table of its own.
    if (map.keys.size() > 2) return "map";
    std::vector<std::string> entries;
    for (const Key& key : map.keys)
      entries.push_back(fmt::format("{}: {}", key.name, value_text(key.form)));
    for (const NamedEntry& entry : map.named)
      entries.push_back(fmt::format("NAME: {}", value_text(entry.form)));
    return fmt::format("{{{}}}", fmt::join(entries, ", "));
  }
  std::string operator()(const List& list) const {
    const std::string of = value_text(list.of.front());
    return of == "map" ? "list of maps" : "list, each " + of;
  }
  std::string operator()(const AnyOf& alternatives) const {
    std::vector<std::string> texts;
    for (const Form& form : alternatives.forms) texts.push_back(value_text(form));
    return fmt::format("{}", fmt::join(texts, "; or "));
  }
};

}  // namespace

Map::Map(Section of_keys, std::size_t at_least, bool may_be_null, std::string name)
    : Map(std::move(of_keys), at_least, may_be_null, std::move(name), {}) {}

Map::Map(Section of_keys, std::size_t at_least, bool may_be_null, std::string name,
         std::vector<NamedEntry> named_entries)
    : keys(std::move(of_keys)),
      min_entries(at_least),
      nullable(may_be_null),
      schema_name(std::move(name)),
      named(std::move(named_entries)) {}

std::vector<std::string> Choice::names() const {
  std::vector<std::string> names;
  for (const Option& option : options) names.push_back(option.name);
  return names;
}

Key Key::required(std::string name, Form form, std::string meaning) {
  return {std::move(name), std::move(form), std::move(meaning), true};
}

Key Key::optional(std::string name, Form form, DefaultText default_text, std::string meaning) {
  Key key{std::move(name), std::move(form), std::move(meaning)};
  key.default_text = std::move(default_text.description);
  return key;
}

Key Key::of(const Quantity& quantity) { return of(quantity, std::string(quantity.symbol)); }

Key Key::of(const Quantity& quantity, std::string name) {
  const NumberWithUnit amount{std::string(quantity.unit), quantity.lower, quantity.upper};
  std::string meaning(quantity.meaning);
  Key key = std::isnan(quantity.default_value)
                ? required(std::move(name), amount, std::move(meaning))
                : optional(std::move(name), amount, quantity.default_value, std::move(meaning));
  key.used_by = used_by_text(quantity.used_by);
  return key;
}

std::string Key::written(double value) const {
  if (const auto* amount = std::get_if<NumberWithUnit>(&form)) return readable(value, amount->unit);
  if (const auto* choice = std::get_if<Choice>(&form))
    return choice->options.at(static_cast<std::size_t>(value)).name;
  if (const auto* alternatives = std::get_if<AnyOf>(&form)) {
    Key first{name, alternatives->forms.front(), meaning};
    return first.written(value);
  }
  if (std::holds_alternative<Boolean>(form)) return value != 0.0 ? "true" : "false";
  return fmt::format("{}", value);
}

const Key& find_key(const Section& section, std::string_view name) {
  const auto found = std::ranges::find(section, name, &Key::name);
  if (found == section.end())
    throw std::logic_error(fmt::format("the key '{}' is not described", name));
  return *found;
}

const Section& keys_below(const Section& section, std::string_view name) {
  return std::get<Map>(find_key(section, name).form).keys;
}

std::string value_text(const Form& form) {
  return std::visit(ValueText(), static_cast<const Form::variant&>(form));
}

std::string meaning_text(const Key& key) {
  std::vector<std::string> options;
  const auto add_options = [&](const Form& form) {
    if (const auto* choice = std::get_if<Choice>(&form))
      for (const Option& option : choice->options)
        if (!option.meaning.empty())
          options.push_back(fmt::format("`{}`: {}", option.name, option.meaning));
  };
  add_options(key.form);
  if (const auto* alternatives = std::get_if<AnyOf>(&key.form))
    std::ranges::for_each(alternatives->forms, add_options);
  if (options.empty()) return key.meaning;
  return fmt::format("{} ({})", key.meaning, fmt::join(options, "; "));
}

std::string default_description(const Key& key) {
  if (key.is_required) return "required";
  return key.default_value.empty() ? key.default_text : key.default_value;
}

}  // namespace axisfit
