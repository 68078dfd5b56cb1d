// What long work reports while it runs.
#pragma once

#include <functional>
#include <limits>
#include <string>

#include "base/work_times.h"

namespace axisfit {

struct Progress {
  std::string phase;  ///< what is being done, in words
  int done = 0;       ///< parts of the phase that are finished
  int of = 0;         ///< parts that it has; zero where it has none
  /// Reduced chi-square of the best model so far; not a number before there is one.
  double best = std::numeric_limits<double>::quiet_NaN();
  std::string finished{};  ///< what has just ended and how, to be kept in view; mostly empty
  Work work = Work::fits;  ///< that the phase is
};

/// Called from several threads, one at a time.
using ProgressReport = std::function<void(const Progress&)>;

}  // namespace axisfit
