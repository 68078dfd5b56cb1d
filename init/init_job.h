// A first job file for recordings that nobody has described yet.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fit/first_look/first_look.h"
#include "fit/solve/run_context.h"
#include "init/init_request.h"
#include "io/results/output_folder.h"

namespace axisfit {

struct InitialJob {
  Files files;                       ///< the job last
  std::vector<std::string> guesses;  ///< what the user should look at, a sentence each
  /// At what a force drives, in units of the input; none where too little moves.
  std::optional<FirstLook> look{};
};

/// Looks at the recordings and writes a job that fits them as it is: columns, units and signs by
/// recording_guess.h, an axis of its own making unless the request names a file, or a machine of
/// machine_axes(), and as free what the recordings can determine of it. What had to be guessed is
/// marked GUESSED in the files. The first recording is fitted, the last of several validates. Paths
/// in the job start at the folder, where the files are meant to go; nothing is written there. Two
/// files of which one has what drives the axis and the other how it moved are one recording, with a
/// delay between their clocks that is free.
///
/// When the stop flag is set, `guesses` say what was not looked at. Throws std::runtime_error where
/// the recordings make no job.
InitialJob initial_job(const InitRequest& request, const RunContext& context = {});

/// The machines of machine_axes() that the columns of the first recording suit: the same joint, and
/// what drives it was recorded. None for those of a velocity loop, which the columns tell.
std::vector<std::string> machines_for(const InitRequest& request);

}  // namespace axisfit
