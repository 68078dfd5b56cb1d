#include "fit/continuation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fit/residual.h"

namespace axisfit {
namespace {

double residual_count(const Job& job) {
  double n = 0.0;
  for (const Recording& r : job.recordings)
    if (r.role == Role::fit)
      for (const Measurement& m : r.measurements)
        if (m.fitted) n += static_cast<double>(r.times.size());
  return n;
}

double longest_duration(const Job& job) {
  double longest = 0.0;
  for (const Recording& r : job.recordings)
    if (r.role == Role::fit) longest = std::max(longest, r.times.back() - r.times.front());
  return longest;
}

bool can_be_coupled(const Job& job) {
  return std::ranges::any_of(job.recordings, [](const Recording& r) {
    return r.role == Role::fit && coupling_for(r, 1.0).active();
  });
}

}  // namespace

double first_coupling_rate(const Job& job) {
  if (job.options.coupling_rate > 0.0) return job.options.coupling_rate;
  double rate = std::numeric_limits<double>::infinity();
  for (const Recording& r : job.recordings) {
    if (r.role != Role::fit || !coupling_for(r, 1.0).active()) continue;
    const double interval =
        (r.times.back() - r.times.front()) / static_cast<double>(r.times.size() - 1);
    rate = std::min(rate, (r.find(Signal::velocity) != nullptr ? 1.0 : 0.3) / interval);
  }
  return rate;
}

ContinuationResult continue_to_free(const Job& job, const ParameterSpace& space,
                                    const Eigen::VectorXd& start,
                                    const std::function<void(const Stage&)>& progress) {
  const FitOptions& options = job.options;
  const double n = residual_count(job);
  ContinuationResult result;
  int iterations = 0;
  const auto stage = [&](const Eigen::VectorXd& u, double rate, bool final) {
    SolveOptions solver;
    solver.max_iterations = final ? options.max_iterations : std::min(options.max_iterations, 20);
    solver.function_tolerance = final ? 1e-10 : 1e-4;
    SolveResult solved = solve(job, space, u, rate, solver);
    iterations += solved.iterations;
    result.stages.push_back({rate, 2.0 * solved.cost / n, solved.iterations, true});
    return solved;
  };
  const auto report = [&] {
    if (progress) progress(result.stages.back());
  };

  if (options.coupling != CouplingMode::continuation || !can_be_coupled(job)) {
    const double rate =
        options.coupling == CouplingMode::fixed ? first_coupling_rate(job) : 0.0;
    result.last = stage(start, rate, true);
    report();
    return result;
  }

  // Below this rate the coupling cannot do anything within the recording any more.
  const double slowest = 1.0 / longest_duration(job);
  double rate = first_coupling_rate(job);
  double ratio = 3.0;
  SolveResult held = stage(start, rate, false);
  report();
  while (held.usable && rate > 0.0) {
    const double held_cost = result.stages.back().reduced_cost;
    double next = rate / ratio;
    if (next < slowest) next = 0.0;
    SolveResult solved = stage(held.u, next, next == 0.0);
    Stage& latest = result.stages.back();
    // The residual may grow as the hold loosens, if the model lacks something, but not by leaps:
    // those mean that the simulation lost the data between two rates.
    const bool lost = !solved.usable || latest.reduced_cost > 3.0 * held_cost + 1.0;
    latest.accepted = !lost || ratio < 1.3;
    report();
    if (!latest.accepted) {
      latest.reduced_cost = held_cost;  // for the comparison with the next try
      ratio = std::sqrt(ratio);
      continue;
    }
    held = std::move(solved);
    rate = next;
    ratio = std::min(ratio * 1.5, 5.0);
  }
  result.last = std::move(held);
  result.last.iterations = iterations;
  return result;
}

}  // namespace axisfit
