// fit-params --init: a job for recordings.
#pragma once

#include <optional>

#include "apps/fit_arguments.h"
#include "apps/progress.h"
#include "base/interrupt.h"

namespace axisfit {

/// Writes a job file for recordings, and an axis file where none is given, and says what it
/// guessed. When the stop flag is set, the files are written all the same, and say what was not
/// looked at. Throws std::runtime_error where a file would be overwritten.
void write_first_job(const FitArguments& arguments, const StopFlag& stop,
                     std::optional<ProgressLine>& line);

}  // namespace axisfit
