// What was found as a JSON document. docs/result.md names every key.
#pragma once

#include <nlohmann/json.hpp>

#include "apps/outcome.h"

namespace axisfit {

nlohmann::ordered_json result_json(const Outcome& outcome);

}  // namespace axisfit
