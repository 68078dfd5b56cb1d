#include "fit/errors/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <span>

#include "base/distributions.h"
#include "base/linear_algebra.h"
#include "fit/errors/residual_colour.h"

namespace axisfit {
namespace {

/// (J'J)^-1, of columns J of any length, over what is not rounding.
class NormalInverse {
 public:
  explicit NormalInverse(const Eigen::MatrixXd& j) : length_(j.colwise().norm()) {
    if (j.cols() == 0) return;
    // Columns of equal length: the rank must not depend on units. A column of zeros stays one.
    Eigen::MatrixXd scaled = j;
    for (Eigen::Index k = 0; k < j.cols(); ++k)
      scaled.col(k) /= length_[k] > 0.0 ? length_[k] : 1.0;
    const auto [s, v] = singular_values(scaled);
    constexpr double kRounding = 1e-9, kPart = 0.1;
    undetermined_.assign(static_cast<std::size_t>(j.cols()), false);
    matrix_.setZero(j.cols(), j.cols());
    for (Eigen::Index m = 0; m < s.size(); ++m) {
      if (s[m] > kRounding * s[0]) matrix_ += v.col(m) * v.col(m).transpose() / (s[m] * s[m]);
      for (Eigen::Index k = 0; k < j.cols() && s[m] <= kRounding * s[0]; ++k)
        if (std::abs(v(k, m)) > kPart) undetermined_[static_cast<std::size_t>(k)] = true;
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

/// Covariance of the estimates of the parameters `chosen`, and the factors of their standard errors
/// that make half of a 95 % interval.
struct Spread {
  Eigen::MatrixXd covariance;
  Eigen::VectorXd student;
  double input_part = 0.0;  ///< of the variances, the largest that noise of the input makes
};

/// The rows after the last series are those of priors, whose variance is one.
Spread spread_of(const Linearization& at, const ResidualColour& colour,
                 const std::vector<Eigen::Index>& chosen, const NormalInverse& inverse, double t) {
  Eigen::Index end = 0;
  for (const SeriesRows& rows : at.series) end = rows.first + rows.count;
  const Eigen::MatrixXd priors = at.jacobian(Eigen::seqN(end, at.jacobian.rows() - end), chosen);
  const Eigen::MatrixXd& n = inverse.matrix();
  Spread found{n * (colour.middle + priors.transpose() * priors) * n,
               Eigen::VectorXd::Constant(n.cols(), t)};
  if (!at.input_noise) return found;
  const Eigen::MatrixXd steps = n * at.input_noise->gradients(chosen, Eigen::all);
  const auto draws = static_cast<double>(steps.cols());
  for (Eigen::Index k = 0; k < n.cols(); ++k) {
    const double of_input = steps.row(k).squaredNorm() / draws;
    const double implied = n(k, k) + of_input;
    found.input_part = std::max(found.input_part, of_input / implied);
    if (!(implied > found.covariance(k, k))) continue;
    const double factor = std::sqrt(implied / found.covariance(k, k));
    found.covariance.row(k) *= factor;
    found.covariance.col(k) *= factor;
    found.student[k] = student_95(draws);
  }
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

double student_95(double degrees_of_freedom) {
  return student_quantile(0.975, std::max(1.0, degrees_of_freedom));
}

Uncertainty uncertainty(const ParameterSpace& space, const Eigen::VectorXd& u,
                        const Linearization& at_solution) {
  Uncertainty result;
  result.parameters.resize(space.size());
  const auto size = static_cast<Eigen::Index>(space.size());
  result.correlation.setConstant(size, size, NAN);
  const auto lower = [&](std::size_t i) { return space.internal(i, space[i].lower); };
  const auto upper = [&](std::size_t i) { return space.internal(i, space[i].upper); };
  std::vector<Eigen::Index> inside;
  for (std::size_t i = 0; i < space.size(); ++i) {
    const double here = u[static_cast<Eigen::Index>(i)];
    const double near = 1e-6 * std::max(1.0, std::min(std::abs(here), upper(i) - lower(i)));
    result.parameters[i].at_bound = here - lower(i) < near || upper(i) - here < near;
    if (!result.parameters[i].at_bound) inside.push_back(static_cast<Eigen::Index>(i));
  }
  if (!at_solution.finite) return result;

  const auto colour_by = [&](const std::vector<Eigen::Index>& chosen,
                             const NormalInverse& inverse) {
    return residual_colour(at_solution.residuals, at_solution.jacobian(Eigen::all, chosen),
                           at_solution.series, inverse.matrix());
  };
  const NormalInverse inverse(at_solution.jacobian(Eigen::all, inside));
  const ResidualColour colour = colour_by(inside, inverse);
  const double inflation = add_colour(at_solution.series, colour.autocovariance, result);
  result.degrees_of_freedom -= static_cast<double>(inside.size());
  for (ParameterUncertainty& p : result.parameters) p.inflation = inflation;
  const double t = student_95(result.degrees_of_freedom);

  if (!inside.empty()) {
    const auto [covariance, student, input_part] =
        spread_of(at_solution, colour, inside, inverse, t);
    result.input_part = input_part;
    for (Eigen::Index k = 0; k < covariance.cols(); ++k) {
      if (inverse.is_undetermined(k)) continue;
      const auto i = static_cast<std::size_t>(inside[static_cast<std::size_t>(k)]);
      const double error = std::sqrt(covariance(k, k));
      const double here = u[inside[static_cast<std::size_t>(k)]];
      const double half = student[k] * error;
      ParameterUncertainty& p = result.parameters[i];
      p.inflation = error / std::sqrt(inverse.matrix()(k, k));
      // An error of more than a factor of e, or one that spans the allowed range, is no knowledge.
      const double ratio = space[i].logarithmic ? error : 2.0 * half / (upper(i) - lower(i));
      constexpr double kWeak = 0.25;
      p.determined = ratio < 1.0;
      if (!p.determined) continue;
      p.weak = ratio > kWeak;
      p.standard_error = error * space.slope(i, here);
      p.lower = std::max(space[i].lower, space.value(i, here - half));
      p.upper = std::min(space[i].upper, space.value(i, here + half));
    }
    for (Eigen::Index a = 0; a < covariance.cols(); ++a)
      for (Eigen::Index b = 0; b < covariance.cols(); ++b) {
        const Eigen::Index row = inside[static_cast<std::size_t>(a)];
        const Eigen::Index column = inside[static_cast<std::size_t>(b)];
        if (result.parameters[static_cast<std::size_t>(row)].determined &&
            result.parameters[static_cast<std::size_t>(column)].determined)
          result.correlation(row, column) =
              covariance(a, b) / std::sqrt(covariance(a, a) * covariance(b, b));
      }
  }

  if (inside.size() == space.size()) return result;
  const NormalInverse inverse_of_all(at_solution.jacobian);
  if (inverse_of_all.has_undetermined()) return result;
  std::vector<Eigen::Index> all(space.size());
  std::iota(all.begin(), all.end(), Eigen::Index{0});
  const auto [covariance, student, input_part] =
      spread_of(at_solution, colour_by(all, inverse_of_all), all, inverse_of_all, t);
  // Where the minimum would be if there were no bounds.
  const Eigen::VectorXd step =
      -inverse_of_all.matrix() * (at_solution.jacobian.transpose() * at_solution.residuals);
  for (std::size_t i = 0; i < space.size(); ++i) {
    ParameterUncertainty& p = result.parameters[i];
    if (!p.at_bound) continue;
    const auto k = static_cast<Eigen::Index>(i);
    p.inflation = std::sqrt(covariance(k, k) / inverse_of_all.matrix()(k, k));
    const double inwards = u[k] - lower(i) < upper(i) - u[k] ? 1.0 : -1.0;
    const double beyond = std::max(0.0, -inwards * step[k]);
    const double variance = student[k] * student[k] * covariance(k, k);
    if (!std::isfinite(variance)) continue;
    // sqrt(variance + beyond^2) - beyond, without its cancellation and overflow
    const double whole = std::hypot(std::sqrt(variance), beyond) + beyond;
    const double reach = whole > 0.0 ? variance / whole : 0.0;
    const double other = space.value(i, std::clamp(u[k] + inwards * reach, lower(i), upper(i)));
    p.lower = inwards > 0.0 ? space[i].lower : other;
    p.upper = inwards > 0.0 ? other : space[i].upper;
  }
  return result;
}

bool is_coloured(double autocorrelation_time) {
  constexpr double kWhite = 1.2;
  return autocorrelation_time > kWhite;
}

std::vector<StrongCorrelation> strong_correlations(const Eigen::MatrixXd& correlation) {
  constexpr double kStrong = 0.95;
  std::vector<StrongCorrelation> strong;
  for (Eigen::Index i = 0; i < correlation.rows(); ++i)
    for (Eigen::Index k = 0; k < i; ++k)
      if (const double c = correlation(i, k); std::abs(c) > kStrong)
        strong.push_back({static_cast<std::size_t>(k), static_cast<std::size_t>(i), c});
  std::ranges::stable_sort(strong, std::greater{},
                           [](const StrongCorrelation& c) { return std::abs(c.value); });
  return strong;
}

}  // namespace axisfit
