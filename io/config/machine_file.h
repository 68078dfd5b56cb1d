// Machine files: several axes that move together, in YAML. docs/machine-file.md tells of every key.
#pragma once

#include <string>
#include <vector>

#include "io/config/config.h"
#include "sim/machine.h"

namespace axisfit {

struct MachineFile {
  std::vector<CoupledAxis> axes;
  double duration = 0.0;           ///< s, that of the longest motion
  std::vector<std::string> files;  ///< all that were read, that of the machine first
};

/// The keys of a machine file, and those of one of its axes.
const Section& machine_keys();
const Section& machine_axis_keys();

/// Whether a file is one of a machine and not of an axis, as far as it can be read.
bool is_machine_file(const std::string& path);

/// Throws ConfigError with everything that is wrong.
MachineFile read_machine_file(const std::string& path);

}  // namespace axisfit
