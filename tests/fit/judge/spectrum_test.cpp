#include "fit/judge/spectrum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "base/random.h"

namespace axisfit {
namespace {

using Series = std::vector<double>;
constexpr double kTurn = 2.0 * std::numbers::pi;

Series white(std::size_t n, std::uint64_t seed) {
  std::mt19937_64 g(seed);
  Series values(n);
  for (double& x : values) x = normal(g);
  return values;
}

double wave_of_peak(const Spectrum& s) {
  const auto peak = std::ranges::max_element(s.size) - s.size.begin();
  return s.wave[static_cast<std::size_t>(peak)];
}

TEST(Autocorrelation, OfWhiteNoiseLeavesItsBandAsOftenAsItShould) {
  constexpr std::size_t n = 20000, lags = 1000;
  const Series r = autocorrelation(white(n, 1), lags);
  ASSERT_EQ(r.size(), lags + 1);
  EXPECT_EQ(r[0], 1.0);
  const auto outside = std::count_if(
      r.begin() + 1, r.end(), [](double x) { return std::abs(x) > 1.96 / std::sqrt(double(n)); });
  EXPECT_NEAR(double(outside), 50.0, 3.0 * std::sqrt(1000.0 * 0.05 * 0.95));
}

TEST(Autocorrelation, OfAFirstOrderProcessFallsGeometrically) {
  constexpr double phi = 0.9;
  Series x = white(200000, 2);
  for (std::size_t i = 1; i < x.size(); ++i) x[i] += phi * x[i - 1];
  const Series r = autocorrelation(x, 10);
  for (std::size_t lag = 1; lag <= 10; ++lag) EXPECT_NEAR(r[lag], std::pow(phi, lag), 0.02);
}

TEST(PowerSpectrum, IsOneForWhiteNoiseOfUnitVariance) {
  const Spectrum s = power_spectrum(white(65536, 3), 1e-3);
  ASSERT_FALSE(s.size.empty());
  double mean = 0.0;
  for (const double p : s.size) mean += p / double(s.size.size());
  // Each of the some eight thousand ordinates is a mean of seven, half overlapping.
  EXPECT_NEAR(mean, 1.0, 0.03);
  EXPECT_NEAR(s.wave.back(), 500.0, 0.1);
}

TEST(PowerSpectrum, ShowsAToneAtItsFrequency) {
  Series values = white(4000, 4);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] += std::sin(kTurn * 37.0 * 1e-3 * double(i));
  const Spectrum s = power_spectrum(values, 1e-3);
  EXPECT_NEAR(wave_of_peak(s), 37.0, 2.0 * s.wave.front());
}

TEST(Periodogram, ShowsATonesFrequencyMoreFinely) {
  Series values = white(3001, 4);  // a prime number of them
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] += 0.5 * std::sin(kTurn * 37.3 * 1e-3 * double(i));
  const Spectrum s = periodogram(values, 1e-3);
  EXPECT_NEAR(wave_of_peak(s), 37.3, 0.2);
  double mean = 0.0;
  for (const double p : periodogram(white(3001, 4), 1e-3).size) mean += p / double(s.size.size());
  EXPECT_NEAR(mean, 1.0, 0.1);
}

TEST(PowerSpectrum, OfFewValuesIsNone) {
  EXPECT_TRUE(power_spectrum(white(31, 5), 1.0).wave.empty());
}

TEST(SpatialSpectrum, FindsPeriodAndAmplitudeWhateverTheSpeed) {
  // There and back, at a speed that changes all the time.
  Series position, force;
  for (int i = 0; i < 3000; ++i) {
    position.push_back(0.4 * (1.0 - std::cos(kTurn * i / 3000.0)));
    force.push_back(5.0 + 3.0 * std::sin(kTurn * position.back() / 0.036));
  }
  const Spectrum s = spatial_spectrum(force, position);
  EXPECT_NEAR(1.0 / wave_of_peak(s), 0.036, 0.0004);
  EXPECT_NEAR(*std::ranges::max_element(s.size), 3.0, 0.15);
}

TEST(SpatialSpectrum, OfAnAxisThatStaysIsNone) {
  EXPECT_TRUE(spatial_spectrum(white(100, 6), Series(100, 0.3)).wave.empty());
}

}  // namespace
}  // namespace axisfit
