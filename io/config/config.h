// Typed reading of YAML configuration files: every mistake of the user is reported as
// "file:line:column: message", and all of them at once.
//
//   Diagnostics diagnostics;
//   if (const auto root = ConfigNode::load("job.yaml", diagnostics)) {
//     ConfigMap map(*root, job_keys());    // which describes the key "mass": unit, range, ...
//     map.read("mass", job.mass);
//     map.finish();
//   }
//   diagnostics.throw_if_any();
#pragma once

#include <yaml-cpp/yaml.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "io/config/diagnostics.h"
#include "io/config/key.h"

namespace axisfit {

/// A value of a configuration file together with its place; cheap to copy.
///
/// The readers as_...() return nothing and record a diagnostic when the value is not what they
/// want. Limits are inclusive; an infinite one does not limit.
class ConfigNode {
 public:
  /// Reads the only document of a YAML file in UTF-8. Nothing, with a diagnostic, when the file
  /// cannot be read, exceeds 1 MiB, is not YAML or nests more than 32 levels or has more than
  /// 100'000 values after its aliases are expanded. Duplicate keys, keys that are not texts, merge
  /// keys ("<<") and tags are reported too, wherever they stand, but reading goes on after them.
  static std::optional<ConfigNode> load(const std::string& path, Diagnostics& diagnostics);

  /// The same from the contents of a file; `path` only names it.
  static std::optional<ConfigNode> parse(std::string contents, const std::string& path,
                                         Diagnostics& diagnostics);

  bool is_map() const { return node_.IsMap(); }
  bool is_sequence() const { return node_.IsSequence(); }
  bool is_scalar() const { return node_.IsScalar(); }
  bool is_null() const { return node_.IsNull(); }

  /// What messages call this value: its key, or "entry 2 of KEY".
  const std::string& name() const { return name_; }
  const std::string& file() const;
  /// The text of the file.
  const std::string& contents() const;
  /// The folder of the file, which relative paths in it refer to; empty for the working directory.
  std::filesystem::path directory() const;
  /// The scalar as it was written, without its quotes; empty for other nodes.
  std::string text() const;

  /// Records a mistake at this place. An alias ("*a") stands where its anchor ("&a") does.
  void error(std::string message) const;

  /// A text that is not empty: one line that is_sanitized().
  std::optional<std::string> as_string() const;

  /// true or false and nothing else.
  std::optional<bool> as_bool() const;

  /// A whole decimal number.
  std::optional<std::int64_t> as_integer(std::int64_t lower, std::int64_t upper) const;

  /// A plain decimal number or a percentage ("5 %" is 0.05).
  std::optional<double> as_number(double lower, double upper) const;

  /// A decimal number with its unit, such as "146 kg" or "2 mm/s", converted to `si_unit`, in which
  /// the limits are given too. The unit is required unless `si_unit` is dimensionless ("1",
  /// "V/V"). Units are those of unit_factor() in base/units.h, which also tells what it throws.
  std::optional<double> as_quantity(std::string_view si_unit, double lower, double upper) const;

  std::optional<double> as_number_with_unit(const NumberWithUnit& amount) const {
    return as_quantity(amount.unit, amount.lower, amount.upper);
  }

  /// A list of two quantities of which the first is less than the second: [40 N s/m, 1 kN s/m].
  std::optional<std::pair<double, double>> as_bounds(std::string_view si_unit, double lower,
                                                     double upper) const;

  /// The index of the text in `allowed`.
  std::optional<std::size_t> as_choice(std::span<const std::string> allowed) const;

  /// The values of a list.
  std::optional<std::vector<ConfigNode>> as_sequence() const;

 private:
  friend class ConfigMap;
  friend class ConfigCheck;
  struct Source;

  ConfigNode(const YAML::Node& node, std::string name, std::shared_ptr<const Source> source);
  ConfigNode child(const YAML::Node& node, std::string name) const;

  // "KEY must be WANTED, not WHAT IT IS"
  void reject_type(const std::string& wanted) const;

  YAML::Node node_;
  YAML::Mark mark_;
  std::string name_;
  std::shared_ptr<const Source> source_;
};

/// The entries of a map. Remembers which keys were asked for, so that finish() can report the rest
/// as unknown.
class ConfigMap {
 public:
  struct Entry {
    ConfigNode key;
    ConfigNode value;
  };

  /// Records a diagnostic when `node` is not a map; the map then has no entries and finds fault
  /// with nothing else.
  explicit ConfigMap(const ConfigNode& node);

  /// The same for a map whose keys are described: asking for any other is a std::logic_error. The
  /// description must outlive this map.
  ConfigMap(const ConfigNode& node, const Section& keys) : ConfigMap(node) { describe(keys); }
  ConfigMap(const ConfigNode& node, Section&& keys) = delete;

  /// Describes the keys to be asked for from now on, where they depend on the value of another.
  void describe(const Section& keys) { keys_ = &keys; }

  /// Reads a described key as its description says, into a double, an integer, a bool, a text, an
  /// enumeration or the index of a choice, or an optional one of these. Leaves `value` alone where
  /// the key is missing or its value wrong, with a diagnostic unless the key may be missing.
  /// Returns where it was given.
  template <class T>
  std::optional<ConfigNode> read(std::string_view key, T& value);

  /// The value of a described key: as required() or optional(), whichever its description says.
  std::optional<ConfigNode> given(std::string_view key);

  /// The value of a key. When it is missing: nothing, with a diagnostic at the start of the map, or
  /// at the key that was probably meant to be this one, which is then no entry any more.
  std::optional<ConfigNode> required(std::string_view key);

  /// The value of a key that may be missing.
  std::optional<ConfigNode> optional(std::string_view key);

  /// All entries in the order of the file, for maps whose keys are free; no key is unknown then.
  const std::vector<Entry>& entries();

  /// Reports the keys that nobody asked for. To be called when reading is complete. Returns whether
  /// there were none, nor any that required() took for another.
  bool finish() const;

 private:
  const Key& described(std::string_view key) const;
  std::vector<Entry>::iterator misspelling_of(std::string_view key);

  ConfigNode node_;
  const Section* keys_ = nullptr;
  std::vector<Entry> entries_;
  std::vector<std::string> known_;  // the keys asked for
  bool any_key_ = false;
  bool all_known_ = true;
};

/// What an optional holds, or the type itself.
template <class T>
struct ValueOf {
  using type = T;
};
template <class T>
struct ValueOf<std::optional<T>> {
  using type = T;
};

template <class T>
std::optional<ConfigNode> ConfigMap::read(std::string_view key, T& value) {
  using Value = typename ValueOf<T>::type;
  const Form& form = described(key).form;
  const auto node = given(key);
  if (!node) return node;
  const auto assign = [&](const auto& read) {
    if (read) value = static_cast<Value>(*read);
  };
  if constexpr (std::is_integral_v<Value> || std::is_enum_v<Value>) {
    if (const auto* choice = std::get_if<Choice>(&form))
      assign(node->as_choice(choice->names()));
    else if (std::holds_alternative<Boolean>(form))
      assign(node->as_bool());
    else
      assign(node->as_integer(std::get<Integer>(form).lower, std::get<Integer>(form).upper));
  } else if constexpr (std::is_same_v<Value, std::string>) {
    static_cast<void>(std::get<Text>(form));
    assign(node->as_string());
  } else {
    assign(node->as_number_with_unit(std::get<NumberWithUnit>(form)));
  }
  return node;
}

/// The text of a configuration file, with the lines of a comment first, made sanitized().
std::string with_comment(const std::string& comment, const std::string& yaml);

}  // namespace axisfit
