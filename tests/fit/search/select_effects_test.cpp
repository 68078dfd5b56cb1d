#include <gtest/gtest.h>

#include <cmath>

#include "fit/criterion/gains.h"
#include "fit/design/discrimination.h"
#include "fit/estimate/horizon.h"
#include "fit/search/rival_models.h"
#include "tests/fit/search/selection.h"

namespace axisfit {
namespace {

using Names = std::set<std::string>;

class OneUndeclaredEffect : public testing::TestWithParam<HiddenEffect> {};

TEST_P(OneUndeclaredEffect, IsAcceptedAlone) {
  const HiddenEffect& secret = GetParam();
  const EffectSelection selection = close(secret.job());
  EXPECT_EQ(accepted(selection), Names{secret.name});
  EXPECT_EQ(selection.verdict.kind, SelectionVerdict::Kind::effects_accepted);
  EXPECT_EQ(selection.verdict.accepted, std::vector<std::string>{secret.name});
  EXPECT_TRUE(selection.verdict.undecided.empty());
  EXPECT_GT(selection.verdict.validate_percent, 0.0);
  EXPECT_EQ(undecided(selection), Names{});
  EXPECT_TRUE(selection.explained);
  EXPECT_FALSE(selection.held_out_blocks);
  ASSERT_EQ(selection.models.size(), 2u);
  EXPECT_EQ(selection.models[0].added, "");
  EXPECT_EQ(selection.models[1].added, secret.name);
  EXPECT_TRUE(selection.result.fit.is_usable());
  EXPECT_LT(selection.result.fit.reduced_chi_square, 1.1);
  for (const auto& list : {secret.strengths, secret.shapes})
    for (const auto& [name, value] : list) expect_found(selection, name, value);
  Model<double> declared = secret.declared();
  for (const char* name : secret.free)
    expect_found(selection, name, *members(declared)[quantity_index(name)]);
}

INSTANTIATE_TEST_SUITE_P(EverySlot, OneUndeclaredEffect, testing::ValuesIn(hidden_effects(false)),
                         [](const auto& one) { return one.param.label(); });

class SelectEffectsTwin : public testing::TestWithParam<HiddenEffect> {};

TEST_P(SelectEffectsTwin, IsLeftUndecided) {
  const HiddenEffect& secret = GetParam();
  Job job = secret.job();
  job.limits = {-0.5, 0.5, 1.0, 10.0};
  EffectSelection selection = close(job);
  EXPECT_EQ(undecided(selection), (Names{secret.name, secret.twin}));
  EXPECT_EQ(selection.verdict.kind, SelectionVerdict::Kind::undecided);
  for (const Outcome& trial : selection.effects)
    if (trial.decision() == Decision::undecided) {
      EXPECT_EQ(trial.reason, Reason::explains_equally);
      EXPECT_EQ(trial.other, trial.hypothesis.name == secret.name ? secret.twin : secret.name);
    }
  EXPECT_EQ(accepted(selection), Names{});
  EXPECT_TRUE(selection.verdict.accepted.empty());
  EXPECT_TRUE(selection.explained);
  ASSERT_EQ(selection.substitutions.size(), 1u);
  EXPECT_EQ((Names{selection.substitutions[0].chosen, selection.substitutions[0].rival}),
            (Names{secret.name, secret.twin}));
  const Discrimination advice = discriminate(selection, selection.substitutions[0], true);
  EXPECT_EQ((Names{advice.chosen, advice.rival}), (Names{secret.name, secret.twin}));
  EXPECT_EQ(advice.signal.has_value(), advice.size >= 0.1);
  // One of them is in the model, for without either the other estimates would pay for it.
  ASSERT_EQ(selection.models.size(), 2u);
  EXPECT_EQ(selection.models[1].added, advice.chosen);
  EXPECT_TRUE(trial_of(selection, advice.chosen)->in_model);
  EXPECT_FALSE(trial_of(selection, advice.rival)->in_model);
  // And they hold the truth, whichever it is.
  const FittedModel& last = selection.result;
  const auto shifts = rival_errors(last.job, last.fit.parameters, rival_models(selection));
  Model<double> declared = secret.declared();
  for (std::size_t i = 0; i < shifts.size(); ++i)
    for (const char* name : secret.free) {
      const ParameterResult& p = last.fit.parameters[i];
      if (p.id != id_of(name)) continue;
      ErrorBudget budget = p.budget;
      budget.rival = shifts[i];
      const ParameterUncertainty known = combined(budget, p.value, last.job.free[i]);
      EXPECT_LT(known.lower, *members(declared)[quantity_index(name)]) << name;
      EXPECT_GT(known.upper, *members(declared)[quantity_index(name)]) << name;
    }
}

INSTANTIATE_TEST_SUITE_P(EverySlot, SelectEffectsTwin, testing::ValuesIn(hidden_effects(true)),
                         [](const auto& one) { return one.param.label(); });

// Without either, every estimate would pay for the clock.
TEST(SelectEffects, AddsOneOfTwoClocksThatMayBeOffAndNamesTheOther) {
  Model<double> truth = slide();
  truth.axis.T_d = 4e-3;
  const EffectSelection selection =
      close(two_recordings(truth, slide(), {"M", "B_a"}, 6.0, {Signal::velocity}));
  EXPECT_EQ(accepted(selection), Names{"dead_time"});
  EXPECT_EQ(undecided(selection), Names{});
  EXPECT_TRUE(selection.explained);
  ASSERT_EQ(selection.substitutions.size(), 1u);
  EXPECT_EQ(selection.substitutions[0].chosen, "dead_time");
  EXPECT_EQ(selection.substitutions[0].rival, "velocity.delay");
  const auto rival = std::ranges::find(selection.effects, "velocity.delay",
                                       [](const Outcome& t) { return t.hypothesis.name; });
  ASSERT_NE(rival, selection.effects.end());
  EXPECT_EQ(rival->decision(), Decision::rejected);
  EXPECT_EQ(rival->reason, Reason::is_equal_delay);
  EXPECT_EQ(rival->other, "dead_time");
  expect_found(selection, "T_d", 4e-3);
}

TEST(SelectEffects, AddsNothingToAModelThatHasEverything) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const EffectSelection selection = close(two_recordings(
        slide(), slide(), {"M", "B_a"}, 6.0, {Signal::velocity, Signal::acceleration}, seed));
    EXPECT_EQ(accepted(selection), Names{}) << seed;
    EXPECT_EQ(undecided(selection), Names{}) << seed;
    EXPECT_TRUE(selection.explained);
    EXPECT_EQ(selection.models.size(), 1u);
    EXPECT_EQ(selection.verdict.kind, SelectionVerdict::Kind::nothing_missing);
  }
}

// The search tracks, and what it found is fitted as the job asks for.
TEST(SelectEffects, FindsEffectsForAFitInWindows) {
  const HiddenEffect secret = hidden_effect_named("stroke_spring");
  Job job = secret.job();
  job.options.criterion = Windows{0.5};
  const FitResult first = estimate(job);
  const EffectSelection selection = select_effects(job, first);
  EXPECT_EQ(accepted(selection), Names{secret.name});
  EXPECT_TRUE(selection.explained);
  ASSERT_EQ(selection.models.size(), 2u);
  EXPECT_EQ(values_of(selection.models.front().fit), values_of(first));
  for (const FittedModel& model : selection.models) {
    EXPECT_EQ(model.job.options.criterion, job.options.criterion);
    EXPECT_TRUE(model.job.options.is_continued());
  }
  for (const auto& [name, value] : secret.strengths) expect_found(selection, name, value);
  EXPECT_EQ(selection.result.fit.observer_gain, 0.0);
}

// One that predicts one step ahead follows the noise of the velocity, and would see nothing.
TEST(SelectEffects, SeesWhatAHorizonThatWasChosenHides) {
  Model<double> truth = slide();
  add_effect<ConstantForce>(truth).F_0 = 1.0;
  Job job = two_recordings(truth, slide(), {"M", "B_a"}, 6.0, {Signal::velocity});
  job.options.criterion = Tracking{highest_gain(job)};
  const FitResult first = estimate(job);
  const EffectSelection as_given = select_effects(job, first);
  EXPECT_EQ(accepted(as_given), Names{});
  EXPECT_FALSE(as_given.horizon);

  job.choose_criterion = true;
  const EffectSelection selection = select_effects(job, first);
  EXPECT_EQ(accepted(selection), Names{"constant_force"});
  expect_found(selection, "constant_force.F_0", 1.0);
  // With the effect another horizon may be best: all models are fitted by that.
  ASSERT_TRUE(selection.horizon);
  ASSERT_EQ(selection.models.size(), 2u);
  for (const FittedModel& model : selection.models) {
    EXPECT_EQ(model.job.options.criterion, selection.horizon->best().criterion);
    EXPECT_TRUE(model.job.choose_criterion);
  }
}

// A free run is off by millimetres, whatever the model: what the noise of the force adds up to.
TEST(SelectEffects, SeesWhatNoiseOfTheInputHidesFromAFreeRun) {
  Model<double> truth = slide();
  add_effect<CoulombFriction>(truth).F_c = 8.0;
  Job job = two_recordings(truth, slide(), {"M", "B_a"}, 6.0, {Signal::position});
  add_input_noise(job, 0.1);
  const FitResult first = estimate(job);
  ASSERT_GT(first.reduced_chi_square, 100.0);
  const EffectSelection selection = select_effects(job, first);
  EXPECT_EQ(accepted(selection), Names{"coulomb_friction"});
  expect_found(selection, "coulomb_friction.F_c", 8.0);
  // With the effect, too, the free run would be off by as much.
  EXPECT_TRUE(tracks(selection.result.job.options.criterion));
  EXPECT_GT(selection.result.fit.observer_gain, 0.0);
  EXPECT_TRUE(selection.explained);
}

TEST(SelectEffects, FitsAllSamplesInWindowsWhereBlocksWereHeldOut) {
  Job job = hidden_effect_named("stroke_spring").job();
  job.recordings.resize(1);
  job.options.criterion = Windows{0.5};
  const EffectSelection selection = select_effects(job, estimate(job));
  ASSERT_TRUE(selection.held_out_blocks);
  ASSERT_EQ(selection.models.size(), 2u);
  for (const FittedModel& model : selection.models)
    EXPECT_FALSE(model.job.recordings[0].held_out.empty());
  EXPECT_TRUE(selection.result.job.recordings[0].held_out.empty());
  EXPECT_GT(selection.result.fit.degrees_of_freedom,
            selection.models.back().fit.degrees_of_freedom);
  EXPECT_GT(selection.verdict.validate_percent, 10.0);
}

// The acceptance test, and not only the size of the residual, keeps effects out.
TEST(SelectEffects, AddsNothingForNoiseThatIsLargerThanStated) {
  Job job = two_recordings(slide(), slide(), {"M", "B_a"});
  for (Recording& r : job.recordings)
    for (Measurement& m : r.measurements) m.sigma *= 0.7;
  const EffectSelection selection = close(job);
  EXPECT_EQ(accepted(selection), Names{});
  EXPECT_EQ(selection.verdict.kind, SelectionVerdict::Kind::none_passes);
  EXPECT_EQ(undecided(selection), Names{});
  EXPECT_FALSE(selection.explained);
  EXPECT_FALSE(selection.effects.empty());
  for (const Outcome& trial : selection.effects) {
    EXPECT_EQ(trial.reason, Reason::failed_test) << trial.hypothesis.name;
    EXPECT_TRUE(trial.rejection.has_value()) << trial.hypothesis.name;
  }
}

// A mass that may not be as large as it is: what is left looks like this effect or that.
TEST(SelectEffects, SaysNothingOfEffectsWhileADeclaredParameterIsAtItsBound) {
  const Model<double> truth = slide();
  Job job = two_recordings(truth, truth, {"M", "B_a"}, 6.0, {Signal::velocity});
  FreeParameter& mass = job.free.front();
  mass.upper = 0.8 * truth.axis.M;
  mass.lower = 0.1 * truth.axis.M;
  mass.initial = 0.5 * truth.axis.M;
  const EffectSelection selection = close(job);
  EXPECT_FALSE(selection.explained);
  EXPECT_EQ(selection.verdict.kind, SelectionVerdict::Kind::misfit);
  EXPECT_EQ(selection.verdict.at_bound, id_of("M"));
  EXPECT_EQ(accepted(selection), Names{});
  EXPECT_EQ(selection.models.size(), 1u);
  EXPECT_FALSE(selection.effects.empty());
}

TEST(SelectEffects, HoldsOutBlocksWhereThereIsNothingToValidate) {
  const HiddenEffect secret = hidden_effect_named("coulomb_friction");
  Job job = secret.job();
  job.recordings.pop_back();
  const EffectSelection selection = close(job);
  EXPECT_TRUE(selection.held_out_blocks);
  EXPECT_EQ(accepted(selection), Names{secret.name});
  EXPECT_TRUE(selection.explained);
  // The blocks are for the judgement only: the result is that of all samples.
  EXPECT_TRUE(selection.result.job.recordings[0].held_out.empty());
  Job declared =
      two_recordings(secret.truth(), secret.truth(), {"M", "B_a", "coulomb_friction.F_c"});
  declared.recordings.pop_back();
  const FitResult fit = estimate(declared);
  ASSERT_EQ(selection.result.fit.parameters.size(), fit.parameters.size());
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const ParameterResult &a = fit.parameters[i], &b = selection.result.fit.parameters[i];
    EXPECT_NEAR(a.value, b.value, 0.05 * a.uncertainty.standard_error) << name_of(a.id);
    EXPECT_NEAR(a.uncertainty.standard_error, b.uncertainty.standard_error,
                0.01 * a.uncertainty.standard_error);
  }
}

TEST(SelectEffects, FindsTwoEffects) {
  Model<double> truth = slide();
  hidden_effect_named("coulomb_friction").put_into(truth);
  hidden_effect_named("stroke_spring").put_into(truth);
  const EffectSelection selection = close(two_recordings(truth, slide(), {"M", "B_a"}));
  EXPECT_EQ(accepted(selection), (Names{"coulomb_friction", "stroke_spring"}));
  EXPECT_TRUE(selection.explained);
  ASSERT_EQ(selection.models.size(), 3u);
  EXPECT_LT(selection.models[1].fit.reduced_chi_square, selection.models[0].fit.reduced_chi_square);
  EXPECT_LT(selection.models[2].fit.reduced_chi_square, selection.models[1].fit.reduced_chi_square);
  expect_found(selection, "coulomb_friction.F_c", 5.0);
  expect_found(selection, "stroke_spring.k_s", 20.0);
  expect_found(selection, "B_a", 30.0);
}

/// While the friction is yet to be found, weight on a joint is a spring, which has a parameter
/// less.
Job weight_beside_friction(double friction, double volts) {
  Model<double> truth = slide();
  add_effect<CoulombFriction>(truth).F_c = friction;
  add_effect<PendulumGravity>(truth).G_s = 80.0;
  return two_recordings(truth, slide(), {"M", "B_a"}, volts);
}

TEST(SelectEffects, ExchangesASimpleEffectForOneThatLaterProvesBetter) {
  const EffectSelection selection = close(weight_beside_friction(80.0, 9.0));
  EXPECT_EQ(accepted(selection), (Names{"coulomb_friction", "pendulum_gravity"}));
  EXPECT_EQ(undecided(selection), Names{});
  EXPECT_TRUE(selection.explained);
  expect_found(selection, "pendulum_gravity.G_s", 80.0);
}

// It explains more than its parameter costs, and not clearly more: what leaves nothing but noise
// needs no other.
TEST(SelectEffects, NamesWhatMayBeBehindASimpleEffectThatLeavesMoreThanNoise) {
  Job job = weight_beside_friction(60.0, 7.0);
  const EffectSelection explained = close(job);
  EXPECT_TRUE(explained.explained);
  EXPECT_EQ(accepted(explained), (Names{"coulomb_friction", "stroke_spring"}));
  for (Recording& r : job.recordings)
    for (Measurement& m : r.measurements) m.sigma *= 0.7;
  const EffectSelection unexplained = close(job);
  EXPECT_FALSE(unexplained.explained);
  EXPECT_EQ(accepted(unexplained), Names{"coulomb_friction"});
  EXPECT_EQ(undecided(unexplained), (Names{"stroke_spring", "pendulum_gravity"}));
}

TEST(SelectEffects, AddsNoMoreThanIsAllowed) {
  const Job job = hidden_effect_named("coulomb_friction").job();
  SearchOptions options;
  options.max_effects = 0;
  const EffectSelection selection = select_effects(job, estimate(job), options);
  EXPECT_EQ(accepted(selection), Names{});
  EXPECT_FALSE(selection.explained);
}

// As a limit of time does, which leaves a part of itself for that.
TEST(SelectEffects, JudgesWhatItHasWhenTheSearchIsToEnd) {
  const Job job = hidden_effect_named("drive_lag").job();
  const StopFlag stop;
  StopFlag search_over(&stop);
  int scored = 0;
  bool is_reviewed = false;
  const auto watch = [&](const Progress& p) {
    if (p.phase == "scoring effects" && ++scored == 2) search_over.set();
    is_reviewed = is_reviewed || p.phase == "is drive_lag necessary?";
  };
  const EffectSelection selection =
      select_effects(job, estimate(job), {}, {&stop, nullptr, watch, &search_over});
  EXPECT_TRUE(selection.cut_short);
  EXPECT_FALSE(selection.interrupted);
  EXPECT_TRUE(is_reviewed);
  EXPECT_EQ(accepted(selection), Names{"drive_lag"});
}

TEST(SelectEffects, KeepsWhatIsAcceptedWhenItIsStopped) {
  const Job job = hidden_effect_named("drive_lag").job();
  const FitResult fit = estimate(job);
  // After the first effect, or else at once.
  for (const bool late : {true, false}) {
    StopFlag stop;
    if (!late) stop.set();
    int phases = 0;
    const EffectSelection selection =
        select_effects(job, fit, {}, {&stop, nullptr, [&](const Progress& p) {
                                        if (p.phase == "scoring effects") ++phases;
                                        if (p.phase == "is drive_lag necessary?" || phases > 1)
                                          stop.set();
                                      }});
    EXPECT_EQ(selection.interrupted, stop.is_set());
    EXPECT_EQ(accepted(selection), late ? Names{"drive_lag"} : Names{});
    EXPECT_TRUE(selection.result.fit.is_usable());
    EXPECT_EQ(selection.verdict.kind,
              late ? SelectionVerdict::Kind::effects_accepted : SelectionVerdict::Kind::stopped);
  }
}

TEST(SelectEffects, IsTheSameForAnyNumberOfThreads) {
  Job job = hidden_effect_named("drive_lag").job();
  const FitResult fit = estimate(job);
  job.options.threads = 1;
  const EffectSelection one = select_effects(job, fit);
  job.options.threads = 2;
  const EffectSelection two = select_effects(job, fit);
  EXPECT_EQ(one.verdict, two.verdict);
  EXPECT_EQ(one.substitutions.size(), two.substitutions.size());
  ASSERT_EQ(one.effects.size(), two.effects.size());
  for (std::size_t i = 0; i < one.effects.size(); ++i) {
    const Outcome &a = one.effects[i], &b = two.effects[i];
    EXPECT_EQ(a.hypothesis.name, b.hypothesis.name);
    EXPECT_EQ(a.decision(), b.decision());
    EXPECT_EQ(a.reason, b.reason);
    EXPECT_EQ(a.rejection, b.rejection);
    EXPECT_EQ(a.other, b.other);
    EXPECT_EQ(a.score, b.score);
    EXPECT_EQ(a.improvement.fit_gain, b.improvement.fit_gain);
    EXPECT_EQ(a.improvement.z, b.improvement.z);
  }
  EXPECT_EQ(values_of(one.result.fit), values_of(two.result.fit));
}

TEST(SelectEffects, TellsWhatItDoes) {
  const Job job = hidden_effect_named("coulomb_friction").job();
  std::set<std::string> phases;
  std::vector<double> best;
  select_effects(job, estimate(job), {}, {nullptr, nullptr, [&](const Progress& p) {
                                            EXPECT_LE(p.done, p.of);
                                            best.push_back(p.best);
                                            phases.insert(p.phase);
                                          }});
  EXPECT_TRUE(phases.contains("scoring effects"));
  EXPECT_TRUE(phases.contains("trying coulomb_friction"));
  EXPECT_GT(best.front(), 2.0 * best.back());  // of the model so far
}

TEST(SelectEffects, NeedsAUsableFit) {
  const Job job = hidden_effect_named("coulomb_friction").job();
  FitResult fit = estimate(job);
  fit.verdict.kind = FitVerdict::Kind::signal_not_followed;
  const EffectSelection selection = select_effects(job, fit);
  EXPECT_TRUE(selection.effects.empty());
  EXPECT_FALSE(selection.explained);
  EXPECT_EQ(selection.models.size(), 1u);
  EXPECT_EQ(selection.verdict.kind, SelectionVerdict::Kind::no_usable_fit);
}

// What the model lacks may leave it without a minimum: then all the more is to be found.
TEST(SelectEffects, IsNotBlindedByAModelWithoutAMinimum) {
  const Job job = hidden_effect_named("coulomb_friction").job();
  FitResult fit = estimate(job);
  fit.verdict.kind = FitVerdict::Kind::no_minimum;
  const EffectSelection selection = select_effects(job, fit);
  EXPECT_EQ(accepted(selection), Names{"coulomb_friction"});
  EXPECT_TRUE(selection.explained);
  EXPECT_TRUE(selection.result.fit.is_usable());
  EXPECT_FALSE(tracks(selection.result.job.options.criterion)) << "the job asks for a free run";
}

// The size of the residual is that of the noise, but its shape is not.
TEST(SelectEffects, FindsWhatHidesInTheNoise) {
  HiddenEffect friction = hidden_effect_named("coulomb_friction");
  friction.strengths[0].second = 0.3;
  const Job job = friction.job();
  const FitResult fit = estimate(job);
  EXPECT_LT(fit.reduced_chi_square, 1.05);
  const EffectSelection selection = select_effects(job, fit);
  EXPECT_EQ(accepted(selection), std::set<std::string>{"coulomb_friction"});
}

/// Of two effects that a job lacks one alone leaves most of the error.
Job two_hidden_effects(double friction = 5.0, const std::string& of_instrument = "velocity.gain") {
  Model<double> truth = slide();
  HiddenEffect coulomb = hidden_effect_named("coulomb_friction");
  coulomb.strengths[0].second = friction;
  coulomb.put_into(truth);
  hidden_effect_named(of_instrument).put_into(truth);
  return two_recordings(truth, slide(), {"M", "B_a"});
}

EffectSelection select_one_effect(const Job& job) {
  SearchOptions options;
  options.max_effects = 1;
  return select_effects(job, estimate(job), options);
}

// A flexible effect that is not there would lower the error as much.
TEST(SelectEffects, NamesNothingWhereMostRemains) {
  Job job = two_hidden_effects();
  std::erase_if(job.recordings, [](const Recording& r) { return r.role == Role::validate; });
  const EffectSelection one = select_one_effect(job);
  EXPECT_TRUE(accepted(one).empty());
  const Outcome* friction = trial_of(one, "coulomb_friction");
  ASSERT_NE(friction, nullptr);
  ASSERT_TRUE(friction->rejection);
  EXPECT_EQ(friction->rejection->test, Rejection::Test::share);
  EXPECT_GT(friction->rejection->found, 25.0);
  EXPECT_LT(friction->rejection->found, 50.0);
  EXPECT_EQ(one.result.job.free.size(), job.free.size());
}

// What the machine lacks looks like an instrument that errs, in all recordings alike.
TEST(SelectEffects, NamesNoInstrumentWhereMostRemains) {
  const EffectSelection one = select_one_effect(two_hidden_effects(1.6, "acceleration.bias"));
  EXPECT_TRUE(accepted(one).empty());
  const Outcome* bias = trial_of(one, "acceleration.bias");
  ASSERT_NE(bias, nullptr);
  ASSERT_TRUE(bias->rejection);
  EXPECT_EQ(bias->rejection->test, Rejection::Test::share);
}

TEST(SelectEffects, NamesWhatTwoRecordingsTellAlikeThoughMostRemains) {
  const EffectSelection one = select_one_effect(two_hidden_effects());
  EXPECT_EQ(accepted(one), std::set<std::string>{"coulomb_friction"});
  EXPECT_LT(one.effects.front().improvement.missing_percent, 50.0);
  ASSERT_TRUE(one.effects.front().replication);
  EXPECT_TRUE(one.effects.front().replication->is_alike);
  EXPECT_FALSE(one.explained);
}

}  // namespace
}  // namespace axisfit
