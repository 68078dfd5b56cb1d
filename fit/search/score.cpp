#include "fit/search/score.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/linear_algebra.h"
#include "base/parallel.h"
#include "fit/criterion/gains.h"
#include "fit/estimate/recipes.h"
#include "fit/search/catalogue.h"
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
                       double gain, const Linearization& base, const Eigen::MatrixXd& basis,
                       const SearchContext& context) {
  SearchScales s{INFINITY, -INFINITY, 0.0, INFINITY, -INFINITY, INFINITY, -INFINITY};
  const Model<double> model = model_at(job, space, u.data(), 0);
  s.mass = Equations<double>(model).moving_mass();
  Eigen::Index row = 0;
  for (std::size_t r = 0; r < job.recordings.size(); ++r) {
    const Recording& recording = job.recordings[r];
    if (recording.role != Role::fit) continue;
    const Observer observer = observer_for(recording, gain);
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
    for (const bool of_drive : {false, true}) {
      auto& periods = of_drive ? s.drive_periods : s.periods;
      for (const double period :
           periods_in(recording, simulation, observer, base.residuals.segment(row, rows),
                      basis.middleRows(row, rows), context.options.scoring.periods, of_drive,
                      context.run.stop))
        periods.push_back(period);
    }
    row += rows;
  }
  s.speed = std::max(std::abs(s.velocity_low), std::abs(s.velocity_high));
  return s;
}

/// What one step of least squares makes of a hypothesis's columns.
class Scorer {
 public:
  Scorer(const Job& job, const ParameterSpace& space, const Eigen::VectorXd& u,
         const Linearization& base, const Eigen::MatrixXd& basis, const Eigen::VectorXd& residual,
         const SearchOptions::Scoring& options)
      : options_(options),
        job_(job),
        space_(space),
        u_(u),
        base_(base),
        basis_(basis),
        residual_(residual),
        solver_(base.jacobian) {}

  /// Enters what the setting promises where that is more than the score has.
  void consider(const EffectSetting& setting, const Eigen::MatrixXd& rows, Scored& score) const {
    const Hypothesis& hypothesis = *setting.hypothesis;
    if (rows.size() == 0) return;  // its simulation does not finish
    const Eigen::MatrixXd derivatives = with_priors(rows);
    const Eigen::MatrixXd columns = projected(derivatives);
    if (columns.size() == 0) return;
    const Eigen::VectorXd step = LeastSquaresSolver(columns).solve(-residual_);
    if (!step.allFinite()) return;
    const std::vector<double>& strengths = setting.own.strengths;
    HypothesisValues reached{{}, setting.own.shapes};
    for (std::size_t k = 0; k < strengths.size(); ++k) {
      const Quantity& q = job_.entry(hypothesis.strengths[k]).quantity;
      const double moved = moved_by(hypothesis, strengths[k], step[static_cast<Eigen::Index>(k)]);
      reached.strengths.push_back(moved);
      if (strengths.size() == 1 && (moved < q.lower || moved > q.upper)) return;
    }
    Eigen::VectorXd change = columns * step;
    const double gain = residual_.squaredNorm() - (residual_ + change).squaredNorm();
    if (!(gain > score.gain)) return;
    score.gain = gain;
    score.change = std::move(change);
    score.own = std::move(reached);
    // The free parameters adapt to the effect, no further than a linear step can be trusted.
    Eigen::VectorXd way = solver_.solve(-(base_.residuals + derivatives * step));
    const double most = options_.largest_log_step;
    for (std::size_t i = 0; i < space_.size(); ++i) {
      double& by = way[static_cast<Eigen::Index>(i)];
      if (space_[i].scale != Scale::linear) by = std::clamp(by, -most, most);
    }
    score.others = space_.values(u_ + way);
  }

  /// The step of the shapes, from a score and the derivatives with respect to strengths and shapes
  /// there; none where they say nothing.
  std::optional<Eigen::VectorXd> step_of_shapes(const EffectSetting& setting,
                                                const Eigen::MatrixXd& rows) const {
    if (rows.size() == 0) return std::nullopt;
    const Eigen::MatrixXd columns = projected(with_priors(rows));
    if (columns.size() == 0) return std::nullopt;
    const auto strengths = static_cast<Eigen::Index>(setting.own.strengths.size());
    Eigen::VectorXd way(strengths);
    for (Eigen::Index k = 0; k < strengths; ++k)
      way[k] = setting.own.strengths[static_cast<std::size_t>(k)] -
               setting.hypothesis->neutral[static_cast<std::size_t>(k)];
    const Eigen::VectorXd there = residual_ + columns.leftCols(strengths) * way;
    const Eigen::VectorXd step = LeastSquaresSolver(columns).solve(-there);
    if (!step.allFinite()) return std::nullopt;
    return step.tail(step.size() - strengths);
  }

 private:
  static double moved_by(const Hypothesis& hypothesis, double value, double step) {
    if (std::isinf(value)) return 1.0 / step;
    const QuantityEntry& entry = quantity_list()[hypothesis.strengths.front()];
    const bool is_logarithmic =
        hypothesis.kind == HypothesisKind::constant && scale_of(entry, value) == Scale::logarithmic;
    return is_logarithmic ? value * std::exp(step) : value + step;
  }

  /// Candidates have no part in what is known of the free parameters.
  Eigen::MatrixXd with_priors(const Eigen::MatrixXd& rows) const {
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(residual_.size(), rows.cols());
    all.topRows(rows.rows()) = rows;
    return all;
  }

  /// Without what the free parameters do; empty where nothing is left of a column but rounding.
  Eigen::MatrixXd projected(const Eigen::MatrixXd& derivatives) const {
    Eigen::MatrixXd columns = derivatives - basis_ * (basis_.transpose() * derivatives);
    for (Eigen::Index k = 0; k < columns.cols(); ++k)
      if (!(columns.col(k).norm() >= options_.least_own_part * derivatives.col(k).norm()))
        return {};
    return columns;
  }

  const SearchOptions::Scoring& options_;
  const Job& job_;
  const ParameterSpace& space_;
  const Eigen::VectorXd& u_;
  const Linearization& base_;
  const Eigen::MatrixXd& basis_;
  const Eigen::VectorXd& residual_;
  const LeastSquaresSolver solver_;
};

/// The mean derivatives up to each of a hypothesis' probes, from the residuals without it.
std::vector<std::pair<double, Eigen::MatrixXd>> probed(const Job& fixed,
                                                       const Hypothesis& hypothesis,
                                                       const std::vector<double>& shapes,
                                                       double gain,
                                                       const Eigen::VectorXd& without) {
  std::vector<std::pair<double, Eigen::MatrixXd>> list;
  for (const double probe : hypothesis.probes) {
    const std::vector<double> strength{probe};
    const Job extended = with_hypothesis(fixed, hypothesis, {}, {strength, shapes}, true);
    const ParameterSpace space(extended);
    const Eigen::VectorXd there = residuals_at(extended, space, space.internal(strength), gain);
    if (there.size() == 0 || there.size() > without.size()) continue;
    list.emplace_back(probe, (there - without.head(there.size())) /
                                 distance_from_neutral(probe, hypothesis.neutral[0]));
  }
  return list;
}

/// Each setting of another transmission takes simulations of its own: those in the middle are tried
/// first, where there are many.
bool is_tried_first(const Hypothesis& hypothesis, std::size_t setting,
                    const SearchOptions::Scoring& options) {
  const std::size_t all = hypothesis.settings.size();
  return hypothesis.kind != HypothesisKind::transmission || all < options.first_settings ||
         (3 * setting >= all && 3 * setting < 2 * all);
}

/// The least and the most that is tried of one shape.
std::pair<double, double> range_of_settings(const Hypothesis& hypothesis, std::size_t shape,
                                            const SearchOptions::Scoring& options) {
  const auto [least, most] = hypothesis.range_tried(shape);
  const double beyond = options.beyond_tried * std::max(std::abs(least), std::abs(most));
  return {least - beyond, most + beyond};
}

/// The best score of each of the few hypotheses whose shapes are worth another step.
std::vector<Scored*> scores_to_refine(std::vector<Scored>& scores, std::size_t count) {
  std::vector<Scored*> order;
  for (Scored& score : scores) order.push_back(&score);
  std::ranges::stable_sort(order, std::greater{}, [](const Scored* s) { return s->gain; });
  std::vector<Scored*> chosen;
  for (Scored* score : order) {
    const Hypothesis& hypothesis = *score->hypothesis;
    if (hypothesis.shapes.empty() || !hypothesis.estimates_shapes() || !hypothesis.probes.empty() ||
        !(score->gain > 0.0))
      continue;
    const bool known = std::ranges::any_of(
        chosen, [&](const Scored* other) { return other->hypothesis == score->hypothesis; });
    if (!known && chosen.size() < count) chosen.push_back(score);
  }
  return chosen;
}

/// The shapes of the hypotheses that gain most go on from the settings tried to where they gain
/// most, by steps of Gauss and Newton.
void refine_shapes(const Job& fixed, const EffectColumns& columns, const Scorer& scorer,
                   const SearchOptions::Scoring& options, std::vector<Scored>& scores) {
  const std::vector<Scored*> chosen = scores_to_refine(scores, options.refined);
  for (int step = 0; step < options.refinements; ++step) {
    std::vector<EffectSetting> here;
    for (const Scored* score : chosen) here.push_back({score->hypothesis.get(), score->own, true});
    const std::vector<Eigen::MatrixXd> slopes = columns.derivatives(here);
    std::vector<EffectSetting> next;
    std::vector<Scored*> of_next;
    for (std::size_t c = 0; c < chosen.size(); ++c) {
      const auto way = scorer.step_of_shapes(here[c], slopes[c]);
      if (!way) continue;
      const Hypothesis& hypothesis = *here[c].hypothesis;
      EffectSetting moved{&hypothesis, {hypothesis.neutral, here[c].own.shapes}};
      std::vector<double>& shapes = moved.own.shapes;
      const Job ranges = with_hypothesis(fixed, hypothesis, {}, moved.own);
      const std::size_t first = ranges.free.size() - shapes.size();
      for (std::size_t k = 0; k < shapes.size(); ++k) {
        const FreeParameter& p = ranges.free[first + k];
        const bool logarithmic = p.scale == Scale::logarithmic;
        const double most = logarithmic ? options.largest_log_step
                                        : options.largest_linear_step * (p.upper - p.lower);
        const double by = std::clamp((*way)[static_cast<Eigen::Index>(k)], -most, most);
        const double value = logarithmic ? shapes[k] * std::exp(by) : shapes[k] + by;
        const auto [least, most_tried] = range_of_settings(hypothesis, k, options);
        shapes[k] = std::clamp(value, std::max(p.lower, least), std::min(p.upper, most_tried));
      }
      next.push_back(std::move(moved));
      of_next.push_back(chosen[c]);
    }
    const std::vector<Eigen::MatrixXd> there = columns.derivatives(next);
    for (std::size_t c = 0; c < next.size(); ++c) scorer.consider(next[c], there[c], *of_next[c]);
  }
}

/// The fit at an observer gain that a score test starts from. Not usable: nothing finite.
SolveResult tracking_fit(const Job& job, const ParameterSpace& space,
                         const std::vector<double>& values, double gain,
                         const SearchContext& context) {
  SolveOptions options;
  options.max_iterations = context.options.scoring.tracking_iterations;
  options.function_tolerance = context.options.scoring.tracking_tolerance;
  return solve(job, space, space.internal(values), gain, options, context.run);
}

Job with_coarse_steps(Job job) {
  job.options = recipe::coarse(job.options);
  return job;
}

/// Looks at those of the scores that have probes, each with simulations of its own.
void probe(const std::vector<Scored*>& scores, const Job& fixed, double gain,
           const Eigen::VectorXd& without, const Scorer& scorer, const RunContext& context) {
  parallel_for(scores.size(), [&](std::size_t i) {
    context.check_stop();
    Scored& score = *scores[i];
    const Hypothesis& hypothesis = *score.hypothesis;
    const EffectSetting absent{&hypothesis, {hypothesis.neutral, score.own.shapes}};
    for (const auto& [strength, derivative] :
         probed(fixed, hypothesis, score.own.shapes, gain, without))
      scorer.consider(absent, derivative, score);
  });
}

/// A score of nothing yet for every setting of the named hypotheses, or of the curves.
std::vector<Scored> settings_of(std::vector<Hypothesis> all, bool curves,
                                const std::vector<double>& others) {
  std::vector<Scored> scores;
  for (Hypothesis& one : all) {
    if ((one.kind == HypothesisKind::curve) != curves) continue;
    const auto hypothesis = std::make_shared<const Hypothesis>(std::move(one));
    for (const auto& setting : hypothesis->settings)
      scores.push_back({hypothesis, {hypothesis->neutral, setting}, others});
  }
  return scores;
}

ScoreTest scored(const Job& job, const std::vector<double>& values, double gain, bool curves,
                 const SearchContext& context) {
  ScoreTest test;
  const SearchOptions::Scoring& options = context.options.scoring;
  const ParameterSpace space(job);
  const SolveResult tracking = tracking_fit(job, space, values, gain, context);
  if (!tracking.usable) return test;
  const std::vector<double> tracking_values = space.values(tracking.u);
  const Linearization base = linearize(job, space, tracking, gain);
  if (!base.finite) return test;
  const Eigen::MatrixXd basis = basis_of(base.jacobian);
  test.residuals = base.residuals - basis * (basis.transpose() * base.residuals);
  test.series = base.series;
  test.sum_of_squares = test.residuals.squaredNorm();
  test.mean_square = test.sum_of_squares / static_cast<double>(test.residuals.size());
  test.usable = std::isfinite(test.sum_of_squares);  // squares may overflow
  if (!test.usable) return test;
  std::vector<Scored>& scores = test.scores;
  scores =
      settings_of(catalogue(job, scales_of(job, space, tracking.u, gain, base, basis, context)),
                  curves, tracking_values);

  const Job fixed = fixed_at(job, tracking_values);
  const EffectColumns columns(fixed, gain, context.run);
  const Scorer scorer(fixed, space, tracking.u, base, basis, test.residuals, options);
  std::vector<EffectSetting> settings;
  std::vector<Scored*> of_setting, first, rest;
  for (std::size_t i = 0, setting = 0; i < scores.size(); ++i, ++setting) {
    Scored& score = scores[i];
    if (i > 0 && score.hypothesis != scores[i - 1].hypothesis) setting = 0;
    if (score.hypothesis->probes.empty()) {
      settings.push_back({score.hypothesis.get(), score.own});
      of_setting.push_back(&score);
    } else {
      (is_tried_first(*score.hypothesis, setting, options) ? first : rest).push_back(&score);
    }
  }
  const std::vector<Eigen::MatrixXd> derivatives = columns.derivatives(settings);
  for (std::size_t i = 0; i < settings.size(); ++i)
    scorer.consider(settings[i], derivatives[i], *of_setting[i]);
  probe(first, fixed, gain, base.residuals, scorer, context.run);
  double best = 0.0;
  for (const Scored& score : scores) best = std::max(best, score.gain);
  std::erase_if(rest, [&](const Scored* other) {
    return std::ranges::none_of(first, [&](const Scored* tried) {
      return tried->hypothesis == other->hypothesis &&
             tried->gain >= options.worth_other_settings * best;
    });
  });
  probe(rest, fixed, gain, base.residuals, scorer, context.run);
  refine_shapes(fixed, columns, scorer, options, scores);
  for (Scored& score : scores) score.fraction = score.gain / test.sum_of_squares;
  std::ranges::stable_sort(scores, std::greater{}, &Scored::gain);
  return test;
}

}  // namespace

ScoreTest score_test(const Job& job, const std::vector<double>& values, double gain, bool curves,
                     const SearchContext& context) {
  const ThreadPool pool(job.options.threads);
  ScoreTest test = scored(with_coarse_steps(job), values, gain, curves, context);
  return test.usable ? test : scored(job, values, gain, curves, context);
}

std::optional<double> close_gain(const Job& job, const std::vector<double>& values,
                                 const SearchContext& context) {
  const SearchOptions::Scoring& options = context.options.scoring;
  if (!has_choice_of_gains(job)) return std::nullopt;
  const Job coarse = with_coarse_steps(job);
  const ParameterSpace space(coarse);
  for (const double part : options.close_gains) {
    const double gain = part * highest_gain(job);
    const SolveResult fit = tracking_fit(coarse, space, values, gain, context);
    if (fit.usable && fit.reduced_cost >= options.large_mean_square) return gain;
  }
  return std::nullopt;
}

}  // namespace axisfit
