// SUNDIALS CVODES: backward differentiation with forward sensitivities, restarted at events.
#pragma once

#include "bench/speed/work.h"

namespace axisfit::speed {

struct CvodesOptions {
  double tolerance = 1e-8;  ///< relative, of states and sensitivities
  bool supplied = true;     ///< derivatives of the right-hand side: supplied, or its own quotients
  bool simultaneous = false;  ///< corrects states and sensitivities together
};

/// Tolerances are relative to each component or to its scale, whichever is larger.
template <int N>
Trajectory by_cvodes(const Work& work, const Scales& scales, const CvodesOptions& options);

}  // namespace axisfit::speed
