#include "fit/selection/score.h"

#include <algorithm>
#include <cmath>

#include "base/linear_algebra.h"
#include "base/parallel.h"
#include "fit/estimation/continuation.h"
#include "fit/estimation/residual.h"
#include "fit/selection/periods.h"
#include "sim/sampling.h"

namespace axisfit {
namespace {

/// The job with its free parameters fixed at these values.
Job fixed_at(const Job& job, std::span<const double> values) {
  Job fixed = job;
  fixed.free.clear();
  const auto member = members(fixed.model);
  for (std::size_t i = 0; i < job.free.size(); ++i) {
    if (job.free[i].recording)
      fixed.recordings[*job.free[i].recording].overrides.emplace_back(job.free[i].quantity,
                                                                      values[i]);
    else
      *member[job.free[i].quantity] = values[i];
  }
  return fixed;
}

/// Orthonormal columns that span those of a matrix; a column of zeros where they span nothing, for
/// of a matrix without columns Eigen takes no blocks.
Eigen::MatrixXd basis_of(const Eigen::MatrixXd& a) {
  const Eigen::MatrixXd nothing = Eigen::MatrixXd::Zero(a.rows(), 1);
  if (a.cols() == 0) return nothing;
  Eigen::MatrixXd scaled = a;
  for (Eigen::Index k = 0; k < a.cols(); ++k)
    if (const double length = a.col(k).norm(); length > 0.0) scaled.col(k) /= length;
  const LeastSquaresSolver solver(scaled, 1e-9);
  return solver.rank() == 0 ? nothing : solver.basis();
}

SearchScales scales_of(const Job& job, const ParameterSpace& space, const Eigen::VectorXd& u,
                       double rate, const Linearization& base, const Eigen::MatrixXd& basis,
                       const StopFlag* stop) {
  SearchScales s{INFINITY, -INFINITY, 0.0, INFINITY, -INFINITY, INFINITY, -INFINITY};
  Eigen::Index row = 0;
  for (std::size_t r = 0; r < job.recordings.size(); ++r) {
    const Recording& recording = job.recordings[r];
    if (recording.role != Role::fit) continue;
    const Observer observer = observer_for(recording, rate);
    const SimulatedRecording simulation = simulate_recording(job, space, r, u.data(), observer);
    for (const Sample& sample : simulation.samples) {
      s.position_low = std::min(s.position_low, sample.position);
      s.position_high = std::max(s.position_high, sample.position);
      s.velocity_low = std::min(s.velocity_low, sample.velocity);
      s.velocity_high = std::max(s.velocity_high, sample.velocity);
    }
    s.start = std::min(s.start, recording.times.front());
    s.end = std::max(s.end, recording.times.back());
    s.interval = std::max(s.interval, mean_interval(recording.times));
    const Eigen::Index rows = RecordingCost(job, space, r, observer).num_residuals();
    constexpr std::size_t kPeriods = 3;
    for (const bool of_drive : {false, true}) {
      auto& periods = of_drive ? s.drive_periods : s.periods;
      for (const double period :
           periods_in(recording, simulation, observer, base.residuals.segment(row, rows),
                      basis.middleRows(row, rows), kPeriods, of_drive, stop))
        periods.push_back(period);
    }
    row += rows;
  }
  s.speed = std::max(std::abs(s.velocity_low), std::abs(s.velocity_high));
  return s;
}

}  // namespace

ScoreTest score_test(const Job& job, const std::vector<double>& values, double rate, bool curves,
                     const RunContext& context) {
  const ThreadPool pool(job.options.threads);
  ScoreTest test;
  const ParameterSpace space(job);
  SolveOptions options;
  options.max_iterations = 15;
  options.function_tolerance = 1e-6;
  const SolveResult tracking = solve(job, space, space.internal(values), rate, options, context);
  if (!tracking.usable) return test;
  const std::vector<double> tracking_values = space.values(tracking.u);
  const Linearization base = linearize(job, space, tracking.u, rate);
  if (!base.finite) return test;
  const Eigen::MatrixXd basis = basis_of(base.jacobian);
  const Eigen::VectorXd residual = base.residuals - basis * (basis.transpose() * base.residuals);
  test.sum_of_squares = residual.squaredNorm();
  test.mean_square = test.sum_of_squares / static_cast<double>(residual.size());
  test.usable = std::isfinite(test.sum_of_squares);  // squares may overflow
  if (!test.usable) return test;
  test.candidates =
      catalogue(job, scales_of(job, space, tracking.u, rate, base, basis, context.stop));
  std::erase_if(test.candidates, [&](const Candidate& c) { return c.is_curve != curves; });
  for (std::size_t c = 0; c < test.candidates.size(); ++c)
    for (const auto& setting : test.candidates[c].settings)
      test.scores.push_back({c, setting, {}, tracking_values, 0.0});

  const LeastSquaresSolver base_solver(base.jacobian);
  const Job fixed = fixed_at(job, tracking_values);
  parallel_for(test.scores.size(), [&](std::size_t i) {
    context.check_stop();
    Score& score = test.scores[i];
    const Candidate& candidate = test.candidates[score.candidate];
    score.strengths.assign(candidate.strengths.size(), 0.0);
    const std::vector<double>& neutral = candidate.neutral;
    Candidate shaped = candidate;
    shaped.shapes_are_free = false;
    const Job extended = with_candidate(fixed, shaped, {}, neutral, score.shapes);
    const ParameterSpace strengths(extended);
    const Eigen::VectorXd u = strengths.internal(neutral);
    const Linearization d = linearize(extended, strengths, u, rate);
    if (!d.finite || d.jacobian.rows() != basis.rows()) return;
    const auto consider = [&](const Eigen::MatrixXd& derivatives) {
      const Eigen::MatrixXd columns = derivatives - basis * (basis.transpose() * derivatives);
      // What is left of a column is rounding where the free parameters do the same.
      for (Eigen::Index k = 0; k < columns.cols(); ++k)
        if (columns.col(k).norm() < 1e-4 * derivatives.col(k).norm()) return;
      const Eigen::VectorXd step = LeastSquaresSolver(columns).solve(-residual);
      if (!step.allFinite()) return;
      const std::vector<double> reached = strengths.values(u + step);
      for (std::size_t k = 0; k < reached.size(); ++k) {
        const Quantity& q = quantity_list()[candidate.strengths[k]].quantity;
        if (reached.size() == 1 && (reached[k] < q.lower || reached[k] > q.upper)) return;
      }
      const double gain = test.sum_of_squares - (residual + columns * step).squaredNorm();
      if (!(gain > score.gain)) return;
      score.gain = gain;
      score.strengths = reached;
      // The free parameters adapt to the effect, no further than a linear step can be trusted.
      const Eigen::VectorXd way = base_solver.solve(-(base.residuals + derivatives * step));
      score.values = space.values(tracking.u + way.cwiseMax(-0.7).cwiseMin(0.7));
    };
    if (candidate.probes.empty()) consider(d.jacobian);
    for (const double probe : candidate.probes) {
      const Eigen::VectorXd there = strengths.internal(std::vector{probe});
      const Linearization probed = linearize(extended, strengths, there, rate);
      if (probed.finite) consider((probed.residuals - d.residuals) / (there[0] - u[0]));
    }
  });
  std::ranges::stable_sort(test.scores, std::greater{}, &Score::gain);
  return test;
}

std::vector<double> score_gains(const Job& job) {
  const double first = initial_observer_gain(job);
  if (job.options.observer == ObserverMode::fixed || !std::isfinite(first)) return {first};
  return {first / 30.0, first / 100.0};
}

}  // namespace axisfit
