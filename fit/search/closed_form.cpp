#include "fit/search/closed_form.h"

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
#include "fit/search/options.h"
#include "fit/solve/parameters.h"
#include "sim/effects/effects.h"

namespace axisfit {
namespace {

constexpr SearchOptions::ClosedForms kOptions;

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

/// All terms over a range of the variable. What is inside a term varies in steps of a twentieth.
std::vector<Form> forms_over(const Variable& x, Vocabulary vocabulary, double from, double to) {
  std::vector<Form> list;
  const std::string force(unit_on(vocabulary, "N"));
  const std::string_view unit = unit_on(vocabulary, x.unit);
  const std::string_view s = x.symbol;
  const double range = to - from;
  if (x.unit == "rad") {
    for (int k = 1; k <= 6; ++k) {
      list.push_back(
          {fmt::format("sin({} {})", k, s), force, 0, [k](double q) { return std::sin(k * q); }});
      list.push_back(
          {fmt::format("cos({} {})", k, s), force, 0, [k](double q) { return std::cos(k * q); }});
    }
    return list;
  }
  for (int n = x.has_line_elsewhere ? 2 : 1; n <= 3; ++n)
    list.push_back({n == 1 ? std::string(s) : fmt::format("{}^{}", s, n),
                    std::string(unit_on(vocabulary, power_unit(x, n))), 0,
                    [n](double q) { return std::pow(q, n); }});
  if (x.effect == "force_over_velocity") {
    list.push_back({"|v|", std::string(unit_on(vocabulary, "N s/m")), 0,
                    [](double q) { return std::abs(q); }});
    list.push_back({"v |v|", std::string(unit_on(vocabulary, power_unit(x, 2))), 0,
                    [](double q) { return q * std::abs(q); }});
  }
  constexpr int kWidths = 40;
  std::vector<double> widths;
  for (const auto& setting : geometric(0.04 * range, 0.6 * range, kWidths))
    widths.push_back(setting.front());
  if (x.is_speed || x.unit == "s")
    for (const double w : widths)
      list.push_back({fmt::format("exp(-{} / {:.3g} {})", s, w, unit), force, 1,
                      [w, from](double q) { return std::exp(-(q - from) / w); }});
  if (x.is_speed)
    for (const double w : widths)
      list.push_back({fmt::format("exp(-({} / {:.3g} {})^2)", s, w, unit), force, 1,
                      [w](double q) { return std::exp(-std::pow(q / w, 2)); }});
  if (x.unit == "m") {
    for (const double w : widths)
      for (int i = 0; i <= 40; ++i) {
        const double at = from + range * i / 40.0;
        list.push_back({fmt::format("exp(-(({0} - {1:.3g} {3}) / {2:.3g} {3})^2)", s, at, w, unit),
                        force, 2,
                        [at, w](double q) { return std::exp(-std::pow((q - at) / w, 2)); }});
      }
    for (const auto& setting : geometric(0.2 * range, range, kWidths))
      for (int i = 0; i < 24; ++i) {
        const double period = setting.front();
        const double phase = std::numbers::pi * i / 24.0;
        list.push_back({fmt::format("sin(2 pi {} / {:.3g} {} + {:.3g})", s, period, unit, phase),
                        force, 2, [period, phase](double q) {
                          return std::sin(2 * std::numbers::pi * q / period + phase);
                        }});
      }
  }
  return list;
}

/// The coefficients of the curve that is nearest to a function: of any curve, or of those that a
/// fit may find, whose ends are held at zero (see curve.h).
class SplineFit {
 public:
  SplineFit(double from, double to, bool closes) : from_(from), to_(to), closes_(closes) {
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
    whole_.emplace(basis_);
    held_.emplace(basis_.middleCols(1, held()));
  }
  Eigen::VectorXd coefficients(const std::function<double(double)>& f) const {
    return whole_->solve(values_of(f));
  }
  Eigen::VectorXd with_held_ends(const std::function<double(double)>& f) const {
    Eigen::VectorXd c = Eigen::VectorXd::Zero(kCount);
    c.segment(1, held()) = held_->solve(values_of(f));
    return c;
  }

 private:
  static constexpr int kPoints = 200;
  static constexpr int kCount = ForceOverPosition<double>::kCoefficients;
  Eigen::Index held() const { return kCount - (closes_ ? 1 : 2); }
  double at(int i) const { return from_ + (to_ - from_) * (i + 0.5) / kPoints; }
  Eigen::VectorXd values_of(const std::function<double(double)>& f) const {
    Eigen::VectorXd values(kPoints);
    for (int i = 0; i < kPoints; ++i) values[i] = f(at(i));
    return values;
  }

  double from_, to_;
  bool closes_;
  Eigen::MatrixXd basis_;
  std::optional<LeastSquaresSolver> whole_, held_;
};

/// The coefficients of a curve that the recordings determine, and their covariance.
class KnownCoefficients {
 public:
  /// Nothing where they are too few, or their covariance is none.
  static std::optional<KnownCoefficients> of(const Job& job, const FitResult& fit,
                                             const Hypothesis& curve) {
    if (fit.correlation.rows() != static_cast<Eigen::Index>(job.free.size())) return std::nullopt;
    KnownCoefficients known;
    std::vector<Eigen::Index> of_fit;
    std::vector<double> values, errors;
    for (std::size_t i = 0; i < job.free.size(); ++i) {
      const ParameterResult& p = fit.parameters[i];
      const auto own = std::ranges::find(curve.strengths, job.free[i].quantity);
      if (own == curve.strengths.end() || !p.uncertainty.determined) continue;
      of_fit.push_back(static_cast<Eigen::Index>(i));
      values.push_back(p.value);
      errors.push_back(p.uncertainty.standard_error);
      // The first coefficient is no strength, see curve.h.
      known.place_.push_back(1 + (own - curve.strengths.begin()));
    }
    constexpr Eigen::Index kLeast = 4;
    if (known.count() < kLeast) return std::nullopt;
    const Eigen::Map<const Eigen::VectorXd> error(errors.data(), known.count());
    known.root_.compute(error.asDiagonal() * Eigen::MatrixXd(fit.correlation(of_fit, of_fit)) *
                        error.asDiagonal());
    if (known.root_.info() != Eigen::Success) return std::nullopt;
    known.found_ = known.root_.matrixL().solve(
        Eigen::Map<const Eigen::VectorXd>(values.data(), known.count()));
    return known;
  }

  Eigen::Index count() const { return static_cast<Eigen::Index>(place_.size()); }
  /// As found, and those of all of a curve's, both with unit covariance.
  const Eigen::VectorXd& found() const { return found_; }
  Eigen::VectorXd whitened(const Eigen::VectorXd& coefficients) const {
    return root_.matrixL().solve(Eigen::VectorXd(coefficients(place_)));
  }

 private:
  std::vector<Eigen::Index> place_;
  Eigen::LLT<Eigen::MatrixXd> root_;
  Eigen::VectorXd found_;
};

Eigen::MatrixXd with_column(Eigen::MatrixXd a, const Eigen::VectorXd& column) {
  a.conservativeResize(Eigen::NoChange, a.cols() + 1);
  a.col(a.cols() - 1) = column;
  return a;
}

/// The form that, beside these terms, takes most off what they leave, the price of what is inside
/// it counted; as many as there are forms: none takes any.
std::size_t best_beside(const Eigen::MatrixXd& terms, const Eigen::VectorXd& left,
                        const std::vector<Form>& forms, const Eigen::MatrixXd& columns,
                        double price) {
  const Eigen::MatrixXd basis = LeastSquaresSolver(terms).basis();
  const Eigen::MatrixXd own = columns - basis * (basis.transpose() * columns);
  double most = 0.0;
  std::size_t best = forms.size();
  for (std::size_t g = 0; g < forms.size(); ++g) {
    const auto k = static_cast<Eigen::Index>(g);
    if (own.col(k).norm() < kOptions.alias * columns.col(k).norm()) continue;
    const double gain =
        std::pow(own.col(k).dot(left), 2) / own.col(k).squaredNorm() - forms[g].inside * price;
    if (gain <= most) continue;
    most = gain;
    best = g;
  }
  return best;
}

}  // namespace

std::optional<ClosedForm> closed_form(const Job& job, const FitResult& fit,
                                      const Hypothesis& curve) {
  const auto* x = std::ranges::find(kVariables, quantity_list()[curve.strengths.front()].group,
                                    &Variable::effect);
  if (x == std::end(kVariables)) return std::nullopt;
  const auto known = KnownCoefficients::of(job, fit, curve);
  if (!known) return std::nullopt;
  const bool closes = x->unit == "rad";
  double from = 0.0, to = 2.0 * std::numbers::pi;
  if (!closes) {
    const HypothesisValues own = values_in(job, fit, curve);
    from = own.shapes[0];
    to = own.shapes[1];
  }
  const SplineFit spline(from, to, closes);
  const auto column_of = [&](const std::function<double(double)>& f) {
    return known->whitened(spline.with_held_ends(f));
  };
  const std::vector<Form> forms = forms_over(*x, job.vocabulary(), from, to);
  Eigen::MatrixXd columns(known->count(), static_cast<Eigen::Index>(forms.size()));
  for (std::size_t g = 0; g < forms.size(); ++g)
    columns.col(static_cast<Eigen::Index>(g)) = column_of(forms[g].value);

  // First what other effects hold.
  std::vector<std::function<double(double)>> functions{[](double) { return 1.0; }};
  if (x->has_line_elsewhere) functions.emplace_back([](double q) { return q; });
  const auto elsewhere = static_cast<Eigen::Index>(functions.size());
  Eigen::MatrixXd terms(known->count(), 0);
  for (const auto& f : functions) terms = with_column(terms, column_of(f));
  const auto count = static_cast<double>(known->count() - elsewhere);
  const double price = std::log(std::max(2.0, fit.degrees_of_freedom));
  double least_cost = count * price;  // of the coefficients
  double parameters = 0.0;
  std::vector<std::size_t> chosen;
  std::optional<ClosedForm> best;
  for (;;) {
    const Eigen::VectorXd factors = LeastSquaresSolver(terms).solve(known->found());
    const Eigen::VectorXd left = known->found() - terms * factors;
    const double chi_square = left.squaredNorm(), degrees = count - parameters;
    const double cost = chi_square + parameters * price;
    if (chosen.empty()) {
      least_cost = std::min(least_cost, cost);  // of nothing at all
    } else if (cost < least_cost && degrees > 0.0 &&
               chi_square <= chi_square_upper_quantile(kOptions.chance, degrees)) {
      least_cost = cost;
      const Eigen::VectorXd sum = spline.coefficients([&](double q) {
        double value = 0.0;
        for (std::size_t k = 0; k < functions.size(); ++k)
          value += factors[static_cast<Eigen::Index>(k)] * functions[k](q);
        return value;
      });
      best = ClosedForm{
          {}, chi_square, degrees, static_cast<std::size_t>(parameters), {sum.begin(), sum.end()}};
      const Eigen::MatrixXd variance =
          Eigen::LLT<Eigen::MatrixXd>(terms.transpose() * terms)
              .solve(Eigen::MatrixXd::Identity(terms.cols(), terms.cols()));
      for (std::size_t c = 0; c < chosen.size(); ++c) {
        const Eigen::Index k = elsewhere + static_cast<Eigen::Index>(c);
        best->terms.push_back(
            {factors[k], std::sqrt(variance(k, k)), forms[chosen[c]].unit, forms[chosen[c]].text});
      }
    }
    if (chosen.size() == kOptions.most_terms) return best;
    const std::size_t next = best_beside(terms, left, forms, columns, price);
    if (next == forms.size()) return best;
    chosen.push_back(next);
    terms = with_column(terms, columns.col(static_cast<Eigen::Index>(next)));
    functions.push_back(forms[next].value);
    parameters += 1.0 + forms[next].inside;
  }
}

bool is_confirmed(const ClosedForm& form, const Hypothesis& curve, const FittedModel& with_curve,
                  const FittedModel& without, const SearchContext& context) {
  Job job = with_curve.job;
  set_initial_values(job, values_of(with_curve.fit));
  std::erase_if(job.free, [&](const FreeParameter& p) {
    return std::ranges::find(curve.strengths, p.quantity) != curve.strengths.end();
  });
  const auto member = members(job.model);
  // The first coefficient is no strength, see curve.h.
  for (std::size_t k = 0; k < form.coefficients.size(); ++k)
    *member[curve.strengths.front() - 1 + k] = form.coefficients[k];
  const FitResult fit = refit(job, context);
  if (!fit.is_usable()) return false;
  const auto found = residual_series(job, fit);
  const Improvement gain = improvement(residual_series(without.job, without.fit), found);
  if (!gain.comparable || gain.p_value > context.options.acceptance.chance) return false;
  return !is_clearly_worse(
      bic_difference(residual_series(with_curve.job, with_curve.fit), with_curve.job.free.size(),
                     found, job.free.size() + form.parameters),
      context.options);
}

}  // namespace axisfit
