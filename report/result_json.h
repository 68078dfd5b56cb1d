// What was found as a JSON document. docs/result.md names every key.
#pragma once

#include <nlohmann/json.hpp>

#include "fit/couplings.h"
#include "fit/data/recording_check.h"
#include "fit/design/forecast.h"
#include "fit/design/run_time_estimate.h"
#include "fit/first_look/first_look.h"
#include "fit/run.h"

namespace axisfit {

nlohmann::ordered_json result_json(const RunResult& run_result);

/// The results of several axes by their names under "axes", and what they say together.
nlohmann::ordered_json axes_json(const std::vector<AxisRun>& axes);

/// What the recordings show and can tell of the parameters, before the fit.
nlohmann::ordered_json check_json(const Job& job, const std::vector<RecordingCheck>& checks,
                                  const std::optional<FirstLook>& look, const Forecast& forecast,
                                  const RunTimeEstimate& run_time);

}  // namespace axisfit
