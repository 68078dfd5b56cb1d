#include "fit/estimate/profile.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/parallel.h"
#include "fit/solve/solve.h"

namespace axisfit {
namespace {

struct Side {
  std::vector<ProfilePoint> points;
  ProfileEnd end;
  std::optional<SolveResult> better;
};

/// Walks from the estimate to one side of one parameter.
class Walk {
 public:
  Walk(const Job& job, const FitResult& fit, std::size_t parameter, double direction,
       const RunContext& context)
      : context_(context),
        job_(job),
        space_(job),
        fit_(fit),
        parameter_(parameter),
        index_(static_cast<Eigen::Index>(parameter)),
        direction_(direction),
        u_(space_.internal(values_of(fit))),
        cost_(0.5 * fit.at_solution->residuals.squaredNorm()),
        wanted_(student_95(fit.degrees_of_freedom)) {
    const FreeParameter& p = space_[parameter];
    bound_ = space_.internal(parameter, direction > 0.0 ? p.upper : p.lower);
  }

  Side run() {
    // The root of the deviance is nearly linear in u: so are the steps that look for its threshold.
    double inside = u_[index_], inside_root = 0.0;
    double outside = bound_, outside_root = INFINITY;
    double next = inside + 0.5 * direction_ * first_step();
    constexpr int kSteps = 20;
    for (int step = 0; step < kSteps; ++step) {
      next = direction_ > 0.0 ? std::min(next, bound_) : std::max(next, bound_);
      const double root = root_at(next);
      constexpr double kClose = 1e-3;
      if (std::abs(root - wanted_) < kClose * wanted_) return ended(next, false);
      (root < wanted_ ? inside : outside) = next;
      (root < wanted_ ? inside_root : outside_root) = root;
      if (inside == bound_) return ended(bound_, true);
      const double reach = std::abs(inside - u_[index_]);
      if (std::isfinite(outside_root)) {
        const double share = (wanted_ - inside_root) / (outside_root - inside_root);
        next = inside + std::clamp(share, 0.05, 0.95) * (outside - inside);
      } else if (failed_) {  // the simulation does not get through out there
        if (std::abs(outside - inside) < 0.01 * reach) break;
        next = 0.5 * (inside + outside);
      } else {
        const double factor = inside_root > 0.0 ? wanted_ / inside_root : 3.0;
        next = u_[index_] +
               direction_ * (reach > 0.0 ? std::clamp(factor, 1.2, 3.0) * reach : first_step());
      }
    }
    return ended(inside, !std::isfinite(outside_root));
  }

 private:
  /// In u, to where the interval should end.
  double first_step() const {
    const ParameterUncertainty& known = fit_.parameters[parameter_].uncertainty;
    const double here = u_[index_];
    if (known.has_interval()) {
      const double end = space_.internal(parameter_, direction_ > 0.0 ? known.upper : known.lower);
      if (end != here) return std::abs(end - here);
    }
    constexpr double kNothingKnown = 0.5;
    return std::min(kNothingKnown, std::abs(bound_ - here));
  }

  /// The root of the deviance with the parameter at u; infinite where the simulation fails.
  double root_at(double u) {
    SolveOptions options;
    options.max_iterations = job_.options.max_iterations;
    options.function_tolerance = job_.options.tolerance;
    options.fixed = {parameter_};
    Eigen::VectorXd start = latest_.value_or(u_);
    start[index_] = u;
    const SolveResult solved = solve(job_, space_, start, fit_.observer_gain, options, context_);
    if (!solved.usable) {
      failed_ = true;
      return INFINITY;
    }
    const double inflation = fit_.parameters[parameter_].uncertainty.inflation;
    const double deviance = 2.0 * (solved.cost - cost_) / (inflation * inflation);
    constexpr double kBetter = 0.1;
    if (deviance < -kBetter && (!side_.better || solved.cost < side_.better->cost))
      side_.better = solved;
    side_.points.push_back({space_.value(parameter_, u), std::max(0.0, deviance)});
    const double root = std::sqrt(side_.points.back().deviance);
    if (root < wanted_) latest_ = solved.u;
    return root;
  }

  Side ended(double u, bool open) {
    side_.end = {space_.value(parameter_, u), open};
    return std::move(side_);
  }

  const RunContext& context_;
  const Job& job_;
  const ParameterSpace space_;
  const FitResult& fit_;
  const std::size_t parameter_;
  const Eigen::Index index_;
  const double direction_;
  const Eigen::VectorXd u_;
  const double cost_, wanted_;
  double bound_ = 0.0;
  bool failed_ = false;
  std::optional<Eigen::VectorXd> latest_;  // solution nearest to the threshold, inside of it
  Side side_;
};

}  // namespace

std::vector<Profile> profiles(const Job& job, const FitResult& fit,
                              std::span<const std::size_t> parameters, const RunContext& context) {
  const ThreadPool pool(job.options.threads);
  std::vector<Side> sides(2 * parameters.size());
  std::mutex mutex;
  int done = 0;
  parallel_for(sides.size(), [&](std::size_t i) {
    sides[i] = Walk(job, fit, parameters[i / 2], i % 2 == 0 ? -1.0 : 1.0, context).run();
    const std::lock_guard lock(mutex);
    context.report({.phase = "profiles",
                    .done = ++done,
                    .of = static_cast<int>(sides.size()),
                    .best = fit.reduced_chi_square,
                    .work = Work::errors});
  });
  const ParameterSpace space(job);
  std::vector<Profile> list;
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    Side &below = sides[2 * k], &above = sides[2 * k + 1];
    Profile& profile = list.emplace_back();
    profile.parameter = parameters[k];
    profile.threshold = std::pow(student_95(fit.degrees_of_freedom), 2);
    profile.lower = below.end;
    profile.upper = above.end;
    profile.points = std::move(below.points);
    profile.points.push_back({fit.parameters[parameters[k]].value, 0.0});
    profile.points.insert(profile.points.end(), above.points.begin(), above.points.end());
    std::ranges::sort(profile.points, {}, &ProfilePoint::value);
    for (const Side* side : {&below, &above})
      if (side->better &&
          (!profile.better || side->better->reduced_cost < profile.better->reduced_cost))
        profile.better = StartResult{values_of(fit), space.values(side->better->u), true,
                                     side->better->reduced_cost};
  }
  return list;
}

}  // namespace axisfit
