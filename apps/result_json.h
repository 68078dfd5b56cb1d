// What was found as a JSON document. docs/result.md names every key.
#pragma once

#include <nlohmann/json.hpp>

#include "apps/outcome.h"
#include "fit/forecast.h"

namespace axisfit {

nlohmann::ordered_json result_json(const Outcome& outcome);

/// What the recordings can tell of the parameters, before the fit.
nlohmann::ordered_json forecast_json(const Job& job, const Forecast& forecast);

}  // namespace axisfit
