// Early termination of long computations.
#pragma once

#include <atomic>

namespace axisfit {

/// Set from outside, for instance by a signal handler: the computation then ends soon.
using StopFlag = std::atomic<bool>;

inline bool is_set(const StopFlag* flag) {
  return flag != nullptr && flag->load(std::memory_order_relaxed);
}

/// Thrown where that leaves nothing to return.
struct Interrupted {};

}  // namespace axisfit
