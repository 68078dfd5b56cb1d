#include "fit/estimate/continuation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/random.h"
#include "fit/solve/residual.h"
#include "sim/sampling.h"

namespace axisfit {
namespace {

double longest_duration(const Job& job) {
  double longest = 0.0;
  for (const Recording& r : job.recordings)
    if (r.role == Role::fit) longest = std::max(longest, r.times.back() - r.times.front());
  return longest;
}

bool can_track(const Job& job) {
  return std::ranges::any_of(job.recordings, [](const Recording& r) {
    return r.role == Role::fit && observer_for(r, 1.0).active();
  });
}

/// A start within a factor of three of another, by a fixed sequence: fits are repeatable.
Eigen::VectorXd perturbed(const ParameterSpace& space, Eigen::VectorXd u, int attempt) {
  std::mt19937_64 generator(static_cast<std::uint64_t>(attempt));
  for (std::size_t i = 0; i < space.size(); ++i) {
    if (!space[i].logarithmic) continue;  // linear ones have no factor, and converge by themselves
    const double z = 2.0 * uniform(generator) - 1.0;
    double& x = u[static_cast<Eigen::Index>(i)];
    x = std::clamp(x + z * std::log(3.0), space.internal(i, space[i].lower),
                   space.internal(i, space[i].upper));
  }
  return u;
}

/// The stages of one continuation, from `rate` down to a free-running simulation.
class Continuation {
 public:
  Continuation(const Job& job, const ParameterSpace& space,
               const std::function<void(const Stage&)>& progress, const RunContext& context)
      : job_(job), space_(space), progress_(progress), context_(context) {}

  /// Solves at one rate; `final` with the full accuracy.
  SolveResult solve_stage(const Eigen::VectorXd& start, double rate, bool final) {
    SolveOptions options;
    options.max_iterations = job_.options.max_iterations;
    options.function_tolerance = job_.options.tolerance;
    if (!final) {
      options.max_iterations = std::min(options.max_iterations, 12);
      options.function_tolerance = 1e-4;
      options.penalize_distance_from_start = true;
    }
    SolveResult solved = solve(job_, space_, start, rate, options, context_);
    iterations_ += solved.iterations;
    stages_.push_back({rate, solved.reduced_cost, solved.iterations, solved.usable});
    return solved;
  }

  /// Reports what was found while tracking with the gain `rate`.
  SolveResult solve_tracking(const Eigen::VectorXd& start, double rate) {
    SolveResult tracking = solve_stage(start, rate, false);
    report();
    return tracking;
  }

  SolveResult run(const Eigen::VectorXd& start, double rate) {
    return run(solve_tracking(start, rate), rate);
  }

  /// From what hold() found. Not usable where an earlier path went the same way.
  SolveResult run(SolveResult tracking, double rate) {
    // Below this rate the observer cannot do anything within the recording any more.
    const double slowest = 1.0 / longest_duration(job_);
    double ratio = 3.0;
    double previous_cost = tracking.reduced_cost;
    while (tracking.usable && rate > 0.0) {
      double next = rate / ratio;
      if (next < slowest) next = 0.0;
      SolveResult solved = solve_stage(tracking.u, next, next == 0.0);
      Stage& latest = stages_.back();
      // The residual may grow as the hold loosens, if the model lacks something, but not by leaps:
      // those mean that the simulation lost the data between two rates.
      const bool lost = !solved.usable || latest.reduced_cost > 3.0 * previous_cost + 1.0;
      latest.accepted = !lost || ratio < 1.3;
      report();
      if (!latest.accepted) {
        ratio = std::sqrt(ratio);
        continue;
      }
      if (next > 0.0 && is_known_minimum(next, solved)) {
        solved.usable = false;
        return solved;
      }
      previous_cost = latest.reduced_cost;
      tracking = std::move(solved);
      rate = next;
      ratio = std::min(ratio * 2.0, 20.0);
    }
    return tracking;
  }

  /// Whether an earlier path came by here, so that its end would be this one's, too. If not, later
  /// ones will know that this one did.
  bool is_known_minimum(double rate, const SolveResult& solved) {
    constexpr double kSame = 1e-2;  // of costs, and of the parameters that the data determine
    const bool known = std::ranges::any_of(visited_, [&](const VisitedMinimum& place) {
      return std::abs(place.rate - rate) < kSame * rate &&
             std::abs(place.cost - solved.cost) < kSame * solved.cost &&
             (place.u - solved.u).lpNorm<Eigen::Infinity>() < kSame;
    });
    if (!known) visited_.push_back({rate, solved.cost, solved.u});
    return known;
  }

  void report() const {
    if (progress_) progress_(stages_.back());
  }
  const std::vector<Stage>& stages() const { return stages_; }
  int iterations() const { return iterations_; }

 private:
  struct VisitedMinimum {
    double rate = 0.0, cost = 0.0;
    Eigen::VectorXd u;
  };

  const Job& job_;
  const ParameterSpace& space_;
  const std::function<void(const Stage&)>& progress_;
  const RunContext& context_;
  std::vector<VisitedMinimum> visited_;  ///< minima met, of all paths
  std::vector<Stage> stages_;
  int iterations_ = 0;
};

}  // namespace

double initial_observer_gain(const Job& job) {
  if (job.options.observer_gain > 0.0) return job.options.observer_gain;
  double rate = std::numeric_limits<double>::infinity();
  for (const Recording& r : job.recordings) {
    if (r.role != Role::fit || !observer_for(r, 1.0).active()) continue;
    rate =
        std::min(rate, (r.find(Signal::velocity) != nullptr ? 1.0 : 0.3) / mean_interval(r.times));
  }
  return rate;
}

double final_observer_gain(const Job& job) {
  return job.options.observer == ObserverMode::fixed ? initial_observer_gain(job) : 0.0;
}

ContinuationResult run_continuation(const Job& job, const ParameterSpace& space,
                                    const Eigen::VectorXd& start,
                                    const std::function<void(const Stage&)>& progress,
                                    const RunContext& context) {
  Continuation continuation(job, space, progress, context);
  ContinuationResult result;
  if (job.options.observer != ObserverMode::continuation || !can_track(job)) {
    result.last = continuation.solve_stage(start, final_observer_gain(job), true);
    continuation.report();
  } else {
    const double rate = initial_observer_gain(job);
    // An end that is near the noise is not the wrong one of many: something small is missing.
    constexpr double kExplained = 1.1, kNear = 5.0;
    const auto explained = [&](double reduced_cost) {
      return result.last.usable && result.last.reduced_cost < reduced_cost;
    };
    std::optional<double> known;  // cost of the best end when it tracks again
    const auto accept_if_better = [&](SolveResult solved) {
      if (result.last.usable && !(solved.usable && solved.cost < result.last.cost)) return;
      const bool same_end = result.last.usable && solved.cost > 0.99 * result.last.cost;
      result.last = std::move(solved);
      if (!same_end) known.reset();
    };
    const auto track_with_best = [&] {
      SolveResult tracking = continuation.solve_tracking(result.last.u, rate);
      known = tracking.cost;
      return tracking;
    };
    const auto follow = [&](const Eigen::VectorXd& from, double at_rate) {
      accept_if_better(continuation.run(from, at_rate));
      // Held again, an end in a wrong valley often finds the right one.
      const bool wrong = result.last.usable && !explained(kNear) && !known;
      if (wrong && job.options.attempts > 1)
        accept_if_better(continuation.run(track_with_best(), rate));
    };
    follow(start, rate);
    // Where the end does not explain the data, start again from a lower gain: a high one feeds the
    // measurement noise into the simulation, which can bias weakly determined parameters for good.
    if (!explained(kExplained) && job.options.attempts > 1) follow(start, rate / 5.0);
    // And from elsewhere: even while tracking, a controller that saturates has local minima. They
    // show there already, so that only a start with a lower tracking cost has to be followed. One
    // that cannot even be simulated costs little: then more perturbations are tried. Several that
    // end where the best did confirm it.
    constexpr int kPerturbations = 8, kFirstPerturbations = 16, kConfirmed = 3;
    int confirmed = 0;
    for (int attempt = 2; attempt < job.options.attempts; ++attempt) {
      if (explained(kNear)) break;
      if (result.last.usable && !known) track_with_best();
      const double best = known.value_or(std::numeric_limits<double>::infinity());
      double least = 0.9 * best;
      std::optional<Eigen::VectorXd> from;
      for (int move = 0; move < (from || result.last.usable ? kPerturbations : kFirstPerturbations);
           ++move) {
        const SolveResult tracking = continuation.solve_tracking(
            perturbed(space, start, attempt * kFirstPerturbations + move), rate);
        if (tracking.usable && std::abs(tracking.cost - best) < 0.01 * best) ++confirmed;
        if (!from && confirmed >= kConfirmed) break;
        if (!tracking.usable || tracking.cost >= least) continue;
        least = tracking.cost;
        from = tracking.u;
      }
      if (confirmed >= kConfirmed && !from) break;
      if (from) follow(*from, rate);
    }
  }
  result.last.iterations = continuation.iterations();
  result.stages = continuation.stages();
  return result;
}

}  // namespace axisfit
