#include "fit/errors/parameter_uncertainty.h"

#include <gtest/gtest.h>

namespace axisfit {
namespace {

// What makes the others meaningless comes first.
TEST(ParameterUncertainty, VerdictIsTheGravestThatApplies) {
  using enum ParameterVerdict;
  ParameterUncertainty u;
  EXPECT_EQ(u.verdict(), not_determined);
  u.weak = true;
  EXPECT_EQ(u.verdict(), not_determined);
  u.determined = true;
  EXPECT_EQ(u.verdict(), weakly_determined);
  u.weak = false;
  EXPECT_EQ(u.verdict(), determined);
  u.at_bound = true;
  EXPECT_EQ(u.verdict(), at_bound);
  u.of_wrong_model = true;
  EXPECT_EQ(u.verdict(), of_wrong_model);
}

TEST(ParameterUncertainty, AnIntervalMayEndAtZero) {
  EXPECT_FALSE(ParameterUncertainty().has_interval());
  EXPECT_TRUE((ParameterUncertainty{.upper = 2.0}).has_interval());
  EXPECT_TRUE((ParameterUncertainty{.lower = -2.0}).has_interval());
}

}  // namespace
}  // namespace axisfit
