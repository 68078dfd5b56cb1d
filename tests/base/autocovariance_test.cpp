#include "base/autocovariance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/base/noise.h"

namespace axisfit {
namespace {

/// Autocovariances of a first-order autoregressive process with innovations of unit variance.
std::vector<double> covariance_of(double phi, std::size_t most) {
  std::vector<double> covariance{1.0 / (1.0 - phi * phi)};
  while (covariance.size() <= most) covariance.push_back(phi * covariance.back());
  return covariance;
}

TEST(FitAutoregression, FindsTheProcessOfExactCovariances) {
  const Autoregression found = fit_autoregression(covariance_of(0.8, 20), 10000.0);
  ASSERT_EQ(found.coefficients.size(), 1u);
  EXPECT_NEAR(found.coefficients[0], 0.8, 1e-12);
  EXPECT_NEAR(found.innovation, 1.0, 1e-12);
  const Autoregression white = fit_autoregression(covariance_of(0.0, 20), 10000.0);
  EXPECT_TRUE(white.coefficients.empty());
  EXPECT_EQ(white.innovation, 1.0);
}

// A coefficient of 0.1 lowers the variance by 1 %, and Schwarz's criterion asks for log(n) / n.
TEST(FitAutoregression, TakesACoefficientWhereTheSamplesAreManyEnough) {
  EXPECT_TRUE(fit_autoregression(covariance_of(0.1, 20), 500.0).coefficients.empty());
  EXPECT_EQ(fit_autoregression(covariance_of(0.1, 20), 2000.0).coefficients.size(), 1u);
}

TEST(Autocovariance, IsTheMeanProductAboutZero) {
  const std::vector<double> values{1.0, 2.0, -1.0, 3.0};
  const std::vector<double> covariance = autocovariance(values, 2);
  ASSERT_EQ(covariance.size(), 3u);
  EXPECT_NEAR(covariance[0], 15.0 / 4.0, 1e-12);
  EXPECT_NEAR(covariance[1], (2.0 - 2.0 - 3.0) / 4.0, 1e-12);
  EXPECT_NEAR(covariance[2], (-1.0 + 6.0) / 4.0, 1e-12);
}

TEST(ModelledAutocovariance, OfAFewSamplesIsThatOfWhiteNoise) {
  const std::vector<double> few = autoregressive(0.9, 49, 1), many = autoregressive(0.9, 2000, 1);
  const std::vector<double> white = modelled_autocovariance(few);
  ASSERT_FALSE(white.empty());
  EXPECT_NEAR(white[0], mean_square(few), 1e-12);
  EXPECT_EQ(white.size(), 1u);
  const std::vector<double> coloured = modelled_autocovariance(many);
  ASSERT_GT(coloured.size(), 10u);
  EXPECT_NEAR(coloured[10] / coloured[0], std::pow(0.9, 10), 0.1);
}

double mean_autocorrelation_time(double phi) {
  constexpr std::uint64_t kTrials = 10;
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= kTrials; ++seed)
    sum += autocorrelation_time(autoregressive(phi, 10000, seed));
  return sum / kTrials;
}

TEST(AutocorrelationTime, OfWhiteNoiseIsOneSample) {
  EXPECT_NEAR(mean_autocorrelation_time(0.0), 1.0, 0.05);
}

TEST(AutocorrelationTime, OfAFirstOrderProcessIsThatOfItsClosedForm) {
  for (const double phi : {0.5, 0.8, 0.95}) {
    const double exact = (1.0 + phi) / (1.0 - phi);
    EXPECT_NEAR(mean_autocorrelation_time(phi), exact, 0.1 * exact) << phi;
  }
}

TEST(AutocorrelationTime, IsNeverLessThanOneSample) {
  EXPECT_EQ(autocorrelation_time(autoregressive(-0.5, 1000, 1)), 1.0);
  EXPECT_EQ(autocorrelation_time(std::vector<double>(100, 3.0)), 1.0);
  EXPECT_EQ(autocorrelation_time(std::vector<double>{1.0, 2.0}), 1.0);
  EXPECT_EQ(autocorrelation_time(std::vector<double>{1.0}), 1.0);
  EXPECT_EQ(autocorrelation_time(std::vector<double>{}), 1.0);
}

/// Mean over some seeds of the variance along a wave of w rad per sample.
double mean_variance_along(double w, double phi) {
  constexpr std::uint64_t kTrials = 20;
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= kTrials; ++seed) {
    std::vector<double> wave(5000);
    for (std::size_t i = 0; i < wave.size(); ++i) wave[i] = std::sin(w * static_cast<double>(i));
    sum += variance_along(wave, autoregressive(phi, wave.size(), seed)) / kTrials;
  }
  return sum;
}

TEST(VarianceAlong, AWaveIsTheSpectrumAtItsFrequency) {
  for (const double phi : {0.0, 0.5, 0.95})
    for (const double w : {0.3, 1.0, 2.5}) {
      const double exact = 1.0 / (1.0 - 2.0 * phi * std::cos(w) + phi * phi);
      EXPECT_NEAR(mean_variance_along(w, phi), exact, 0.2 * exact) << phi << " " << w;
    }
}

TEST(VarianceAlong, ASlowChangeIsTheMeanSquareTimesTheAutocorrelationTime) {
  const double phi = 0.8, exact = 1.0 / std::pow(1.0 - phi, 2);
  EXPECT_NEAR(mean_variance_along(0.002, phi), exact, 0.3 * exact);
}

TEST(VarianceAlong, NoChangeIsThatOfASlowOne) {
  const std::vector<double> r = autoregressive(0.8, 5000, 1), none(r.size(), 0.0);
  EXPECT_EQ(variance_along(none, r), mean_square(r) * autocorrelation_time(r));
}

}  // namespace
}  // namespace axisfit
