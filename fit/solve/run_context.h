// The surroundings of long work, which change no result: stop flag, journal and progress.
#pragma once

#include "base/interrupt.h"
#include "base/progress.h"

namespace axisfit {

class Journal;

/// Of a limit of time, what a search for effects may spend: the rest is for judging what it found.
inline constexpr double kPartOfSearch = 0.7;

/// Passed down to everything that takes long. The objects it points to must outlive the call.
struct RunContext {
  const StopFlag* stop = nullptr;  ///< ends the work early; null: never
  Journal* journal = nullptr;      ///< of solved problems (journal.h); null: none
  ProgressReport progress{};       ///< called from any thread, one call at a time; empty: nobody
  /// Ends a search for effects, so that time is left to judge what it found: an inner flag of
  /// `stop`. Null: `stop` does.
  const StopFlag* end_search = nullptr;

  /// The same without reports, for work within work.
  RunContext quiet() const { return {stop, journal, {}, end_search}; }
  /// Reports progress, if there is somebody to report to.
  void report(const Progress& now) const {
    if (progress) progress(now);
  }
  /// Throws Interrupted when the stop flag is set.
  void check_stop() const {
    if (is_set(stop)) throw Interrupted();
  }
};

}  // namespace axisfit
