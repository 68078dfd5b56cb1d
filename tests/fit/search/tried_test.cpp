#include "fit/search/tried.h"

#include <gtest/gtest.h>

#include "sim/model.h"
#include "tests/fit/search/selection.h"

namespace axisfit {
namespace {

class AsSimplerTest : public testing::Test {
 protected:
  AsSimplerTest() {
    for (const char* name : {"B_a", "dahl_friction.F_d", "dahl_friction.l_d"}) {
      job_.free.push_back(free_parameter(name, 1.0));
      fit_.parameters.emplace_back().id = id_of(name);
    }
    hypothesis_.strengths = {quantity_index("dahl_friction.F_d")};
    hypothesis_.shapes = {quantity_index("dahl_friction.l_d")};
  }
  std::optional<Rejection> found() const { return rejection_as_simpler(job_, fit_, hypothesis_); }

  Job job_;
  FitResult fit_;
  Hypothesis hypothesis_;
};

TEST_F(AsSimplerTest, IsThatOfTheEffect) {
  EXPECT_EQ(found(), std::nullopt);
  fit_.parameters[0].uncertainty.at_bound = true;  // of the axis
  fit_.parameters[1].uncertainty.at_bound = true;  // a strength
  EXPECT_EQ(found(), std::nullopt);
  fit_.parameters[2].uncertainty.at_bound = true;
  EXPECT_EQ(found(),
            (Rejection{.test = Rejection::Test::bound, .parameter = id_of("dahl_friction.l_d")}));
}

TEST_F(AsSimplerTest, IsBeyondWhatWasTried) {
  hypothesis_.settings = {{1e-4}, {1e-2}};
  for (const double length : {1e-4, 1e-2, 2.9e-2, 3.5e-5}) {
    fit_.parameters[2].value = length;
    EXPECT_EQ(found(), std::nullopt) << length;
  }
  for (const double length : {3.1e-2, 3.2e-5}) {
    fit_.parameters[2].value = length;
    EXPECT_EQ(found(), (Rejection{.test = Rejection::Test::span,
                                  .found = length,
                                  .parameter = id_of("dahl_friction.l_d")}));
  }
}

TEST_F(AsSimplerTest, IsNoneWhereShapesAreNotEstimated) {
  fit_.parameters[2].uncertainty.at_bound = true;
  hypothesis_.kind = HypothesisKind::curve;
  EXPECT_EQ(found(), std::nullopt);
}

TEST(Resume, GoesOnToTheMinimum) {
  const HiddenEffect secret = hidden_effect_named("drive_lag");
  Tried e;
  e.job = two_recordings(secret.truth(), secret.truth(), {"M", "B_a", "drive_lag.T_l"});
  const FitResult whole = refit(e.job, {}, 100);
  ASSERT_TRUE(whole.verdict.has_minimum());
  e.fit = refit(e.job, {}, 1);
  ASSERT_EQ(e.fit.verdict.kind, FitVerdict::Kind::no_minimum);
  resume(e);
  EXPECT_TRUE(e.fit.verdict.has_minimum());
  EXPECT_NEAR(e.fit.reduced_chi_square, whole.reduced_chi_square, 1e-5);
  for (std::size_t i = 0; i < e.job.free.size(); ++i)
    EXPECT_NEAR(e.fit.parameters[i].value, whole.parameters[i].value,
                0.05 * whole.parameters[i].uncertainty.standard_error);
  EXPECT_EQ(e.residuals.size(), residual_series(e.job, e.fit).size());
}

}  // namespace
}  // namespace axisfit
