// What a configuration file may hold: its keys, and for each what kind of value it takes, in which
// unit and range, what holds without it, and what it means. The only place where that stands. The
// readers (ConfigMap) go by it; the JSON schemas and the tables of docs/ are made from it.
//
//   const Section& trim_keys() {
//     static const Section keys{
//         Key::optional("from", Amount{"s"}, Otherwise{"the first sample"}, "start, inclusive"),
//         Key::optional("to", Amount{"s"}, Otherwise{"the last sample"}, "end, inclusive")};
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
struct Flag {};

/// A whole number.
struct Whole {
  std::int64_t lower = 0;
  std::int64_t upper = std::numeric_limits<std::int64_t>::max();
};

/// A number with its unit; a plain number or a percentage where the unit is dimensionless.
struct Amount {
  std::string unit;
  double lower = -kUnlimited;  ///< in `unit`
  double upper = kUnlimited;
  std::string words{};  ///< for people, where the above do not tell all: "V, +-limit"
};

/// [lower, upper], two amounts.
struct Bounds {
  Amount of;
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

/// A map with keys of its own.
struct Map {
  Section keys;
  std::size_t least = 0;     ///< how many of them there must be
  bool may_be_null = false;  ///< nothing after the colon is as good as {}
  std::string shared{};      ///< name for schemas, where the same map occurs under many keys
};

/// A list of at least one value of the same form.
struct List {
  std::vector<Form> of;  ///< one
};

/// A value of one of several forms.
struct Either {
  std::vector<Form> forms;
};

struct Form : std::variant<Text, Flag, Whole, Amount, Bounds, Choice, Map, List, Either> {
  using variant::variant;
};

/// In words, what holds when a key is missing and no single value stands for that.
struct Otherwise {
  std::string words;
};

struct Key {
  std::string name;
  Form form;
  std::string meaning;  ///< a phrase, in Markdown
  bool is_required = false;
  std::string standard{};   ///< the value, as it would be written, that holds when it is missing
  std::string otherwise{};  ///< or in words
  std::string used{};       ///< by which axes, in words; empty: by all

  static Key required(std::string name, Form form, std::string meaning);
  static Key optional(std::string name, Form form, Otherwise otherwise, std::string meaning);
  /// With the value that the program has by itself.
  template <class T>
  requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) static Key
      optional(std::string name, Form form, T standard, std::string meaning) {
    Key key{std::move(name), std::move(form), std::move(meaning)};
    key.standard = key.written(static_cast<double>(standard));
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
std::string standard_text(const Key& key);

}  // namespace axisfit
