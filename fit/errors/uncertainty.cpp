#include "fit/errors/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <span>

#include "base/linear_algebra.h"
#include "fit/errors/residual_colour.h"

namespace axisfit {
namespace {

/// (J'J)^-1, of columns J of any length, without directions that are mere rounding.
class NormalInverse {
 public:
  NormalInverse(const Eigen::MatrixXd& j, double open_part) : length_(j.colwise().norm()) {
    if (j.cols() == 0) return;
    // Columns of equal length: the rank must not depend on units. A column of zeros stays one.
    Eigen::MatrixXd scaled = j;
    for (Eigen::Index k = 0; k < j.cols(); ++k)
      scaled.col(k) /= length_[k] > 0.0 ? length_[k] : 1.0;
    const auto [s, v] = singular_values(scaled);
    constexpr double kRounding = 1e-9;
    undetermined_.assign(static_cast<std::size_t>(j.cols()), false);
    matrix_.setZero(j.cols(), j.cols());
    for (Eigen::Index m = 0; m < s.size(); ++m) {
      if (s[m] > kRounding * s[0]) matrix_ += v.col(m) * v.col(m).transpose() / (s[m] * s[m]);
      for (Eigen::Index k = 0; k < j.cols() && s[m] <= kRounding * s[0]; ++k)
        if (std::abs(v(k, m)) > open_part) undetermined_[static_cast<std::size_t>(k)] = true;
    }
    for (Eigen::Index k = 0; k < j.cols(); ++k) {
      if (!(length_[k] > 0.0)) undetermined_[static_cast<std::size_t>(k)] = true;
      const double back = length_[k] > 0.0 ? 1.0 / length_[k] : 0.0;
      matrix_.row(k) *= back;
      matrix_.col(k) *= back;
    }
  }
  const Eigen::MatrixXd& matrix() const { return matrix_; }
  /// Whether the k-th parameter can change with no effect, alone or together with others.
  bool is_undetermined(Eigen::Index k) const { return undetermined_[static_cast<std::size_t>(k)]; }
  bool has_undetermined() const {
    return std::ranges::find(undetermined_, true) != undetermined_.end();
  }

 private:
  Eigen::VectorXd length_;
  Eigen::MatrixXd matrix_;
  std::vector<bool> undetermined_;
};

/// Covariance of the estimates of some parameters.
struct Spread {
  Eigen::MatrixXd covariance;
  /// Variances by white noise of the stated sizes, in readings and inputs; none: inputs are exact.
  Eigen::VectorXd stated;
  double draws = 0.0;       ///< of the inputs' noise
  double input_part = 0.0;  ///< of the variances, the largest that noise of the input makes
};

/// The covariance of the parameters `chosen`. The rows after the last series are those of priors,
/// whose variance is one.
Spread spread_of(const Linearization& at, const ResidualColour& colour,
                 const std::vector<Eigen::Index>& chosen, const NormalInverse& inverse) {
  Eigen::Index end = 0;
  for (const SeriesRows& rows : at.series) end = rows.first + rows.count;
  const Eigen::MatrixXd priors = at.jacobian(Eigen::seqN(end, at.jacobian.rows() - end), chosen);
  const Eigen::MatrixXd& n = inverse.matrix();
  Spread found{n * (colour.middle + priors.transpose() * priors) * n, {}};
  if (!at.input_noise) return found;
  const Eigen::MatrixXd steps = n * at.input_noise->gradients(chosen, Eigen::all);
  found.draws = static_cast<double>(steps.cols());
  const Eigen::VectorXd of_input = steps.rowwise().squaredNorm() / found.draws;
  found.stated = n.diagonal() + of_input;
  for (Eigen::Index k = 0; k < n.cols(); ++k)
    found.input_part = std::max(found.input_part, of_input[k] / found.stated[k]);
  return found;
}

/// Puts the independent samples and the autocorrelation time into `result`; returns the factor of
/// what white noise of the stated size contributes to standard errors, at most.
double add_colour(std::span<const SeriesRows> series,
                  std::span<const std::vector<double>> autocovariance, Uncertainty& result) {
  double most = 1.0;
  for (std::size_t s = 0; s < series.size(); ++s) {
    const std::vector<double>& g = autocovariance[s];
    const double time =
        std::max(1.0, 1.0 + 2.0 * std::accumulate(g.begin() + 1, g.end(), 0.0) / g[0]);
    result.degrees_of_freedom += static_cast<double>(series[s].count) / time;
    result.autocorrelation_time = std::max(result.autocorrelation_time, time);
    most = std::max(most, std::sqrt(g[0] * time));
  }
  return most;
}

}  // namespace

Uncertainty uncertainty(const ParameterSpace& space, const Eigen::VectorXd& u,
                        const Linearization& at_solution, const ErrorOptions& options) {
  Uncertainty result;
  result.budgets.resize(space.size());
  const auto size = static_cast<Eigen::Index>(space.size());
  result.correlation.setConstant(size, size, NAN);
  std::vector<Eigen::Index> inside;
  for (std::size_t i = 0; i < space.size(); ++i) {
    const double here = u[static_cast<Eigen::Index>(i)];
    const double lower = space.internal(i, space[i].lower);
    const double upper = space.internal(i, space[i].upper);
    const double near = options.at_bound * std::max(1.0, std::min(std::abs(here), upper - lower));
    SamplingError& sampling = result.budgets[i].sampling;
    sampling.at_bound = here - lower < near || upper - here < near;
    if (!sampling.at_bound) inside.push_back(static_cast<Eigen::Index>(i));
  }
  const auto combine = [&] {
    for (std::size_t i = 0; i < space.size(); ++i)
      result.parameters.push_back(combined(
          result.budgets[i], space.value(i, u[static_cast<Eigen::Index>(i)]), space[i], options));
  };
  if (!at_solution.finite) {
    combine();
    return result;
  }

  const auto colour_by = [&](const std::vector<Eigen::Index>& chosen,
                             const NormalInverse& inverse) {
    return residual_colour(at_solution.residuals, at_solution.jacobian(Eigen::all, chosen),
                           at_solution.series, inverse.matrix(), options);
  };
  const NormalInverse inverse(at_solution.jacobian(Eigen::all, inside), options.open_part);
  const ResidualColour colour = colour_by(inside, inverse);
  const double inflation = add_colour(at_solution.series, colour.autocovariance, result);
  result.degrees_of_freedom -= static_cast<double>(inside.size());
  for (ErrorBudget& budget : result.budgets) {
    budget.sampling.inflation = inflation;
    budget.sampling.degrees_of_freedom = result.degrees_of_freedom;
  }
  /// The budget of a parameter that is the k-th of those spread.
  const auto fill = [&](std::size_t i, const Spread& spread, const NormalInverse& normal,
                        Eigen::Index k) {
    const double slope = space.slope(i, u[static_cast<Eigen::Index>(i)]);
    const double error = std::sqrt(spread.covariance(k, k));
    SamplingError& sampling = result.budgets[i].sampling;
    sampling.standard_error = error * slope;
    sampling.inflation = error / std::sqrt(normal.matrix()(k, k));
    if (spread.stated.size() > 0)
      result.budgets[i].input_noise = {std::sqrt(spread.stated[k]) * slope, spread.draws};
  };

  Spread spread;
  if (!inside.empty()) {
    spread = spread_of(at_solution, colour, inside, inverse);
    result.input_part = spread.input_part;
    for (Eigen::Index k = 0; k < spread.covariance.cols(); ++k)
      if (!inverse.is_undetermined(k))
        fill(static_cast<std::size_t>(inside[static_cast<std::size_t>(k)]), spread, inverse, k);
  }
  if (inside.size() < space.size()) {
    const NormalInverse inverse_of_all(at_solution.jacobian, options.open_part);
    if (!inverse_of_all.has_undetermined()) {
      std::vector<Eigen::Index> all(space.size());
      std::iota(all.begin(), all.end(), Eigen::Index{0});
      const Spread spread_of_all =
          spread_of(at_solution, colour_by(all, inverse_of_all), all, inverse_of_all);
      // Where the minimum would be if there were no bounds.
      const Eigen::VectorXd step =
          -inverse_of_all.matrix() * (at_solution.jacobian.transpose() * at_solution.residuals);
      for (const Eigen::Index k : all) {
        const auto i = static_cast<std::size_t>(k);
        if (!result.budgets[i].sampling.at_bound) continue;
        fill(i, spread_of_all, inverse_of_all, k);
        result.budgets[i].sampling.step = step[k] * space.slope(i, u[k]);
      }
    }
  }
  combine();

  for (Eigen::Index a = 0; a < spread.covariance.cols(); ++a)
    for (Eigen::Index b = 0; b < spread.covariance.cols(); ++b) {
      const Eigen::Index row = inside[static_cast<std::size_t>(a)];
      const Eigen::Index column = inside[static_cast<std::size_t>(b)];
      const Eigen::MatrixXd& c = spread.covariance;
      if (result.parameters[static_cast<std::size_t>(row)].determined &&
          result.parameters[static_cast<std::size_t>(column)].determined)
        // Rounding takes a covariance that is nearly singular beyond.
        result.correlation(row, column) =
            std::clamp(0.5 * (c(a, b) + c(b, a)) / std::sqrt(c(a, a) * c(b, b)), -1.0, 1.0);
    }
  return result;
}

bool is_coloured(double autocorrelation_time, const ErrorOptions& options) {
  return autocorrelation_time > options.white_time;
}

std::vector<StrongCorrelation> strong_correlations(const Eigen::MatrixXd& correlation,
                                                   const ErrorOptions& options) {
  std::vector<StrongCorrelation> strong;
  for (Eigen::Index i = 0; i < correlation.rows(); ++i)
    for (Eigen::Index k = 0; k < i; ++k)
      if (const double c = correlation(i, k); std::abs(c) > options.strong_correlation)
        strong.push_back({static_cast<std::size_t>(k), static_cast<std::size_t>(i), c});
  std::ranges::stable_sort(strong, std::greater{},
                           [](const StrongCorrelation& c) { return std::abs(c.value); });
  return strong;
}

}  // namespace axisfit
