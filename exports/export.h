// A fitted axis in the files of other tools.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/results/output_folder.h"
#include "sim/rig.h"

namespace axisfit {

enum class ExportTarget {
  fmu2,    ///< a unit for co-simulation by FMI 2.0
  fmu3,    ///< the same by FMI 3.0
  c,       ///< source in C, and that of an S-function and a MEX function
  mjcf,    ///< a model of MuJoCo, with the attributes that make its dry friction hold
  urdf,    ///< a joint and its link
  matlab,  ///< parameters and their covariance: a function, and a MAT-file
  frc,     ///< gains of a feed-forward in volts, as JSON
};
inline constexpr std::string_view kExportTargets[] = {"fmu2", "fmu3",   "c",  "mjcf",
                                                      "urdf", "matlab", "frc"};

/// What a target was given.
struct Export {
  Files files;                    ///< names and contents
  Rig carried;                    ///< the axis as the target has it
  std::vector<std::string> lost;  ///< of the axis, that the target cannot express: a sentence each
};

/// The files of a target, called `name` with their endings, or what C and MATLAB can take for it;
/// `origin` is said in a comment. Throws std::runtime_error, naming what is in the way, for an axis
/// that the target cannot express at all: a velocity loop or a preamplifier between the command and
/// the motor; of `frc`, a command that is no voltage or an effect that no gain stands for.
Export export_axis(const Rig& rig, ExportTarget target, const std::string& name,
                   const std::string& origin);

}  // namespace axisfit
