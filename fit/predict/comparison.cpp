#include "fit/predict/comparison.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <tuple>

#include "base/autocovariance.h"
#include "fit/estimate/free_run.h"
#include "fit/predict/prediction.h"

namespace axisfit {
namespace {

std::vector<std::size_t> to_validate(const Job& job) {
  std::vector<std::size_t> recordings;
  for (std::size_t r = 0; r < job.recordings.size(); ++r)
    if (job.recordings[r].role == Role::validate) recordings.push_back(r);
  return recordings;
}

/// Window errors of all recordings, one after the other; empty where one is not simulated to its
/// end.
std::vector<double> window_errors(const ModelEntry& model,
                                  const std::vector<std::size_t>& recordings, double horizon) {
  std::vector<double> all;
  for (const std::size_t r : recordings) {
    const double length =
        horizon > 0.0 ? horizon : std::numeric_limits<double>::max();  // one window
    const std::vector<double> errors = free_run_errors(model.job, values_of(model.fit), r, length);
    if (errors.empty()) return {};
    std::ranges::copy_if(errors, std::back_inserter(all), [](double e) { return e > 0.0; });
  }
  return all;
}

double root_mean(const std::vector<double>& squares) {
  if (squares.empty()) return ComparedModel::kNone;
  return std::sqrt(std::accumulate(squares.begin(), squares.end(), 0.0) /
                   static_cast<double>(squares.size()));
}

double missing_force_of(const ModelEntry& model, const std::vector<std::size_t>& recordings) {
  std::vector<double> squares;
  for (const std::size_t r : recordings)
    if (model.forces[r].found) squares.push_back(model.forces[r].rms * model.forces[r].rms);
  return root_mean(squares);
}

/// -2 log likelihood of what was fitted, but for a constant: of autoregressions.
void set_criteria(const ModelEntry& model, ComparedModel& compared) {
  if (model.fit.parameters.empty()) return;
  double deviance = 0.0, samples = 0.0;
  for (const ResidualSeries& series : residual_series(model.job, model.fit)) {
    if (!series.fitted || series.values.size() < 50) continue;
    const auto n = static_cast<double>(series.values.size());
    const std::size_t lags = std::min<std::size_t>(40, series.values.size() / 10);
    const Autoregression found = fit_autoregression(autocovariance(series.values, lags), n);
    deviance += n * std::log(found.innovation) +
                std::log(n) * static_cast<double>(found.coefficients.size());
    samples += n;
  }
  if (samples == 0.0) return;
  const auto parameters = static_cast<double>(model.fit.parameters.size());
  compared.aic = deviance + 2.0 * parameters;
  compared.bic = deviance + std::log(samples) * parameters;
}

void set_coverage(const ModelEntry& model, const RunContext& context, ComparedModel& compared) {
  if (!model.uncertainty) return;
  double inside = 0.0;
  for (const RecordingPrediction& prediction :
       predict_recordings(model.job, model.fit, *model.uncertainty, context))
    for (const SignalPrediction& signal : prediction.signals) {
      inside += signal.inside_percent;
      ++compared.curves;
      compared.whole_inside += signal.is_whole_inside ? 1 : 0;
    }
  if (compared.curves > 0) compared.inside_percent = inside / compared.curves;
}

/// Mean and standard error of the logarithm of a ratio of window errors, of a and of b.
std::pair<double, double> log_ratio(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0, squares = 0.0;
  const auto n = static_cast<double>(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double ratio = 0.5 * std::log(a[i] / b[i]);
    sum += ratio;
    squares += ratio * ratio;
  }
  const double mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean) / std::max(1.0, n - 1.0))};
}

}  // namespace

Job with_model(Job job, const Model<double>& model) {
  Structure structure = model.structure;
  structure.closed_loop = job.model.structure.closed_loop;
  structure.channels = job.model.structure.channels;
  job.model = model;
  job.model.structure = structure;
  job.free.clear();
  return job;
}

std::optional<Comparison> compare_models(const std::vector<ModelEntry>& models,
                                         const RunContext& context) {
  if (models.empty()) return std::nullopt;
  const Job& first = models.front().job;
  const std::vector<std::size_t> recordings = to_validate(first);
  if (recordings.empty()) return std::nullopt;
  double shortest = std::numeric_limits<double>::infinity(), all = 0.0;
  for (const std::size_t r : recordings) {
    const Samples& times = first.recordings[r].times;
    shortest = std::min(shortest, times.back() - times.front());
    all += times.back() - times.front();
  }
  Comparison comparison;
  // Round horizons that leave eight windows in all, and whole recordings.
  constexpr double kWindows = 8.0;
  for (const double horizon : {0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0})
    if (horizon >= 0.01 * shortest && kWindows * horizon <= all)
      comparison.horizons.push_back(horizon);
  if (comparison.horizons.empty()) comparison.horizons.push_back(all / kWindows);
  comparison.judged = comparison.horizons.back();
  comparison.horizons.push_back(0.0);

  std::vector<std::vector<double>> judged;
  for (const ModelEntry& model : models) {
    context.check_stop();
    context.report({.phase = "comparing " + (model.name.empty() ? "models" : model.name),
                    .work = Work::errors});
    ComparedModel& compared = comparison.models.emplace_back();
    compared.name = model.name;
    compared.parameters = model.fit.parameters;
    compared.missing_force = missing_force_of(model, recordings);
    for (const double horizon : comparison.horizons) {
      std::vector<double> errors = window_errors(model, recordings, horizon);
      compared.free_running.push_back(root_mean(errors));
      if (horizon == comparison.judged) judged.push_back(std::move(errors));
    }
    set_criteria(model, compared);
    set_coverage(model, context.quiet(), compared);
  }
  const auto error_of = [&](std::size_t m) {
    double sum = 0.0;  // of logarithms: no window decides alone
    for (const double e : judged[m]) sum += std::log(e);
    return judged[m].empty() ? std::numeric_limits<double>::infinity() : sum;
  };
  std::size_t best = 0;
  for (std::size_t m = 1; m < models.size(); ++m)
    if (error_of(m) < error_of(best)) best = m;
  if (judged[best].empty()) return std::nullopt;
  comparison.windows = static_cast<int>(judged[best].size());
  comparison.preferred = best;
  constexpr double kErrors = 2.0;
  for (std::size_t m = 0; m < models.size(); ++m) {
    if (judged[m].size() != judged[best].size()) continue;
    const auto [mean, error] = log_ratio(judged[m], judged[best]);
    const std::size_t parameters = models[m].fit.parameters.size();
    if (parameters > 0 && !(mean > kErrors * error) &&
        parameters < models[comparison.preferred].fit.parameters.size())
      comparison.preferred = m;
  }
  for (std::size_t m = 0; m < models.size(); ++m) {
    const std::vector<double>& preferred = judged[comparison.preferred];
    if (m == comparison.preferred || judged[m].size() != preferred.size()) continue;
    ComparedModel& compared = comparison.models[m];
    std::tie(compared.log_ratio, compared.log_ratio_error) = log_ratio(judged[m], preferred);
    for (std::size_t i = 0; i < preferred.size(); ++i)
      compared.windows_lost += preferred[i] < judged[m][i] ? 1 : 0;
  }
  return comparison;
}

}  // namespace axisfit
