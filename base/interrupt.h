// Early termination of long computations.
#pragma once

#include <atomic>
#include <limits>

namespace axisfit {

/// Ends a computation early: set from outside, for instance by a signal handler, or when the work
/// allowed to it is done. Work is counted, not timed: a loaded machine comes as far as an idle one.
class StopFlag {
 public:
  StopFlag() = default;
  /// For a part of what `outer` may end, which must outlive it; null: nothing may. `work` in steps
  /// of a simulation in plain numbers; one with n derivatives counts n + 1 times.
  explicit StopFlag(const StopFlag* outer, long work = std::numeric_limits<long>::max())
      : outer_(outer), left_(work) {}

  /// Returns whether it was set before.
  bool set() { return is_set_.exchange(true); }
  bool is_set() const {
    return is_set_.load(std::memory_order_relaxed) || left() < 0 ||
           (outer_ != nullptr && outer_->is_set());
  }

  /// Counts work that is done. Of several threads, in whatever order: the flag is set if all of it
  /// together is more than allowed.
  void count(long work) const {
    if (outer_ != nullptr) outer_->count(work);
    left_.fetch_sub(work, std::memory_order_relaxed);
  }
  /// Work that is still allowed.
  long left() const { return left_.load(std::memory_order_relaxed); }

  static constexpr bool is_always_lock_free =
      std::atomic<bool>::is_always_lock_free && std::atomic<long>::is_always_lock_free;

 private:
  std::atomic<bool> is_set_ = false;
  const StopFlag* outer_ = nullptr;
  mutable std::atomic<long> left_ = std::numeric_limits<long>::max();
};

inline bool is_set(const StopFlag* flag) { return flag != nullptr && flag->is_set(); }

/// Thrown where that leaves nothing to return.
struct Interrupted {};

}  // namespace axisfit
