#include "io/config/recording_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "fit/data/validation.h"
#include "io/config/recording_column.h"

namespace axisfit {

std::string resolved(const ConfigNode& node, const std::string& file, const std::string& base) {
  const std::filesystem::path given(file);
  if (given.is_absolute()) return file;
  return (base.empty() ? node.directory() / given : std::filesystem::path(base) / given)
      .lexically_normal()
      .string();
}

void keep(const Trim& trim, Series& series) {
  Series kept{{}, {}, series.own_clock, series.missing};
  for (std::size_t i = 0; i < series.times.size(); ++i) {
    if (!trim.keeps(series.times[i])) continue;
    kept.times.push_back(series.times[i]);
    kept.values.push_back(series.values[i]);
  }
  series = std::move(kept);
}

bool has_value_for_each(const std::vector<double>& times, const ConfigNode& node,
                        const std::vector<double>& values) {
  if (values.size() == times.size()) return true;
  node.error(fmt::format("{} has {} values but the time has {}", node.name(), values.size(),
                         times.size()));
  return false;
}

bool SeriesReader::open_own(const ConfigNode& node, const std::string& path) {
  file_ = open(node, path);
  return file_ != nullptr;
}

void SeriesReader::read_own_times(const ConfigNode& node) {
  time_node_ = node;
  times_ = read_times(*file_, node);
}

void SeriesReader::make_own_times(const ConfigNode& node, double rate) {
  time_node_ = node;
  has_rate_ = true;
  times_.emplace();
  for (const Column& column : file_->columns())
    while (times_->size() < column.values.size())
      times_->push_back(static_cast<double>(times_->size()) / rate);
}

std::optional<Series> SeriesReader::read(const ConfigNode& node, ConfigMap& map,
                                         std::string_view unit) {
  std::optional<std::string> path;
  const auto file = map.read("file", path);
  const auto time = map.optional("time");
  Series series;
  double offset = 0.0;
  map.read("offset", offset);
  const RecordingFile* const data = path ? open(*file, *path) : file_;
  if (data == nullptr) return std::nullopt;
  if (path && !time && has_rate_) {
    file->error("a column of another file needs a time of its own: the recording has none");
    return std::nullopt;
  }
  const auto values = read_column(*data, map, unit);
  series.own_clock = path || time || offset != 0.0;
  const auto times = path || time ? read_times(*data, time.value_or(*time_node_)) : times_;
  if (!values || !times || !has_value_for_each(*times, node, *values)) return std::nullopt;
  for (std::size_t i = 0; i < times->size(); ++i) {
    if (std::isnan((*times)[i]) || std::isnan((*values)[i])) continue;
    series.times.push_back((*times)[i] + offset);
    series.values.push_back((*values)[i]);
  }
  const auto timed = std::ranges::count_if(*times, [](double t) { return !std::isnan(t); });
  if (!series.own_clock) series.missing = static_cast<std::size_t>(timed) - series.times.size();
  // Whether the recording is too short altogether is said once, for all signals.
  if (series.times.size() >= kLeastSamples || times->size() < kLeastSamples) return series;
  node.error(fmt::format("{} has only {} values with a time: at least 10 are needed", node.name(),
                         series.times.size()));
  return std::nullopt;
}

const RecordingFile* SeriesReader::open(const ConfigNode& node, const std::string& path) {
  const auto table = sources_.tables.find(path);
  const std::string found =
      table != sources_.tables.end() ? path : resolved(node, path, sources_.folder);
  if (const auto open = files_.find(found); open != files_.end()) return &open->second;
  if (table != sources_.tables.end())
    return &files_.emplace(found, RecordingFile(table->second)).first->second;
  try {
    return &files_.emplace(found, RecordingFile(found)).first->second;
  } catch (const RecordingError& error) {
    node.error(error.what());
    return nullptr;
  }
}

}  // namespace axisfit
