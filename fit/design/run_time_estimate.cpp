#include "fit/design/run_time_estimate.h"

#include <algorithm>
#include <chrono>

#include "base/parallel.h"
#include "fit/estimation/continuation.h"
#include "fit/estimation/estimate.h"

namespace axisfit {

RunTimeEstimate estimate_run_time(const Job& job) {
  // Of the jobs in configs/jobs whose model explains them, and that with a generous hand: from a
  // start to its end, by continuation or without, and then for the tests of the residual.
  const double of_start = job.options.observer == ObserverMode::continuation ? 100.0 : 50.0;
  constexpr double kOfDiagnosis = 10.0;
  using Clock = std::chrono::steady_clock;
  const ParameterSpace space(job);
  const Eigen::VectorXd u = space.internal(draw_start(job, 0));
  // The best of a few: others may use the machine, too, and the first one is slow.
  RunTimeEstimate run_time;
  double spent = 0.0;
  for (int turn = 0; turn < 5 && spent < 0.2; ++turn) {
    const auto begin = Clock::now();
    linearize(job, space, u, final_observer_gain(job));
    const double time = std::chrono::duration<double>(Clock::now() - begin).count();
    run_time.evaluation = turn == 0 ? time : std::min(run_time.evaluation, time);
    spent += time;
  }
  const double starts = std::max(1, job.options.starts);
  const auto recordings = std::ranges::count(job.recordings, Role::fit, &Recording::role);
  const double threads =
      std::min<double>(thread_count(job.options.threads), starts * static_cast<double>(recordings));
  run_time.expected = run_time.evaluation * (of_start * starts / threads + kOfDiagnosis);
  return run_time;
}

}  // namespace axisfit
