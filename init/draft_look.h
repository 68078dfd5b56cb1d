// The first look at the recordings of a draft, and what a job takes from it.
#pragma once

#include <span>

#include "fit/first_look/first_look.h"
#include "init/job_draft.h"

namespace axisfit {

/// A recording as a first look takes it, with what drives it. Both must outlive the result.
DrivenMotion driven_motion(const RecordingGuess& recording, std::span<const double> input);

/// At all recordings together; with gravity on a joint where that leaves clearly less of the input.
/// None for drives that are no source of force, and where too little moves.
std::optional<FirstLook> look_at(const JobDraft& draft);

/// The input has one sign in all recordings. It is turned if the axis would have to be driven by
/// its own friction otherwise, or by a mass below zero; where neither tells, it is asked. Of a
/// velocity loop the motion goes the way of the input.
void correct_signs(JobDraft& draft);

/// Where the motion goes one way only, friction and a constant force are one: the first look takes
/// all of it for friction, unless it pushes the axis along.
void take_for_friction(JobDraft& draft);

}  // namespace axisfit
