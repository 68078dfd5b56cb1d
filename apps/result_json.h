// What was found as a JSON document. docs/result.md names every key.
#pragma once

#include <nlohmann/json.hpp>

#include "apps/outcome.h"
#include "fit/effort.h"
#include "fit/forecast.h"
#include "fit/recording_check.h"

namespace axisfit {

nlohmann::ordered_json result_json(const Outcome& outcome);

/// What the recordings show and can tell of the parameters, before the fit.
nlohmann::ordered_json check_json(const JobFile& file, const std::vector<RecordingCheck>& checks,
                                  const Forecast& forecast, const Effort& effort);

}  // namespace axisfit
