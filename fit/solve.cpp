#include "fit/solve.h"

#include <ceres/iteration_callback.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <glog/logging.h>

#include <limits>
#include <memory>
#include <vector>

#include "fit/residual.h"

namespace axisfit {
namespace {

/// (value - mean) / sigma for every parameter with a prior.
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
class KeepCost : public ceres::CostFunction {
 public:
  explicit KeepCost(Eigen::VectorXd start) : start_(std::move(start)) {
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

std::vector<std::unique_ptr<ceres::CostFunction>> costs(const Job& job, const ParameterSpace& space,
                                                        double coupling_rate) {
  std::vector<std::unique_ptr<ceres::CostFunction>> list;
  for (std::size_t r = 0; r < job.recordings.size(); ++r)
    if (job.recordings[r].role == Role::fit)
      list.push_back(std::make_unique<RecordingCost>(
          job, space, r, coupling_for(job.recordings[r], coupling_rate)));
  for (std::size_t i = 0; i < space.size(); ++i)
    if (space[i].prior) list.push_back(std::make_unique<PriorCost>(space, i));
  return list;
}

/// Ends a solution as soon as a step arrives at a bound at which it did not begin.
class StopAtBound : public ceres::IterationCallback {
 public:
  StopAtBound(const double* u, std::vector<bool> watched, std::vector<double> lower,
              std::vector<double> upper)
      : u_(u), watched_(std::move(watched)), lower_(std::move(lower)), upper_(std::move(upper)) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    for (std::size_t i = 0; i < watched_.size() && summary.step_is_successful; ++i)
      if (watched_[i] && (u_[i] <= lower_[i] || u_[i] >= upper_[i]))
        return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    return ceres::SOLVER_CONTINUE;
  }

 private:
  const double* u_;
  std::vector<bool> watched_;
  std::vector<double> lower_, upper_;
};

}  // namespace

SolveResult solve(const Job& job, const ParameterSpace& space, const Eigen::VectorXd& start,
                  double coupling_rate, const SolveOptions& options) {
  // A rejected point is no event that a user should read of; the outcome is in the result.
  static const bool silent = (FLAGS_minloglevel = google::FATAL, true);
  (void)silent;
  SolveResult result;
  result.u = start;
  result.coupling_rate = coupling_rate;
  const std::size_t n = space.size();
  ceres::Problem problem;
  double* u = result.u.data();
  for (auto& cost : costs(job, space, coupling_rate))
    problem.AddResidualBlock(cost.release(), nullptr, u);
  if (options.keep_to_start) problem.AddResidualBlock(new KeepCost(start), nullptr, u);
  std::vector<double> lower, upper;
  for (std::size_t i = 0; i < n; ++i) {
    lower.push_back(space.internal(i, space[i].lower));
    upper.push_back(space.internal(i, space[i].upper));
    u[i] = std::clamp(u[i], lower[i], upper[i]);  // exp and log may round a start off its bound
    problem.SetParameterLowerBound(u, static_cast<int>(i), lower[i]);
    problem.SetParameterUpperBound(u, static_cast<int>(i), upper[i]);
  }
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.num_threads = 1;
  solver.function_tolerance = options.function_tolerance;
  solver.parameter_tolerance = options.parameter_tolerance;
  solver.update_state_every_iteration = true;
  solver.logging_type = ceres::SILENT;

  // The solver projects steps onto the bounds: one that leads beyond a bound moves the other
  // parameters as if it had got there, and at a bound it gets no further. So a parameter that is
  // pushed against its bound is held there while the others are fitted, and let go when it is not
  // pushed any more.
  const auto at_bound = [&](std::size_t i) { return u[i] <= lower[i] || u[i] >= upper[i]; };
  const auto any_at_bound = [&] {
    for (std::size_t i = 0; i < n; ++i)
      if (at_bound(i)) return true;
    return false;
  };
  std::vector<bool> held(n, false);
  std::vector<int> changes(n, 0);
  /// Holds or lets go what the gradient says; whether anything changed.
  const auto review = [&] {
    problem.SetManifold(u, nullptr);
    std::vector<double> gradient;
    if (!problem.Evaluate({}, nullptr, nullptr, &gradient, nullptr)) return false;
    bool changed = false;
    for (std::size_t i = 0; i < n; ++i) {
      const bool outwards = u[i] <= lower[i] ? gradient[i] > 0.0 : gradient[i] < 0.0;
      const bool hold = at_bound(i) && outwards;
      constexpr int kChanges = 4;  // held and let go twice
      if (hold == held[i] || ++changes[i] > kChanges) continue;
      held[i] = hold;
      changed = true;
    }
    return changed;
  };
  if (any_at_bound()) review();
  for (;;) {
    std::vector<int> constant;
    std::vector<bool> watched(n, false);
    for (std::size_t i = 0; i < n; ++i) {
      if (held[i]) constant.push_back(static_cast<int>(i));
      watched[i] = !at_bound(i);
    }
    if (constant.size() == n) {
      result.converged = true;
      break;
    }
    problem.SetManifold(
        u, constant.empty() ? nullptr : new ceres::SubsetManifold(static_cast<int>(n), constant));
    StopAtBound stop(u, std::move(watched), lower, upper);
    solver.callbacks = {&stop};
    solver.max_num_iterations = std::max(1, options.max_iterations - result.iterations);
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    result.usable = summary.IsSolutionUsable();
    result.converged = summary.termination_type == ceres::CONVERGENCE;
    // The solver reports a negative cost where even the start could not be evaluated.
    result.cost = result.usable ? summary.final_cost : std::numeric_limits<double>::infinity();
    result.iterations += static_cast<int>(summary.iterations.size());
    result.message = summary.message;
    if (!result.usable || !any_at_bound() || result.iterations > options.max_iterations) break;
    const bool stopped = summary.termination_type == ceres::USER_SUCCESS;
    if (!review() && !stopped) break;
  }
  result.reduced_cost = 2.0 * result.cost / problem.NumResiduals();
  return result;
}

Linearization linearize(const Job& job, const ParameterSpace& space, const Eigen::VectorXd& u,
                        double coupling_rate) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto list = costs(job, space, coupling_rate);
  Eigen::Index rows = 0;
  for (const auto& cost : list) rows += cost->num_residuals();
  Linearization result;
  result.residuals.resize(rows);
  result.jacobian.resize(rows, u.size());
  result.finite = true;
  Eigen::Index row = 0;
  for (const auto& cost : list) {
    const Eigen::Index n = cost->num_residuals();
    RowMajor block(n, u.size());
    const double* parameters = u.data();
    double* jacobian = block.data();
    result.finite =
        result.finite && cost->Evaluate(&parameters, result.residuals.data() + row, &jacobian);
    result.jacobian.middleRows(row, n) = block;
    row += n;
  }
  // As RecordingCost has them: recording by recording, measurement by measurement.
  row = 0;
  for (std::size_t r = 0; r < job.recordings.size(); ++r) {
    const Recording& recording = job.recordings[r];
    for (std::size_t m = 0; m < recording.measurements.size(); ++m) {
      Eigen::Index n = 0;
      for (std::size_t i = 0; i < recording.times.size(); ++i)
        n += recording.fits(recording.measurements[m], i) ? 1 : 0;
      if (n > 0) result.series.push_back({r, m, row, n});
      row += n;
    }
  }
  return result;
}

}  // namespace axisfit
