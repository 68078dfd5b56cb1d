#include "fit/data/filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include "fit/data/noise.h"
#include "tests/fit/example.h"

namespace axisfit {
namespace {

Filter average(std::size_t length, bool zero_phase) {
  Filter filter;
  filter.kind = Filter::Kind::moving_average;
  filter.length = length;
  filter.zero_phase = zero_phase;
  return filter;
}

Filter butterworth(int order, double cutoff, bool zero_phase) {
  Filter filter;
  filter.kind = Filter::Kind::butterworth;
  filter.order = order;
  filter.cutoff = cutoff;
  filter.zero_phase = zero_phase;
  return filter;
}

std::vector<Filter> all_kinds() {
  std::vector<Filter> filters;
  for (const bool zero_phase : {false, true}) {
    filters.push_back(average(7, zero_phase));
    for (const int order : {1, 2, 3, 4}) filters.push_back(butterworth(order, 0.07, zero_phase));
  }
  return filters;
}

/// Of a sine of this many cycles per sample.
std::complex<double> response(const Filter& filter, double frequency) {
  const std::vector<double> h = impulse_response(filter);
  const std::size_t centre = h.size() / 2;
  std::complex<double> sum = 0.0;
  for (std::size_t i = 0; i < h.size(); ++i)
    sum += h[i] * std::polar(1.0, -2.0 * std::numbers::pi * frequency *
                                      (static_cast<double>(i) - static_cast<double>(centre)));
  return sum;
}

TEST(FilterTest, NoneLeavesTheValues) {
  const std::vector<double> values{1.0, -2.0, 4.0};
  EXPECT_EQ(filtered(Filter(), values), values);
  EXPECT_EQ(impulse_response(Filter()), std::vector<double>{1.0});
  EXPECT_EQ(reach_of(Filter()), 0u);
  EXPECT_EQ(autocorrelation_time(Filter()), 1.0);
}

TEST(FilterTest, AnImpulseBecomesThePartsOfAnAverage) {
  EXPECT_EQ(impulse_response(average(2, false)), (std::vector<double>{0.0, 0.0, 0.5, 0.5, 0.0}));
  const std::vector<double> centred = impulse_response(average(3, true));
  for (std::size_t i = 0; i < 7; ++i)
    EXPECT_NEAR(centred[i], i >= 2 && i <= 4 ? 1.0 / 3.0 : 0.0, 1e-15) << i;
  EXPECT_EQ(reach_of(average(21, false)), 20u);
  EXPECT_EQ(reach_of(average(21, true)), 10u);
}

TEST(FilterTest, LetsAConstantPassFromItsFirstSampleToItsLast) {
  for (const Filter& filter : all_kinds()) {
    for (const double x : filtered(filter, std::vector<double>(50, 3.0)))
      EXPECT_NEAR(x, 3.0, 1e-13);
    EXPECT_NEAR(std::abs(response(filter, 0.0)), 1.0, 1e-8);
  }
}

TEST(FilterTest, AnAverageHasItsNotches) {
  for (const bool zero_phase : {false, true})
    for (const int k : {1, 2, 3})
      EXPECT_LT(std::abs(response(average(7, zero_phase), k / 7.0)), 1e-14);
}

TEST(FilterTest, AButterworthFilterHasItsAmplitudes) {
  for (const int order : {1, 2, 3, 4}) {
    const auto amplitude = [&](double f, bool zero_phase) {
      return std::abs(response(butterworth(order, 0.07, zero_phase), f));
    };
    EXPECT_NEAR(amplitude(0.07, false), std::sqrt(0.5), 1e-6) << order;
    EXPECT_NEAR(amplitude(0.07, true), 0.5, 1e-6) << order;
    // 1 / sqrt(1 + x^(2 order)) at x = tan(pi f) / tan(pi cutoff)
    const double x = std::tan(0.2 * std::numbers::pi) / std::tan(0.07 * std::numbers::pi);
    EXPECT_NEAR(amplitude(0.2, false), 1.0 / std::sqrt(1.0 + std::pow(x, 2 * order)), 1e-6);
  }
}

TEST(FilterTest, DelaysASlowSignalUnlessWithoutPhase) {
  for (const Filter& filter : all_kinds()) {
    constexpr double kSlow = 1e-4;
    const double phase = std::arg(response(filter, kSlow));
    EXPECT_NEAR(-phase / (2.0 * std::numbers::pi * kSlow), delay_of(filter), 1e-3);
    EXPECT_EQ(delay_of(filter) > 0.0, !filter.zero_phase);
  }
  EXPECT_EQ(advanced({0.0, 1.0, 4.0, 9.0}, 1.5), (std::vector<double>{2.5, 6.5, 9.0, 9.0}));
}

TEST(FilterTest, FurtherThanItReachesHardlyAnythingCounts) {
  for (const Filter& filter : all_kinds()) {
    // A history that the recording does not have.
    constexpr std::size_t kBefore = 200, kAfter = 100;
    std::vector<double> values(kBefore + kAfter);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = i < kBefore ? 1.0 : 0.0;
    const std::vector<double> whole = filtered(filter, values);
    const std::vector<double> cut =
        filtered(filter, std::vector<double>(values.begin() + kBefore, values.end()));
    const std::size_t reach = reach_of(filter);
    for (std::size_t i = reach; i < kAfter; ++i)
      EXPECT_NEAR(cut[i], whole[kBefore + i], 1.01e-3) << i;
  }
}

TEST(FilterTest, FreshSamplesAreThoseThatDoNotRepeat) {
  // From the middle of a hold on; equal values in a row; and one that is late.
  const std::vector<double> values{1, 2, 2, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4};
  const std::vector<bool> fresh = fresh_samples(values, 3);
  EXPECT_EQ(fresh, (std::vector<bool>{false, true, false, false, true, false, false, true, false,
                                      false, true, true, false, false}));
  EXPECT_EQ(fresh_samples(values, 1), std::vector<bool>(values.size(), true));
}

TEST(FilterTest, BetweenFreshSamplesIsACurve) {
  std::vector<double> held, truth;
  for (std::size_t i = 0; i < 200; ++i) {
    truth.push_back(std::sin(0.02 * static_cast<double>(i)));
    held.push_back(truth[i - i % 10]);
  }
  const std::vector<double> curve = between_fresh(held, fresh_samples(held, 10));
  // The stairs are off by up to 0.18, chords by up to 0.005.
  for (std::size_t i = 10; i < 180; ++i) EXPECT_NEAR(curve[i], truth[i], 5e-4) << i;
}

/// A smooth motion with white noise of 2e-3.
Measurement noisy_motion() {
  Measurement m;
  Normal normal(4);
  for (std::size_t i = 0; i < 6000; ++i)
    m.values.edit().push_back(std::sin(0.01 * static_cast<double>(i)) + 2e-3 * normal());
  return m;
}

TEST(NoiseOfAFilteredSignal, IsThatAfterTheFilter) {
  for (const Filter& filter : all_kinds()) {
    Measurement m = noisy_motion();
    m.filter = filter;
    m.values = filtered(filter, std::vector<double>(m.values));
    exclude_uninformative(m);
    const double size = 2e-3 / std::sqrt(autocorrelation_time(filter));
    EXPECT_NEAR(noise_from_differences(m), size, 0.1 * size);
  }
}

TEST(NoiseOfAHeldSignal, IsThatOfTheFreshSamples) {
  Measurement m = noisy_motion();
  for (std::size_t i = 0; i < m.values.size(); ++i) m.values.edit()[i] = m.values[i - i % 5];
  m.hold = 5;
  exclude_uninformative(m);
  EXPECT_NEAR(noise_from_differences(m), 2e-3, 2e-4);
  EXPECT_TRUE(m.counts(10));
  EXPECT_FALSE(m.counts(11));
}

TEST(ExcludeUninformative, LeavesOutWhatTheFilterCannotKnow) {
  Measurement m = noisy_motion();
  m.filter = average(21, false);
  exclude_uninformative(m);
  EXPECT_FALSE(m.counts(19));
  EXPECT_TRUE(m.counts(20));
  EXPECT_TRUE(m.counts(m.values.size() - 1));
  m.filter = average(21, true);
  exclude_uninformative(m);
  EXPECT_FALSE(m.counts(9));
  EXPECT_TRUE(m.counts(10));
  EXPECT_TRUE(m.counts(m.values.size() - 11));
  EXPECT_FALSE(m.counts(m.values.size() - 10));
  EXPECT_NEAR(noise_correlation_time(m), 21.0, 1e-9);
}

/// The paper's step, exact at ten times the rate, filtered as the axis's recorder might.
Job filtered_job(const Filter& filter, std::size_t hold) {
  Job job;
  job.options.threads = 1;
  job.model = paper_axis();
  job.recordings = {recorded_step(job.model)};
  for (Measurement& m : job.recordings[0].measurements) {
    m.values = filtered(filter, std::vector<double>(m.values));
    for (std::size_t i = 0; i < m.values.size(); ++i) m.values.edit()[i] = m.values[i - i % hold];
  }
  job.free = {free_parameter("V_L", 2.5), free_parameter("B_a", 150.0),
              free_parameter("b_g", 1700.0), free_parameter("k_g", 4e6),
              free_parameter("T_p", 0.05)};
  return job;
}

/// By how many standard errors the gear stiffness is wrong.
double distance_of_stiffness(const Job& job) {
  const ParameterResult stiffness = estimate(job).parameters[3];
  return std::abs(stiffness.value - 5e6) / stiffness.uncertainty.standard_error;
}

TEST(FitOfAFilteredRecording, FindsTheTruthWhereTheFilterIsDeclared) {
  for (const auto& [filter, hold] :
       {std::pair{average(21, true), 1u}, std::pair{butterworth(2, 0.08, false), 1u},
        std::pair{Filter(), 5u}}) {
    Job job = filtered_job(filter, hold);
    EXPECT_GT(distance_of_stiffness(job), 4.0);
    for (Measurement& m : job.recordings[0].measurements) {
      m.filter = filter;
      m.hold = hold;
      exclude_uninformative(m);
      m.sigma = noise_from_differences(m);
    }
    EXPECT_LT(distance_of_stiffness(job), 3.0);
  }
}

constexpr double kInterval = 1e-3;  // s

/// Amplitude behind the filter of a sine of the frequency f, Hz, away from the ends.
double gain(double f, double cutoff) {
  std::vector<double> sine(4001);
  for (std::size_t i = 0; i < sine.size(); ++i)
    sine[i] = std::sin(2.0 * std::numbers::pi * f * kInterval * static_cast<double>(i));
  const auto passed = low_pass(sine, kInterval, cutoff);
  // The frequencies below have whole numbers of periods in the middle second.
  double in = 0.0, out = 0.0;
  for (std::size_t i = 1500; i < 2500; ++i) {
    in += sine[i] * sine[i];
    out += sine[i] * passed[i];
  }
  return out / in;
}

TEST(LowPass, LetsAConstantThrough) {
  for (const double x : low_pass(std::vector<double>(500, 3.0), kInterval, 20.0))
    EXPECT_NEAR(x, 3.0, 1e-9);
}

TEST(LowPass, HasNoDelay) {
  std::vector<double> impulse(2001, 0.0);
  impulse[1000] = 1.0;
  const auto response = low_pass(impulse, kInterval, 20.0);
  EXPECT_NEAR(std::accumulate(response.begin(), response.end(), 0.0), 1.0, 1e-9);
  EXPECT_EQ(std::ranges::max_element(response) - response.begin(), 1000);
  for (std::size_t i = 1; i <= 1000; ++i)
    EXPECT_NEAR(response[1000 + i], response[1000 - i], 1e-10) << i;
}

TEST(LowPass, HalvesAtTheCutoffAndStopsBeyond) {
  EXPECT_NEAR(gain(2.0, 20.0), 1.0, 1e-3);
  EXPECT_NEAR(gain(20.0, 20.0), 0.5, 1e-3);
  EXPECT_NEAR(gain(18.0, 20.0), std::sqrt(0.5), 0.02);
  EXPECT_LT(std::abs(gain(40.0, 20.0)), 0.004);  // 1 / (1 + 2^8)
  EXPECT_LT(std::abs(gain(100.0, 20.0)), 1e-4);
}

TEST(LowPass, LeavesAloneWhatSamplingCannotSee) {
  const auto noise = Normal(1).values(100);
  EXPECT_EQ(low_pass(noise, kInterval, 490.0), noise);
  EXPECT_EQ(low_pass({1.0}, kInterval, 20.0), std::vector<double>{1.0});
  EXPECT_TRUE(low_pass({}, kInterval, 20.0).empty());
}

}  // namespace
}  // namespace axisfit
