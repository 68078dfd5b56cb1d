#include "fit/errors/identifiability.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

/// Three linear parameters, each with a column of its own: of ones, and of alternating signs.
class IdentifiabilityTest : public ::testing::Test {
 protected:
  static constexpr Eigen::Index kRows = 4000;

  IdentifiabilityTest() {
    for (const char* name : {"B_a", "b_g", "k_g"}) {
      FreeParameter p = free_parameter(name, 1.0);
      p.scale = Scale::linear;
      job_.free.push_back(p);
    }
    linear_.finite = true;
    linear_.jacobian.resize(kRows, 3);
    for (Eigen::Index i = 0; i < kRows; ++i)
      linear_.jacobian.row(i) << 1.0, i % 2 == 0 ? 1.0 : -1.0, i % 4 < 2 ? 1.0 : -1.0;
  }
  Identifiability known(const Eigen::Vector3d& u = {0, 0, 0}) const {
    return identifiability(ParameterSpace(job_), u, linear_, 1.0);
  }

  Job job_;
  Linearization linear_;
};

/// Standard error of each parameter.
const double kWhite = 1.0 / std::sqrt(4000.0);

// The standard error along a direction is `scale` over its singular value.
TEST_F(IdentifiabilityTest, ADirectionIsWeakFromAnErrorOfOne) {
  const Eigen::MatrixXd jacobian = linear_.jacobian;
  const ParameterSpace space(job_);
  for (const double scale : {1.0, 2.0})
    for (const double error : {0.9, 1.1}) {
      linear_.jacobian = jacobian;
      linear_.jacobian.col(2) *= kWhite * scale / error;
      const Identifiability seen = identifiability(space, Eigen::Vector3d::Zero(), linear_, scale);
      ASSERT_EQ(seen.weak.size(), error > 1.0 ? 1u : 0u) << scale << " " << error;
      if (error < 1.0) continue;
      EXPECT_NEAR(seen.weak[0].singular_value, scale / error, 1e-9);
      ASSERT_EQ(seen.weak[0].parts.size(), 1u);
      EXPECT_EQ(seen.weak[0].parts[0].parameter, 2u);
    }
}

TEST_F(IdentifiabilityTest, NamesWhatIsSeenOfTwoParameters) {
  for (const std::size_t i : {0u, 1u}) job_.free[i].scale = Scale::logarithmic;
  linear_.jacobian.col(1) = -linear_.jacobian.col(0);
  const Identifiability seen = known({std::log(6.0), std::log(2.0), 0.0});
  ASSERT_EQ(seen.weak.size(), 1u);
  ASSERT_EQ(seen.weak[0].parts.size(), 2u);
  ASSERT_EQ(seen.combinations.size(), 1u);
  const Combination& ratio = seen.combinations[0];
  EXPECT_EQ(ratio.first, seen.weak[0].parts[0].parameter);
  EXPECT_EQ(ratio.second, seen.weak[0].parts[1].parameter);
  EXPECT_EQ(ratio.first + ratio.second, 1u);
  EXPECT_NEAR(ratio.exponent, -1.0, 1e-12);
  EXPECT_NEAR(ratio.value, ratio.first == 0 ? 3.0 : 1.0 / 3.0, 1e-12);
  EXPECT_NEAR(ratio.standard_error / ratio.value, kWhite, 1e-6 * kWhite);
  ASSERT_TRUE(seen.weak[0].combination);
  EXPECT_EQ(seen.weak[0].combination->value, ratio.value);
  EXPECT_EQ(seen.singular_values.size(), 3u);
}

// Where neither the ratio nor the product is seen, none is claimed.
TEST_F(IdentifiabilityTest, ClaimsNoCombinationThatAnotherWeakDirectionHides) {
  for (const std::size_t i : {0u, 1u}) job_.free[i].scale = Scale::logarithmic;
  linear_.jacobian.col(1) = -linear_.jacobian.col(0);
  linear_.jacobian.leftCols(2) *= 1e-6 * kWhite;
  const Identifiability seen = known({std::log(6.0), std::log(2.0), 0.0});
  ASSERT_EQ(seen.weak.size(), 2u);
  EXPECT_TRUE(seen.combinations.empty());
  for (const WeakDirection& weak : seen.weak) {
    ASSERT_EQ(weak.parts.size(), 2u);
    EXPECT_FALSE(weak.combination);
    for (const WeakDirection::Part& part : weak.parts) {
      EXPECT_TRUE(part.relative);
      EXPECT_NEAR(part.tenth, std::expm1(0.1 * part.change), 1e-12);
    }
  }
}

TEST_F(IdentifiabilityTest, NamesWhatNoSignalShows) {
  linear_.jacobian.col(2).setZero();
  const Identifiability seen = known();
  EXPECT_EQ(seen.without_influence, std::vector<std::size_t>{2});
  EXPECT_TRUE(seen.weak.empty());
  EXPECT_EQ(seen.singular_values.size(), 2u);
}

/// Of a recorded job at its initial values.
Identifiability at_start(const Job& job) {
  const ParameterSpace space(job);
  const Eigen::VectorXd u = space.internal(initial_values(job));
  return identifiability(space, u, linearize(job, space, u, 0.0), 1.0);
}

// Without friction M y1' = K_f U: the motion shows K_f / M alone.
TEST(Identifiability, OfAMassWithoutFrictionIsItsAccelerationPerVolt) {
  Job job = two_recordings(driven_mass(20.0), driven_mass(20.0), {"K_f", "M"}, 60.0);
  const Identifiability seen = at_start(job);
  ASSERT_EQ(seen.weak.size(), 1u);
  const std::vector<WeakDirection::Part>& parts = seen.weak[0].parts;
  ASSERT_EQ(parts.size(), 2u);  // together, in the same proportion
  EXPECT_NEAR(parts[0].change, std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(parts[1].change, std::sqrt(0.5), 1e-6);
  ASSERT_TRUE(seen.weak[0].combination);
  const Combination& ratio = *seen.weak[0].combination;
  EXPECT_NEAR(ratio.exponent, -1.0, 1e-6);
  EXPECT_NEAR(ratio.value, ratio.first == 0 ? 1.0 / 20.0 : 20.0, 1e-6 * ratio.value);
  // It is known as well as either of them is with the other fixed.
  job.free.pop_back();
  EXPECT_NEAR(ratio.standard_error / ratio.value, 1.0 / at_start(job).singular_values[0],
              1e-4 * ratio.standard_error / ratio.value);
}

TEST(Identifiability, FrictionTellsForceAndMassApart) {
  Model<double> model = driven_mass(20.0);
  model.axis.B_a = 100.0;
  Job job = two_recordings(model, model, {"K_f", "M", "k_g"}, 60.0);
  job.model.axis.B_a = 100.0;  // known
  const Identifiability seen = at_start(job);
  EXPECT_TRUE(seen.weak.empty());
  EXPECT_TRUE(seen.combinations.empty());
  EXPECT_EQ(seen.singular_values.size(), 2u);
  EXPECT_EQ(seen.without_influence, std::vector<std::size_t>{2});  // there is no gear
}

TEST_F(IdentifiabilityTest, IsUnknownWhereTheSimulationDoesNotFinish) {
  linear_.finite = false;
  EXPECT_TRUE(known().singular_values.empty());
  EXPECT_TRUE(known().without_influence.empty());
}

}  // namespace
}  // namespace axisfit
