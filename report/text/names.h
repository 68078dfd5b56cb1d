// The names of the parameters that results tell of by their place in a job.
#pragma once

#include <string>

#include "fit/run.h"

namespace axisfit {

/// "M", "coulomb_friction.F_c" or, of one recording only, "K_f@day2".
std::string name_of(const Job& job, ParameterId id);
std::string name_of(const Job& job, const FreeParameter& free);

/// With unit and meaning on the job's axis.
const Quantity& quantity_of(const Job& job, ParameterId id);

/// "k_g / M", "k_g M", "k_g M^0.5"
std::string name_of(const Job& job, const Combination& combination);

}  // namespace axisfit
