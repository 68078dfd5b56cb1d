// Axes as they may be, and the bands of what they do.
#include "sim/ensemble.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "base/random.h"
#include "tests/sim/axes.h"

namespace axisfit {
namespace {

double deviation(const std::vector<double>& values, double about) {
  double sum = 0.0;
  for (const double x : values) sum += (x - about) * (x - about);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

TEST(Ensemble, DrawsParametersWithTheirErrorsAndCorrelation) {
  Model<double> model = paper_axis();
  model.axis.M = 20.0;
  model.axis.B_a = 50.0;
  AxisUncertainty uncertainty;
  uncertainty.quantities = {{quantity_index("M"), true, 0.03, 0.0, 1.0},
                            {quantity_index("B_a"), false, 2.0, 0.0, 1.0}};
  uncertainty.correlation = {1.0, -0.8, -0.8, 1.0};
  const AxisEnsemble ensemble(uncertainty, model.structure, 7);
  std::vector<double> masses, frictions;
  double product = 0.0;
  constexpr std::size_t kDraws = 4000;
  for (std::size_t k = 0; k < kDraws; ++k) {
    const Model<double> axis = ensemble.axis(model, k);
    masses.push_back(std::log(axis.axis.M / 20.0));
    frictions.push_back(axis.axis.B_a);
    product += masses.back() * (frictions.back() - 50.0) / kDraws;
  }
  EXPECT_NEAR(deviation(masses, 0.0), 0.03, 0.0015);
  EXPECT_NEAR(deviation(frictions, 50.0), 2.0, 0.1);
  EXPECT_NEAR(product / (0.03 * 2.0), -0.8, 0.05);
  EXPECT_EQ(ensemble.axis(model, 5).axis.M, ensemble.axis(model, 5).axis.M);
  EXPECT_EQ(model.structure.channels, ensemble.axis(model, 5).structure.channels);
}

// Few recordings tell little of a scatter: then far values are more likely.
TEST(Ensemble, ScatterOfFewRecordingsHasHeavyTails) {
  Model<double> model = paper_axis();
  model.axis.B_a = 1000.0;
  for (const auto& [freedom, quantile] : {std::pair{2.0, 4.303}, {9.0, 2.262}}) {
    AxisUncertainty uncertainty;
    uncertainty.quantities = {{quantity_index("B_a"), false, 0.0, 1.0, freedom}};
    uncertainty.correlation = {1.0};
    const AxisEnsemble ensemble(uncertainty, model.structure, 3);
    int beyond = 0;
    constexpr int kDraws = 8000;
    for (int k = 0; k < kDraws; ++k)
      beyond +=
          std::abs(ensemble.axis(model, static_cast<std::size_t>(k)).axis.B_a - 1000.0) > quantile;
    EXPECT_NEAR(beyond, 0.05 * kDraws, 80.0) << freedom;  // four standard errors
  }
}

TEST(Ensemble, StaysWithinTheRangeOfAQuantity) {
  Model<double> model = paper_axis();
  model.axis.B_a = 1.0;
  AxisUncertainty uncertainty;
  uncertainty.quantities = {{quantity_index("B_a"), false, 5.0, 0.0, 1.0}};
  uncertainty.correlation = {1.0};
  const AxisEnsemble ensemble(uncertainty, model.structure, 1);
  for (std::size_t k = 0; k < 50; ++k) EXPECT_GE(ensemble.axis(model, k).axis.B_a, 0.0);
}

TEST(Ensemble, TheMissingForceIsItsProcess) {
  const Model<double> model = paper_axis();
  AxisUncertainty uncertainty;
  uncertainty.missing_force = MissingForceProcess{0.01, 6.9, 3.0, {0.9}};
  const AxisEnsemble ensemble(uncertainty, model.structure, 1);
  std::vector<double> instants;
  for (int i = 0; i < 20000; ++i) instants.push_back(1.0 + 0.01 * i);
  const std::vector<double> force = ensemble.missing_force(4, instants);
  ASSERT_EQ(force.size(), instants.size());
  double neighbours = 0.0;
  for (std::size_t i = 1; i < force.size(); ++i) neighbours += force[i] * force[i - 1];
  const double size = deviation(force, 0.0);
  EXPECT_NEAR(size, 3.0 / std::sqrt(1.0 - 0.81), 0.5);
  EXPECT_NEAR(neighbours / double(force.size()) / (size * size), 0.9, 0.01);
  EXPECT_NE(ensemble.missing_force(5, instants), force);
  // Straight between.
  const std::vector<double> fine =
      ensemble.missing_force(4, std::vector<double>{1.0, 1.0025, 1.01});
  EXPECT_NEAR(fine[1], 0.75 * fine[0] + 0.25 * fine[2], 1e-9);
  EXPECT_NEAR(fine[2], force[1], 1e-9);
  // It acts as a channel of one newton per newton.
  const Model<double> drawn = ensemble.axis(model, 4);
  ASSERT_NE(drawn.structure.channels, nullptr);
  EXPECT_EQ(drawn.structure.channels->size(), 1u);
  Model<double> copy = drawn;
  EXPECT_EQ(*members(copy)[quantity_index("channel_force.k_1")], 1.0);
}

TEST(Ensemble, NeedsAChannelForTheMissingForce) {
  Model<double> model = paper_axis();
  model.structure.channels = kept({{"a", "1"}, {"b", "1"}, {"c", "1"}, {"d", "1"}});
  AxisUncertainty uncertainty;
  EXPECT_NO_THROW(AxisEnsemble(uncertainty, model.structure, 1));
  uncertainty.missing_force = MissingForceProcess{0.01, 6.9, 3.0, {}};
  EXPECT_THROW(AxisEnsemble(uncertainty, model.structure, 1), std::runtime_error);
}

// Of random walks: known in closed form at any instant, and from the reflection principle as a
// whole.
TEST(Ensemble, ABandHoldsItsShareOfTheCurves) {
  std::mt19937_64 random(5);
  constexpr std::size_t kCurves = 1000, kSamples = 400;
  const auto walks = [&] {
    std::vector<std::vector<double>> curves(kCurves, std::vector<double>(kSamples, 0.0));
    for (auto& c : curves)
      for (std::size_t i = 1; i < kSamples; ++i) c[i] = c[i - 1] + normal(random);
    return curves;
  };
  const std::vector<double> middle(kSamples, 0.0);
  const Band band = band_of(middle, walks());
  EXPECT_EQ(band.half_width[0], 0.0);
  EXPECT_NEAR(band.half_width[100], 19.6, 1.6);
  EXPECT_NEAR(band.half_width[399], 39.2, 3.2);
  int inside = 0, whole = 0;
  for (const auto& c : walks()) {
    bool all = true;
    for (std::size_t i = 1; i < kSamples; ++i) {
      inside += std::abs(c[i]) <= band.half_width[i];
      all = all && std::abs(c[i]) <= band.whole * band.half_width[i];
    }
    whole += all;
  }
  EXPECT_NEAR(inside / double(kCurves * (kSamples - 1)), 0.95, 0.01);
  EXPECT_NEAR(whole / double(kCurves), 0.95, 0.03);
  EXPECT_GT(band.whole, 1.2);
  EXPECT_EQ(band.reach(0.5), 1u);
  EXPECT_EQ(band.reach(1e9), kSamples);
}

}  // namespace
}  // namespace axisfit
