// What a configuration file may hold: its keys, and for each what kind of value it takes, in which
// unit and range, what holds without it, and what it means. The only place where that stands. The
// readers (ConfigMap) go by it; the JSON schemas and the tables of docs/ are made from it.
//
//   const Section& trim_keys() {
//     static const Section keys{
//         Key::optional("from", NumberWithUnit{"s"}, DefaultText{"the first sample"}, "start,
//         inclusive"), Key::optional("to", NumberWithUnit{"s"}, DefaultText{"the last sample"},
//         "end, inclusive")};
//     return keys;
//   }
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "sim/quantity.h"

namespace axisfit {

struct Key;
struct Form;

/// The keys of a map.
using Section = std::vector<Key>;

inline constexpr double kUnlimited = std::numeric_limits<double>::infinity();

/// A text, such as the name of a file.
struct Text {};

/// true or false.
struct Boolean {};

/// A whole number.
struct Integer {
  std::int64_t lower = 0;
  std::int64_t upper = std::numeric_limits<std::int64_t>::max();
};

/// A number with its unit; a plain number or a percentage where the unit is dimensionless.
struct NumberWithUnit {
  std::string unit;
  double lower = -kUnlimited;  ///< in `unit`
  double upper = kUnlimited;
  std::string description{};  ///< for people, where the above do not tell all: "V, +-limit"
};

/// [lower, upper], two amounts.
struct Bounds {
  NumberWithUnit of;
};

struct Option {
  std::string name;
  std::string meaning{};
};

/// One of several words.
struct Choice {
  std::vector<Option> options;

  std::vector<std::string> names() const;
};

struct NamedEntry;

/// A map with keys of its own.
struct Map {
  Section keys;
  std::size_t min_entries;  ///< how many of them there must be
  bool nullable;            ///< nothing after the colon is as good as {}
  std::string schema_name;  ///< name for schemas, where the same map occurs under many keys
  /// What stands under names that the user gives, besides the keys.
  std::vector<NamedEntry> named;

  // No aggregate: entries are complete further down only.
  explicit Map(Section of_keys, std::size_t at_least = 0, bool may_be_null = false,
               std::string name = {});
  Map(Section of_keys, std::size_t at_least, bool may_be_null, std::string name,
      std::vector<NamedEntry> named_entries);
};

/// A list of at least one value of the same form.
struct List {
  std::vector<Form> of;  ///< one
};

/// A value of one of several forms.
struct AnyOf {
  std::vector<Form> forms;
};

struct Form
    : std::variant<Text, Boolean, Integer, NumberWithUnit, Bounds, Choice, Map, List, AnyOf> {
  using variant::variant;
};

/// An entry under a name that the user gives.
struct NamedEntry {
  std::string pattern;  ///< of such names, a regular expression
  Form form;
};

/// In words, what holds when a key is missing and no single value stands for that.
struct DefaultText {
  std::string description;
};

struct Key {
  std::string name;
  Form form;
  std::string meaning;  ///< a phrase, in Markdown
  bool is_required = false;
  std::string
      default_value{};         ///< the value, as it would be written, that holds when it is missing
  std::string default_text{};  ///< or in words
  std::string used_by{};       ///< by which axes, in words; empty: by all

  static Key required(std::string name, Form form, std::string meaning);
  static Key optional(std::string name, Form form, DefaultText default_text, std::string meaning);
  /// With the value that the program has by itself.
  template <class T>
  requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) static Key
      optional(std::string name, Form form, T default_value, std::string meaning) {
    Key key{std::move(name), std::move(form), std::move(meaning)};
    key.default_value = key.written(static_cast<double>(default_value));
    return key;
  }
  /// A quantity of the model, under its symbol or another name.
  static Key of(const Quantity& quantity);
  static Key of(const Quantity& quantity, std::string name);

 private:
  std::string written(
      double value) const;  // a flag's is 0 or 1, a choice's the place of its option
};

/// The key of that name. Throws std::logic_error when the section has none: a reader must not know
/// more keys than are described.
const Key& find_key(const Section& section, std::string_view name);

/// The keys of the map that a key of this section holds.
const Section& keys_below(const Section& section, std::string_view name);

/// Which value a key takes, in words and Markdown: "s, 1e-5 .. 1", "`fit` or `validate`".
std::string value_text(const Form& form);

/// What the key means, with the options of a choice.
std::string meaning_text(const Key& key);

/// What holds without the key: "required", "5 ms", "all samples".
std::string default_description(const Key& key);

}  // namespace axisfit
