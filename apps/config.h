// Typed reading of YAML configuration files: every mistake of the user is reported as
// "file:line:column: message", and all of them at once.
//
//   Diagnostics diagnostics;
//   if (const auto root = ConfigNode::load("job.yaml", diagnostics)) {
//     ConfigMap map(*root);
//     if (const auto mass = map.required("mass")) job.mass = mass->as_quantity("kg", 1e-3, 1e5);
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
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace axisfit {

/// One mistake in a configuration file.
struct Diagnostic {
  std::string file;  ///< as the file was named when it was loaded
  int line = 1;      ///< from 1
  int column = 1;    ///< from 1, in characters
  std::string message;

  /// "file:line:column: message"
  std::string text() const;
};

/// All the mistakes found; what() has one line for each.
class ConfigError : public std::runtime_error {
 public:
  explicit ConfigError(std::vector<Diagnostic> diagnostics);
  const std::vector<Diagnostic>& diagnostics() const { return *diagnostics_; }

 private:
  // Shared, because copying an exception must not throw.
  std::shared_ptr<const std::vector<Diagnostic>> diagnostics_;
};

/// Collects the mistakes of all files of one job. Must outlive the nodes that report to it; not for
/// use by several threads at once.
class Diagnostics {
 public:
  Diagnostics() = default;
  Diagnostics(const Diagnostics&) = delete;
  Diagnostics& operator=(const Diagnostics&) = delete;

  /// Control characters in the message are replaced, so that it stays one line. Does nothing when
  /// full().
  void add(Diagnostic diagnostic);

  bool empty() const { return diagnostics_.empty(); }
  /// Whether there are more diagnostics than anybody would read.
  bool full() const { return diagnostics_.size() >= 1000; }

  /// Every diagnostic once: the files in the order of their first mistake, within a file from top
  /// to bottom.
  std::vector<Diagnostic> sorted() const;

  /// Throws ConfigError unless empty.
  void throw_if_any() const;

 private:
  std::vector<Diagnostic> diagnostics_;
};

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
  /// The folder of the file, which relative paths in it refer to; empty for the working directory.
  std::filesystem::path directory() const;
  /// The scalar as it was written, without its quotes; empty for other nodes.
  std::string text() const;

  /// Records a mistake at this place. An alias ("*a") stands where its anchor ("&a") does.
  void error(std::string message) const;

  /// A text that is not empty.
  std::optional<std::string> as_string() const;

  /// true or false and nothing else.
  std::optional<bool> as_bool() const;

  /// A whole decimal number.
  std::optional<std::int64_t> as_integer(std::int64_t lower, std::int64_t upper) const;

  /// A plain decimal number or a percentage ("5 %" is 0.05).
  std::optional<double> as_number(double lower, double upper) const;

  /// A decimal number with its unit, such as "146 kg" or "2 mm/s", converted to `si_unit`, in which
  /// the limits are given too. The unit is compulsory unless `si_unit` is dimensionless ("1",
  /// "V/V"). Units are those of unit_factor() in apps/units.h, which also tells what it throws.
  std::optional<double> as_quantity(std::string_view si_unit, double lower, double upper) const;

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

  ConfigNode(YAML::Node node, std::string name, std::shared_ptr<const Source> source);
  ConfigNode child(const YAML::Node& node, std::string name) const;

  // "KEY must be WANTED, not WHAT IT IS"
  void refuse(const std::string& wanted) const;

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

  /// The value of a key. When it is missing: nothing, with a diagnostic at the start of the map.
  std::optional<ConfigNode> required(std::string_view key);

  /// The value of a key that may be missing.
  std::optional<ConfigNode> optional(std::string_view key);

  /// All entries in the order of the file, for maps whose keys are free; no key is unknown then.
  const std::vector<Entry>& entries();

  /// Reports the keys that nobody asked for. To be called when reading is complete.
  void finish() const;

 private:
  ConfigNode node_;
  std::vector<Entry> entries_;
  std::vector<std::string> known_;  // the keys asked for
  bool any_key_ = false;
};

/// The offset of the first byte that is not UTF-8 (RFC 3629: no overlong forms, no surrogates), or
/// npos.
std::size_t find_invalid_utf8(std::string_view text);

/// The text of a configuration file, with the lines of a comment first.
std::string with_comment(const std::string& comment, const std::string& yaml);

}  // namespace axisfit
