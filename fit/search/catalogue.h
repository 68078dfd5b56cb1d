// The catalogue: all that a model may lack.
#pragma once

#include <vector>

#include "fit/search/hypothesis.h"

namespace axisfit {

/// All hypotheses that the job's axis can have, its recordings could show, and its model lacks:
/// effects, instruments that are not as they should be, and constants that are not what the axis
/// file says. The pinion radius is the job's.
std::vector<Hypothesis> catalogue(const Job& job, SearchScales scales);

}  // namespace axisfit
