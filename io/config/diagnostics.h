// The mistakes of a user in configuration files, each with its place.
#pragma once

#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
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

  /// What is not sanitized() in it is replaced, so that it stays one line. Kept unless full().
  void add(Diagnostic diagnostic);

  bool empty() const { return diagnostics_.empty(); }
  /// How many were added, kept or not.
  std::size_t count() const { return count_; }
  /// Whether there are more diagnostics than anybody would read.
  bool full() const { return diagnostics_.size() >= 1000; }

  /// Every diagnostic once: the files in the order of their first mistake, within a file from top
  /// to bottom.
  std::vector<Diagnostic> sorted() const;

  /// Throws ConfigError unless empty.
  void throw_if_any() const;

 private:
  std::vector<Diagnostic> diagnostics_;
  std::size_t count_ = 0;
};

}  // namespace axisfit
