// The names of the parameters that results tell of by their place in a job.
#pragma once

#include <string>
#include <string_view>

#include "fit/run.h"

namespace axisfit {

/// "M", "coulomb_friction.F_c" or, of one recording only, "K_f@day2".
std::string name_of(const Job& job, ParameterId id);
std::string name_of(const Job& job, const FreeParameter& free);

/// With unit and meaning on the job's axis.
const Quantity& quantity_of(const Job& job, ParameterId id);

/// As a job has it: "log", "linear" or "from_zero".
std::string_view scale_name(Scale scale);

/// "k_g / M", "k_g M", "k_g M^0.5"
std::string name_of(const Job& job, const Combination& combination);

}  // namespace axisfit
