// The section of an axis file that tells what is not known of it, as fit-params leaves it behind.
#pragma once

#include <optional>

#include "io/config/config.h"
#include "io/config/key.h"
#include "sim/axis_uncertainty.h"
#include "sim/model.h"

namespace YAML {
class Emitter;
}

namespace axisfit {

Key axis_uncertainty_key(Vocabulary vocabulary);

/// Nothing, with diagnostics, where anything in it is wrong.
std::optional<AxisUncertainty> read_axis_uncertainty(const ConfigNode& node,
                                                     const Structure& structure);

/// Writes the section, with its key.
void write_axis_uncertainty(YAML::Emitter& out, const AxisUncertainty& uncertainty,
                            Vocabulary vocabulary);

}  // namespace axisfit
