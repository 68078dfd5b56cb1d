// Parameters of all recordings, by the names that the sources give them.
#pragma once

#include <string>
#include <string_view>

#include "fit/data/job.h"

namespace axisfit {

inline ParameterId id_of(std::string_view name) { return {quantity_index(name)}; }
inline const std::string& name_of(ParameterId id) { return quantity_list()[id.quantity].name; }

}  // namespace axisfit
