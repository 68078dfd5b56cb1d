// Where the time of a run goes.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <ctime>
#include <string_view>

namespace axisfit {

/// Kinds of work that take long.
enum class Work {
  fits,         ///< of the declared model and of the last one
  scores,       ///< of hypotheses, without a refit
  trials,       ///< refits with a hypothesis, and what other data say of it
  substitutes,  ///< of accepted hypotheses, and models without them
  errors,       ///< what the errors of the result need, and all that follows
};

inline constexpr std::array<std::string_view, 5> kWorkNames{"fits", "scores", "trials",
                                                            "substitutes", "errors"};

struct WorkTime {
  double wall = 0.0, processor = 0.0;  ///< s, the latter of all threads together
};

/// A stopwatch that is always at one kind of work; not for two threads at once.
class WorkTimes {
 public:
  /// The time from now on is that of this kind.
  void enter(Work work) {
    const auto wall = std::chrono::steady_clock::now();
    const std::clock_t processor = std::clock();
    WorkTime& before = times_[static_cast<std::size_t>(now_)];
    before.wall += std::chrono::duration<double>(wall - wall_).count();
    before.processor += static_cast<double>(processor - processor_) / CLOCKS_PER_SEC;
    wall_ = wall;
    processor_ = processor;
    now_ = work;
  }
  /// Of each kind, up to now.
  std::array<WorkTime, kWorkNames.size()> times() {
    enter(now_);
    return times_;
  }

 private:
  std::array<WorkTime, kWorkNames.size()> times_{};
  Work now_ = Work::fits;
  std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
  std::clock_t processor_ = std::clock();
};

}  // namespace axisfit
