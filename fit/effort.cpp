#include "fit/effort.h"

#include <algorithm>
#include <chrono>

#include "fit/continuation.h"
#include "fit/estimate.h"
#include "fit/parallel.h"

namespace axisfit {

Effort expected_effort(const Job& job) {
  // Of the jobs in configs/jobs: the mean, on a logarithmic scale. From a start to the end of its
  // continuation, and then for the tests of the residual.
  constexpr double kOfStart = 100.0, kOfDiagnosis = 150.0;
  using Clock = std::chrono::steady_clock;
  const ParameterSpace space(job);
  const Eigen::VectorXd u = space.internal(draw_start(job, 0));
  // The best of a few: others may use the machine, too, and the first one is slow.
  Effort effort;
  double spent = 0.0;
  for (int turn = 0; turn < 5 && spent < 0.2; ++turn) {
    const auto begin = Clock::now();
    linearize(job, space, u, last_coupling_rate(job));
    const double time = std::chrono::duration<double>(Clock::now() - begin).count();
    effort.evaluation = turn == 0 ? time : std::min(effort.evaluation, time);
    spent += time;
  }
  const int starts = std::max(1, job.options.starts);
  const int threads = thread_count(job.options.threads);
  const int turns = (starts + threads - 1) / threads;
  effort.expected = effort.evaluation * (kOfStart * turns + kOfDiagnosis);
  return effort;
}

}  // namespace axisfit
