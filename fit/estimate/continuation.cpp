#include "fit/estimate/continuation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/random.h"
#include "fit/criterion/gains.h"
#include "fit/estimate/recipes.h"

namespace axisfit {
namespace {

/// How the observer gain is lowered, stage by stage.
struct DescentOptions {
  /// Of a stage before the last, which only has to come near.
  int iterations = 12;
  double tolerance = 1e-4;
  /// Ratio of one gain to the next: the first, and the largest, to which it is doubled while the
  /// simulation keeps to the data.
  double first_ratio = 3.0, largest_ratio = 20.0;
  /// At a ratio below it, the next stage is taken whatever became of it.
  double smallest_ratio = 1.3;
  /// The cost may grow as the gain falls, if the model lacks something, but not by leaps beyond
  /// this factor and term: those mean that the simulation lost the data between two gains.
  double lost_factor = 3.0, lost_term = 1.0;
  /// What a missing force leaves grows as a power of the falling gain: with its square, or where
  /// only the position is known with its fourth power. As much as that power of the stage before
  /// foretells is no leap, up to this factor, which also bounds the next ratio.
  double largest_growth = 10.0;
  /// Two minima are one that differ by less in gain, cost and the parameters that the data
  /// determine.
  double same_minimum = 1e-2;
};

/// When a fit starts again, from where, and when it has seen enough. Costs are reduced costs where
/// nothing else is said.
struct StartOptions {
  /// Below it an end explains the data. Noise of the stated size leaves 1.
  double explained = 1.1;
  /// Below it an end is near the noise, and not the wrong one of many: something small is missing.
  double near = 5.0;
  /// While tracking, even a model that lacks something comes below it, but not in a wrong valley.
  double followed = 10.0;
  /// By which the gain is lowered for the second start. A high one feeds the noise of the readings
  /// into the simulation, which can bias weakly determined parameters for good.
  double lower_gain = 5.0;
  /// Factor within which a start is perturbed, either way: about the usual error of initial values.
  double perturbation = 3.0;
  /// Perturbations of an attempt. Where nothing could be simulated so far each costs little: then
  /// more of them are tried.
  int perturbations = 8, first_perturbations = 16;
  /// A perturbed start is followed if its cost while tracking is below this part of that of the
  /// best end: local minima show there already.
  double promising = 0.9;
  /// So many perturbed starts that lead, within this part of its cost, to where the best end tracks
  /// confirm it.
  int confirmations = 3;
  double confirming = 0.01;
  /// An end whose cost is above this part of the former best is the same one, found more exactly.
  double same_end = 0.99;
};

double longest_duration(const Job& job) {
  double longest = 0.0;
  for (const Recording& r : job.recordings)
    if (r.role == Role::fit) longest = std::max(longest, r.times.back() - r.times.front());
  return longest;
}

/// A start within a factor of another, by a fixed sequence: fits are repeatable.
Eigen::VectorXd perturbed(const ParameterSpace& space, Eigen::VectorXd u, double factor,
                          int number) {
  std::mt19937_64 generator(static_cast<std::uint64_t>(number));
  for (std::size_t i = 0; i < space.size(); ++i) {
    if (space[i].scale == Scale::linear)
      continue;  // linear ones have no factor, and converge by themselves
    const double z = 2.0 * uniform(generator) - 1.0;
    double& x = u[static_cast<Eigen::Index>(i)];
    x = std::clamp(x + z * std::log(factor), space.internal(i, space[i].lower),
                   space.internal(i, space[i].upper));
  }
  return u;
}

/// The way from a high observer gain down to the free run, stage by stage.
class Descent {
 public:
  Descent(const Job& job, const ParameterSpace& space,
          const std::function<void(const Stage&)>& progress, const RunContext& context)
      : job_(job), coarse_(job), space_(space), progress_(progress), context_(context) {
    coarse_.options = recipe::coarse(coarse_.options);
  }

  /// Solves at one gain; `final` with the full accuracy.
  SolveResult solve_stage(const Eigen::VectorXd& start, double gain, bool final) {
    SolveOptions options;
    options.max_iterations = job_.options.max_iterations;
    options.function_tolerance = job_.options.tolerance;
    if (final) {
      options.give_up_above = job_.options.give_up_above;
    } else {
      options.max_iterations = std::min(options.max_iterations, options_.iterations);
      options.function_tolerance = options_.tolerance;
      options.penalize_distance_from_start = true;
    }
    SolveResult solved = solve(final ? job_ : coarse_, space_, start, gain, options, context_);
    iterations_ += solved.iterations;
    stages_.push_back({gain, solved.reduced_cost, solved.iterations, solved.usable});
    return solved;
  }

  /// Solves while tracking with this gain, the first stage of a descent.
  SolveResult solve_tracking(const Eigen::VectorXd& start, double gain) {
    SolveResult tracking = solve_stage(start, gain, false);
    report();
    return tracking;
  }

  /// From a start, tracking with this gain, down to the free run.
  SolveResult run(const Eigen::VectorXd& start, double gain) {
    return run(solve_tracking(start, gain), gain);
  }

  /// From what solve_tracking() found. Not usable where an earlier descent went the same way.
  SolveResult run(SolveResult tracking, double gain) {
    if (tracking.usable && is_known_minimum(gain, tracking)) tracking.usable = false;
    // Below it the observer cannot do anything within the recording any more.
    const double lowest = 1.0 / longest_duration(job_);
    double ratio = options_.first_ratio;
    double previous_cost = tracking.reduced_cost;
    double power = 0.0;  // of the growth of the cost
    while (tracking.usable && gain > 0.0) {
      double next = gain / ratio;
      if (next < lowest) next = 0.0;
      SolveResult solved = solve_stage(tracking.u, next, next == 0.0);
      Stage& latest = stages_.back();
      const double foretold = std::min(std::pow(ratio, power), options_.largest_growth);
      const double lost_cost = options_.lost_factor * foretold * previous_cost + options_.lost_term;
      const bool lost = !solved.usable || latest.reduced_cost > lost_cost;
      latest.accepted = !lost || ratio < options_.smallest_ratio;
      report();
      if (!latest.accepted) {
        ratio = std::sqrt(ratio);
        continue;
      }
      if (next > 0.0 && is_known_minimum(next, solved)) {
        solved.usable = false;
        return solved;
      }
      power = std::max(0.0, std::log(latest.reduced_cost / previous_cost) / std::log(ratio));
      previous_cost = latest.reduced_cost;
      tracking = std::move(solved);
      gain = next;
      const double bounded = std::pow(options_.largest_growth, 1.0 / power);
      ratio = std::max(options_.smallest_ratio,
                       std::min({ratio * 2.0, options_.largest_ratio, bounded}));
    }
    return tracking;
  }

  void report() const {
    if (progress_) progress_(stages_.back());
  }
  const std::vector<Stage>& stages() const { return stages_; }
  int iterations() const { return iterations_; }

 private:
  /// Whether an earlier descent came by here, so that its end would be this one's, too. If not,
  /// later ones will know that this one did.
  bool is_known_minimum(double gain, const SolveResult& solved) {
    const double same = options_.same_minimum;
    const bool known = std::ranges::any_of(visited_, [&](const VisitedMinimum& place) {
      return std::abs(place.gain - gain) < same * gain &&
             std::abs(place.cost - solved.cost) < same * solved.cost &&
             (place.u - solved.u).lpNorm<Eigen::Infinity>() < same;
    });
    if (!known) visited_.push_back({gain, solved.cost, solved.u});
    return known;
  }

  struct VisitedMinimum {
    double gain = 0.0, cost = 0.0;
    Eigen::VectorXd u;
  };

  const DescentOptions options_;
  const Job& job_;
  Job coarse_;  ///< of the stages before the last
  const ParameterSpace& space_;
  const std::function<void(const Stage&)>& progress_;
  const RunContext& context_;
  std::vector<VisitedMinimum> visited_;  ///< minima met, of all descents
  std::vector<Stage> stages_;
  int iterations_ = 0;
};

/// The best end of the descents so far.
struct BestEnd {
  SolveResult solved;
  std::optional<double> tracking_cost;  ///< where it leads when it tracks again, if that is known

  bool is_below(double reduced_cost) const {
    return solved.usable && solved.reduced_cost < reduced_cost;
  }
};

/// What some perturbations of a start led to, while tracking.
struct Perturbed {
  std::optional<Eigen::VectorXd> promising{};  ///< the best of those that may end better
  int confirmations = 0;                       ///< how many lead where the best end does
};

/// Descents from the initial values `start` and from elsewhere, by one strategy after the other
/// while the best end does not explain the data. `gain`: where they begin.
class Starts {
 public:
  Starts(Descent& descent, const ParameterSpace& space, const Eigen::VectorXd& start, double gain)
      : descent_(descent), space_(space), start_(start), gain_(gain) {}

  SolveResult best_end(int attempts) {
    if (attempts < 2) return descent_.run(start_, gain_);
    BestEnd best = descend_again({descent_.run(tracking_start(), gain_), std::nullopt});
    if (attempts < 3 || best.is_below(options_.explained)) return best.solved;
    best = descend_again(
        better_of(std::move(best), descent_.run(tracking_low(), gain_ / options_.lower_gain)));
    return descend_from_perturbed(std::move(best), attempts).solved;
  }

 private:
  bool is_followed(const SolveResult& tracking) const {
    return tracking.usable && tracking.reduced_cost < options_.followed;
  }

  /// From the start, at the lower gain.
  const SolveResult& tracking_low() {
    if (!low_) low_ = descent_.solve_tracking(start_, gain_ / options_.lower_gain);
    return *low_;
  }

  /// Where the first descent begins: while tracking from the start, or where that ends in a wrong
  /// valley, from elsewhere.
  SolveResult tracking_start() {
    SolveResult best = descent_.solve_tracking(start_, gain_);
    if (is_followed(best)) return best;
    if (const SolveResult& low = tracking_low(); low.usable)
      if (SolveResult high = descent_.solve_tracking(low.u, gain_);
          high.usable && !(best.usable && best.cost <= high.cost))
        best = std::move(high);
    if (is_followed(best)) return best;
    const BestEnd here{best, best.usable ? std::optional(best.cost) : std::nullopt};
    if (const Perturbed found = perturb(here, 0, 0); found.promising)
      return descent_.solve_tracking(*found.promising, gain_);
    return best;
  }

  BestEnd descend(BestEnd best, const Eigen::VectorXd& from, double gain) const {
    return better_of(std::move(best), descent_.run(from, gain));
  }

  /// From the best end: one that tracks again often leaves a wrong valley for the right one. Once,
  /// and not where the end is near the noise.
  BestEnd descend_again(BestEnd best) const {
    if (!best.solved.usable || best.is_below(options_.near) || best.tracking_cost) return best;
    SolveResult tracking = descent_.solve_tracking(best.solved.u, gain_);
    best.tracking_cost = tracking.cost;
    return better_of(std::move(best), descent_.run(std::move(tracking), gain_));
  }

  /// From elsewhere: even while tracking, a controller that saturates has local minima.
  BestEnd descend_from_perturbed(BestEnd best, int attempts) const {
    int confirmations = 0;
    for (int attempt = 2; attempt < attempts && !best.is_below(options_.near); ++attempt) {
      if (best.solved.usable && !best.tracking_cost)
        best.tracking_cost = descent_.solve_tracking(best.solved.u, gain_).cost;
      const Perturbed found = perturb(best, attempt, confirmations);
      confirmations = found.confirmations;
      if (found.promising)
        best = descend_again(descend(std::move(best), *found.promising, gain_));
      else if (confirmations >= options_.confirmations)
        break;
    }
    return best;
  }

  /// Those of one attempt, after so many confirmations in earlier ones.
  Perturbed perturb(const BestEnd& best, int attempt, int confirmations) const {
    const double cost = best.tracking_cost.value_or(std::numeric_limits<double>::infinity());
    double least = options_.promising * cost;
    Perturbed found{.confirmations = confirmations};
    const auto most = [&] {
      return found.promising || best.solved.usable ? options_.perturbations
                                                   : options_.first_perturbations;
    };
    for (int i = 0; i < most(); ++i) {
      const int number = attempt * options_.first_perturbations + i;
      const SolveResult tracking =
          descent_.solve_tracking(perturbed(space_, start_, options_.perturbation, number), gain_);
      if (tracking.usable && std::abs(tracking.cost - cost) < options_.confirming * cost)
        ++found.confirmations;
      if (!found.promising && found.confirmations >= options_.confirmations) break;
      if (!tracking.usable || tracking.cost >= least) continue;
      least = tracking.cost;
      found.promising = tracking.u;
      if (is_followed(tracking)) break;
    }
    return found;
  }

  BestEnd better_of(BestEnd best, SolveResult end) const {
    if (best.solved.usable && !(end.usable && end.cost < best.solved.cost)) return best;
    const bool is_same = best.solved.usable && end.cost > options_.same_end * best.solved.cost;
    best.solved = std::move(end);
    if (!is_same) best.tracking_cost.reset();
    return best;
  }

  const StartOptions options_;
  Descent& descent_;
  const ParameterSpace& space_;
  const Eigen::VectorXd& start_;
  const double gain_;
  std::optional<SolveResult> low_{};  ///< of tracking_low()
};

}  // namespace

ContinuationResult run_continuation(const Job& job, const ParameterSpace& space,
                                    const Eigen::VectorXd& start,
                                    const std::function<void(const Stage&)>& progress,
                                    const RunContext& context) {
  Descent descent(job, space, progress, context);
  ContinuationResult result;
  if (job.options.is_continued() && can_track(job)) {
    Starts starts(descent, space, start, highest_gain(job));
    result.last = starts.best_end(job.options.attempts);
  } else {
    result.last = descent.solve_stage(start, final_gain(job), true);
    descent.report();
  }
  result.last.iterations = descent.iterations();
  result.stages = descent.stages();
  return result;
}

}  // namespace axisfit
