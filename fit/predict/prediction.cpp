#include "fit/predict/prediction.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/autocovariance.h"
#include "base/linear_algebra.h"
#include "base/parallel.h"
#include "base/random.h"
#include "fit/data/filter.h"
#include "fit/data/initial_state.h"
#include "fit/solve/residual.h"
#include "sim/sampling.h"

namespace axisfit {
namespace {

/// A series of the missing force, every so many samples of its recording.
struct ForceSeries {
  double interval = 0.0;  ///< s
  std::vector<double> values;
};

/// The part of a force that is in proportion to none of these, by least squares.
std::vector<double> without(const std::vector<double>& force,
                            const std::vector<std::vector<double>>& causes) {
  const auto rows = static_cast<Eigen::Index>(force.size());
  Eigen::MatrixXd columns(rows, static_cast<Eigen::Index>(causes.size()));
  for (std::size_t c = 0; c < causes.size(); ++c)
    columns.col(static_cast<Eigen::Index>(c)) =
        Eigen::Map<const Eigen::VectorXd>(causes[c].data(), rows);
  const Eigen::Map<const Eigen::VectorXd> whole(force.data(), rows);
  const Eigen::VectorXd left = whole - columns * LeastSquaresSolver(columns).solve(whole);
  return {left.data(), left.data() + left.size()};
}

/// The missing force of a recording; nothing where it is no more than noise. The part that other
/// parameters would make is taken out, for these have errors and a scatter of their own: viscous
/// and dry friction, a constant force, and the drive's gain, which is a mass as well. (With the
/// acceleration besides, it would be the balance of forces itself.)
std::optional<ForceSeries> force_series(const Recording& r, const MissingForce& missing) {
  constexpr double kClear = 1.5;
  if (!missing.found) return std::nullopt;
  const double sampling = mean_interval(r.times);
  std::vector<double> velocity, direction, drive;
  for (const Sample& s : missing.samples) {
    velocity.push_back(s.velocity);
    direction.push_back(double(s.velocity > 0.0) - double(s.velocity < 0.0));
    drive.push_back(s.drive_force);
  }
  std::vector<std::vector<double>> causes{std::vector<double>(velocity.size(), 1.0), velocity,
                                          direction, drive};
  std::vector<double> force;
  for (std::vector<double>& cause : causes)
    cause = low_pass(std::move(cause), sampling, missing.cutoff);
  const std::size_t begin = r.score_initial_samples ? 0 : r.initial_samples;
  std::vector<std::vector<double>> counted(causes.size());
  for (std::size_t i = begin; i < missing.force.size(); ++i) {
    force.push_back(missing.force[i]);
    for (std::size_t c = 0; c < causes.size(); ++c) counted[c].push_back(causes[c][i]);
  }
  if (force.size() < 10 * causes.size()) return std::nullopt;
  const std::vector<double> left = without(force, counted);
  if (mean_square(left) < std::pow(kClear * missing.noise, 2)) return std::nullopt;
  constexpr double kPerPeriod = 2.5;  // of the highest frequency
  const auto every = static_cast<std::size_t>(
      std::max(1.0, std::round(1.0 / (kPerPeriod * missing.cutoff * sampling))));
  ForceSeries series{static_cast<double>(every) * sampling, {}};
  for (std::size_t i = 0; i < left.size(); i += every) series.values.push_back(left[i]);
  return series;
}

std::vector<ForceSeries> all_force_series(const Job& job, std::span<const MissingForce> forces) {
  std::vector<ForceSeries> all;
  for (std::size_t r = 0; r < forces.size(); ++r)
    if (job.recordings[r].role == Role::fit)
      if (auto series = force_series(job.recordings[r], forces[r]))
        all.push_back(*std::move(series));
  return all;
}

/// The process behind series that share an interval with the longest of them.
std::optional<MissingForceProcess> process_of(const std::vector<ForceSeries>& all) {
  constexpr std::size_t kMostLags = 40, kFewest = 30;
  constexpr double kSame = 0.01;
  const auto size = [](const ForceSeries& s) { return s.values.size(); };
  const auto longest = std::ranges::max_element(all, {}, size);
  if (longest == all.end()) return std::nullopt;
  const std::size_t lags = std::min(kMostLags, longest->values.size() / 10);
  std::vector<double> covariance(lags + 1, 0.0);
  double samples = 0.0;
  for (const ForceSeries& series : all) {
    if (std::abs(series.interval / longest->interval - 1.0) > kSame) continue;
    const auto n = static_cast<double>(series.values.size());
    const std::vector<double> own = autocovariance(series.values, lags);
    for (std::size_t lag = 0; lag <= lags; ++lag) covariance[lag] += n * own[lag];
    samples += n;
  }
  if (samples < static_cast<double>(kFewest)) return std::nullopt;
  for (double& c : covariance) c /= samples;
  Autoregression found = fit_autoregression(covariance, samples);
  return MissingForceProcess{longest->interval, std::sqrt(covariance[0]),
                             std::sqrt(found.innovation), std::move(found.coefficients)};
}

/// The model of a recording as the k-th axis of an ensemble, with an initial state as uncertain as
/// the samples that it was taken from.
Model<double> drawn_model(const AxisEnsemble& ensemble, const Model<double>& model,
                          const Recording& recording, std::size_t k, std::mt19937_64& random) {
  Model<double> drawn = ensemble.axis(model, k);
  const std::vector<double*> values = members(drawn);
  for (const auto& [quantity, value] : recording.overrides) *values[quantity] = value;
  const InitialErrors errors = initial_errors(recording);
  drawn.initial[0] += errors.position * normal(random);
  drawn.initial[1] += errors.velocity * normal(random);
  return drawn;
}

RecordingPrediction predict_recording(const Job& job, const FitResult& fit, std::size_t index,
                                      const AxisUncertainty& uncertainty,
                                      const RunContext& context) {
  const Recording& recording = job.recordings[index];
  const ParameterSpace space(job);
  const Eigen::VectorXd u = space.internal(values_of(fit));
  const Model<double> model = model_at(job, space, u.data(), index);
  const AxisEnsemble ensemble(uncertainty, model.structure, job.options.seed);
  std::vector<std::vector<std::vector<double>>> drawn(AxisEnsemble::kDraws);
  parallel_for(drawn.size(), [&](std::size_t k) {
    context.check_stop();
    std::seed_seq sequence{static_cast<std::uint64_t>(k), static_cast<std::uint64_t>(index),
                           job.options.seed};
    std::mt19937_64 random(sequence);
    const Model<double> axis = drawn_model(ensemble, model, recording, k, random);
    Recording driven = recording;
    if (ensemble.has_missing_force()) {
      driven.channels.resize(axis.structure.channels->size() - 1,
                             std::vector<double>(recording.times.size(), 0.0));
      driven.channels.emplace_back(ensemble.missing_force(k, recording.times));
    }
    SimulatedRecording ran = simulate_recording(job, driven, axis, {});
    if (ran.finished) drawn[k] = std::move(ran.simulated);
    for (std::size_t m = 0; m < drawn[k].size(); ++m)
      for (double& x : drawn[k][m]) x += recording.measurements[m].sigma * normal(random);
  });
  std::erase_if(drawn, [](const auto& readings) { return readings.empty(); });
  RecordingPrediction prediction{index, drawn.size(), {}};
  const std::vector<std::vector<double>>& nominal = fit.recordings[index].free_running.simulated;
  if (!AxisEnsemble::are_enough(drawn.size())) return prediction;
  for (std::size_t m = 0; m < nominal.size(); ++m) {
    SignalPrediction signal{{index, m, false}, nominal[m], {}};
    std::vector<std::vector<double>> curves;
    for (auto& readings : drawn) curves.push_back(std::move(readings[m]));
    signal.band = band_of(signal.values, curves);
    const Measurement& measured = recording.measurements[m];
    std::size_t counted = 0, inside = 0;
    double squares = 0.0;
    signal.is_whole_inside = true;
    for (std::size_t i = 0; i < signal.values.size(); ++i) {
      if (!measured.counts(i)) continue;
      const double distance = std::abs(measured.values[i] - signal.values[i]);
      ++counted;
      squares += distance * distance;
      inside += distance <= signal.band.half_width[i];
      signal.is_whole_inside =
          signal.is_whole_inside && distance <= signal.band.whole * signal.band.half_width[i];
    }
    if (counted > 0) {
      signal.rmse = std::sqrt(squares / static_cast<double>(counted));
      signal.inside_percent = 100.0 * static_cast<double>(inside) / static_cast<double>(counted);
    }
    prediction.signals.push_back(std::move(signal));
  }
  return prediction;
}

}  // namespace

AxisUncertainty axis_uncertainty(const Job& job, const FitResult& fit,
                                 const std::optional<Scatter>& scatter,
                                 std::span<const MissingForce> forces) {
  AxisUncertainty found;
  const ParameterSpace space(job);
  const Eigen::VectorXd u = space.internal(values_of(fit));
  std::vector<Eigen::Index> places;
  for (std::size_t i = 0; i < space.size(); ++i) {
    const ParameterResult& p = fit.parameters[i];
    const FreeParameter& free = space[i];
    const ParameterUncertainty alone = combined(without_rival(p.budget), p.value, free);
    if (!is_of_machine(job, i) || !alone.determined) continue;
    const double error = alone.standard_error;
    // On a logarithmic scale the errors are those of the logarithm; and so they may be far from
    // zero.
    constexpr double kFar = 0.25;
    const bool is_relative = free.scale == Scale::logarithmic ||
                             (free.scale == Scale::from_zero && error < kFar * p.value);
    const double per_unit = is_relative ? 1.0 / p.value : 1.0;
    UncertainQuantity q{free.quantity, is_relative, error * per_unit, 0.0, 1.0};
    // A parameter that changes from stretch to stretch changes during a prediction, too: the change
    // is part of the missing force, and the mean is as uncertain as the estimate.
    if (scatter && !scatter->of_stretches) {
      const auto s = std::ranges::find(scatter->parameters, i, &ParameterScatter::parameter);
      if (s != scatter->parameters.end() && s->error) {
        const double of_all = error * error - s->within * s->within + s->deviation * s->deviation;
        q.error = s->within * per_unit;
        q.scatter = std::sqrt(std::max(0.0, of_all)) * per_unit;
        q.freedom = s->error->degrees_of_freedom;
      }
    }
    found.quantities.push_back(q);
    places.push_back(static_cast<Eigen::Index>(i));
  }
  for (const Eigen::Index i : places)
    for (const Eigen::Index j : places) {
      const double c = i == j ? 1.0 : fit.correlation(i, j);
      found.correlation.push_back(std::isfinite(c) ? c : 0.0);
    }
  found.missing_force = process_of(all_force_series(job, forces));
  return found;
}

MotionPrediction predict_motion(const Job& job, const FitResult& fit,
                                const AxisUncertainty& uncertainty, MotionToPredict motion) {
  MotionPrediction prediction{motion.name, {}, {}};
  Rig& rig = motion.rig;
  rig.model = fitted_model(job, fit);
  rig.uncertainty = uncertainty;
  for (const Measurement& m : job.recordings.front().measurements) {
    if (!has_signal(m.signal, rig.model.structure)) continue;
    prediction.signals.push_back(m.signal);
    rig.noise[index_of(m.signal)] = m.sigma;
  }
  RecordingOptions options;
  options.duration = motion.duration;
  options.rate = 1.0 / mean_interval(job.recordings.front().times);
  options.signals = prediction.signals;
  options.step = job.options.step;
  prediction.columns = record_with_bands(rig, motion.motion, options);
  return prediction;
}

std::vector<RecordingPrediction> predict_recordings(const Job& job, const FitResult& fit,
                                                    const AxisUncertainty& uncertainty,
                                                    const RunContext& context) {
  std::vector<RecordingPrediction> predictions;
  for (std::size_t r = 0; r < job.recordings.size(); ++r) {
    if (job.recordings[r].role != Role::validate || !fit.recordings[r].free_running.finished)
      continue;
    context.report({.phase = "predicting " + job.recordings[r].name, .work = Work::errors});
    predictions.push_back(predict_recording(job, fit, r, uncertainty, context));
  }
  return predictions;
}

}  // namespace axisfit
