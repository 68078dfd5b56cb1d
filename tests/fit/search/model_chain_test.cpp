#include "fit/search/model_chain.h"

#include <gtest/gtest.h>

#include "fit/criterion/gains.h"
#include "fit/search/catalogue.h"
#include "fit/search/strategies.h"
#include "tests/fit/search/hypotheses.h"
#include "tests/fit/search/selection.h"

namespace axisfit {
namespace {

/// A slide whose job lacks friction and a spring, and the chain of models that has both.
class ChainOfTwo : public testing::Test {
 protected:
  struct Made {
    FittedModel declared;
    Hypothesis friction, spring;
    ModelChain chain;
  };
  static Made make() {
    Model<double> truth = slide();
    hidden_effect_named("coulomb_friction").put_into(truth);
    hidden_effect_named("stroke_spring").put_into(truth);
    Job job = two_recordings(truth, slide(), {"M", "B_a"});
    FittedModel declared{"", job, estimate(job)};
    const std::vector<Hypothesis> all = catalogue(job, scales());
    Made made{declared, *find(all, "coulomb_friction"), *find(all, "stroke_spring"),
              ModelChain(declared, kContext)};
    for (const auto& [hypothesis, strength] :
         {std::pair(made.friction, 4.0), std::pair(made.spring, 15.0)}) {
      const FittedModel& now = made.chain.current();
      Tried tried = try_hypothesis(
          now.job,
          {std::make_shared<const Hypothesis>(hypothesis), {{strength}, {}}, values_of(now.fit)});
      made.chain.append({hypothesis}, std::move(tried.job), std::move(tried.fit));
    }
    return made;
  }
  static const Made& made() {
    static const Made once = make();
    return once;
  }

  static inline const SearchContext kContext{};
  ModelChain chain_ = made().chain;
};

TEST_F(ChainOfTwo, HasAModelForEachEffectAndTheDeclaredOne) {
  const std::vector<FittedModel> models = chain_.models();
  ASSERT_EQ(models.size(), 3u);
  EXPECT_EQ(models[0].added, "");
  EXPECT_EQ(models[1].added, "coulomb_friction");
  EXPECT_EQ(models[2].added, "stroke_spring");
  EXPECT_EQ(chain_.current().job.free.size(), 4u);
  EXPECT_TRUE(chain_.explained());
  EXPECT_FALSE(explains(chain_.declared()));
}

TEST_F(ChainOfTwo, FitsWithoutAnEffectOnce) {
  const FittedModel& reduced = chain_.without(0);
  EXPECT_EQ(reduced.job.free.size(), 3u);
  EXPECT_GT(reduced.fit.reduced_chi_square, 2.0 * chain_.current().fit.reduced_chi_square);
  EXPECT_EQ(&chain_.without(0), &reduced);
  // By itself and side by side.
  ModelChain other = made().chain;
  other.fit_without({0, 1});
  EXPECT_EQ(values_of(other.without(0).fit), values_of(reduced.fit));
}

TEST_F(ChainOfTwo, IsFarWithoutWhatItNeeds) {
  EXPECT_TRUE(chain_.is_far_without(0));
  EXPECT_TRUE(chain_.is_far_without(1));
  const FittedModel& now = chain_.current();
  const std::vector<Hypothesis> all = catalogue(now.job, scales());
  const Hypothesis& drag = *find(all, "quadratic_drag");
  Tried tried = try_hypothesis(
      now.job, {std::make_shared<const Hypothesis>(drag), {{1.0}, {}}, values_of(now.fit)});
  chain_.append({drag}, std::move(tried.job), std::move(tried.fit));
  EXPECT_TRUE(chain_.is_far_without(0));
  EXPECT_FALSE(chain_.is_far_without(2)) << "it explains nothing";
}

TEST_F(ChainOfTwo, ForgetsWhatWasBesideAnotherModel) {
  const double before = chain_.without(1).fit.reduced_chi_square;
  FittedModel reduced = chain_.without(0);
  EXPECT_TRUE(chain_.erase(0).empty());
  chain_.set_last(std::move(reduced));
  ASSERT_EQ(chain_.accepted().size(), 1u);
  EXPECT_EQ(chain_.accepted()[0].hypothesis.name, "stroke_spring");
  EXPECT_EQ(chain_.current().added, "stroke_spring");
  // Without the only effect it is the declared model.
  EXPECT_EQ(values_of(chain_.without(0).fit), values_of(chain_.declared().fit));
  EXPECT_NE(chain_.without(0).fit.reduced_chi_square, before);
}

TEST_F(ChainOfTwo, HasTheModelBeforeEachEffect) {
  EXPECT_EQ(values_of(chain_.before(0).fit), values_of(chain_.declared().fit));
  const FittedModel known = chain_.before(1);
  EXPECT_EQ(known.added, "coulomb_friction");
  EXPECT_EQ(known.job.free.size(), 3u);
  chain_.set_last(chain_.current());
  const FittedModel refitted = chain_.before(1);
  EXPECT_EQ(refitted.added, "coulomb_friction");
  EXPECT_NEAR(refitted.fit.reduced_chi_square, known.fit.reduced_chi_square,
              1e-3 * known.fit.reduced_chi_square);
}

TEST_F(ChainOfTwo, RefitsTheModelsBetweenWhereOneWasExchanged) {
  chain_.set_last(chain_.current());
  const std::vector<FittedModel> models = chain_.models();
  ASSERT_EQ(models.size(), 3u);
  EXPECT_EQ(models[1].added, "coulomb_friction");
  EXPECT_EQ(models[1].job.free.size(), 3u);
  EXPECT_TRUE(models[1].fit.is_usable());
}

TEST_F(ChainOfTwo, BeginsAnewWithTheDeclaredModelAlone) {
  chain_.restart(made().declared);
  EXPECT_TRUE(chain_.accepted().empty());
  EXPECT_EQ(chain_.models().size(), 1u);
  EXPECT_EQ(chain_.current().job.free.size(), 2u);
}

TEST_F(ChainOfTwo, IsFittedToTheOtherRecordingOnce) {
  EXPECT_FALSE(chain_.has_elsewhere());
  ASSERT_TRUE(chain_.elsewhere());
  EXPECT_TRUE(chain_.has_elsewhere());
  const ParameterResult& here = chain_.current().fit.parameters[2];
  const ParameterResult& there = chain_.elsewhere()->parameters[2];
  EXPECT_NE(here.value, there.value);
  EXPECT_NEAR(here.value, there.value, 4.0 * there.uncertainty.standard_error);
}

TEST_F(ChainOfTwo, RefitsItsEffectsFreelyWhereItTracks) {
  const FittedModel& declared = made().declared;
  ModelChain tracked(tracking(declared, search_gain(declared.job), kContext), kContext);
  tracked.set_free(declared.job);
  const FittedModel& now = tracked.current();
  Tried tried = try_hypothesis(
      now.job,
      {std::make_shared<const Hypothesis>(made().friction), {{4.0}, {}}, values_of(now.fit)});
  tracked.append({made().friction}, std::move(tried.job), std::move(tried.fit));
  EXPECT_FALSE(tracked.explained()) << "without the spring";
  EXPECT_GT(tracked.current().fit.observer_gain, 0.0);
  EXPECT_EQ(tracked.free_run().fit.observer_gain, 0.0);
  EXPECT_EQ(tracked.free_run().job.free.size(), 3u);
}

/// A slide that the motor moves through the paper's gear.
Model<double> geared_slide() {
  Model<double> model = free_gear();
  model.axis.b_g = 1500.0;
  model.axis.K_f = 40.0;
  model.axis.M = 20.0;
  model.axis.B_a = 30.0;
  return model;
}

// Noise of the readings drives a simulation that tracks, and is no missing effect. Here readings
// whose noise is larger than stated stand for it.
TEST(Explained, IsWhatTheFreeRunExplainsWhereAModelTracks) {
  const SearchContext context;
  Model<double> truth = geared_slide();
  add_effect<StrokeSpring>(truth).k_s = 15.0;
  const Job job = two_recordings(truth, geared_slide(), {"M", "B_a"});
  FittedModel declared{"", job, estimate(job)};
  for (Recording& r : declared.job.recordings)
    for (Measurement& m : r.measurements) m.sigma *= 0.9;
  ModelChain tracked(tracking(declared, search_gain(job), context), context);
  ModelChain asks = tracked;
  asks.set_free(job);
  const std::vector<Hypothesis> all = catalogue(job, scales());
  const Hypothesis& spring = *find(all, "stroke_spring");
  for (ModelChain* chain : {&tracked, &asks}) {
    EXPECT_FALSE(chain->explained());
    const FittedModel& now = chain->current();
    Tried tried = try_hypothesis(
        now.job, {std::make_shared<const Hypothesis>(spring), {{10.0}, {}}, values_of(now.fit)},
        context);
    chain->append({spring}, std::move(tried.job), std::move(tried.fit));
  }
  EXPECT_FALSE(tracked.explained());
  EXPECT_TRUE(asks.explained());
}

// A fit that a bound stopped too early leaves more than noise.
TEST(Settled, IsExactNearTheNoiseAlone) {
  const Job job = two_recordings(geared_slide(), geared_slide(), {"M", "B_a"});
  const double exact = values_of(estimate(job)).front();
  const auto settled_from = [&](double least) {
    Job early = job;
    early.free.front().lower = early.free.front().initial = least;
    FittedModel model{"", job, estimate(early)};
    EXPECT_TRUE(model.fit.is_usable() && !explains(model)) << least;
    return settled(std::move(model), {}).fit.parameters.front().value;
  };
  EXPECT_NEAR(settled_from(20.1), exact, 1e-3);
  EXPECT_EQ(settled_from(40.0), 40.0);
}

/// A geared slide whose fitted recording says little of it, and that is rather sure of the wrong
/// viscous friction.
FittedModel wrong_slide(const Model<double>& truth) {
  Job job = two_recordings(truth, geared_slide(), {"M", "B_a"});
  for (Measurement& m : job.recordings.front().measurements) m.sigma *= 100.0;
  job.free.front().prior = Prior{20.0, 0.1};
  job.free.back().prior = Prior{36.0, 1.7};
  return {"", job, estimate(job)};
}

TEST(Explained, IsWhatAFitToAllRecordingsExplains) {
  const SearchContext context;
  const FittedModel wrong = wrong_slide(geared_slide());
  EXPECT_FALSE(explains(wrong));
  EXPECT_TRUE(ModelChain(wrong, context).explained());
  Model<double> truth = geared_slide();
  add_effect<StrokeSpring>(truth).k_s = 15.0;
  EXPECT_FALSE(ModelChain(wrong_slide(truth), context).explained());
}

}  // namespace
}  // namespace axisfit
