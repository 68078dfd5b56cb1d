// A job file's `free`: the quantities that are estimated.
#pragma once

#include "fit/data/job.h"
#include "io/config/config.h"

namespace axisfit {

/// All quantities, each with the keys for a free one.
Map free_quantities();

/// Adds to the job, whose model and recordings are read already, what is free of mistakes; the
/// others are in the diagnostics.
void read_free(const ConfigNode& node, const Diagnostics& diagnostics, Job& job);

}  // namespace axisfit
