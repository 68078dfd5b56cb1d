#include "fit/solve/least_squares.h"

#include <ceres/evaluation_callback.h>
#include <ceres/iteration_callback.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <glog/logging.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "base/linear_algebra.h"
#include "base/parallel.h"

namespace axisfit {
namespace {

/// (value - mean) / sigma for a parameter with a prior.
class PriorCost : public ceres::CostFunction {
 public:
  PriorCost(const ParameterSpace& space, std::size_t parameter)
      : space_(space), parameter_(parameter) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(space.size()));
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const Prior& prior = *space_[parameter_].prior;
    const double u = parameters[0][parameter_];
    residuals[0] = (space_.value(parameter_, u) - prior.mean) / prior.sigma;
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      std::fill_n(jacobians[0], space_.size(), 0.0);
      jacobians[0][parameter_] = space_.slope(parameter_, u) / prior.sigma;
    }
    return true;
  }

 private:
  const ParameterSpace& space_;
  std::size_t parameter_;
};

/// u - start
class StartPenalty : public ceres::CostFunction {
 public:
  explicit StartPenalty(Eigen::VectorXd start) : start_(std::move(start)) {
    set_num_residuals(static_cast<int>(start_.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(start_.size()));
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const Eigen::Index n = start_.size();
    Eigen::Map<Eigen::VectorXd>(residuals, n) =
        Eigen::Map<const Eigen::VectorXd>(parameters[0], n) - start_;
    if (jacobians != nullptr && jacobians[0] != nullptr)
      Eigen::Map<Eigen::MatrixXd>(jacobians[0], n, n).setIdentity();
    return true;
  }

 private:
  Eigen::VectorXd start_;
};

/// Keeps what another cost gave at the two latest points. A solver with bounds asks for the
/// Jacobian at a point that it tries, then for the residuals there, and if it takes it for the
/// Jacobian once more; the last point that it tries is not the one at which it ends.
class CachedCost : public ceres::CostFunction {
 public:
  explicit CachedCost(std::unique_ptr<ceres::CostFunction> cost)
      : cost_(std::move(cost)),
        size_(static_cast<std::size_t>(cost_->parameter_block_sizes().front())) {
    set_num_residuals(cost_->num_residuals());
    *mutable_parameter_block_sizes() = cost_->parameter_block_sizes();
  }

  void compute(const double* u, bool with_jacobian) const {
    if (!latest_.is_at(u)) std::swap(latest_, other_);
    if (latest_.is_at(u) && (latest_.has_jacobian || !with_jacobian)) return;
    latest_.u.assign(u, u + size_);
    latest_.has_jacobian = with_jacobian;
    latest_.finished = false;  // also where it throws
    latest_.residuals.resize(static_cast<std::size_t>(num_residuals()));
    if (with_jacobian) latest_.jacobian.resize(latest_.residuals.size() * size_);
    double* jacobian = latest_.jacobian.data();
    latest_.finished =
        cost_->Evaluate(&u, latest_.residuals.data(), with_jacobian ? &jacobian : nullptr);
  }

  /// Whether the Jacobian there need not be computed.
  bool knows_jacobian(const double* u) const {
    const auto knows = [u](const Point& p) { return p.is_at(u) && p.has_jacobian; };
    return knows(latest_) || knows(other_);
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const bool with_jacobian = jacobians != nullptr && jacobians[0] != nullptr;
    compute(parameters[0], with_jacobian);
    if (!latest_.finished) return false;
    std::ranges::copy(latest_.residuals, residuals);
    if (with_jacobian) std::ranges::copy(latest_.jacobian, jacobians[0]);
    return true;
  }

 private:
  struct Point {
    std::vector<double> u, residuals, jacobian;
    bool has_jacobian = false, finished = false;

    bool is_at(const double* point) const {
      return std::equal(u.begin(), u.end(), point) && !u.empty();
    }
  };

  std::unique_ptr<ceres::CostFunction> cost_;
  std::size_t size_;  ///< of u
  mutable Point latest_, other_;
};

/// Computes costs side by side, at a point where a solver is about to ask for one after the other.
class ParallelEvaluation : public ceres::EvaluationCallback {
 public:
  explicit ParallelEvaluation(const double* u) : u_(u) {}
  void add(const CachedCost* cost) { costs_.push_back(cost); }
  const std::vector<const CachedCost*>& costs() const { return costs_; }
  void PrepareForEvaluation(bool with_jacobian, bool) override {
    parallel_for(costs_.size(), [&](std::size_t i) { costs_[i]->compute(u_, with_jacobian); });
  }

 private:
  const double* u_;
  std::vector<const CachedCost*> costs_;
};

Costs priors_of(const ParameterSpace& space) {
  Costs costs;
  for (std::size_t i = 0; i < space.size(); ++i)
    if (space[i].prior) costs.push_back(std::make_unique<PriorCost>(space, i));
  return costs;
}

using CostPointers = std::vector<const ceres::CostFunction*>;

CostPointers pointers_to(const Costs& costs) {
  CostPointers list;
  for (const auto& cost : costs) list.push_back(cost.get());
  return list;
}

/// The costs and then the priors at u, all rows of one series; with their Jacobian or without.
Linearization evaluated(const ParameterSpace& space, CostPointers costs, const Eigen::VectorXd& u,
                        bool with_jacobian) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Linearization result;
  SeriesRows& all = result.series.emplace_back();
  for (const auto* cost : costs) all.count += cost->num_residuals();
  const Costs priors = priors_of(space);
  std::ranges::copy(pointers_to(priors), std::back_inserter(costs));
  std::vector<Eigen::Index> first{0};
  for (const auto* cost : costs) first.push_back(first.back() + cost->num_residuals());
  result.residuals.resize(first.back());
  if (with_jacobian) result.jacobian.resize(first.back(), u.size());
  std::atomic<bool> finite = true;
  parallel_for(costs.size(), [&](std::size_t i) {
    const Eigen::Index row = first[i], n = costs[i]->num_residuals();
    RowMajor block(with_jacobian ? n : 0, u.size());
    const double* parameters = u.data();
    double* jacobian = block.data();
    if (!costs[i]->Evaluate(&parameters, result.residuals.data() + row,
                            with_jacobian ? &jacobian : nullptr))
      finite = false;
    if (with_jacobian) result.jacobian.middleRows(row, n) = block;
  });
  result.finite = finite;
  return result;
}

/// The point of a solution between its bounds. Knows which parameters are at one, and which of
/// these are fixed there.
class BoundConstraints {
 public:
  BoundConstraints(const ParameterSpace& space, const std::vector<std::size_t>& fixed, double* u,
                   ceres::Problem& problem)
      : u_(u), problem_(problem), fixed_(space.size(), false) {
    for (const std::size_t i : fixed) fixed_[i] = true;
    for (std::size_t i = 0; i < space.size(); ++i) {
      lower_.push_back(space.internal(i, space[i].lower));
      upper_.push_back(space.internal(i, space[i].upper));
      u[i] = std::clamp(u[i], lower_[i], upper_[i]);  // exp and log may round off a bound
      problem.SetParameterLowerBound(u, static_cast<int>(i), lower_[i]);
      problem.SetParameterUpperBound(u, static_cast<int>(i), upper_[i]);
    }
    pinned_ = fixed_;
    changes_.assign(space.size(), 0);
  }

  bool at_bound(std::size_t i) const {
    return !fixed_[i] && (u_[i] <= lower_[i] || u_[i] >= upper_[i]);
  }
  bool any_at_bound() const {
    for (std::size_t i = 0; i < pinned_.size(); ++i)
      if (at_bound(i)) return true;
    return false;
  }

  /// Fixes or frees parameters as the gradient says; returns whether anything changed.
  bool review() {
    problem_.SetManifold(u_, nullptr);
    std::vector<double> gradient;
    if (!problem_.Evaluate({}, nullptr, nullptr, &gradient, nullptr)) return false;
    bool changed = false;
    for (std::size_t i = 0; i < pinned_.size(); ++i) {
      if (fixed_[i]) continue;
      const bool outwards = u_[i] <= lower_[i] ? gradient[i] > 0.0 : gradient[i] < 0.0;
      const bool hold = at_bound(i) && outwards;
      constexpr int kChanges = 4;  // fixed and freed twice
      if (hold == pinned_[i] || ++changes_[i] > kChanges) continue;
      pinned_[i] = hold;
      changed = true;
    }
    return changed;
  }

  /// Fixes all that are pushed against their bounds, however often they came and went; returns
  /// whether there are any that were free.
  bool fix_at_bounds() {
    changes_.assign(changes_.size(), 0);
    return review();
  }

  /// Makes the fixed ones constant; false when nothing is left to vary.
  bool apply() {
    std::vector<int> constant;
    for (std::size_t i = 0; i < pinned_.size(); ++i)
      if (pinned_[i]) constant.push_back(static_cast<int>(i));
    if (constant.size() == pinned_.size()) return false;
    problem_.SetManifold(u_, constant.empty() ? nullptr
                                              : new ceres::SubsetManifold(
                                                    static_cast<int>(pinned_.size()), constant));
    return true;
  }

 private:
  double* u_;
  ceres::Problem& problem_;
  std::vector<bool> fixed_, pinned_;
  std::vector<double> lower_, upper_;
  std::vector<int> changes_;
};

/// Whether the iterations that are left lead to a cost, at the pace of the last ones.
class Pace {
 public:
  Pace(double cost, int iterations) : cost_(cost), left_(iterations) {}

  /// Enters an iteration, counted from the start of the solution.
  void enter(const ceres::IterationSummary& summary) {
    --left_;
    falls_[static_cast<std::size_t>(summary.iteration) % falls_.size()] =
        summary.step_is_successful ? std::max(0.0, summary.cost_change) : 0.0;
    if (summary.step_is_successful || summary.iteration == 0) now_ = summary.cost;
    is_known_ = summary.iteration >= static_cast<int>(falls_.size());
  }
  bool is_too_slow() const {
    return is_known_ && now_ - std::max(0, left_) * std::ranges::max(falls_) > cost_;
  }

 private:
  double cost_, now_ = 0.0;
  int left_;
  std::array<double, 4> falls_{};  ///< of the cost, in the latest iterations
  bool is_known_ = false;
};

/// Whether what the linearised costs promise leads to a cost.
class Promise {
 public:
  /// `linearized` gives the costs at the present point with their Jacobian, if that is known.
  Promise(double cost, std::function<std::optional<Linearization>()> linearized)
      : cost_(cost), linearized_(std::move(linearized)) {}

  void enter(const ceres::IterationSummary& summary) {
    // A first step has to show first what a promise is worth.
    if (!std::isfinite(cost_) || summary.iteration == 0 || !summary.step_is_successful) return;
    std::optional<Linearization> at = linearized_();
    if (!at) return;
    Eigen::MatrixXd& columns = at->jacobian;
    for (auto column : columns.colwise())
      if (const double length = column.norm(); length > 0.0) column /= length;
    const Eigen::VectorXd shown = columns * LeastSquaresSolver(columns).solve(at->residuals);
    is_too_little_ = summary.cost - kTimes * 0.5 * shown.squaredNorm() > cost_;
  }
  bool is_too_little() const { return is_too_little_; }

 private:
  static constexpr double kTimes = 5.0;  ///< what is curved may hold more than was promised
  double cost_;
  std::function<std::optional<Linearization>()> linearized_;
  bool is_too_little_ = false;
};

/// Whether a solution stands before a jump of its cost that bars little. Of a simulation a reading
/// jumps where an event passes its instant, an acceleration at an impact above all. Then the search
/// along each step ends just before the jump, and gains next to nothing of what the step promised.
class Stall {
 public:
  Stall(bool jumps, int residuals) : jumps_(jumps), residuals_(residuals) {}

  void enter(const ceres::IterationSummary& summary) {
    if (!jumps_ || summary.iteration == 0) return;
    const double mean_square = 2.0 * summary.cost / residuals_;
    const bool is_in_vain = summary.step_is_successful && summary.relative_decrease < kPart &&
                            summary.trust_region_radius > kWholeStep &&
                            summary.cost_change < summary.relative_decrease * kLittle * mean_square;
    in_vain_ = is_in_vain ? in_vain_ + 1 : 0;
  }
  bool is_stalled() const { return in_vain_ >= kSteps; }

 private:
  static constexpr double kPart = 0.1;  ///< of what a step promised
  /// Mean squares of the residuals: the minimum that a step promises is within two thirds of a
  /// standard error.
  static constexpr double kLittle = 0.2;
  static constexpr double kWholeStep = 10.0;  ///< radius that does not shorten one
  static constexpr int kSteps = 2;
  bool jumps_;
  int residuals_;
  int in_vain_ = 0;
};

/// Ends a solution as soon as a step arrives at a bound at which it did not begin, it stalls, is
/// too slow or promises too little to be of use, or it is to stop.
class EarlyTermination : public ceres::IterationCallback {
 public:
  EarlyTermination(const BoundConstraints& point, std::size_t size, Pace pace, Promise promise,
                   Stall stall, const StopFlag* stop)
      : point_(point), pace_(pace), promise_(std::move(promise)), stall_(stall), stop_(stop) {
    for (std::size_t i = 0; i < size; ++i) began_there_.push_back(point.at_bound(i));
  }

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (is_set(stop_)) return ceres::SOLVER_ABORT;
    pace_.enter(summary);
    promise_.enter(summary);
    stall_.enter(summary);
    if (is_of_no_use() || stall_.is_stalled()) return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    for (std::size_t i = 0; i < began_there_.size() && summary.step_is_successful; ++i)
      if (!began_there_[i] && point_.at_bound(i)) return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    return ceres::SOLVER_CONTINUE;
  }
  bool is_of_no_use() const { return pace_.is_too_slow() || promise_.is_too_little(); }
  bool has_stalled() const { return stall_.is_stalled(); }

 private:
  const BoundConstraints& point_;
  Pace pace_;
  Promise promise_;
  Stall stall_;
  const StopFlag* stop_;
  std::vector<bool> began_there_;
};

}  // namespace

SolveResult minimize(const ParameterSpace& space, Costs costs, const Eigen::VectorXd& start,
                     const SolveOptions& options) {
  // A rejected point is no event that a user should read of; the outcome is in the result.
  static const bool silent = (FLAGS_minloglevel = google::FATAL, true);
  (void)silent;
  SolveResult result;
  result.u = start;
  double* u = result.u.data();
  ParallelEvaluation parallel_evaluation(u);
  ceres::Problem::Options of_problem;
  of_problem.evaluation_callback = &parallel_evaluation;
  ceres::Problem problem(of_problem);
  for (auto& cost : costs) {
    auto* cached = new CachedCost(std::move(cost));  // the problem's
    problem.AddResidualBlock(cached, nullptr, u);
    parallel_evaluation.add(cached);
  }
  for (auto& cost : priors_of(space)) problem.AddResidualBlock(cost.release(), nullptr, u);
  if (options.penalize_distance_from_start)
    problem.AddResidualBlock(new StartPenalty(start), nullptr, u);
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.num_threads = 1;
  solver.function_tolerance = options.function_tolerance;
  solver.parameter_tolerance = options.parameter_tolerance;
  solver.update_state_every_iteration = true;
  solver.logging_type = ceres::SILENT;

  // The solver projects steps onto the bounds: one that leads beyond a bound moves the other
  // parameters as if it had got there, and at a bound it gets no further. So a parameter that is
  // pushed against its bound is fixed there while the others are fitted, and freed as soon as the
  // gradient points inwards.
  BoundConstraints point(space, options.fixed, u, problem);
  if (point.any_at_bound()) point.review();
  const auto& cached = parallel_evaluation.costs();
  const auto known_linearization = [&]() -> std::optional<Linearization> {
    const auto is_known = [u](const CachedCost* cost) { return cost->knows_jacobian(u); };
    if (!std::ranges::all_of(cached, is_known)) return std::nullopt;
    return evaluated(space, {cached.begin(), cached.end()}, result.u, true);
  };
  // One that comes and goes is left free, and may creep along its bound until the iterations are
  // spent. Then it is fixed there, and a few more find the rest.
  constexpr int kLastIterations = 10;
  for (bool is_last = false;;) {
    if (!point.apply()) {  // the point itself is the solution
      result.usable = result.converged =
          problem.Evaluate({}, &result.cost, nullptr, nullptr, nullptr);
      break;
    }
    solver.max_num_iterations =
        is_last ? kLastIterations : std::max(1, options.max_iterations - result.iterations);
    const double cost_to_reach = 0.5 * options.give_up_above * problem.NumResiduals();
    EarlyTermination end(point, space.size(), Pace(cost_to_reach, solver.max_num_iterations),
                         Promise(cost_to_reach, known_linearization),
                         Stall(options.jumps, problem.NumResiduals()), options.stop);
    solver.callbacks = {&end};
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    result.usable = summary.IsSolutionUsable();
    result.converged =
        summary.termination_type == ceres::CONVERGENCE || (result.usable && end.has_stalled());
    // The solver reports a negative cost where even the start could not be evaluated.
    result.cost = result.usable ? summary.final_cost : std::numeric_limits<double>::infinity();
    result.iterations += static_cast<int>(summary.iterations.size());
    result.message = summary.message;
    if (!result.usable || !point.any_at_bound() || is_last || end.is_of_no_use()) break;
    if (result.iterations > options.max_iterations) {
      if (result.converged || !point.fix_at_bounds()) break;
      is_last = true;
      continue;
    }
    const bool stopped = summary.termination_type == ceres::USER_SUCCESS && !end.has_stalled();
    if (!point.review() && !stopped) break;
  }
  result.reduced_cost = 2.0 * result.cost / problem.NumResiduals();
  if (result.usable)
    if (auto known = known_linearization())
      result.at_solution = std::make_shared<const Linearization>(*std::move(known));
  return result;
}

Linearization linearize(const ParameterSpace& space, const Costs& costs, const Eigen::VectorXd& u) {
  return evaluated(space, pointers_to(costs), u, true);
}

Eigen::VectorXd residuals_at(const ParameterSpace& space, const Costs& costs,
                             const Eigen::VectorXd& u) {
  Linearization at = evaluated(space, pointers_to(costs), u, false);
  return at.finite ? std::move(at.residuals) : Eigen::VectorXd();
}

}  // namespace axisfit
