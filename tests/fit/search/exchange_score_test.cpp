#include "fit/search/exchange_score.h"

#include <gtest/gtest.h>

#include "fit/search/tried.h"
#include "tests/fit/search/hypotheses.h"
#include "tests/fit/search/selection.h"

namespace axisfit {
namespace {

const SearchContext kContext;

/// A search that accepted Coulomb friction, which is there.
class ExchangeScoreTest : public testing::Test {
 protected:
  ExchangeScoreTest()
      : job_(hidden_effect_named("coulomb_friction").job()),
        chain_({"", job_, estimate(job_)}, kContext) {
    Tried tried = try_hypothesis(
        job_, {named("coulomb_friction"), {{4.0}, {}}, values_of(chain_.current().fit)}, kContext);
    chain_.append({*named("coulomb_friction")}, std::move(tried.job), std::move(tried.fit));
    others_ = chain_.job_with_accepted(job_, 0);
  }

  std::shared_ptr<const Hypothesis> named(const char* name) const {
    return std::make_shared<const Hypothesis>(*find(catalogue(job_, scales()), name));
  }
  std::optional<ExchangeScore> score(const char* name) const {
    const auto rival = named(name);
    return exchange_score(chain_.current(), chain_.accepted(), others_,
                          {rival, {{}, rival->settings.front()}});
  }
  double sum_of_squares(const Job& job, const FitResult& fit) const {
    const ParameterSpace space(job);
    return residuals_at(job, space, space.internal(values_of(fit)), fit.observer_gain)
        .squaredNorm();
  }

  Job job_, others_;
  ModelChain chain_;
};

// The refits of this slide are what a linear step says.
TEST_F(ExchangeScoreTest, IsWhatRefitsLose) {
  const double now = sum_of_squares(chain_.current().job, chain_.current().fit);
  const FittedModel& without = chain_.without(0);
  const double nothing = sum_of_squares(without.job, without.fit) - now;
  for (const char* name : {"stroke_spring", "constant_force", "directional_friction"}) {
    const auto found = score(name);
    ASSERT_TRUE(found) << name;
    EXPECT_NEAR(found->with_nothing, nothing, 0.2 * nothing) << name;
    const Tried tried =
        try_hypothesis(others_, {named(name), {{0.0}, named(name)->settings[0]}, {}}, kContext);
    ASSERT_TRUE(tried.fit.is_usable()) << name;
    const double with = sum_of_squares(tried.job, tried.fit) - now;
    EXPECT_NEAR(found->with_rival, with, 0.2 * nothing) << name;
    EXPECT_LE(found->with_rival, found->with_nothing * (1.0 + 1e-9)) << name;
  }
}

TEST_F(ExchangeScoreTest, IsNoneOfWhatOneStepSaysLittleOf) {
  EXPECT_FALSE(score("velocity.delay"));
}

}  // namespace
}  // namespace axisfit
