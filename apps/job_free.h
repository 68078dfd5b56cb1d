// A job file's `free`: the quantities that are estimated.
#pragma once

#include "apps/config.h"
#include "fit/job.h"

namespace axisfit {

/// Adds to the job, whose model and recordings are read already. With diagnostics where anything is
/// wrong.
void read_free(const ConfigNode& node, Job& job);

}  // namespace axisfit
