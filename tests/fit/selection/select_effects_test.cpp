#include <gtest/gtest.h>

#include <cmath>

#include "fit/design/discrimination.h"
#include "tests/fit/selection/selection.h"
namespace axisfit {
namespace {

using Names = std::set<std::string>;

class OneUndeclaredEffect : public testing::TestWithParam<Secret> {};

TEST_P(OneUndeclaredEffect, IsAcceptedAlone) {
  const Secret& secret = GetParam();
  const ClosedLoop loop = close(secret.job());
  EXPECT_EQ(accepted(loop), Names{secret.name}) << loop.verdict;
  EXPECT_EQ(undecided(loop), Names{});
  EXPECT_TRUE(loop.explained);
  EXPECT_FALSE(loop.held_out_blocks);
  ASSERT_EQ(loop.models.size(), 2u);
  EXPECT_EQ(loop.models[0].added, "");
  EXPECT_EQ(loop.models[1].added, secret.name);
  EXPECT_TRUE(loop.result.fit.usable);
  EXPECT_LT(loop.result.fit.reduced_chi_square, 1.1);
  for (const auto& list : {secret.strengths, secret.shapes})
    for (const auto& [name, value] : list) expect_found(loop, name, value);
  Model<double> declared = secret.declared();
  for (const char* name : secret.free)
    expect_found(loop, name, *members(declared)[find_quantity(name)->index]);
}

INSTANTIATE_TEST_SUITE_P(EverySlot, OneUndeclaredEffect, testing::ValuesIn(secrets(false)),
                         [](const auto& one) { return one.param.label(); });

class AnEffectWithATwin : public testing::TestWithParam<Secret> {};

TEST_P(AnEffectWithATwin, IsLeftUndecided) {
  const Secret& secret = GetParam();
  const ClosedLoop loop = close(secret.job());
  EXPECT_EQ(undecided(loop), (Names{secret.name, secret.twin})) << loop.verdict;
  EXPECT_EQ(accepted(loop), Names{});
  EXPECT_FALSE(loop.explained);
  ASSERT_EQ(loop.rivals.size(), 1u);
  EXPECT_EQ((Names{loop.rivals[0].chosen, loop.rivals[0].rival}),
            (Names{secret.name, secret.twin}));
  const MachineLimits limits{-0.5, 0.5, 1.0, 10.0};
  const Separation advice = what_separates(loop, loop.rivals[0], ControllerSettings(), limits);
  EXPECT_NE(advice.words.find(secret.name), std::string::npos);
  EXPECT_NE(advice.words.find(secret.twin), std::string::npos);
  EXPECT_EQ(advice.signal.has_value(), advice.size >= 0.1) << advice.words;
  // Neither is added: the result is the model as declared.
  ASSERT_EQ(loop.models.size(), 1u);
  EXPECT_EQ(loop.result.job.free.size(), secret.free.size());
}

INSTANTIATE_TEST_SUITE_P(EverySlot, AnEffectWithATwin, testing::ValuesIn(secrets(true)),
                         [](const auto& one) { return one.param.label(); });

TEST(CloseLoop, AddsNothingToAModelThatHasEverything) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const ClosedLoop loop = close(two_recordings(slide(), slide(), {"M", "B_a"}, 6.0,
                                                 {Signal::velocity, Signal::acceleration}, seed));
    EXPECT_EQ(accepted(loop), Names{}) << seed;
    EXPECT_EQ(undecided(loop), Names{}) << seed;
    EXPECT_TRUE(loop.explained);
    EXPECT_EQ(loop.models.size(), 1u);
    EXPECT_EQ(loop.verdict.find("Nothing is missing"), 0u) << loop.verdict;
  }
}

// The gate, and not only the size of the residual, keeps effects out.
TEST(CloseLoop, AddsNothingForNoiseThatIsLargerThanStated) {
  Job job = two_recordings(slide(), slide(), {"M", "B_a"});
  for (Recording& r : job.recordings)
    for (Measurement& m : r.measurements) m.sigma *= 0.7;
  const ClosedLoop loop = close(job);
  EXPECT_EQ(accepted(loop), Names{}) << loop.verdict;
  EXPECT_EQ(undecided(loop), Names{});
  EXPECT_FALSE(loop.explained);
  EXPECT_FALSE(loop.effects.empty());
  for (const EffectTrial& trial : loop.effects) EXPECT_FALSE(trial.reason.empty());
}

TEST(CloseLoop, HoldsOutBlocksWhereThereIsNothingToValidate) {
  const Secret secret = secret_named("coulomb_friction");
  Job job = secret.job();
  job.recordings.pop_back();
  const ClosedLoop loop = close(job);
  EXPECT_TRUE(loop.held_out_blocks);
  EXPECT_EQ(accepted(loop), Names{secret.name});
  EXPECT_TRUE(loop.explained);
  // The blocks are for the judgement only: the result is that of all samples.
  EXPECT_TRUE(loop.result.job.recordings[0].held_out.empty());
  Job declared =
      two_recordings(secret.truth(), secret.truth(), {"M", "B_a", "coulomb_friction.F_c"});
  declared.recordings.pop_back();
  const FitResult fit = estimate(declared);
  ASSERT_EQ(loop.result.fit.parameters.size(), fit.parameters.size());
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const ParameterResult &a = fit.parameters[i], &b = loop.result.fit.parameters[i];
    EXPECT_NEAR(a.value, b.value, 0.05 * a.uncertainty.standard_error) << a.name;
    EXPECT_NEAR(a.uncertainty.standard_error, b.uncertainty.standard_error,
                0.01 * a.uncertainty.standard_error);
  }
}

TEST(CloseLoop, FindsTwoEffects) {
  Model<double> truth = slide();
  secret_named("coulomb_friction").put_into(truth);
  secret_named("added_mass").put_into(truth);
  const ClosedLoop loop = close(two_recordings(truth, slide(), {"B_a"}));
  EXPECT_EQ(accepted(loop), (Names{"coulomb_friction", "added_mass"})) << loop.verdict;
  EXPECT_TRUE(loop.explained);
  ASSERT_EQ(loop.models.size(), 3u);
  EXPECT_LT(loop.models[1].fit.reduced_chi_square, loop.models[0].fit.reduced_chi_square);
  EXPECT_LT(loop.models[2].fit.reduced_chi_square, loop.models[1].fit.reduced_chi_square);
  expect_found(loop, "coulomb_friction.F_c", 5.0);
  expect_found(loop, "added_mass.dM", 0.5);
  expect_found(loop, "B_a", 30.0);
}

TEST(CloseLoop, AddsNoMoreThanIsAllowed) {
  const Job job = secret_named("coulomb_friction").job();
  CloseLoopOptions options;
  options.max_effects = 0;
  const ClosedLoop loop = close_loop(job, estimate(job), options);
  EXPECT_EQ(accepted(loop), Names{});
  EXPECT_FALSE(loop.explained);
}

TEST(CloseLoop, KeepsWhatIsAcceptedWhenItIsStopped) {
  Job job = secret_named("drive_lag").job();
  const FitResult fit = estimate(job);
  StopFlag stop = false;
  job.options.stop = &stop;
  // After the first effect, or else at once.
  for (const bool late : {true, false}) {
    stop = !late;
    int phases = 0;
    const ClosedLoop loop = close_loop(job, fit, {}, [&](const Progress& p) {
      if (p.phase == "looking for suspects") ++phases;
      if (p.phase == "is drive_lag needed?" || phases > 1) stop = true;
    });
    EXPECT_EQ(loop.interrupted, stop.load());
    EXPECT_EQ(accepted(loop), late ? Names{"drive_lag"} : Names{});
    EXPECT_TRUE(loop.result.fit.usable);
    EXPECT_EQ(loop.verdict.find("was stopped") != std::string::npos, !late) << loop.verdict;
  }
}

TEST(CloseLoop, IsTheSameForAnyNumberOfThreads) {
  Job job = secret_named("drive_lag").job();
  const FitResult fit = estimate(job);
  job.options.threads = 1;
  const ClosedLoop one = close_loop(job, fit);
  job.options.threads = 2;
  const ClosedLoop two = close_loop(job, fit);
  EXPECT_EQ(one.verdict, two.verdict);
  EXPECT_EQ(one.rivals.size(), two.rivals.size());
  ASSERT_EQ(one.effects.size(), two.effects.size());
  for (std::size_t i = 0; i < one.effects.size(); ++i) {
    const EffectTrial &a = one.effects[i], &b = two.effects[i];
    EXPECT_EQ(a.candidate.name, b.candidate.name);
    EXPECT_EQ(a.decision, b.decision);
    EXPECT_EQ(a.reason, b.reason);
    EXPECT_EQ(a.score, b.score);
    EXPECT_EQ(a.improvement.fit_gain, b.improvement.fit_gain);
    EXPECT_EQ(a.improvement.z, b.improvement.z);
  }
  EXPECT_EQ(values_of(one.result.fit), values_of(two.result.fit));
}

TEST(CloseLoop, TellsWhatItDoes) {
  const Job job = secret_named("coulomb_friction").job();
  std::set<std::string> phases;
  std::vector<double> best;
  close_loop(job, estimate(job), {}, [&](const Progress& p) {
    EXPECT_LE(p.done, p.of);
    best.push_back(p.best);
    phases.insert(p.phase);
  });
  EXPECT_TRUE(phases.contains("looking for suspects"));
  EXPECT_TRUE(phases.contains("trying coulomb_friction"));
  EXPECT_GT(best.front(), 2.0 * best.back());  // of the model so far
}

TEST(CloseLoop, NeedsAUsableFit) {
  const Job job = secret_named("coulomb_friction").job();
  FitResult fit = estimate(job);
  fit.usable = false;
  const ClosedLoop loop = close_loop(job, fit);
  EXPECT_TRUE(loop.effects.empty());
  EXPECT_FALSE(loop.explained);
  EXPECT_EQ(loop.models.size(), 1u);
  EXPECT_NE(loop.verdict.find("not closed"), std::string::npos);
}

}  // namespace
}  // namespace axisfit
