// The result of a fit as a JSON document. docs/result.md names every key.
#pragma once

#include <nlohmann/json.hpp>

#include "apps/job_file.h"
#include "fit/estimate.h"

namespace axisfit {

nlohmann::ordered_json result_json(const JobFile& file, const FitResult& result,
                                   double wall_time_s);

}  // namespace axisfit
