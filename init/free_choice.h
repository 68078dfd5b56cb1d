// What a job frees: what the recordings determine of its axis.
#pragma once

#include "base/interrupt.h"
#include "init/job_draft.h"

namespace axisfit {

/// The job as the reader takes it, which is also the proof that it does. Throws std::runtime_error
/// where it does not.
Job draft_job(const JobDraft& draft);

/// All that the axis has and no data sheet tells, the most wanted first.
void list_parameters(JobDraft& draft);

/// Takes out one after the other what the recordings leave open, the least wanted first. What is
/// told apart only by effects that the machine need not have is open, too.
/// When the stop flag is set, the rest stays free.
void choose_free(JobDraft& draft, const StopFlag* stop = nullptr);

}  // namespace axisfit
