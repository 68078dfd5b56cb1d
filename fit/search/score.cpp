#include "fit/search/score.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/linear_algebra.h"
#include "base/parallel.h"
#include "fit/criterion/gains.h"
#include "fit/estimate/recipes.h"
#include "fit/search/effect_columns.h"
#include "fit/search/periods.h"
#include "fit/solve/residual.h"
#include "sim/sampling.h"

namespace axisfit {
namespace {

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
  const Model<double> model = model_at(job, space, u.data(), 0);
  s.mass = Equations<double>(model).moving_mass();
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

/// What one step of least squares makes of a candidate's columns.
class Scorer {
 public:
  Scorer(const Job& job, const ParameterSpace& space, const Eigen::VectorXd& u,
         const Linearization& base, const Eigen::MatrixXd& basis, const Eigen::VectorXd& residual)
      : job_(job),
        space_(space),
        u_(u),
        base_(base),
        basis_(basis),
        residual_(residual),
        solver_(base.jacobian) {}

  /// Enters strengths, values and gain where that is more than the score has.
  void consider(const EffectSetting& setting, const Eigen::MatrixXd& rows, Score& score) const {
    const Eigen::MatrixXd derivatives = with_priors(rows);
    const Eigen::MatrixXd columns = projected(derivatives);
    if (columns.size() == 0) return;
    const Eigen::VectorXd step = LeastSquaresSolver(columns).solve(-residual_);
    if (!step.allFinite()) return;
    std::vector<double> reached;
    for (std::size_t k = 0; k < setting.strengths.size(); ++k) {
      const Quantity& q = job_.entry(setting.candidate->strengths[k]).quantity;
      reached.push_back(
          moved(*setting.candidate, setting.strengths[k], step[static_cast<Eigen::Index>(k)]));
      if (setting.strengths.size() == 1 && (reached[k] < q.lower || reached[k] > q.upper)) return;
    }
    Eigen::VectorXd change = columns * step;
    const double gain = residual_.squaredNorm() - (residual_ + change).squaredNorm();
    if (!(gain > score.gain)) return;
    score.gain = gain;
    score.change = std::move(change);
    score.shapes = setting.shapes;
    score.strengths = reached;
    // The free parameters adapt to the effect, no further than a linear step can be trusted.
    Eigen::VectorXd way = solver_.solve(-(base_.residuals + derivatives * step));
    for (std::size_t i = 0; i < space_.size(); ++i) {
      double& by = way[static_cast<Eigen::Index>(i)];
      if (space_[i].logarithmic) by = std::clamp(by, -0.7, 0.7);
    }
    score.values = space_.values(u_ + way);
  }

  /// The step of the shapes, from a score and the derivatives with respect to strengths and shapes
  /// there; none where they say nothing.
  std::optional<Eigen::VectorXd> step_of_shapes(const EffectSetting& setting,
                                                const Eigen::MatrixXd& rows) const {
    const Eigen::MatrixXd columns = projected(with_priors(rows));
    if (columns.size() == 0) return std::nullopt;
    const auto strengths = static_cast<Eigen::Index>(setting.strengths.size());
    Eigen::VectorXd way(strengths);
    for (Eigen::Index k = 0; k < strengths; ++k)
      way[k] = setting.strengths[static_cast<std::size_t>(k)] -
               setting.candidate->neutral[static_cast<std::size_t>(k)];
    const Eigen::VectorXd there = residual_ + columns.leftCols(strengths) * way;
    const Eigen::VectorXd step = LeastSquaresSolver(columns).solve(-there);
    if (!step.allFinite()) return std::nullopt;
    return step.tail(step.size() - strengths);
  }

 private:
  static double moved(const Candidate& candidate, double value, double step) {
    if (std::isinf(value)) return 1.0 / step;
    return candidate.is_constant && value > 0.0 ? value * std::exp(step) : value + step;
  }

  /// Candidates have no part in what is known of the free parameters.
  Eigen::MatrixXd with_priors(const Eigen::MatrixXd& rows) const {
    if (rows.cols() == 0) return {};
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(residual_.size(), rows.cols());
    all.topRows(rows.rows()) = rows;
    return all;
  }

  /// Without what the free parameters do; empty where nothing is left of a column but rounding.
  Eigen::MatrixXd projected(const Eigen::MatrixXd& derivatives) const {
    Eigen::MatrixXd columns = derivatives - basis_ * (basis_.transpose() * derivatives);
    for (Eigen::Index k = 0; k < columns.cols(); ++k)
      if (!(columns.col(k).norm() >= 1e-4 * derivatives.col(k).norm())) return {};
    return columns;
  }

  const Job& job_;
  const ParameterSpace& space_;
  const Eigen::VectorXd& u_;
  const Linearization& base_;
  const Eigen::MatrixXd& basis_;
  const Eigen::VectorXd& residual_;
  const LeastSquaresSolver solver_;
};

/// The mean derivatives up to each of a candidate's probes, from the residuals without it.
std::vector<std::pair<double, Eigen::MatrixXd>> probed(const Job& fixed, const Candidate& candidate,
                                                       const std::vector<double>& shapes,
                                                       double rate,
                                                       const Eigen::VectorXd& without) {
  std::vector<std::pair<double, Eigen::MatrixXd>> list;
  Candidate shaped = candidate;
  shaped.shapes_are_free = false;
  for (const double probe : candidate.probes) {
    const std::vector<double> strength{probe};
    const Job extended = with_candidate(fixed, shaped, {}, strength, shapes);
    const ParameterSpace space(extended);
    const Eigen::VectorXd there = residuals_at(extended, space, space.internal(strength), rate);
    if (there.size() == 0 || there.size() > without.size()) continue;
    list.emplace_back(probe, (there - without.head(there.size())) /
                                 distance_from_neutral(probe, candidate.neutral[0]));
  }
  return list;
}

/// Each setting of another transmission takes simulations of its own: those in the middle are tried
/// first, where there are many.
bool is_tried_first(const Candidate& candidate, std::size_t setting) {
  const std::size_t all = candidate.settings.size();
  return !candidate.gives_backlash || all < 9 || (3 * setting >= all && 3 * setting < 2 * all);
}

/// Whether a candidate's settings that were tried are worth trying the others, too: with a part of
/// what the best of all candidates gains.
bool gains_part_of(double best, std::size_t candidate, const std::vector<Score*>& tried) {
  constexpr double kPart = 0.1;
  return std::ranges::any_of(tried, [&](const Score* score) {
    return score->candidate == candidate && score->gain >= kPart * best;
  });
}

/// Of one shape, the least and the most that is tried.
std::pair<double, double> range_of_settings(const Candidate& candidate, std::size_t shape) {
  double least = INFINITY, most = -INFINITY;
  for (const auto& setting : candidate.settings) {
    least = std::min(least, setting[shape]);
    most = std::max(most, setting[shape]);
  }
  // A period is not on a grid, but where the spectrum has a peak.
  constexpr double kBeyond = 0.05;
  const double beyond = kBeyond * std::max(std::abs(least), std::abs(most));
  return {least - beyond, most + beyond};
}

/// The shapes of the candidates that gain most go on from the settings tried to where they gain
/// most, by steps of Gauss and Newton.
void refine_shapes(const Job& fixed, const EffectColumns& columns, const Scorer& scorer,
                   ScoreTest& test) {
  constexpr std::size_t kRefined = 8;
  constexpr int kSteps = 2;
  std::vector<std::size_t> order(test.scores.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, std::greater{},
                           [&](std::size_t i) { return test.scores[i].gain; });
  std::vector<std::size_t> chosen;
  for (const std::size_t i : order) {
    const Candidate& candidate = test.candidates[test.scores[i].candidate];
    if (candidate.shapes.empty() || !candidate.shapes_are_free || !candidate.probes.empty() ||
        !(test.scores[i].gain > 0.0))
      continue;
    const bool known = std::ranges::any_of(chosen, [&](std::size_t other) {
      return test.scores[other].candidate == test.scores[i].candidate;
    });
    if (!known && chosen.size() < kRefined) chosen.push_back(i);
  }
  for (int step = 0; step < kSteps; ++step) {
    std::vector<EffectSetting> here;
    for (const std::size_t i : chosen) {
      const Score& score = test.scores[i];
      here.push_back({&test.candidates[score.candidate], score.strengths, score.shapes, true});
    }
    const std::vector<Eigen::MatrixXd> slopes = columns.derivatives(here);
    std::vector<EffectSetting> next;
    std::vector<std::size_t> of_next;
    for (std::size_t c = 0; c < chosen.size(); ++c) {
      const auto way = scorer.step_of_shapes(here[c], slopes[c]);
      if (!way) continue;
      EffectSetting moved{here[c].candidate, here[c].candidate->neutral, here[c].shapes};
      const Job ranges = with_candidate(fixed, *moved.candidate, {}, moved.strengths, moved.shapes);
      const std::size_t first = ranges.free.size() - moved.shapes.size();
      for (std::size_t k = 0; k < moved.shapes.size(); ++k) {
        const FreeParameter& p = ranges.free[first + k];
        const double most = p.logarithmic ? 0.7 : 0.1 * (p.upper - p.lower);
        const double by = std::clamp((*way)[static_cast<Eigen::Index>(k)], -most, most);
        const double value = p.logarithmic ? moved.shapes[k] * std::exp(by) : moved.shapes[k] + by;
        const auto [least, most_tried] = range_of_settings(*moved.candidate, k);
        moved.shapes[k] =
            std::clamp(value, std::max(p.lower, least), std::min(p.upper, most_tried));
      }
      next.push_back(std::move(moved));
      of_next.push_back(chosen[c]);
    }
    const std::vector<Eigen::MatrixXd> there = columns.derivatives(next);
    for (std::size_t c = 0; c < next.size(); ++c)
      scorer.consider(next[c], there[c], test.scores[of_next[c]]);
  }
}

/// The fit at an observer gain that a score test starts from. Not usable: nothing finite.
SolveResult tracking_fit(const Job& job, const ParameterSpace& space,
                         const std::vector<double>& values, double rate,
                         const RunContext& context) {
  SolveOptions options;
  options.max_iterations = 15;
  options.function_tolerance = 1e-6;
  return solve(job, space, space.internal(values), rate, options, context);
}

Job with_coarse_steps(Job job) {
  job.options = recipe::coarse(job.options);
  return job;
}

ScoreTest scored(const Job& job, const std::vector<double>& values, double rate, bool curves,
                 const RunContext& context) {
  ScoreTest test;
  const ParameterSpace space(job);
  const SolveResult tracking = tracking_fit(job, space, values, rate, context);
  if (!tracking.usable) return test;
  const std::vector<double> tracking_values = space.values(tracking.u);
  const Linearization base = linearize(job, space, tracking, rate);
  if (!base.finite) return test;
  const Eigen::MatrixXd basis = basis_of(base.jacobian);
  test.residuals = base.residuals - basis * (basis.transpose() * base.residuals);
  test.series = base.series;
  test.sum_of_squares = test.residuals.squaredNorm();
  test.mean_square = test.sum_of_squares / static_cast<double>(test.residuals.size());
  test.usable = std::isfinite(test.sum_of_squares);  // squares may overflow
  if (!test.usable) return test;
  test.candidates =
      catalogue(job, scales_of(job, space, tracking.u, rate, base, basis, context.stop));
  std::erase_if(test.candidates, [&](const Candidate& c) { return c.is_curve != curves; });
  for (std::size_t c = 0; c < test.candidates.size(); ++c)
    for (const auto& setting : test.candidates[c].settings)
      test.scores.push_back({c, setting, {}, tracking_values, 0.0, {}});

  const Job fixed = fixed_at(job, tracking_values);
  const EffectColumns columns(fixed, rate, context);
  Scorer scorer(fixed, space, tracking.u, base, basis, test.residuals);
  std::vector<EffectSetting> settings;
  std::vector<Score*> of_setting;
  for (Score& score : test.scores) {
    const Candidate& candidate = test.candidates[score.candidate];
    score.strengths = candidate.neutral;
    if (!candidate.probes.empty()) continue;
    settings.push_back({&candidate, candidate.neutral, score.shapes});
    of_setting.push_back(&score);
  }
  const std::vector<Eigen::MatrixXd> derivatives = columns.derivatives(settings);
  for (std::size_t i = 0; i < settings.size(); ++i)
    scorer.consider(settings[i], derivatives[i], *of_setting[i]);
  const auto probe = [&](const std::vector<Score*>& scores) {
    parallel_for(scores.size(), [&](std::size_t i) {
      context.check_stop();
      Score& score = *scores[i];
      const Candidate& candidate = test.candidates[score.candidate];
      for (const auto& [strength, derivative] :
           probed(fixed, candidate, score.shapes, rate, base.residuals))
        scorer.consider({&candidate, candidate.neutral, score.shapes}, derivative, score);
    });
  };
  std::vector<Score*> first, rest;
  for (std::size_t c = 0, at = 0; c < test.candidates.size(); ++c) {
    const Candidate& candidate = test.candidates[c];
    for (std::size_t k = 0; k < candidate.settings.size(); ++k, ++at)
      if (!candidate.probes.empty())
        (is_tried_first(candidate, k) ? first : rest).push_back(&test.scores[at]);
  }
  probe(first);
  double best = 0.0;
  for (const Score& score : test.scores) best = std::max(best, score.gain);
  std::erase_if(rest,
                [&](const Score* score) { return !gains_part_of(best, score->candidate, first); });
  probe(rest);
  refine_shapes(fixed, columns, scorer, test);
  std::ranges::stable_sort(test.scores, std::greater{}, &Score::gain);
  return test;
}

}  // namespace

ScoreTest score_test(const Job& job, const std::vector<double>& values, double rate, bool curves,
                     const RunContext& context) {
  const ThreadPool pool(job.options.threads);
  ScoreTest test = scored(with_coarse_steps(job), values, rate, curves, context);
  return test.usable ? test : scored(job, values, rate, curves, context);
}

std::optional<double> close_gain(const Job& job, const std::vector<double>& values,
                                 const RunContext& context) {
  constexpr double kLeastChiSquare = 100.0;  // per sample: ten times the noise
  if (!has_choice_of_gains(job)) return std::nullopt;
  const Job coarse = with_coarse_steps(job);
  const ParameterSpace space(coarse);
  for (const double part : {1.0, 1.0 / 3.0, 1.0 / 10.0}) {
    const double gain = part * highest_gain(job);
    const SolveResult fit = tracking_fit(coarse, space, values, gain, context);
    if (fit.usable && fit.reduced_cost >= kLeastChiSquare) return gain;
  }
  return std::nullopt;
}

}  // namespace axisfit
