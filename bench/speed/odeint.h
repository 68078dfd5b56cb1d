// Boost.odeint: Dormand-Prince 5(4) with dense output on states and sensitivities together.
#pragma once

#include "bench/speed/work.h"

namespace axisfit::speed {

/// The tolerance is relative to each component or to its scale, whichever is larger.
template <int N>
Trajectory by_odeint(const Work& work, const Scales& scales, double tolerance);

}  // namespace axisfit::speed
