// Options of a run that name files, amounts or parameters, as users write them.
#pragma once

#include <string>
#include <vector>

#include "fit/run.h"

namespace axisfit {

// All throw std::runtime_error or ConfigError with what the user is to know.

/// That an axis can stand in for the job's: with the same joint, command and channels. `where`
/// begins the message.
void check_is_of_machine(const Rig& rig, const Job& job, const std::string& where);

/// The axes of files, as models of the job's recordings.
std::vector<OtherModel> models_of(const std::vector<std::string>& axis_files, const Job& job);

/// An allowed error of a signal that the job has, such as "1 mm".
Tolerance tolerance_of(const std::string& text, const Job& job);

/// Lets the parameters of these names be profiled, or all of them: "all".
void set_profiles(const std::vector<std::string>& names, const Job& job, RunOptions& options);

/// A motion file, for the rig of the job.
MotionToPredict motion_of(const std::string& path, const Rig& rig);

}  // namespace axisfit
