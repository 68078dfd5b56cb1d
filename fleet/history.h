// The history of a fleet: one SQLite database.
//
// Tables (version 1, in PRAGMA user_version):
//   nights(id, axis, night, status, reason, fingerprint, tool, seconds)   one per axis and night
//   parameters(night, name, unit, value, standard_error)                  SI units
//   residuals(night, recording, signal, unit, role, rmse, chi_square)
//   effects(night, name)                                                  that were accepted
//   channels(night, name, mean)
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "fleet/night_result.h"

struct sqlite3;

namespace axisfit {

/// All errors are std::runtime_error that name the file.
class History {
 public:
  /// Opens the database, or makes it. Refuses one that is not a history, or of a later version.
  explicit History(const std::string& path);
  ~History();
  History(const History&) = delete;
  History& operator=(const History&) = delete;

  /// What is known of one axis on one night, without its numbers.
  struct Entry {
    std::string fingerprint, tool, status;
  };
  /// By axis and night.
  std::map<std::pair<std::string, std::string>, Entry> entries() const;

  /// Replaces what is there of the same axes and nights; all or nothing.
  void add(const std::vector<NightResult>& results, const std::string& tool);

  /// Of all axes, ordered by axis and night.
  std::vector<NightResult> results() const;

 private:
  class Statement;
  void execute(const std::string& sql) const;
  [[noreturn]] void fail() const;

  std::string path_;
  sqlite3* database_ = nullptr;
};

}  // namespace axisfit
