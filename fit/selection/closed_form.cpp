#include "fit/selection/closed_form.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string_view>
#include <utility>

#include "base/distributions.h"
#include "base/linear_algebra.h"
#include "fit/selection/extended_model.h"
#include "sim/effects/effects.h"

namespace axisfit {
namespace {

/// What curves have as their variable.
struct Variable {
  std::string_view effect, symbol, unit;
  bool is_speed, has_line_elsewhere;
};
constexpr Variable kVariables[] = {
    {"force_over_velocity", "v", "m/s", false, true},
    {"friction_over_velocity", "|v|", "m/s", true, true},
    {"force_over_position", "y", "m", false, false},
    {"friction_over_position", "y", "m", false, false},
    {"force_over_motor_angle", "phi", "rad", false, false},
    {"force_over_time", "t", "s", false, false},
};

/// A term of the grammar with all that is inside it settled.
struct Form {
  std::string text;
  std::string unit;  ///< of its factor
  int inside = 0;    ///< parameters that were chosen inside it
  std::function<double(double)> value;
};

std::string power_unit(const Variable& x, int power) {
  if (x.unit == "m/s") return power == 1 ? "N s/m" : fmt::format("N s^{0}/m^{0}", power);
  return power == 1 ? fmt::format("N/{}", x.unit) : fmt::format("N/{}^{}", x.unit, power);
}

std::vector<double> between(double low, double high, int count) {
  std::vector<double> list;
  for (int i = 0; i < count; ++i)
    list.push_back(low * std::pow(high / low, static_cast<double>(i) / (count - 1)));
  return list;
}

/// All terms over a range of the variable. Of what is inside a term, steps of a twentieth.
std::vector<Form> forms_over(const Variable& x, double from, double to) {
  std::vector<Form> list;
  const std::string_view s = x.symbol;
  const double range = to - from;
  if (x.unit == "rad") {
    for (int k = 1; k <= 6; ++k) {
      list.push_back(
          {fmt::format("sin({} {})", k, s), "N", 0, [k](double q) { return std::sin(k * q); }});
      list.push_back(
          {fmt::format("cos({} {})", k, s), "N", 0, [k](double q) { return std::cos(k * q); }});
    }
    return list;
  }
  for (int n = x.has_line_elsewhere ? 2 : 1; n <= 3; ++n)
    list.push_back({n == 1 ? std::string(s) : fmt::format("{}^{}", s, n), power_unit(x, n), 0,
                    [n](double q) { return std::pow(q, n); }});
  if (x.effect == "force_over_velocity") {
    list.push_back({"|v|", "N s/m", 0, [](double q) { return std::abs(q); }});
    list.push_back({"v |v|", power_unit(x, 2), 0, [](double q) { return q * std::abs(q); }});
  }
  constexpr int kWidths = 40;
  const auto widths = between(0.04 * range, 0.6 * range, kWidths);
  if (x.is_speed || x.unit == "s")
    for (const double w : widths)
      list.push_back({fmt::format("exp(-{} / {:.3g} {})", s, w, x.unit), "N", 1,
                      [w, from](double q) { return std::exp(-(q - from) / w); }});
  if (x.is_speed)
    for (const double w : widths)
      list.push_back({fmt::format("exp(-({} / {:.3g} {})^2)", s, w, x.unit), "N", 1,
                      [w](double q) { return std::exp(-std::pow(q / w, 2)); }});
  if (x.unit == "m") {
    for (const double w : widths)
      for (int i = 0; i <= 40; ++i) {
        const double at = from + range * i / 40.0;
        list.push_back({fmt::format("exp(-(({} - {:.3g} m) / {:.3g} m)^2)", s, at, w), "N", 2,
                        [at, w](double q) { return std::exp(-std::pow((q - at) / w, 2)); }});
      }
    for (const double period : between(0.2 * range, range, kWidths))
      for (int i = 0; i < 24; ++i) {
        const double phase = std::numbers::pi * i / 24.0;
        list.push_back({fmt::format("sin(2 pi {} / {:.3g} m + {:.3g})", s, period, phase), "N", 2,
                        [period, phase](double q) {
                          return std::sin(2 * std::numbers::pi * q / period + phase);
                        }});
      }
  }
  return list;
}

/// The coefficients of the curve that is nearest to a function.
class SplineFit {
 public:
  SplineFit(double from, double to, bool closes) : from_(from), to_(to) {
    basis_.resize(kPoints, kCount);
    for (int k = 0; k < kCount; ++k) {
      ForceOverMotorAngle<double> closed{};
      ForceOverPosition<double> open{};
      open.from = from;
      open.to = to;
      closed.c[static_cast<std::size_t>(k)] = open.c[static_cast<std::size_t>(k)] = 1.0;
      for (int i = 0; i < kPoints; ++i)
        basis_(i, k) = closes ? closed.value(at(i)) : open.value(at(i));
    }
    solver_.emplace(basis_);
  }
  Eigen::VectorXd coefficients(const std::function<double(double)>& f) const {
    Eigen::VectorXd values(kPoints);
    for (int i = 0; i < kPoints; ++i) values[i] = f(at(i));
    return solver_->solve(values);
  }

 private:
  static constexpr int kPoints = 200;
  static constexpr int kCount = ForceOverPosition<double>::kCoefficients;
  double at(int i) const { return from_ + (to_ - from_) * (i + 0.5) / kPoints; }

  double from_, to_;
  Eigen::MatrixXd basis_;
  std::optional<LeastSquaresSolver> solver_;
};

}  // namespace

std::optional<ClosedForm> closed_form(const Job& job, const FitResult& fit,
                                      const Candidate& curve) {
  const auto* x = std::ranges::find(kVariables, curve.name, &Variable::effect);
  const auto free_count = static_cast<Eigen::Index>(job.free.size());
  if (x == std::end(kVariables) || fit.correlation.rows() != free_count) return std::nullopt;
  // The coefficients that the recordings determine, and their covariance.
  std::vector<Eigen::Index> known, place;
  for (std::size_t i = 0; i < job.free.size(); ++i) {
    const auto own = std::ranges::find(curve.strengths, job.free[i].quantity);
    if (own == curve.strengths.end() || !fit.parameters[i].uncertainty.determined) continue;
    known.push_back(static_cast<Eigen::Index>(i));
    // The first coefficient is no strength, see curve.h.
    place.push_back(1 + (own - curve.strengths.begin()));
  }
  const auto count = static_cast<Eigen::Index>(known.size());
  if (count < 4) return std::nullopt;
  Eigen::VectorXd found(count), errors(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const ParameterResult& p =
        fit.parameters[static_cast<std::size_t>(known[static_cast<std::size_t>(k)])];
    found[k] = p.value;
    errors[k] = p.uncertainty.standard_error;
  }
  const Eigen::MatrixXd covariance =
      errors.asDiagonal() * Eigen::MatrixXd(fit.correlation(known, known)) * errors.asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> root(covariance);
  if (root.info() != Eigen::Success) return std::nullopt;
  const auto whitened = [&](const Eigen::VectorXd& coefficients) {
    Eigen::VectorXd own(count);
    for (Eigen::Index k = 0; k < count; ++k)
      own[k] = coefficients[place[static_cast<std::size_t>(k)]];
    return Eigen::VectorXd(root.matrixL().solve(own));
  };

  const bool closes = x->unit == "rad";
  double from = 0.0, to = 2.0 * std::numbers::pi;
  if (!closes) {
    const CandidateValues own = candidate_values(job, fit, curve);
    from = own.shapes[0];
    to = own.shapes[1];
  }
  const SplineFit spline(from, to, closes);
  const Eigen::VectorXd target = root.matrixL().solve(found);
  // What other effects hold.
  Eigen::MatrixXd terms = whitened(spline.coefficients([](double) { return 1.0; }));
  const auto add = [&terms](const Eigen::VectorXd& column) {
    terms.conservativeResize(Eigen::NoChange, terms.cols() + 1);
    terms.col(terms.cols() - 1) = column;
  };
  if (x->has_line_elsewhere) add(whitened(spline.coefficients([](double q) { return q; })));
  const Eigen::Index elsewhere = terms.cols();

  const std::vector<Form> grammar = forms_over(*x, from, to);
  Eigen::MatrixXd columns(count, static_cast<Eigen::Index>(grammar.size()));
  for (std::size_t g = 0; g < grammar.size(); ++g)
    columns.col(static_cast<Eigen::Index>(g)) = whitened(spline.coefficients(grammar[g].value));

  const auto left_of = [&target](const Eigen::MatrixXd& a) {
    return (target - a * LeastSquaresSolver(a).solve(target)).squaredNorm();
  };
  const double price = std::log(std::max(2.0, fit.degrees_of_freedom));
  // Of the coefficients, or of nothing at all.
  double best_cost = std::min(static_cast<double>(count - elsewhere) * price, left_of(terms));
  std::optional<ClosedForm> best;
  std::vector<std::size_t> chosen;
  constexpr std::size_t kMost = 3;
  double parameters = 0.0;
  while (chosen.size() < kMost) {
    const Eigen::MatrixXd basis = LeastSquaresSolver(terms).basis();
    const Eigen::VectorXd left = target - basis * (basis.transpose() * target);
    double most = 0.0;
    std::size_t next = grammar.size();
    for (std::size_t g = 0; g < grammar.size(); ++g) {
      const Eigen::VectorXd raw = columns.col(static_cast<Eigen::Index>(g));
      const Eigen::VectorXd own = raw - basis * (basis.transpose() * raw);
      if (own.norm() < 1e-6 * raw.norm()) continue;
      const double gain =
          std::pow(own.dot(left), 2) / own.squaredNorm() - grammar[g].inside * price;
      if (gain > most) {
        most = gain;
        next = g;
      }
    }
    if (next == grammar.size()) break;
    chosen.push_back(next);
    add(columns.col(static_cast<Eigen::Index>(next)));
    parameters += 1.0 + grammar[next].inside;
    const LeastSquaresSolver solver(terms);
    const Eigen::VectorXd factors = solver.solve(target);
    const double chi_square = (target - terms * factors).squaredNorm();
    const double degrees = static_cast<double>(count - elsewhere) - parameters;
    const double cost = chi_square + parameters * price;
    if (degrees <= 0.0 || cost >= best_cost) continue;
    if (chi_square > chi_square_upper_quantile(1e-3, degrees)) continue;
    best_cost = cost;
    best = ClosedForm{{}, chi_square, degrees};
    const Eigen::MatrixXd variance =
        Eigen::LLT<Eigen::MatrixXd>(terms.transpose() * terms)
            .solve(Eigen::MatrixXd::Identity(terms.cols(), terms.cols()));
    for (std::size_t c = 0; c < chosen.size(); ++c) {
      const Eigen::Index k = elsewhere + static_cast<Eigen::Index>(c);
      best->terms.push_back({factors[k], std::sqrt(variance(k, k)), grammar[chosen[c]].unit,
                             grammar[chosen[c]].text});
    }
  }
  return best;
}

}  // namespace axisfit
