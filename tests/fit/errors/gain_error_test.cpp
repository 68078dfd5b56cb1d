#include "fit/errors/gain_error.h"

#include <gtest/gtest.h>

#include "tests/fit/parameter_ids.h"

namespace axisfit {
namespace {

ParameterResult estimate_of(double value, double error) {
  ParameterResult p{id_of("B_a"), value, {}};
  p.uncertainty.determined = true;
  p.uncertainty.standard_error = error;
  return p;
}

/// The move of an estimate of 10 +- 3 that is these at gains of 30 and 300.
std::optional<GainShift> move_to(const ParameterResult& low, const ParameterResult& high) {
  const std::vector here{estimate_of(10.0, 3.0)};
  const std::vector<EstimatesAtGain> others{{30.0, {low}}, {300.0, {high}}};
  return gain_errors(here, others).front();
}

// The errors of both are five.
TEST(GainErrors, AreMovesBeyondTwiceTheErrorsOfBoth) {
  EXPECT_FALSE(move_to(estimate_of(19.9, 4.0), estimate_of(0.1, 4.0)));
  const auto up = move_to(estimate_of(20.1, 4.0), estimate_of(0.1, 4.0));
  ASSERT_TRUE(up);
  EXPECT_EQ(up->observer_gain, 30.0);
  EXPECT_EQ(up->value, 20.1);
  EXPECT_TRUE(move_to(estimate_of(10.0, 4.0), estimate_of(-0.1, 4.0)));
}

TEST(GainErrors, AreTheFurthestMove) {
  for (const bool is_high : {false, true}) {
    const auto found = move_to(estimate_of(is_high ? 25.0 : 40.0, 4.0), estimate_of(-10.0, 4.0));
    ASSERT_TRUE(found);
    EXPECT_EQ(found->observer_gain, is_high ? 300.0 : 30.0);
    EXPECT_EQ(found->value, is_high ? -10.0 : 40.0);
  }
}

TEST(GainErrors, AreOfDeterminedEstimatesAlone) {
  ParameterResult open = estimate_of(1000.0, 0.0);
  open.uncertainty.determined = false;
  EXPECT_FALSE(move_to(open, open));
  EXPECT_FALSE(
      gain_errors(std::vector{open}, std::vector<EstimatesAtGain>{{30.0, {estimate_of(10.0, 3.0)}}})
          .front());
}

}  // namespace
}  // namespace axisfit
