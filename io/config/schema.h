// JSON Schema (draft-07) of the configuration files, for editors: completion, explanations and
// mistakes while a file is written. Made of the same descriptions that the readers go by; what
// depends on several keys at once or on other files is left to the readers.
#pragma once

#include <nlohmann/json.hpp>

namespace axisfit {

nlohmann::ordered_json job_schema();

/// With the parameters, initial states and effects that each drive and transmission has.
nlohmann::ordered_json axis_schema();

/// With the keys of each type of motion.
nlohmann::ordered_json motion_schema();

nlohmann::ordered_json machine_schema();
nlohmann::ordered_json fleet_schema();

}  // namespace axisfit
