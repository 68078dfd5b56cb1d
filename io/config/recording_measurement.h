// The measured signals of a recording.
#pragma once

#include <optional>
#include <vector>

#include "fit/data/job.h"
#include "fit/data/recording_check.h"
#include "io/config/recording_series.h"

namespace axisfit {

/// A measured signal before all have the same times.
struct Measured {
  Measurement measurement;  ///< without values
  Series series;            ///< trimmed
  ConfigNode node;
  std::optional<ConfigNode> shaped;  ///< the filter or the hold
};

/// A filter of samples like these. None where anything is wrong, with a diagnostic, or without
/// enough samples.
Filter read_filter(const ConfigNode& node, const Sampling& sampling);

/// All signals of an axis but the input.
void read_measurements(ConfigMap& signals, const Structure& structure, const Trim& trim,
                       SeriesReader& series, std::vector<Measured>& measured);

/// The values at these times, s. Where there is none, no residual counts, and a curve through those
/// that there are takes its place in all that goes by the values.
Measurement on_times(Measured measured, const std::vector<double>& times);

}  // namespace axisfit
