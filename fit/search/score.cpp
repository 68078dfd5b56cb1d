#include "fit/search/score.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/parallel.h"
#include "fit/criterion/gains.h"
#include "fit/search/catalogue.h"
#include "fit/search/periods.h"
#include "fit/search/pulses.h"
#include "fit/search/resonances.h"
#include "fit/search/scorer.h"
#include "fit/solve/residual.h"
#include "sim/sampling.h"

namespace axisfit {
namespace {

/// Pulses are for curves alone.
SearchScales scales_of(const Job& job, const ScorePoint& point, double gain, bool curves,
                       const SearchContext& context) {
  SearchScales s{INFINITY, -INFINITY, 0.0, INFINITY, -INFINITY, INFINITY, -INFINITY};
  const ParameterSpace space(job);
  const Eigen::VectorXd& u = point.u;
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
           periods_in(recording, simulation, observer, point.base.residuals.segment(row, rows),
                      point.basis.middleRows(row, rows), context.options.scoring.periods, of_drive,
                      context.run.stop))
        periods.push_back(period);
    }
    if (curves)
      for (const Pulse& pulse :
           pulses_in(recording, observer, point.base.residuals.segment(row, rows),
                     point.basis.middleRows(row, rows), context.options.scoring.pulses))
        s.pulses.push_back({pulse.start, pulse.end});
    row += rows;
  }
  for (const SeriesRows& series : point.base.series) {
    const auto own = point.residuals.segment(series.first, series.count);
    for (const double frequency :
         resonances_in({own.data(), static_cast<std::size_t>(own.size())},
                       mean_interval(job.recordings[series.recording].times),
                       context.options.scoring.resonances))
      s.resonances.push_back(frequency);
  }
  s.speed = std::max(std::abs(s.velocity_low), std::abs(s.velocity_high));
  return s;
}

/// Enters what the setting promises where that is more than the score has.
void consider(const Scorer& scorer, const EffectSetting& setting,
              const Eigen::MatrixXd& derivatives, Scored& score) {
  std::optional<ScoreStep> step = scorer.step({&setting, 1}, {&derivatives, 1}, score.gain);
  if (!step) return;
  score.gain = step->gain;
  score.change = std::move(step->change);
  score.own = std::move(step->own.front());
  score.others = std::move(step->others);
}

/// The mean derivative up to one of a hypothesis' probes, from the residuals without it; empty
/// where there are none.
Eigen::MatrixXd probed(const Job& fixed, const Hypothesis& hypothesis, double probe,
                       const std::vector<double>& shapes, double gain,
                       const Eigen::VectorXd& without) {
  const std::vector<double> strength{probe};
  const Job extended = with_hypothesis(fixed, hypothesis, {}, {strength, shapes}, true);
  const ParameterSpace space(extended);
  const Eigen::VectorXd there = residuals_at(extended, space, space.internal(strength), gain);
  if (there.size() == 0 || there.size() > without.size()) return {};
  return (there - without.head(there.size())) / distance_from_neutral(probe, hypothesis.neutral[0]);
}

/// Strengths at which a score is looked at with simulations of its own.
struct Probing {
  Scored* score;
  std::vector<double> strengths;
};

/// Of the many settings of another transmission those in the middle are tried first, of anything
/// else the first of its probes.
void share_probes(Scored& score, std::size_t setting, const SearchOptions::Scoring& options,
                  std::vector<Probing>& first, std::vector<Probing>& rest) {
  const Hypothesis& hypothesis = *score.hypothesis;
  const std::vector<double>& probes = hypothesis.probes;
  if (hypothesis.kind != HypothesisKind::transmission) {
    first.push_back({&score, {probes.front()}});
    if (probes.size() > 1) rest.push_back({&score, {probes.begin() + 1, probes.end()}});
    return;
  }
  const std::size_t all = hypothesis.settings.size();
  const bool is_first =
      all < options.first_settings || (3 * setting >= all && 3 * setting < 2 * all);
  (is_first ? first : rest).push_back({&score, probes});
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
    if (hypothesis.estimated_shapes().empty() || !hypothesis.probes.empty() || !(score->gain > 0.0))
      continue;
    const bool known = std::ranges::any_of(
        chosen, [&](const Scored* other) { return is_same_law(*other, *score); });
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
      const std::size_t estimated = hypothesis.estimated_shapes().size(),
                        first = ranges.free.size() - estimated;
      for (std::size_t k = 0; k < estimated; ++k) {
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
    for (std::size_t c = 0; c < next.size(); ++c) consider(scorer, next[c], there[c], *of_next[c]);
  }
}

void probe(const std::vector<Probing>& list, const Job& fixed, double gain,
           const Eigen::VectorXd& without, const Scorer& scorer, const RunContext& context) {
  parallel_for(list.size(), [&](std::size_t i) {
    context.check_stop();
    Scored& score = *list[i].score;
    const Hypothesis& hypothesis = *score.hypothesis;
    const EffectSetting absent{&hypothesis, {hypothesis.neutral, score.own.shapes}};
    for (const double strength : list[i].strengths)
      consider(scorer, absent, probed(fixed, hypothesis, strength, score.own.shapes, gain, without),
               score);
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
  const std::optional<ScorePoint> point = score_point(job, values, gain, context);
  if (!point) return test;
  test.residuals = point->residuals;
  test.series = point->base.series;
  test.sum_of_squares = test.residuals.squaredNorm();
  test.mean_square = point->mean_square();
  test.usable = true;
  std::vector<Scored>& scores = test.scores;
  scores = settings_of(catalogue(job, scales_of(job, *point, gain, curves, context)), curves,
                       point->values);

  const Job fixed = fixed_at(job, point->values);
  const EffectColumns columns(fixed, gain, context.run);
  const Scorer scorer(job, *point, options);
  std::vector<EffectSetting> settings;
  std::vector<Scored*> of_setting;
  std::vector<Probing> first, rest;
  for (std::size_t i = 0, setting = 0; i < scores.size(); ++i, ++setting) {
    Scored& score = scores[i];
    if (i > 0 && score.hypothesis != scores[i - 1].hypothesis) setting = 0;
    if (score.hypothesis->probes.empty()) {
      settings.push_back({score.hypothesis.get(), score.own});
      of_setting.push_back(&score);
    } else {
      share_probes(score, setting, options, first, rest);
    }
  }
  const std::vector<Eigen::MatrixXd> derivatives = columns.derivatives(settings);
  for (std::size_t i = 0; i < settings.size(); ++i)
    consider(scorer, settings[i], derivatives[i], *of_setting[i]);
  probe(first, fixed, gain, point->base.residuals, scorer, context.run);
  double best = 0.0;
  for (const Scored& score : scores) best = std::max(best, score.gain);
  std::erase_if(rest, [&](const Probing& other) {
    return std::ranges::none_of(first, [&](const Probing& tried) {
      return tried.score->hypothesis == other.score->hypothesis &&
             tried.score->gain >= options.worth_other_probes * best;
    });
  });
  probe(rest, fixed, gain, point->base.residuals, scorer, context.run);
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
