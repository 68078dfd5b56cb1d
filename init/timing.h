// How the samples of input and motion go together in time: the hold of the input, and the lag of a
// log.
#pragma once

#include "fit/solve/run_context.h"
#include "init/job_draft.h"

namespace axisfit {

/// Takes the hold of the input that suits the motion, and frees the time by which the motion
/// follows it where that is clearly more than half a sample. Both holds are tried, with the time of
/// the first look to begin with. Where they do as well, what was commanded is held, and so is what
/// stays in steps; what was measured is not. A velocity that is late and recorded without a
/// position may be a mean over the last samples, as motor controllers make it: it is taken for one
/// where the motion goes clearly better with it. When the stop flag is set, `guesses` say that
/// nothing was tried.
void set_timing(JobDraft& draft, const RunContext& context = {});

}  // namespace axisfit
