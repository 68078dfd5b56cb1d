// The work of a fleet: one axis on one night each.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "io/config/fleet_file.h"

namespace axisfit {

/// One axis on one night.
struct FleetItem {
  std::string axis, night;
  std::map<std::string, std::string> values;  ///< for names in braces, axis and night among them
  std::string fingerprint;  ///< of the job and of names, sizes and times of its files
};

/// All of them, ordered by axis and night. Throws std::runtime_error where there are none, or two
/// of the same axis and night.
std::vector<FleetItem> find_items(const FleetFile& file);

/// A text with the values in place of their names in braces.
std::string filled_in(std::string text, const std::map<std::string, std::string>& values);

}  // namespace axisfit
