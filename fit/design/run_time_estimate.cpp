#include "fit/design/run_time_estimate.h"

#include <algorithm>
#include <chrono>

#include "base/parallel.h"
#include "fit/criterion/gains.h"
#include "fit/estimate/estimate.h"
#include "fit/solve/solve.h"

namespace axisfit {

RunTimeEstimate estimate_run_time(const Job& job) {
  using Clock = std::chrono::steady_clock;
  const ParameterSpace space(job);
  const Eigen::VectorXd u = space.internal(draw_start(job, 0));
  // The best of a few: others may use the machine, too, and the first one is slow.
  RunTimeEstimate run_time;
  double spent = 0.0;
  for (int turn = 0; turn < 5 && spent < 0.2; ++turn) {
    const auto begin = Clock::now();
    linearize(job, space, u, final_gain(job));
    const double time = std::chrono::duration<double>(Clock::now() - begin).count();
    run_time.evaluation = turn == 0 ? time : std::min(run_time.evaluation, time);
    spent += time;
  }
  // Evaluations on the two threads of one machine, medians over recordings that were explained or
  // not (bench/results/run_times.md). Without a continuation there are fewer attempts.
  constexpr double kStartUp = 0.03, kSearch = 0.05;  // s
  const bool attempts = job.options.is_continued();
  const double unexplained = attempts ? 1500.0 : 500.0;
  const double starts = std::max(1, job.options.starts);
  const double threads = thread_count(job.options.threads);
  const double per_start = run_time.evaluation * starts / std::min(threads, starts);
  const double slower = 2.0 / std::min(threads, 8.0);  // hypotheses share the threads
  run_time.explained = kStartUp + 60.0 * per_start;
  run_time.unexplained = kStartUp + unexplained * per_start;
  run_time.nothing_missing = run_time.explained + kSearch + 350.0 * slower * run_time.evaluation;
  run_time.one_effect =
      run_time.unexplained + (attempts ? 4000.0 : 1500.0) * slower * run_time.evaluation;
  run_time.no_effect =
      run_time.unexplained + (attempts ? 15000.0 : 3000.0) * slower * run_time.evaluation;
  return run_time;
}

}  // namespace axisfit
