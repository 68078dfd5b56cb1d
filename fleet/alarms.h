// What the history of a fleet tells: which axis changed, since when, by how much.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "fleet/night_result.h"

namespace axisfit {

struct Alarm {
  enum class Kind { parameter, effect, failures, outlier };  // kind_name() names them

  Kind kind = Kind::parameter;
  std::string axis;
  std::string what;                  ///< parameter or effect
  std::string night;                 ///< on which it was told
  std::string since;                 ///< the first night of the change, as far as it can be told
  double before = 0.0, after = 0.0;  ///< of a parameter, in its unit
  double errors = 0.0;               ///< the change in standard errors
  std::string text;                  ///< a sentence or two
};

const char* kind_name(Alarm::Kind kind);

/// What the residual of a signal is called among the parameters.
std::string residual_name(const NightResult::Residual& residual);

struct FleetReport {
  std::size_t axes = 0, nights = 0, results = 0, failed = 0, unusable = 0;
  double threshold = 0.0;     ///< of the charts
  std::size_t charts = 0;     ///< parameters whose course was looked at
  std::vector<Alarm> alarms;  ///< by axis; an axis' in the order of nights
};

struct AlarmOptions {
  int one_in = 1000;  ///< axis-nights, in which one false alarm is allowed
  /// By parameters, with their units: what an axis must not reach.
  std::map<std::string, std::pair<double, std::string>> limits{};
};

/// Of results that are ordered by axis and night. Throws std::runtime_error for a limit in a unit
/// that the parameter has not.
FleetReport look_at(const std::vector<NightResult>& results, const AlarmOptions& options);

nlohmann::ordered_json to_json(const FleetReport& report);

/// As text: a summary, then a line for each alarm.
std::string report_text(const FleetReport& report);

/// Days of nights whose names are dates (2026-10-03) or whole numbers; else their place among all.
std::map<std::string, double> days_of(const std::vector<std::string>& nights);

}  // namespace axisfit
