#include "fit/estimation/continuation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/random.h"
#include "fit/estimation/residual.h"
#include "sim/sampling.h"

namespace axisfit {
namespace {

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

/// A start within a factor of three of another, by a fixed sequence: fits are repeatable.
Eigen::VectorXd moved(const ParameterSpace& space, Eigen::VectorXd u, int attempt) {
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
               const std::function<void(const Stage&)>& progress)
      : job_(job), space_(space), progress_(progress) {}

  /// Solves at one rate; `final` with the full accuracy.
  SolveResult solve_stage(const Eigen::VectorXd& start, double rate, bool final) {
    SolveOptions options;
    options.max_iterations = job_.options.max_iterations;
    options.function_tolerance = job_.options.tolerance;
    if (!final) {
      options.max_iterations = std::min(options.max_iterations, 12);
      options.function_tolerance = 1e-4;
      options.keep_to_start = true;
    }
    SolveResult solved = solve(job_, space_, start, rate, options);
    iterations_ += solved.iterations;
    stages_.push_back({rate, solved.reduced_cost, solved.iterations, solved.usable});
    return solved;
  }

  /// What was found while held at `rate`, reported.
  SolveResult hold(const Eigen::VectorXd& start, double rate) {
    SolveResult held = solve_stage(start, rate, false);
    report();
    return held;
  }

  SolveResult run(const Eigen::VectorXd& start, double rate) {
    return run(hold(start, rate), rate);
  }

  /// From what hold() found. Not usable where an earlier path went the same way.
  SolveResult run(SolveResult held, double rate) {
    // Below this rate the coupling cannot do anything within the recording any more.
    const double slowest = 1.0 / longest_duration(job_);
    double ratio = 3.0;
    double held_cost = held.reduced_cost;
    while (held.usable && rate > 0.0) {
      double next = rate / ratio;
      if (next < slowest) next = 0.0;
      SolveResult solved = solve_stage(held.u, next, next == 0.0);
      Stage& latest = stages_.back();
      // The residual may grow as the hold loosens, if the model lacks something, but not by leaps:
      // those mean that the simulation lost the data between two rates.
      const bool lost = !solved.usable || latest.reduced_cost > 3.0 * held_cost + 1.0;
      latest.accepted = !lost || ratio < 1.3;
      report();
      if (!latest.accepted) {
        ratio = std::sqrt(ratio);
        continue;
      }
      if (next > 0.0 && been_there(next, solved)) {
        solved.usable = false;
        return solved;
      }
      held_cost = latest.reduced_cost;
      held = std::move(solved);
      rate = next;
      ratio = std::min(ratio * 2.0, 20.0);
    }
    return held;
  }

  /// Whether an earlier path came by here, so that its end would be this one's, too. If not, later
  /// ones will know that this one did.
  bool been_there(double rate, const SolveResult& solved) {
    constexpr double kSame = 1e-2;  // of costs, and of the parameters that the data determine
    const bool known = std::ranges::any_of(places_, [&](const Place& place) {
      return std::abs(place.rate - rate) < kSame * rate &&
             std::abs(place.cost - solved.cost) < kSame * solved.cost &&
             (place.u - solved.u).lpNorm<Eigen::Infinity>() < kSame;
    });
    if (!known) places_.push_back({rate, solved.cost, solved.u});
    return known;
  }

  void report() const {
    if (progress_) progress_(stages_.back());
  }
  const std::vector<Stage>& stages() const { return stages_; }
  int iterations() const { return iterations_; }

 private:
  struct Place {
    double rate = 0.0, cost = 0.0;
    Eigen::VectorXd u;
  };

  const Job& job_;
  const ParameterSpace& space_;
  const std::function<void(const Stage&)>& progress_;
  std::vector<Place> places_;  ///< minima on the way, of all paths
  std::vector<Stage> stages_;
  int iterations_ = 0;
};

}  // namespace

double first_coupling_rate(const Job& job) {
  if (job.options.coupling_rate > 0.0) return job.options.coupling_rate;
  double rate = std::numeric_limits<double>::infinity();
  for (const Recording& r : job.recordings) {
    if (r.role != Role::fit || !coupling_for(r, 1.0).active()) continue;
    rate =
        std::min(rate, (r.find(Signal::velocity) != nullptr ? 1.0 : 0.3) / mean_interval(r.times));
  }
  return rate;
}

double last_coupling_rate(const Job& job) {
  return job.options.coupling == CouplingMode::fixed ? first_coupling_rate(job) : 0.0;
}

bool is_ignored(const QuantityEntry& entry, CouplingMode coupling) {
  const auto signal = signal_by_name(entry.group);
  return coupling == CouplingMode::fixed &&
         (signal == Signal::position || signal == Signal::velocity) &&
         (entry.quantity.symbol == "lag" || entry.quantity.symbol == "delay");
}

ContinuationResult continue_to_free(const Job& job, const ParameterSpace& space,
                                    const Eigen::VectorXd& start,
                                    const std::function<void(const Stage&)>& progress) {
  Continuation continuation(job, space, progress);
  ContinuationResult result;
  if (job.options.coupling != CouplingMode::continuation || !can_be_coupled(job)) {
    result.last = continuation.solve_stage(start, last_coupling_rate(job), true);
    continuation.report();
  } else {
    const double rate = first_coupling_rate(job);
    // An end that is near the noise is not the wrong one of many: something small is missing.
    constexpr double kExplained = 1.1, kNear = 5.0;
    const auto explained = [&](double reduced_cost) {
      return result.last.usable && result.last.reduced_cost < reduced_cost;
    };
    std::optional<double> known;  // cost of the best end when it is held again
    const auto take = [&](SolveResult solved) {
      if (result.last.usable && !(solved.usable && solved.cost < result.last.cost)) return;
      const bool same_end = result.last.usable && solved.cost > 0.99 * result.last.cost;
      result.last = std::move(solved);
      if (!same_end) known.reset();
    };
    const auto hold_best = [&] {
      SolveResult held = continuation.hold(result.last.u, rate);
      known = held.cost;
      return held;
    };
    const auto follow = [&](const Eigen::VectorXd& from, double at_rate) {
      take(continuation.run(from, at_rate));
      // Held again, an end in a wrong valley often finds the right one.
      const bool wrong = result.last.usable && !explained(kNear) && !known;
      if (wrong && job.options.attempts > 1) take(continuation.run(hold_best(), rate));
    };
    follow(start, rate);
    // Where the end does not explain the data, begin anew. Less firmly: a firm hold feeds the noise
    // of the measurement into the simulation, which can bias what the data hardly show beyond
    // return.
    if (!explained(kExplained) && job.options.attempts > 1) follow(start, rate / 5.0);
    // And from elsewhere: even held firmly, a controller that saturates has local minima. That
    // shows while it is held, so that only a start which is better there has to be followed.
    // One that cannot even be simulated costs little: there the moves go on for longer.
    // Several that end where the best did confirm it.
    constexpr int kMoves = 8, kMovesToBegin = 16, kConfirmed = 3;
    int confirmed = 0;
    for (int attempt = 2; attempt < job.options.attempts; ++attempt) {
      if (explained(kNear)) break;
      if (result.last.usable && !known) hold_best();
      const double best = known.value_or(std::numeric_limits<double>::infinity());
      double least = 0.9 * best;
      std::optional<Eigen::VectorXd> from;
      for (int move = 0; move < (from || result.last.usable ? kMoves : kMovesToBegin); ++move) {
        const SolveResult held =
            continuation.hold(moved(space, start, attempt * kMovesToBegin + move), rate);
        if (held.usable && std::abs(held.cost - best) < 0.01 * best) ++confirmed;
        if (!from && confirmed >= kConfirmed) break;
        if (!held.usable || held.cost >= least) continue;
        least = held.cost;
        from = held.u;
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
