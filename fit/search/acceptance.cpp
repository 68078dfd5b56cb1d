#include "fit/search/acceptance.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "base/distributions.h"
#include "base/linear_algebra.h"

namespace axisfit {
namespace {

using Eigen::Index;

double sum_of_squares(const ResidualSeries& series) {
  return mean_square(series.values) * static_cast<double>(series.values.size());
}

/// a - b
std::vector<double> difference(const ResidualSeries& a, const ResidualSeries& b) {
  std::vector<double> d(a.values.size());
  for (std::size_t i = 0; i < d.size(); ++i) d[i] = a.values[i] - b.values[i];
  return d;
}

/// The variance of the sum of products of a change with the residual that it leaves, if they have
/// nothing to do with each other. Both may be large at the same places, such as where the motion
/// turns: then their products scatter more than those of two stationary series.
double variance_of_products(const std::vector<double>& change, const ResidualSeries& after) {
  std::vector<double> products(change.size());
  double square = 0.0;
  for (std::size_t i = 0; i < change.size(); ++i) {
    products[i] = change[i] * after.values[i];
    square += change[i] * change[i];
  }
  const std::vector<double> ones(products.size(), 1.0);
  return std::max(square * variance_along(change, after.values),
                  static_cast<double>(products.size()) * variance_along(ones, products));
}

/// Of free quantities, of one recording or of all, their places among the parameters.
std::vector<Index> places_of(std::span<const std::size_t> quantities,
                             std::optional<std::size_t> recording, const Job& job) {
  std::vector<Index> places;
  for (const std::size_t q : quantities)
    places.push_back(std::ranges::find(job.free, ParameterId{q, recording}, &FreeParameter::id) -
                     job.free.begin());
  return places;
}

}  // namespace

Improvement improvement(const std::vector<ResidualSeries>& before,
                        const std::vector<ResidualSeries>& after) {
  Improvement result;
  double gain = 0.0, expected = 0.0, variance = 0.0, least_variance = 0.0, square_before = 0.0,
         square_after = 0.0, noise = 0.0;
  for (const ResidualSeries& old : before) {
    const ResidualSeries* now = find_series(after, old);
    if (now == nullptr) return result;
    const std::vector<double> change = difference(old, *now);
    if (old.fitted) {
      const double unit = variance_along(change, now->values);
      result.fit_gain += (sum_of_squares(old) - sum_of_squares(*now)) / unit;
      result.samples += sum_of_squares(*now) / unit;
      continue;
    }
    // With d the change of the prediction, r' = r - d: the fall of the sum of squares is
    // |d|^2 + 2 d r', of which only the second part is chance.
    const double by_chance = variance_of_products(change, *now);
    variance += 4.0 * by_chance;
    // A wrong change is in what it leaves, a right one was in what there was.
    least_variance += 4.0 * std::min(by_chance, variance_of_products(change, old));
    for (const double d : change) expected += d * d;
    square_before += sum_of_squares(old);
    square_after += sum_of_squares(*now);
    if (old.noise != NoiseSource::fit) noise += static_cast<double>(old.values.size());
  }
  gain = square_before - square_after;
  result.comparable = true;
  result.z = variance > 0.0 ? gain / std::sqrt(variance) : 0.0;
  result.expected_z = least_variance > 0.0 ? expected / std::sqrt(least_variance) : 0.0;
  result.p_value = 0.5 * std::erfc(result.z / std::sqrt(2.0));
  result.validate_percent =
      square_before > 0.0 ? 100.0 * (1.0 - std::sqrt(square_after / square_before)) : 0.0;
  const double missing = square_before - noise, left = std::max(0.0, square_after - noise);
  result.missing_percent = missing > 0.0 ? 100.0 * (1.0 - std::sqrt(left / missing)) : 0.0;
  return result;
}

double bic_difference(const std::vector<ResidualSeries>& best, std::size_t best_parameters,
                      const std::vector<ResidualSeries>& other, std::size_t other_parameters) {
  double loss = 0.0, samples = 0.0;
  for (const ResidualSeries& series : best) {
    const ResidualSeries* rival = find_series(other, series);
    if (rival == nullptr) return INFINITY;
    // Neither needs to be true, so that what both lack may tell them apart: at least as much as a
    // slow change is worth.
    const double unit = std::max(variance_along(difference(*rival, series), series.values),
                                 mean_square(series.values) * autocorrelation_time(series.values));
    loss += (sum_of_squares(*rival) - sum_of_squares(series)) / unit;
    samples += sum_of_squares(series) / unit;
  }
  return loss + (static_cast<double>(other_parameters) - static_cast<double>(best_parameters)) *
                    std::log(std::max(2.0, samples));
}

double least_bic_difference(const std::vector<ResidualSeries>& best, double more_parameters) {
  double gain = 0.0, samples = 0.0;
  for (const ResidualSeries& series : best) {
    if (series.noise == NoiseSource::fit) return -INFINITY;
    const double independent =
        static_cast<double>(series.values.size()) / autocorrelation_time(series.values);
    gain += std::max(0.0, 1.0 - 1.0 / mean_square(series.values)) * independent;
    samples += independent;
  }
  return more_parameters * std::log(std::max(2.0, samples)) - gain;
}

double clear_difference(const SearchOptions& options) {
  return 2.0 * std::log(options.acceptance.odds);
}

bool is_clearly_worse(double bic_difference, const SearchOptions& options) {
  return bic_difference > clear_difference(options);
}

bool is_needed(const Improvement& gain, std::size_t parameters, bool replicates,
               const SearchOptions& options) {
  const double price = static_cast<double>(parameters) * std::log(std::max(2.0, gain.samples));
  return gain.comparable && gain.fit_gain > price &&
         (replicates || gain.p_value < options.acceptance.chance);
}

Determination determination(const Job& job, const FitResult& result, const Hypothesis& hypothesis,
                            const std::vector<ResidualSeries>& residuals,
                            const SearchOptions& options) {
  Determination d;
  const std::vector<Index> strengths = places_of(hypothesis.strengths, hypothesis.recording, job);
  const auto note = [&](Index place, bool is_shape) {
    const ParameterResult& p = result.parameters.at(static_cast<std::size_t>(place));
    if (p.uncertainty.at_bound && !d.at_bound) d.at_bound = p.id;
    if (is_shape && hypothesis.kind != HypothesisKind::transmission && !p.uncertainty.determined &&
        !d.undetermined)
      d.undetermined = p.id;
  };
  for (const Index i : strengths) note(i, false);
  for (const Index i : places_of(hypothesis.estimated_shapes(), hypothesis.recording, job))
    note(i, true);
  d.required = chi_square_upper_quantile(options.acceptance.strength_chance,
                                         static_cast<double>(strengths.size()));

  const ParameterSpace space(job);
  const Eigen::VectorXd u = space.internal(values_of(result));
  const Linearization& at = *result.at_solution;
  if (!at.finite) return d;
  std::vector<Index> rest;
  for (Index i = 0; i < u.size(); ++i)
    if (std::ranges::find(strengths, i) == strengths.end()) rest.push_back(i);
  Eigen::MatrixXd others = at.jacobian(Eigen::all, rest);
  for (Index k = 0; k < others.cols(); ++k)
    if (const double length = others.col(k).norm(); length > 0.0) others.col(k) /= length;
  // A neutral value that is not zero, as a gain of one, is not part of the strength.
  Eigen::VectorXd way(static_cast<Index>(strengths.size()));
  for (Index s = 0; s < way.size(); ++s) {
    const Index place = strengths[static_cast<std::size_t>(s)];
    const double neutral = hypothesis.neutral[static_cast<std::size_t>(s)];
    // To first order in the compliance, none is one more of the logarithm of the stiffness.
    way[s] = std::isinf(neutral)
                 ? -1.0
                 : u[place] - space.internal(static_cast<std::size_t>(place), neutral);
  }
  const Eigen::VectorXd shown = at.jacobian(Eigen::all, strengths) * way;
  Eigen::VectorXd residual = shown;
  if (others.cols() > 0) residual -= others * LeastSquaresSolver(others).solve(shown);
  d.distinct = shown.squaredNorm() > 0.0 ? residual.squaredNorm() / shown.squaredNorm() : 0.0;
  for (const SeriesRows& rows : at.series)
    if (const auto* series = find_series(residuals, {rows.recording, rows.measurement, true})) {
      const Eigen::VectorXd own_part = residual.segment(rows.first, rows.count);
      d.wald += own_part.squaredNorm() /
                variance_along({own_part.data(), static_cast<std::size_t>(own_part.size())},
                               series->values);
    }
  return d;
}

double least_gain(const Hypothesis& hypothesis, double samples, std::size_t tried) {
  return static_cast<double>(hypothesis.parameters()) * std::log(std::max(2.0, samples)) +
         2.0 * std::log(static_cast<double>(std::max<std::size_t>(1, tried)));
}

std::optional<Rejection> rejection_as_chance(const Hypothesis& hypothesis, const Improvement& gain,
                                             std::size_t tried) {
  const double required = least_gain(hypothesis, gain.samples, tried);
  if (!gain.comparable || gain.fit_gain >= required) return std::nullopt;
  return Rejection{.test = Rejection::Test::significance,
                   .found = std::max(0.0, gain.fit_gain),
                   .required = required,
                   .tried = tried};
}

std::optional<Rejection> rejection_of(const Hypothesis& hypothesis, const Improvement& gain,
                                      const Determination& determined, const Strictness& strictness,
                                      const SearchOptions& options) {
  using enum Rejection::Test;
  const SearchOptions::Acceptance& limits = options.acceptance;
  const auto& [tried, chance, replicates] = strictness;
  if (!gain.comparable) return Rejection{.test = simulation};
  if (auto rejection = rejection_as_chance(hypothesis, gain, tried)) return rejection;
  const bool fails = !replicates && gain.p_value > chance;
  const bool is_unseen = fails && gain.expected_z < limits.power;
  if (fails && !is_unseen) return Rejection{.test = validation, .found = gain.p_value};
  if (!replicates && !is_unseen && gain.validate_percent < limits.least_percent)
    return Rejection{.test = validation_size, .found = gain.validate_percent};
  if (determined.at_bound) return Rejection{.test = bound, .parameter = determined.at_bound};
  if (determined.undetermined)
    return Rejection{.test = shape, .parameter = determined.undetermined};
  if (determined.distinct < limits.alias) return Rejection{.test = distinct};
  if (determined.wald < determined.required)
    return Rejection{.test = strength, .found = std::sqrt(determined.wald)};
  if (is_unseen) return Rejection{.test = power, .found = gain.p_value};
  return std::nullopt;
}

}  // namespace axisfit
