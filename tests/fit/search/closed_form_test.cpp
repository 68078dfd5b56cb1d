#include "fit/search/closed_form.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "base/linear_algebra.h"
#include "base/random.h"
#include "fit/search/catalogue.h"
#include "tests/fit/example.h"

namespace axisfit {
namespace {

/// A fit that found a curve over 0 ... 1 m/s or m: that nearest to a function of those whose ends
/// are held at zero, with independent errors of this size.
class FoundCurve {
 public:
  template <template <class> class Of>
  static FoundCurve of(const std::function<double(double)>& f, double error) {
    using CurveType = Of<double>;
    FoundCurve found;
    add_effect<Of>(found.job.model) = {};
    Model<double> model = found.job.model;
    const auto member = members(model);
    const std::string group(CurveType::name);
    *member[quantity_index(group + ".to")] = 1.0;
    CurveType one{};
    one.to = 1.0;
    constexpr int kPoints = 300;
    Eigen::MatrixXd basis(kPoints, CurveType::kCoefficients);
    Eigen::VectorXd values(kPoints);
    for (int i = 0; i < kPoints; ++i) {
      const double x = (i + 0.5) / kPoints;
      values[i] = f(x);
      for (std::size_t k = 0; k < CurveType::kCoefficients; ++k) {
        one.c.fill(0.0);
        one.c[k] = 1.0;
        basis(i, static_cast<Eigen::Index>(k)) = one.value(x);
      }
    }
    const Eigen::MatrixXd inner = basis.middleCols(1, basis.cols() - 2);
    const Eigen::VectorXd c = LeastSquaresSolver(inner).solve(values);
    found.job.model = model;
    std::mt19937_64 random(7);
    for (std::size_t k = 1; k + 1 < CurveType::kCoefficients; ++k) {
      const std::string name = group + "." + std::string(CurveType::kNames[k]);
      found.job.free.push_back(free_parameter(name, 0.0));
      ParameterResult p;
      p.id = id_of(name);
      p.value = c[static_cast<Eigen::Index>(k) - 1] + error * normal(random);
      p.uncertainty.determined = true;
      p.uncertainty.standard_error = error;
      found.fit.parameters.push_back(p);
      found.curve.strengths.push_back(quantity_index(name));
    }
    found.curve.name = group;
    found.curve.shapes = {quantity_index(group + ".from"), quantity_index(group + ".to")};
    const auto n = static_cast<Eigen::Index>(found.job.free.size());
    found.fit.correlation = Eigen::MatrixXd::Identity(n, n);
    found.fit.degrees_of_freedom = 2000.0;
    return found;
  }
  std::optional<ClosedForm> closed() const { return closed_form(job, fit, curve); }

  Job job;
  FitResult fit;
  Hypothesis curve;
};

TEST(ClosedForm, OfQuadraticDragIsOneTerm) {
  const auto found =
      FoundCurve::of<FrictionOverVelocity>([](double v) { return 3.0 + 8.0 * v * v; }, 0.02)
          .closed();
  ASSERT_TRUE(found);
  ASSERT_EQ(found->terms.size(), 1u);
  EXPECT_EQ(found->terms[0].form, "|v|^2");
  EXPECT_EQ(found->terms[0].unit, "N s^2/m^2");
  EXPECT_NEAR(found->terms[0].factor, 8.0, 4.0 * found->terms[0].standard_error);
  EXPECT_LT(found->terms[0].standard_error, 0.2);
}

TEST(ClosedForm, OfStribeckFrictionIsAnExponential) {
  const auto found = FoundCurve::of<FrictionOverVelocity>(
                         [](double v) { return 5.0 * std::exp(-v / 0.2) + 2.0 * v; }, 0.02)
                         .closed();
  ASSERT_TRUE(found);
  ASSERT_EQ(found->terms.size(), 1u);
  EXPECT_EQ(found->terms[0].form.substr(0, 11), "exp(-|v| / ");
  EXPECT_NEAR(std::stod(found->terms[0].form.substr(11)), 0.2, 0.02);
  EXPECT_NEAR(found->terms[0].factor, 5.0, 0.2);
}

TEST(ClosedForm, OfABumpIsABell) {
  const auto found =
      FoundCurve::of<FrictionOverPosition>(
          [](double y) { return 4.0 * std::exp(-std::pow((y - 0.4) / 0.15, 2)); }, 0.05)
          .closed();
  ASSERT_TRUE(found);
  ASSERT_EQ(found->terms.size(), 1u);
  EXPECT_EQ(found->terms[0].form.substr(0, 10), "exp(-((y -");
  EXPECT_NEAR(found->terms[0].factor, 4.0, 0.3);
}

// Coefficients that nothing connects.
TEST(ClosedForm, IsNoneForACurveThatWriggles) {
  EXPECT_FALSE(
      FoundCurve::of<FrictionOverPosition>(
          [](double y) { return std::sin(40.0 * y * y) + 2.0 * std::cos(11.0 / (y + 0.3)); }, 0.01)
          .closed());
}

// Then the coefficients say so little that a constant would do.
TEST(ClosedForm, IsNoneWhereNothingButAConstantIsSeen) {
  const auto found = FoundCurve::of<FrictionOverPosition>([](double) { return 2.0; }, 0.1).closed();
  EXPECT_FALSE(found);
}

/// A slide with a drag that is not declared, and a curve in its place.
class OfASlide : public testing::Test {
 protected:
  static FittedModel with_curve(const FittedModel& declared, const Hypothesis& curve) {
    Tried e = try_hypothesis(declared.job,
                             {std::make_shared<const Hypothesis>(curve),
                              {std::vector<double>(curve.strengths.size(), 0.0), curve.settings[0]},
                              values_of(declared.fit)});
    return {curve.name, e.job, e.fit};
  }

  OfASlide() {
    Model<double> truth = slide();
    add_effect<QuadraticDrag>(truth).c = 25.0;
    declared_.job = two_recordings(truth, slide(), {"M", "B_a"});
    declared_.fit = refit(declared_.job);
    double speed = 0.0;
    for (const double v : declared_.job.recordings[0].measurements[0].values)
      speed = std::max(speed, std::abs(v));
    const auto hypotheses = catalogue(declared_.job, {.speed = speed});
    curve_ = *std::ranges::find(hypotheses, "friction_over_velocity", &Hypothesis::name);
    fitted_ = with_curve(declared_, curve_);
    form_ = closed_form(fitted_.job, fitted_.fit, curve_);
  }

  FittedModel declared_, fitted_;
  Hypothesis curve_;
  std::optional<ClosedForm> form_;
};

TEST_F(OfASlide, IsConfirmedByTheOtherRecording) {
  ASSERT_TRUE(form_);
  EXPECT_EQ(form_->terms[0].form, "|v|^2");
  EXPECT_TRUE(is_confirmed(*form_, curve_, fitted_, declared_));
}

// The parameters that are refitted cannot make up for it.
TEST_F(OfASlide, IsNotConfirmedWhereItSaysSomethingElse) {
  ASSERT_TRUE(form_);
  for (const double factor : {-1.0, 0.0, 0.5}) {
    ClosedForm other = *form_;
    for (double& c : other.coefficients) c *= factor;
    EXPECT_FALSE(is_confirmed(other, curve_, fitted_, declared_)) << factor;
  }
}

}  // namespace
}  // namespace axisfit
