#include "fit/search/scorer.h"

#include <gtest/gtest.h>

#include <array>

#include "tests/fit/search/hypotheses.h"
#include "tests/fit/search/selection.h"

namespace axisfit {
namespace {

constexpr double kGain = 30.0;

/// A slide with a dry friction that its job does not declare.
class ScorerTest : public ::testing::Test {
 protected:
  ScorerTest()
      : job_(hidden_effect_named("coulomb_friction").job()),
        point_(*score_point(job_, {20.0, 30.0}, kGain, {})),
        fixed_(fixed_at(job_, point_.values)),
        columns_(fixed_, kGain, context_),
        scorer_(job_, point_, options_),
        catalogue_(catalogue(job_, scales())) {}

  EffectSetting setting_of(const char* name) const {
    const Hypothesis* hypothesis = find(catalogue_, name);
    return {hypothesis, {hypothesis->neutral, hypothesis->settings.front()}};
  }
  std::optional<ScoreStep> step(const std::vector<EffectSetting>& settings,
                                double least_gain = 0.0) const {
    return scorer_.step(settings, columns_.derivatives(settings), least_gain);
  }

  const Job job_;
  const ScorePoint point_;
  const Job fixed_;
  const RunContext context_;
  const SearchOptions::Scoring options_;
  const EffectColumns columns_;
  const Scorer scorer_;
  const std::vector<Hypothesis> catalogue_;
};

TEST_F(ScorerTest, APointHasNothingLeftThatTheParametersCanDo) {
  const Eigen::VectorXd along = point_.base.jacobian.transpose() * point_.residuals;
  EXPECT_LT(along.norm(), 1e-9 * point_.base.jacobian.norm() * point_.residuals.norm());
  EXPECT_LT((point_.basis.transpose() * point_.basis - Eigen::Matrix2d::Identity()).norm(), 1e-12);
}

TEST_F(ScorerTest, AStepGoesToTheStrengthThatIsThere) {
  const auto found = step({setting_of("coulomb_friction")});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->own[0].strengths[0], 5.0, 0.5);
  EXPECT_NEAR(found->gain,
              point_.residuals.squaredNorm() - (point_.residuals + found->change).squaredNorm(),
              1e-9 * found->gain);
  EXPECT_EQ(found->others.size(), 2u);
  EXPECT_FALSE(step({setting_of("coulomb_friction")}, 2.0 * found->gain));
}

TEST_F(ScorerTest, OfTwoTogetherGainsAtLeastWhatTheBetterDoes) {
  const EffectSetting friction = setting_of("coulomb_friction"),
                      spring = setting_of("stroke_spring");
  const auto both = step({friction, spring});
  ASSERT_TRUE(both);
  ASSERT_EQ(both->own.size(), 2u);
  EXPECT_GE(both->gain, step({friction})->gain);
  // What orthonormal columns of both take away is the same.
  const auto derivatives = columns_.derivatives({friction, spring});
  Eigen::MatrixXd all(derivatives[0].rows(), 2);
  all << derivatives[0], derivatives[1];
  const Eigen::MatrixXd basis = scorer_.own_basis(all);
  EXPECT_NEAR((basis.transpose() * point_.residuals).squaredNorm(), both->gain, 1e-6 * both->gain);
}

}  // namespace
}  // namespace axisfit
