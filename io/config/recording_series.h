// Columns of a recording with their times, from one file or several.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/config/config.h"
#include "io/recording/recording_file.h"
#include "io/recording/table.h"

namespace axisfit {

/// Where recordings come from.
struct RecordingSources {
  std::string folder{};  ///< below which relative paths are; empty: that of the job file
  Tables tables{};       ///< instead of files of these names
};

/// The path of a file named in a configuration file: relative to `base`, or else to the folder of
/// that file.
std::string resolved(const ConfigNode& node, const std::string& file, const std::string& base);

/// The part of a recording that is kept, in recorded time, s.
struct Trim {
  double from = -kUnlimited, to = kUnlimited;
  bool keeps(double time) const { return time >= from && time <= to; }
};

/// The values of a column that there are, and their times, s.
struct Series {
  std::vector<double> times, values;
  bool own_clock = false;   ///< not that of the recording
  std::size_t missing = 0;  ///< values that the recording has none of at its times
};

/// Leaves what is kept.
void keep(const Trim& trim, Series& series);

/// Whether there is a value for each of the times; else with a diagnostic.
bool has_value_for_each(const std::vector<double>& times, const ConfigNode& node,
                        const std::vector<double>& values);

/// The columns of one recording.
class SeriesReader {
 public:
  explicit SeriesReader(const RecordingSources& sources) : sources_(sources) {}

  /// Opens the recording's own file. Whether it can be read; else with a diagnostic at `node`.
  bool open_own(const ConfigNode& node, const std::string& path);
  /// Reads the times of the recording from its own file.
  void read_own_times(const ConfigNode& node);
  /// Times of its rows as samples at a rate, Hz, from 0 s; `node` is where that is said.
  void make_own_times(const ConfigNode& node, double rate);

  /// Its own file, once it is open.
  const RecordingFile& file() const { return *file_; }
  /// s, NaN where there is none. None where they could not be read.
  const std::optional<std::vector<double>>& times() const { return times_; }

  /// A column and its times, without what is missing. Nothing, with diagnostics, where something is
  /// wrong.
  std::optional<Series> read(const ConfigNode& node, ConfigMap& map, std::string_view unit);

 private:
  /// Null, with a diagnostic at `node`, where it cannot be read.
  const RecordingFile* open(const ConfigNode& node, const std::string& path);

  const RecordingSources& sources_;
  std::map<std::string, RecordingFile> files_;  ///< read already, by path
  const RecordingFile* file_ = nullptr;
  std::optional<ConfigNode> time_node_;
  bool has_rate_ = false;  ///< there is no column of times
  std::optional<std::vector<double>> times_;
};

}  // namespace axisfit
