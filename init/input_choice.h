// Which column of a recording drives its axis, and how the columns go with it.
#pragma once

#include "init/job_draft.h"

namespace axisfit {

/// What a force recording may be driven by, the nearest to a force first.
const std::vector<InputColumn>& force_inputs();

/// What a motor is driven by, of which voltage and position controller are known.
std::optional<InputColumn> voltage_input(const RecordingGuess& recording);

/// Whether the recording has that column, and it changes.
bool has_changing_input(const RecordingGuess& recording, const InputColumn& input);

/// Whether only a velocity loop has such columns. A velocity that is asked for is that of any
/// drive, where a force or a current was recorded, too: then that drives a mass, whatever controls
/// it.
bool is_of_velocity_loop(const RecordingGuess& recording);

/// Two files of which one has what drives the axis, and the other how it moved, are one
/// recording. Their clocks need not have started together: the force goes best with the
/// acceleration where they agree.
void join_files(JobDraft& draft);

/// One input for all recordings of a force recording, since K_f belongs to it: one that all have,
/// at best one that changes in all, or else the first of them. Recordings without it have none.
void choose_inputs(JobDraft& draft);

/// Leaves out velocities that say less than the position does, or come late: in all recordings
/// where one shows it, for what is fitted and what validates have the same signals.
void drop_idle_velocities(JobDraft& draft);

/// Leaves out what was not measured in all recordings, unless they have nothing in common.
void use_common_signals(JobDraft& draft);

/// Throws std::runtime_error where what drives the axis goes with its motion in no recording, and
/// the user has not named both.
void refuse_unrelated(const JobDraft& draft);

}  // namespace axisfit
