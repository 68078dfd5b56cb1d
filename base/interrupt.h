// Ending early what takes long.
#pragma once

#include <atomic>

namespace axisfit {

/// Set from outside, as by a signal handler: what is under way ends soon.
using StopFlag = std::atomic<bool>;

inline bool is_set(const StopFlag* flag) {
  return flag != nullptr && flag->load(std::memory_order_relaxed);
}

/// Thrown where that leaves nothing to return.
struct Interrupted {};

}  // namespace axisfit
