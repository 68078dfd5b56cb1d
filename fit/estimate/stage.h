// One stage of the observer-gain continuation (continuation.h).
#pragma once

namespace axisfit {

/// One solved stage of the continuation.
struct Stage {
  double observer_gain = 0.0;  ///< 1/s, zero at the end
  double reduced_cost = 0.0;   ///< 2 cost / number of residuals
  int iterations = 0;
  bool accepted = true;  ///< false: the step in the gain was too long, a shorter one followed
};

}  // namespace axisfit
