#include "fit/search/acceptance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <iostream>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

constexpr std::size_t kSamples = 2000;

/// Residuals of one signal: white noise, and a part that follows what the model lacks.
ResidualSeries series(bool fitted, std::vector<double> values) {
  ResidualSeries s;
  s.recording = fitted ? 0 : 1;
  s.fitted = fitted;
  for (std::size_t i = 0; i < values.size(); ++i) s.samples.push_back(i);
  s.values = std::move(values);
  return s;
}

std::vector<double> noise(std::uint64_t seed) { return Normal(seed).values(kSamples); }

/// The noise of a seed with `size` times a wave added: what an effect of that size leaves.
std::vector<double> with_wave(std::vector<double> values, double size) {
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] += size * std::sin(0.02 * static_cast<double>(i));
  return values;
}

/// Neighbours alike: what carries the information of a fifth of its samples.
std::vector<double> held_for_five(std::vector<double> values) {
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = values[i - i % 5];
  return values;
}

/// A pair of series, fitted and judged.
std::vector<ResidualSeries> pair(std::vector<double> fitted, std::vector<double> judged) {
  return {series(true, std::move(fitted)), series(false, std::move(judged))};
}

Hypothesis hypothesis(std::size_t strengths = 1, std::size_t shapes = 0) {
  Hypothesis c;
  c.name = "effect";
  c.strengths.assign(strengths, quantity_index("coulomb_friction.F_c"));
  c.neutral.assign(strengths, 0.0);
  c.shapes.assign(shapes, quantity_index("stribeck_friction.v_st"));
  return c;
}

/// One whose strength stands far from zero and that nothing else imitates.
Determination determined() { return {400.0, 11.0, 0.5, {}, {}}; }

TEST(ImprovementTest, CountsInUnitsOfTheNoiseThatIsLeft) {
  // The noise along a wave is known from a band of frequencies only, and scatters.
  constexpr std::uint64_t kSeeds = 20;
  double fit_gain = 0.0, samples = 0.0, z = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const auto fitted = noise(2 * seed), judged = noise(2 * seed + 1);
    const auto before = pair(with_wave(fitted, 1.0), with_wave(judged, 1.0));
    const Improvement gain = improvement(before, pair(fitted, judged));
    EXPECT_TRUE(gain.comparable);
    fit_gain += gain.fit_gain / kSeeds;
    samples += gain.samples / kSeeds;
    z += gain.z / kSeeds;
    EXPECT_LT(gain.p_value, 1e-12);
    EXPECT_NEAR(gain.validate_percent, 100.0 * (1.0 - std::sqrt(1.0 / 1.5)), 2.5);
  }
  // The mean square of the wave is a half; n / 2, give or take the product with the noise.
  EXPECT_NEAR(fit_gain, 0.5 * kSamples, 0.1 * kSamples);
  EXPECT_NEAR(samples, kSamples, 0.1 * kSamples);
  // 2000 / 2 over the standard deviation sqrt(4 * 1000)
  EXPECT_NEAR(z, 1000.0 / std::sqrt(4000.0), 1.5);
}

// The same residual in other units of noise gains the same.
TEST(ImprovementTest, DoesNotDependOnTheStatedNoise) {
  const auto scale = [](std::vector<ResidualSeries> list) {
    for (ResidualSeries& s : list)
      for (double& x : s.values) x *= 30.0;
    return list;
  };
  const auto before = pair(with_wave(noise(1), 1.0), with_wave(noise(2), 1.0));
  const auto after = pair(noise(1), noise(2));
  const Improvement a = improvement(before, after), b = improvement(scale(before), scale(after));
  EXPECT_NEAR(a.fit_gain, b.fit_gain, 1e-9 * a.fit_gain);
  EXPECT_NEAR(a.z, b.z, 1e-9 * a.z);
  EXPECT_NEAR(a.validate_percent, b.validate_percent, 1e-9);
}

TEST(ImprovementTest, CorrelatedResidualsCountLess) {
  // The wave is slow against five samples, so that it hardly notices.
  const auto fitted = held_for_five(noise(1)), judged = held_for_five(noise(2));
  const Improvement gain =
      improvement(pair(with_wave(fitted, 1.0), with_wave(judged, 1.0)), pair(fitted, judged));
  EXPECT_NEAR(gain.samples, kSamples / 5.0, 0.25 * kSamples / 5.0);
  EXPECT_LT(gain.fit_gain, 0.3 * kSamples / 2.0);
  EXPECT_GT(gain.fit_gain, 0.08 * kSamples / 2.0);
  EXPECT_NEAR(gain.z, 1000.0 / std::sqrt(4000.0 * 5.0), 2.0);
}

/// White noise on a slow drift, with bursts in which it is five times as large: as real residuals.
std::vector<double> coloured(std::uint64_t seed) {
  Normal normal(seed);
  std::vector<double> values(kSamples);
  double drift = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    drift = 0.995 * drift + 0.3 * normal();
    values[i] = drift + (i % 200 < 10 ? 5.0 : 1.0) * normal();
  }
  return values;
}

// Slow drift that the model lacks hides no effect of another rhythm: by the autocorrelation time
// alone it would be 1.5 standard deviations.
TEST(ImprovementTest, ADriftHidesNoRipple) {
  const auto wave = [](std::vector<double> values) {
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] += 0.7 * std::sin(0.5 * static_cast<double>(i));
    return values;
  };
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto fitted = coloured(2 * seed), judged = coloured(2 * seed + 1);
    const Improvement gain = improvement(pair(wave(fitted), wave(judged)), pair(fitted, judged));
    EXPECT_LT(gain.p_value, SearchOptions().acceptance.chance) << seed;
    const double slow =
        2.0 * std::sqrt(0.5 * kSamples * 0.49 * mean_square(judged) * autocorrelation_time(judged));
    EXPECT_LT(0.5 * kSamples * 0.49 / slow, 2.5);
  }
}

// An effect that is not there, with the strength that one coloured residual gives it, and judged by
// another: waves of many lengths, and a pulse at every burst, as friction is.
TEST(ImprovementTest, ChanceHardlyEverPasses) {
  int passed = 0, trials = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const auto fitted = coloured(2 * seed), judged = coloured(2 * seed + 1);
    for (const double w : {0.0, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0}) {
      double product = 0.0, square = 0.0;
      const auto shape = [&](std::size_t i) {
        return w > 0.0 ? std::sin(w * static_cast<double>(i)) : (i % 200 < 10 ? 1.0 : 0.0);
      };
      for (std::size_t i = 0; i < fitted.size(); ++i) {
        product += fitted[i] * shape(i);
        square += shape(i) * shape(i);
      }
      auto after_fit = fitted, after = judged;
      for (std::size_t i = 0; i < fitted.size(); ++i) {
        after_fit[i] -= product / square * shape(i);
        after[i] -= product / square * shape(i);
      }
      ++trials;
      passed += improvement(pair(fitted, judged), pair(after_fit, after)).p_value <
                SearchOptions().acceptance.chance;
    }
  }
  std::cout << passed << " of " << trials << " effects by chance pass on the validation\n";
  EXPECT_LE(passed, trials / 100);
}

TEST(ImprovementTest, NeedsTheSameSeries) {
  const auto both = pair(noise(1), noise(2));
  EXPECT_FALSE(improvement(both, {series(true, noise(1))}).comparable);
  // A series that only the extended model has takes nothing away.
  EXPECT_TRUE(improvement({series(true, noise(1))}, both).comparable);
}

TEST(ImprovementTest, OfNothingIsNone) {
  const auto same = pair(noise(1), noise(2));
  const Improvement gain = improvement(same, same);
  EXPECT_TRUE(gain.comparable);
  EXPECT_EQ(gain.fit_gain, 0.0);
  EXPECT_EQ(gain.z, 0.0);
  EXPECT_EQ(gain.p_value, 0.5);
  EXPECT_EQ(gain.validate_percent, 0.0);
}

TEST(AcceptanceTest, OddsOfAHundredToOneAreClear) {
  EXPECT_FALSE(is_clearly_worse(-20.0));
  EXPECT_FALSE(is_clearly_worse(9.0));
  EXPECT_TRUE(is_clearly_worse(9.5));
}

TEST(AcceptanceTest, AnEffectIsNeededForMoreThanThePriceOfItsParameters) {
  Improvement gain;
  gain.comparable = true;
  gain.samples = 1000.0;  // ln 1000 = 6.9
  gain.p_value = 1e-9;
  gain.fit_gain = 13.0;
  EXPECT_TRUE(is_needed(gain, 1, false));
  EXPECT_FALSE(is_needed(gain, 2, false));
  gain.fit_gain = 14.5;
  EXPECT_TRUE(is_needed(gain, 2, false));
}

TEST(AcceptanceTest, AnEffectIsNotNeededWhereChanceExplainsWhatItPredicts) {
  Improvement gain;
  gain.comparable = true;
  gain.samples = 1000.0;
  gain.fit_gain = 100.0;
  gain.p_value = 0.5 * SearchOptions().acceptance.chance;
  EXPECT_TRUE(is_needed(gain, 1, false));
  gain.p_value = 2.0 * SearchOptions().acceptance.chance;
  EXPECT_FALSE(is_needed(gain, 1, false));
  gain.p_value = 0.0;
  gain.comparable = false;
  EXPECT_FALSE(is_needed(gain, 1, false));
}

// An effect that a fit to other noise has found changes the prediction without knowledge of this
// noise: it makes things worse on average, and better by chance in at most as many cases as said.
TEST(ImprovementTest, PValueOfChanceIsHonest) {
  constexpr int kTrials = 2000;
  int below = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Normal normal(static_cast<std::uint64_t>(trial) + 1);
    const double size = 0.1 * normal();
    const auto before = normal.values(200);
    const auto after = with_wave(before, size);
    below += improvement({series(false, before)}, {series(false, after)}).p_value < 0.05 ? 1 : 0;
  }
  EXPECT_LE(below, kTrials / 20);
}

TEST(BicDifferenceTest, IsWhatTheOtherExplainsLess) {
  const auto best = pair(noise(1), noise(2));
  const auto other = pair(with_wave(noise(1), 0.5), with_wave(noise(2), 0.5));
  // Two series with a mean square of 1 / 8 each.
  EXPECT_NEAR(bic_difference(best, 3, other, 3), 2.0 * kSamples / 8.0, 0.1 * kSamples);
  // The other way round. NOLINTNEXTLINE(readability-suspicious-call-argument)
  EXPECT_LT(bic_difference(other, 3, best, 3), 0.0);
  EXPECT_EQ(bic_difference(best, 3, best, 3), 0.0);
}

TEST(BicDifferenceTest, PricesParametersByTheNumberOfSamples) {
  const auto same = pair(noise(1), noise(2));
  const double price = std::log(2.0 * kSamples);
  EXPECT_NEAR(bic_difference(same, 3, same, 5), 2.0 * price, 0.02 * price);
  EXPECT_NEAR(bic_difference(same, 5, same, 3), -2.0 * price, 0.02 * price);
}

TEST(BicDifferenceTest, OfAModelThatFailsIsInfinite) {
  const auto both = pair(noise(1), noise(2));
  EXPECT_EQ(bic_difference(both, 3, {series(true, noise(1))}, 3), INFINITY);
}

TEST(BicDifferenceTest, IsAtLeastThatOfAModelThatLeavesNoiseAlone) {
  const auto wave = pair(with_wave(noise(1), 1.0), with_wave(noise(2), 1.0));
  const double price = std::log(static_cast<double>(kSamples));
  for (const double more : {-2.0, 0.0, 14.0}) {
    const double least = least_bic_difference(wave, more);
    const auto parameters = static_cast<std::size_t>(5.0 + more);
    const double of_noise = bic_difference(wave, 5, pair(noise(1), noise(2)), parameters);
    EXPECT_LT(least, of_noise + std::abs(more)) << more;
    EXPECT_GT(least, -2.0 * kSamples + more * price) << more;
  }
  auto unknown = wave;
  unknown.front().noise = NoiseSource::fit;
  EXPECT_EQ(least_bic_difference(unknown, 14.0), -INFINITY);
}

TEST(BicDifferenceTest, CorrelatedResidualsCountLess) {
  const auto best = pair(held_for_five(noise(1)), held_for_five(noise(2)));
  const auto other = pair(with_wave(best[0].values, 0.5), with_wave(best[1].values, 0.5));
  EXPECT_NEAR(bic_difference(best, 3, other, 3), 2.0 * kSamples / 8.0 / 5.0, 0.03 * kSamples);
}

TEST(RefusalTest, OfAnImprovementThatIsRealIsNone) {
  const Improvement gain = improvement(pair(with_wave(noise(1), 1.0), with_wave(noise(2), 1.0)),
                                       pair(noise(1), noise(2)));
  EXPECT_FALSE(rejection_of(hypothesis(), gain, determined(), {100}));
  EXPECT_FALSE(rejection_of(hypothesis(2, 1), gain, determined(), {100}));
}

// A parameter that was fitted to the noise gains about one of the sum of squares, and the best of a
// hundred about nine.
TEST(RefusalTest, OfChance) {
  int refused = 0;
  constexpr int kTrials = 200;
  for (int trial = 0; trial < kTrials; ++trial) {
    Normal normal(static_cast<std::uint64_t>(trial) + 1);
    const auto fitted = normal.values(kSamples), judged = normal.values(kSamples);
    double best = 0.0;
    std::vector<double> after_fitted = fitted, after_judged = judged;
    for (int tried = 0; tried < 100; ++tried) {
      std::vector<double> wave(kSamples);
      const double frequency = 0.01 + 0.03 * tried;
      double dot = 0.0, square = 0.0;
      for (std::size_t i = 0; i < kSamples; ++i) {
        wave[i] = std::sin(frequency * static_cast<double>(i));
        dot += wave[i] * fitted[i];
        square += wave[i] * wave[i];
      }
      if (dot * dot / square < best) continue;
      best = dot * dot / square;
      for (std::size_t i = 0; i < kSamples; ++i) {
        after_fitted[i] = fitted[i] - dot / square * wave[i];
        after_judged[i] = judged[i] - dot / square * wave[i];
      }
    }
    const Improvement gain = improvement(pair(fitted, judged), pair(after_fitted, after_judged));
    refused += rejection_of(hypothesis(), gain, determined(), {100}) ? 1 : 0;
  }
  EXPECT_EQ(refused, kTrials);
}

TEST(RefusalTest, OfWhatOnlyFits) {
  const Improvement gain = improvement(pair(with_wave(noise(1), 1.0), noise(2)),
                                       pair(noise(1), with_wave(noise(2), 1.0)));
  EXPECT_GT(gain.fit_gain, 500.0);
  EXPECT_LT(gain.validate_percent, 0.0);
  EXPECT_GT(gain.p_value, 0.9);
  const auto rejection = rejection_of(hypothesis(), gain, determined(), {100});
  EXPECT_EQ(rejection, (Rejection{.test = Rejection::Test::validation, .found = gain.p_value}));
}

// The motion that was not fitted has a thirtieth of the effect: no recording of noise tells.
TEST(RefusalTest, OfWhatTheOtherRecordingCouldNotHaveShownSaysSo) {
  const Improvement gain = improvement(pair(with_wave(noise(1), 1.0), noise(2)),
                                       pair(noise(1), with_wave(noise(2), 0.03)));
  EXPECT_LT(gain.expected_z, 4.4);
  const auto rejection = rejection_of(hypothesis(), gain, determined(), {100});
  EXPECT_EQ(rejection, (Rejection{.test = Rejection::Test::power, .found = gain.p_value}));
}

// At twice the variance of the noise no model lowers the error by more than 29 %.
TEST(ImprovementTest, CountsWhatIsMissingBeyondTheNoise) {
  const Improvement gain =
      improvement(pair(noise(1), with_wave(noise(2), std::sqrt(2.0))), pair(noise(1), noise(2)));
  EXPECT_LT(gain.validate_percent, 40.0);
  EXPECT_GT(gain.missing_percent, 80.0);
}

TEST(RefusalTest, OfWhatHardlyHelps) {
  Improvement gain;
  gain.comparable = true;
  gain.fit_gain = 100.0;
  gain.samples = 1e6;
  gain.z = 6.0;
  gain.p_value = 1e-9;
  gain.validate_percent = 0.3;
  EXPECT_EQ(rejection_of(hypothesis(), gain, determined(), {100}),
            (Rejection{.test = Rejection::Test::validation_size, .found = 0.3}));
  gain.validate_percent = 0.6;
  EXPECT_FALSE(rejection_of(hypothesis(), gain, determined(), {100}));
}

TEST(RefusalTest, OfWhatHelpsByChanceMoreOftenThanOnceInAThousand) {
  Improvement gain;
  gain.comparable = true;
  gain.fit_gain = 100.0;
  gain.samples = 2000.0;
  gain.validate_percent = 5.0;
  gain.expected_z = 10.0;
  gain.p_value = 1.1e-3;
  EXPECT_EQ(rejection_of(hypothesis(), gain, determined(), {100}),
            (Rejection{.test = Rejection::Test::validation, .found = 1.1e-3}));
  EXPECT_FALSE(rejection_of(hypothesis(), gain, determined(), {100, 1.2e-3}));
  gain.p_value = 0.9e-3;
  EXPECT_FALSE(rejection_of(hypothesis(), gain, determined(), {100}));
}

TEST(RefusalTest, PricesParametersAndTheChoice) {
  Improvement gain = improvement(pair(with_wave(noise(1), 1.0), with_wave(noise(2), 1.0)),
                                 pair(noise(1), noise(2)));
  gain.samples = 2000.0;  // log 7.6
  gain.fit_gain = 8.0;
  EXPECT_FALSE(rejection_of(hypothesis(), gain, determined(), {1}));
  const double log_n = std::log(2000.0);
  const auto chosen = [](double required, std::size_t tried) {
    return Rejection{Rejection::Test::significance, 8.0, required, tried};
  };
  EXPECT_EQ(rejection_of(hypothesis(), gain, determined(), {100}),
            chosen(log_n + 2.0 * std::log(100.0), 100));
  EXPECT_EQ(rejection_of(hypothesis(1, 1), gain, determined(), {1}), chosen(2.0 * log_n, 1));
  gain.fit_gain = 17.0;
  EXPECT_FALSE(rejection_of(hypothesis(), gain, determined(), {100}));
}

TEST(RefusalTest, OfWhatIsNotDetermined) {
  const Improvement gain = improvement(pair(with_wave(noise(1), 1.0), with_wave(noise(2), 1.0)),
                                       pair(noise(1), noise(2)));
  const auto rejection = [&](const Determination& d) {
    return rejection_of(hypothesis(), gain, d, {100});
  };
  using enum Rejection::Test;
  Determination d = determined();
  d.wald = 9.0;
  EXPECT_EQ(rejection(d), (Rejection{.test = strength, .found = 3.0}));
  d = determined();
  d.distinct = 1e-12;
  EXPECT_EQ(rejection(d), Rejection{.test = distinct});
  d = determined();
  d.at_bound = id_of("coulomb_friction.F_c");
  EXPECT_EQ(rejection(d), (Rejection{.test = bound, .parameter = d.at_bound}));
  d = determined();
  d.undetermined = id_of("stribeck_friction.v_st");
  EXPECT_EQ(rejection(d), (Rejection{.test = shape, .parameter = d.undetermined}));
}

TEST(RefusalTest, OfWhatCannotBeSimulated) {
  EXPECT_EQ(rejection_of(hypothesis(), {}, {}, {1}),
            Rejection{.test = Rejection::Test::simulation});
}

/// The slide with dry friction, fitted with it.
class DeterminationTest : public testing::Test {
 protected:
  void fit(double friction, const std::vector<const char*>& free) {
    Model<double> truth = slide();
    add_effect<CoulombFriction>(truth).F_c = friction;
    job_ = two_recordings(truth, slide(), free);
    hypothesis_.name = "coulomb_friction";
    hypothesis_.strengths = {quantity_index("coulomb_friction.F_c")};
    hypothesis_.neutral = {0.0};
    std::vector<double> values;
    for (const FreeParameter& p : job_.free) values.push_back(p.initial);
    const std::vector<double> strengths{friction};
    job_ = with_hypothesis(job_, hypothesis_, values, {strengths, {}});
    job_.options.continuation.reset();
    result_ = estimate(job_);
  }
  Determination determination_now() {
    return determination(job_, result_, hypothesis_, residual_series(job_, result_));
  }
  Job job_;
  Hypothesis hypothesis_;
  FitResult result_;
};

TEST_F(DeterminationTest, IsTheSquareOfValueOverStandardError) {
  fit(5.0, {"M", "B_a"});
  const ParameterResult& p = result_.parameters.back();
  ASSERT_TRUE(p.uncertainty.determined);
  const Determination d = determination_now();
  const double ratio = p.value / p.uncertainty.standard_error;
  // Standard errors count every sample, this only independent ones.
  EXPECT_LT(d.wald, 1.1 * ratio * ratio);
  EXPECT_GT(d.wald, 0.7 * ratio * ratio);
  EXPECT_NEAR(d.required, 3.62 * 3.62, 1.0);  // three in ten thousand, either side
  EXPECT_GT(d.distinct, 0.01);
  EXPECT_LE(d.distinct, 1.0);
  EXPECT_FALSE(d.at_bound);
  EXPECT_FALSE(d.undetermined);
}

TEST_F(DeterminationTest, CorrelatedResidualsCountLess) {
  fit(5.0, {"M", "B_a"});
  auto residuals = residual_series(job_, result_);
  const auto wald_with = [&](const std::vector<double>& values) {
    for (ResidualSeries& s : residuals) s.values = values;
    return determination(job_, result_, hypothesis_, residuals).wald;
  };
  const auto white = noise(1), held = held_for_five(white);
  // To a fifth where the effect is slow against five samples, to no less where it is not.
  EXPECT_LT(wald_with(held), 0.5 * wald_with(white));
  EXPECT_GT(wald_with(held), 0.15 * wald_with(white));
}

TEST_F(DeterminationTest, OfAWeakEffectIsBelowWhatIsRequired) {
  fit(0.01, {"M", "B_a"});
  const Determination d = determination_now();
  EXPECT_TRUE(d.wald < d.required || d.at_bound) << d.wald;
}

TEST_F(DeterminationTest, SaysThatAStrengthIsAtItsBound) {
  fit(0.0, {"M", "B_a"});
  result_.parameters.back().uncertainty.at_bound = true;
  EXPECT_EQ(determination_now().at_bound, id_of("coulomb_friction.F_c"));
}

// A constant force and an offset of the command are the same for a drive that is a force.
TEST_F(DeterminationTest, SeesThatAnotherParameterDoesTheSame) {
  Model<double> truth = slide();
  add_effect<CommandOffset>(truth).U_0 = 0.2;
  Job job = two_recordings(truth, truth, {"B_a", "command_offset.U_0"});
  hypothesis_.strengths = {quantity_index("constant_force.F_0")};
  hypothesis_.neutral = {0.0};
  const std::vector<double> values{30.0, 0.1}, strengths{4.0};
  job_ = with_hypothesis(job, hypothesis_, values, {strengths, {}});
  result_ = result_at_start(job_);
  EXPECT_LT(determination_now().distinct, 1e-9);
}

// The neutral value of a gain is one: the strength is what differs from it.
TEST_F(DeterminationTest, CountsAGainFromOne) {
  Model<double> truth = slide();
  Job job = two_recordings(truth, truth, {"B_a"});
  hypothesis_.strengths = {quantity_index("velocity.gain")};
  hypothesis_.neutral = {1.0};
  const std::vector<double> values{30.0};
  const auto wald = [&](double gain) {
    const std::vector<double> strengths{gain};
    job_ = with_hypothesis(job, hypothesis_, values, {strengths, {}});
    result_ = result_at_start(job_);
    // What is left of a fit: at the truth nothing but noise.
    const std::vector<double> neutral{1.0};
    const Job at_truth = with_hypothesis(job, hypothesis_, values, {neutral, {}});
    return determination(job_, result_, hypothesis_,
                         residual_series(at_truth, result_at_start(at_truth)))
        .wald;
  };
  EXPECT_NEAR(wald(1.0), 0.0, 1e-9);
  EXPECT_NEAR(wald(1.0002) / wald(1.0001), 4.0, 0.01);
}

}  // namespace
}  // namespace axisfit
