// What surrounds long work and changes no result: how it is stopped, what it keeps, whom it
// informs.
#pragma once

#include "base/interrupt.h"
#include "base/progress.h"

namespace axisfit {

class Journal;

/// Passed down through all that takes long. What it points to must outlive the call.
struct RunContext {
  const StopFlag* stop = nullptr;  ///< ends the work early; null: never
  Journal* journal = nullptr;      ///< of solved problems (journal.h); null: none
  ProgressReport progress{};       ///< called from any thread, one call at a time; empty: nobody

  /// The same without reports, for work within work.
  RunContext quiet() const { return {stop, journal, {}}; }
  /// Informs whoever wants to know.
  void report(const Progress& now) const {
    if (progress) progress(now);
  }
  /// Throws Interrupted when the stop flag is set.
  void check_stop() const {
    if (is_set(stop)) throw Interrupted();
  }
};

}  // namespace axisfit
