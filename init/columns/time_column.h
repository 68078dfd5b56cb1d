// Which column of a recording has its times, and what is wrong with them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "init/columns/column_set.h"
#include "init/columns/heading.h"

namespace axisfit {

/// The times of a recording.
struct TimeColumn {
  std::optional<std::size_t> place;  ///< of the column; none: samples at an even rate
  UnscaledColumn column;             ///< its unit may be open
  double rate = 0.0;                 ///< Hz, where there is no column
};

/// Of columns that are named as a time the one by which most others go, or else one that increases:
/// evenly, or among the first two by intervals that jitter, or as a count of samples. With a `rate`
/// there is none. Throws RecordingError where nothing can be the time, and where one time stands in
/// several rows that differ.
TimeColumn find_time(const RecordingFile& file, const std::string& path,
                     const std::vector<Heading>& headings, std::optional<double> rate);

/// The times of a clock: NaN at rows that only repeat the row before.
std::vector<double> times_of_clock(const RecordingFile& file, std::size_t clock);

/// Times of samples at an even rate, s, for the longest column.
std::vector<double> even_times(const RecordingFile& file, double rate);

/// Whether every value is larger than the one before.
bool increases(const std::vector<double>& values);

/// The values that there are.
std::vector<double> without_gaps(const std::vector<double>& values);

}  // namespace axisfit
