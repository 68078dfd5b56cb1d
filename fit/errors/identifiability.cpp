#include "fit/errors/identifiability.h"

#include <algorithm>
#include <cmath>

#include "base/linear_algebra.h"

namespace axisfit {

Identifiability identifiability(const ParameterSpace& space, const Eigen::VectorXd& u,
                                const Linearization& at, double scale,
                                const ErrorOptions& options) {
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
  const SingularValues svd = singular_values(at.jacobian(Eigen::all, seen));
  const Eigen::VectorXd& s = svd.values;
  const Eigen::MatrixXd& v = svd.right;
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

  for (Eigen::Index m = s.size() - 1; m >= 0 && options.largest_error * s[m] <= scale; --m) {
    WeakDirection& weak = result.weak.emplace_back();
    weak.singular_value = s[m];
    const double largest = v.col(m).cwiseAbs().maxCoeff();
    for (Eigen::Index k = 0; k < v.rows(); ++k)
      if (std::abs(v(k, m)) > options.told_part * largest)
        weak.parts.push_back(
            {static_cast<std::size_t>(seen[static_cast<std::size_t>(k)]), v(k, m)});
    std::ranges::sort(weak.parts, std::greater{},
                      [](const WeakDirection::Part& p) { return std::abs(p.change); });
    const bool shrinks = weak.parts[0].change < 0.0;
    for (WeakDirection::Part& p : weak.parts) {
      if (shrinks) p.change = -p.change;  // the largest grows
      p.relative = space[p.parameter].scale != Scale::linear;
      const double tenth = 0.1 * p.change;
      p.tenth = p.relative ? std::expm1(tenth) : tenth * space.slope(p.parameter, 0.0);
    }
    if (weak.parts.size() == 2 && weak.parts[0].relative && weak.parts[1].relative) {
      const std::size_t a = weak.parts[0].parameter, b = weak.parts[1].parameter;
      const double exponent = -weak.parts[0].change / weak.parts[1].change;
      const auto column = [&](std::size_t parameter) {
        return std::ranges::find(seen, static_cast<Eigen::Index>(parameter)) - seen.begin();
      };
      Eigen::VectorXd g = Eigen::VectorXd::Zero(s.size());
      g[column(a)] = 1.0;
      g[column(b)] = exponent;
      const double error = error_without(m, g);
      Combination c{a, b, exponent};
      c.value =
          std::exp(u[static_cast<Eigen::Index>(a)] + exponent * u[static_cast<Eigen::Index>(b)]);
      c.standard_error = c.value * error;
      // Unless another weak direction hides it, too.
      if (error < options.largest_log_error && std::isfinite(c.value)) {
        weak.combination = c;
        result.combinations.push_back(c);
      }
    }
  }
  return result;
}

}  // namespace axisfit
