#include "io/config/diagnostics.h"

#include <algorithm>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "base/plain_text.h"

namespace axisfit {
namespace {

std::string lines(const std::vector<Diagnostic>& diagnostics) {
  std::string result;
  for (const Diagnostic& diagnostic : diagnostics) {
    if (!result.empty()) result += '\n';
    result += diagnostic.text();
  }
  return result;
}

}  // namespace

std::string Diagnostic::text() const {
  return file + ':' + std::to_string(line) + ':' + std::to_string(column) + ": " + message;
}

ConfigError::ConfigError(std::vector<Diagnostic> diagnostics)
    : std::runtime_error(lines(diagnostics)),
      diagnostics_(std::make_shared<const std::vector<Diagnostic>>(std::move(diagnostics))) {}

void Diagnostics::add(Diagnostic diagnostic) {
  ++count_;
  if (full()) return;
  diagnostic.file = sanitized(diagnostic.file);
  diagnostic.message = sanitized(diagnostic.message);
  diagnostics_.push_back(std::move(diagnostic));
}

std::vector<Diagnostic> Diagnostics::sorted() const {
  std::unordered_map<std::string, std::size_t> rank;
  for (const Diagnostic& diagnostic : diagnostics_) rank.try_emplace(diagnostic.file, rank.size());

  std::vector<Diagnostic> result = diagnostics_;
  const auto place = [&](const Diagnostic& d) {
    return std::tuple(rank.at(d.file), d.line, d.column);
  };
  std::stable_sort(result.begin(), result.end(),
                   [&](const auto& a, const auto& b) { return place(a) < place(b); });
  const auto same = [&](const Diagnostic& a, const Diagnostic& b) {
    return place(a) == place(b) && a.message == b.message;
  };
  result.erase(std::unique(result.begin(), result.end(), same), result.end());
  return result;
}

void Diagnostics::throw_if_any() const {
  if (!empty()) throw ConfigError(sorted());
}

}  // namespace axisfit
