// fleet.html: the fleet in one file, for a browser without network.
#pragma once

#include <string>
#include <vector>

#include "fleet/alarms.h"
#include "fleet/night_result.h"

namespace axisfit {

/// Of results that are ordered by axis and night, and what they tell.
std::string fleet_page(const std::vector<NightResult>& results, const FleetReport& report);

}  // namespace axisfit
