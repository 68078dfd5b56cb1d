// The first look at the recordings of a job.
#pragma once

#include <optional>

#include "fit/data/job.h"
#include "fit/first_look/first_look.h"

namespace axisfit {

/// At all recordings together, with the force K_f U as it is declared: in N, kg and m, or in N m,
/// kg m^2 and rad. None for drives that are no such source, and where too little moves.
std::optional<FirstLook> look_at(const Job& job);

}  // namespace axisfit
