// A fitted axis in the files of other tools.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/results/output_folder.h"
#include "sim/rig.h"

namespace axisfit {

enum class ExportTarget {
  mjcf,    ///< a model of MuJoCo, with the attributes that make its dry friction hold
  urdf,    ///< a joint and its link
  matlab,  ///< parameters and their covariance: a function, and a MAT-file
};
inline constexpr std::string_view kExportTargets[] = {"mjcf", "urdf", "matlab"};

/// What a target was given.
struct Export {
  Files files;                    ///< names and contents
  Rig carried;                    ///< the axis as the target has it
  std::vector<std::string> lost;  ///< of the axis, that the target cannot express: a sentence each
};

/// The files of a target, called `name` with their endings, or what MATLAB can take for it;
/// `origin` is said in a comment. Throws std::runtime_error, naming what is in the way, for an axis
/// that the target cannot express at all: a velocity loop or a preamplifier between the command and
/// the motor.
Export export_axis(const Rig& rig, ExportTarget target, const std::string& name,
                   const std::string& origin);

}  // namespace axisfit
