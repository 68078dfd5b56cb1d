// A first job file for recordings that nobody has described yet.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fit/first_look/first_look.h"
#include "fit/solve/run_context.h"
#include "init/recording_guess.h"
#include "io/results/output_folder.h"

namespace axisfit {

struct InitialJob {
  Files files;                       ///< the job last
  std::vector<std::string> guesses;  ///< what the user should look at, a sentence each
  /// At what a force drives, in units of the input; none where too little moves.
  std::optional<FirstLook> look{};
};

/// Looks at the recordings and writes a job that fits them as it is: columns, units and signs by
/// recording_guess.h, an axis of its own making unless `axis` names a file, or a machine of
/// machine_axes() where `is_machine`, and as free what the
/// recordings can determine of it. What had to be guessed is marked GUESSED in the files. The first
/// recording is fitted, the last of several validates. Paths in the job start at `folder`, where
/// the files are meant to go; nothing is written there. `gain` is K_f of the axis to be made, the
/// force in N per unit of a recorded current or command, if it is known. `answers` say what columns
/// are (recording_guess.h). Two files of which one has what drives the axis and the other how it
/// moved are one recording, with a delay between their clocks that is free.
///
/// When the stop flag is set, `guesses` say what was not looked at. Throws std::runtime_error where
/// the recordings make no job.
InitialJob initial_job(const std::vector<std::string>& recordings, const std::string& axis,
                       const std::string& folder, std::optional<double> gain = {},
                       const std::vector<ColumnAnswer>& answers = {}, bool is_machine = false,
                       const RunContext& context = {});

/// The machines of machine_axes() that the columns of recordings suit: the same joint, and what
/// drives it was recorded. None for those of a velocity loop, which the columns tell.
std::vector<std::string> machines_for(const std::vector<std::string>& recordings,
                                      const std::vector<ColumnAnswer>& answers = {});

}  // namespace axisfit
