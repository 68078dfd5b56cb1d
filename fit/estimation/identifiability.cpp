#include "fit/estimation/identifiability.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace axisfit {
namespace {

/// "k_g / M", "k_g M", "k_g M^0.5"
std::string product(const std::string& a, const std::string& b, double exponent) {
  constexpr double kWhole = 0.05;
  if (std::abs(exponent + 1.0) < kWhole) return a + " / " + b;
  if (std::abs(exponent - 1.0) < kWhole) return a + " " + b;
  return fmt::format("{} {}^{:.2g}", a, b, exponent);
}

std::string change_of(const ParameterSpace& space, const WeakDirection::Part& part) {
  const double tenth = 0.1 * part.change;
  if (space[part.parameter].logarithmic)
    return fmt::format("{} by {:+.2g} %", space.name(part.parameter), 100.0 * std::expm1(tenth));
  return fmt::format("{} by {:+.2g}", space.name(part.parameter),
                     tenth * space.slope(part.parameter, 0.0));
}

}  // namespace

Identifiability identifiability(const ParameterSpace& space, const Eigen::VectorXd& u,
                                const Linearization& at, double scale) {
  Identifiability result;
  if (!at.finite || space.size() == 0) return result;
  std::vector<Eigen::Index> seen;
  for (Eigen::Index k = 0; k < at.jacobian.cols(); ++k) {
    if (at.jacobian.col(k).norm() > 0.0)
      seen.push_back(k);
    else
      result.without_influence.push_back(static_cast<std::size_t>(k));
  }
  if (seen.empty()) return result;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(at.jacobian(Eigen::all, seen), Eigen::ComputeThinV);
  const Eigen::VectorXd& s = svd.singularValues();
  const Eigen::MatrixXd& v = svd.matrixV();
  result.singular_values.assign(s.begin(), s.end());
  // Standard error of g'u in all directions but one.
  const auto error_without = [&](Eigen::Index m, const Eigen::VectorXd& g) {
    constexpr double kRounding = 1e-9;
    double variance = 0.0;
    for (Eigen::Index k = 0; k < s.size(); ++k)
      if (const double part = v.col(k).dot(g); k != m && std::abs(part) > kRounding * g.norm())
        variance += std::pow(part / s[k], 2);
    return scale * std::sqrt(variance);
  };

  for (Eigen::Index m = s.size() - 1; m >= 0 && s[m] <= scale; --m) {
    WeakDirection& weak = result.weak.emplace_back();
    weak.singular_value = s[m];
    const double largest = v.col(m).cwiseAbs().maxCoeff();
    for (Eigen::Index k = 0; k < v.rows(); ++k)
      if (std::abs(v(k, m)) > 0.1 * largest)
        weak.parts.push_back(
            {static_cast<std::size_t>(seen[static_cast<std::size_t>(k)]), v(k, m)});
    std::ranges::sort(weak.parts, std::greater{},
                      [](const WeakDirection::Part& p) { return std::abs(p.change); });
    // The largest grows.
    if (weak.parts[0].change < 0.0)
      for (WeakDirection::Part& p : weak.parts) p.change = -p.change;

    const auto name = [&](std::size_t i) { return space.name(weak.parts[i].parameter); };
    if (weak.parts.size() == 1) {
      weak.description = fmt::format("{} hardly affects these recordings.", name(0));
      continue;
    }
    const std::size_t a = weak.parts[0].parameter, b = weak.parts[1].parameter;
    if (weak.parts.size() == 2 && space[a].logarithmic && space[b].logarithmic) {
      const double exponent = -weak.parts[0].change / weak.parts[1].change;
      const auto column = [&](std::size_t parameter) {
        return std::ranges::find(seen, static_cast<Eigen::Index>(parameter)) - seen.begin();
      };
      Eigen::VectorXd g = Eigen::VectorXd::Zero(s.size());
      g[column(a)] = 1.0;
      g[column(b)] = exponent;
      const double error = error_without(m, g);
      Combination c;
      c.name = product(name(0), name(1), exponent);
      c.value =
          std::exp(u[static_cast<Eigen::Index>(a)] + exponent * u[static_cast<Eigen::Index>(b)]);
      c.standard_error = c.value * error;
      // Unless another weak direction hides it, too.
      if (error < 1.0 && std::isfinite(c.value)) {
        weak.description =
            fmt::format("{} and {} are determined only as {}.", name(0), name(1), c.name);
        result.combinations.push_back(std::move(c));
        continue;
      }
    }
    std::vector<std::string> changes;
    for (const WeakDirection::Part& part : weak.parts) changes.push_back(change_of(space, part));
    weak.description = fmt::format("These can change jointly with hardly any effect: {}.",
                                   fmt::join(changes, ", "));
  }
  return result;
}

}  // namespace axisfit
