// What a job frees: what the recordings determine of its axis.
#pragma once

#include "init/job_draft.h"

namespace axisfit {

/// All that the axis has and no data sheet tells, the most wanted first.
void list_parameters(JobDraft& draft);

/// Takes out one after the other what the recordings leave open, the least wanted first. What is
/// told apart only by effects that the machine need not have is open, too.
void choose_free(JobDraft& draft);

/// A drive that holds its current for a sample is not what a straight line between samples says.
/// The motion is often logged a sample or two after what drives it, or before, which a fit
/// without a delay takes for a smaller force. Each as short fits show it.
void try_timing(JobDraft& draft);

}  // namespace axisfit
