// Progress on the last line of a terminal.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "base/progress.h"

namespace axisfit {

/// A guess of the seconds that a phase still takes, by the mean of its parts so far; none before
/// two of them are finished. It grows while a part takes longer than those before.
std::optional<double> time_left(int done, int of, double elapsed);

/// "about 40 s", no finer than such a guess deserves.
std::string about(double seconds);

/// "1:05", "2:03:10"
std::string stopwatch(double seconds);

/// One line of less than `width` characters: phase, bar, parts done, time left in this phase, best
/// cost, and time elapsed in all, s. What there is no room for is left out, the bar first.
std::string progress_text(const Progress& progress, double elapsed, std::optional<double> left,
                          std::size_t width);

/// Shows the latest of what it is told on standard error, until it goes away and takes the line
/// with it; what finished stays. Paints from a thread of its own, at most ten times a second and
/// only what has changed, so that the clock runs on while there is nothing to tell. Silent for the
/// first second.
class ProgressLine {
 public:
  explicit ProgressLine(bool visible);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void update(Progress progress);

 private:
  using Clock = std::chrono::steady_clock;

  void run(const std::stop_token& end);
  std::string text_now() const;

  const Clock::time_point begin_ = Clock::now();
  std::mutex mutex_;
  std::condition_variable_any tick_;
  Progress progress_;                       ///< guarded by the mutex, as are the next two
  std::string finished_;                    ///< lines that are to stay
  Clock::time_point phase_begin_ = begin_;  ///< of the parts that are counted
  std::jthread painter_;                    ///< not running unless visible
};

/// Ends the program by a signal, as if it were not handled, but with the line taken away. For
/// signal handlers.
void end_by_signal(int signal);

}  // namespace axisfit
