// The forces of effects that an axis does not have, read off a trajectory without them.
#pragma once

#include <span>
#include <vector>

#include "fit/search/hypothesis.h"
#include "fit/solve/residual.h"
#include "sim/model.h"

namespace axisfit {

/// Derivatives with respect to so many quantities at a time.
inline constexpr std::size_t kMostQuantities = 2;

/// Whether a quantity is that of an effect with smooth forces, and acts by these alone.
bool is_smooth_force(std::size_t quantity);

/// Whether what a hypothesis with these shapes does can be read off a trajectory without it, by
/// instants about `interval` (s) apart: smooth forces, and elastic modes that swing slowly enough.
bool is_read_off(const Hypothesis& hypothesis, const std::vector<double>& shapes, double interval);

/// The derivatives of an effect's accelerations along the trajectory of the model `without` it,
/// which this observer tracks, with respect to up to kMostQuantities of its quantities (indices of
/// quantity_list()), by columns. `model` has the effect with the values at which they are taken.
Disturbances disturbances_of(const Model<double>& model, const Model<double>& without,
                             std::span<const std::size_t> quantities, const Observer& observer,
                             const std::vector<AxisInstant>& trajectory);

}  // namespace axisfit
