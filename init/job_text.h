// The files of a job in the making.
#pragma once

#include "init/job_draft.h"

namespace axisfit {

/// The job, after the axis file where that is to be written. What was guessed is marked.
Files job_files(const JobDraft& draft);

}  // namespace axisfit
