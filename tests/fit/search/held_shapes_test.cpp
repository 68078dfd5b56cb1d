#include "fit/search/held_shapes.h"

#include <gtest/gtest.h>

#include "fit/search/catalogue.h"
#include "tests/fit/search/hypotheses.h"
#include "tests/fit/search/selection.h"

namespace axisfit {
namespace {

/// A slide whose friction follows the Gaussian law, and Tustin's law in its place, accepted: dry
/// friction is missing beside it.
class BesideTustinsLaw : public testing::Test {
 protected:
  static Tried tried(const FittedModel& model, const Hypothesis& hypothesis,
                     const HypothesisValues& own) {
    Tried refit = try_hypothesis(
        model.job, {std::make_shared<const Hypothesis>(hypothesis), own, values_of(model.fit)});
    EXPECT_TRUE(refit.fit.is_usable()) << hypothesis.name;
    return refit;
  }

  void SetUp() override {
    Model<double> truth = slide();
    add_effect<CoulombFriction>(truth).F_c = 15.0;
    add_effect<StribeckFriction>(truth) = {20.0, 0.1, 2.0};
    const Job job = two_recordings(truth, slide(), {"M", "B_a"});
    all_ = catalogue(job, scales());
    const FittedModel declared{"", job, estimate(job)};
    Tried law = tried(declared, *find(all_, "stribeck_friction"), {{20.0}, {0.1, 1.0}});
    state_ = SearchState{ModelChain(declared, context_)};
    state_->chain.append({law.hypothesis}, std::move(law.job), std::move(law.fit));
  }

  Tried friction() const {
    return tried(state_->current(), *find(all_, "coulomb_friction"), {{15.0}, {}});
  }
  static double exponent(const Job& job) {
    return std::get<StribeckFriction<double>>(job.model.effects).n;
  }

  SearchContext context_{};
  std::vector<Hypothesis> all_;
  std::optional<SearchState> state_;
};

TEST_F(BesideTustinsLaw, TheGaussianOneShowsWhatIsBest) {
  context_.options.acceptance.odds = 1e300;  // all do about as well
  std::vector<Tried> models{tried(state_->current(), *find(all_, "quadratic_drag"), {{1.0}, {2.0}}),
                            friction()};
  const double before = reduced_cost(models[1].fit);
  const Tried* best = best_beside_held(&models[0], models, *state_, context_);
  EXPECT_EQ(best, &models[1]);
  EXPECT_EQ(exponent(best->job), 2.0);
  EXPECT_LT(reduced_cost(best->fit), 0.9 * before);
  EXPECT_TRUE(explains({"", best->job, best->fit}));
  EXPECT_TRUE(is_fitted_to_noise(best->residuals));
}

TEST_F(BesideTustinsLaw, WhatIsClearlyWorseIsNoEqual) {
  std::vector<Tried> models{friction(), friction()};
  models[1].fit.reduced_chi_square *= 2.0;
  models[1].residuals = residual_series(state_->current().job, state_->current().fit);
  EXPECT_EQ(best_beside_held(&models[0], models, *state_, context_), &models[0]);
  EXPECT_EQ(exponent(models[0].job), 1.0);
}

TEST_F(BesideTustinsLaw, TheGaussianOneTakesItsPlaceWhereThatExplainsMore) {
  Tried found = friction();
  state_->chain.append({found.hypothesis}, std::move(found.job), std::move(found.fit));
  reconsider_held(*state_, 0, context_);
  EXPECT_EQ(exponent(state_->current().job), 1.0);
  reconsider_held(*state_, 1, context_);
  EXPECT_EQ(exponent(state_->current().job), 2.0);
  EXPECT_TRUE(state_->explained());
}

}  // namespace
}  // namespace axisfit
