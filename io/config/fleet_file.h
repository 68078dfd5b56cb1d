// Fleet files: one job for many axes and nights. docs/fleet.md tells of every key.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "io/config/key.h"

namespace axisfit {

/// When effects that the model lacks are searched for.
enum class CloseLoop {
  never,
  unexplained,  ///< on nights whose fit leaves more than noise
  always,
};

struct FleetFile {
  std::string path;      ///< of the fleet file
  std::string folder;    ///< of the job, absolute
  std::string job_name;  ///< of the job's file in that folder
  std::string job_text;  ///< with {axis}, {night} and other names in braces
  std::string items;     ///< pattern with {axis} and {night}, absolute; or
  std::string manifest;  ///< a list of items
  std::string history;   ///< database, absolute
  CloseLoop close_loop = CloseLoop::never;
  int one_in = 1000;  ///< axis-nights, in which one false alarm is allowed
  /// By the names of parameters, with their units: what an axis must not reach.
  std::map<std::string, std::pair<double, std::string>> limits;
};

const Section& fleet_keys();

/// Throws ConfigError with everything that is wrong.
FleetFile read_fleet_file(const std::string& path);

}  // namespace axisfit
