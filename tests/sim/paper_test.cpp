// What the paper says of its simulations, and figures of an independent simulator.
#include <gtest/gtest.h>

#include <iostream>
#include <numbers>

#include "tests/sim/axes.h"

namespace axisfit {
namespace {

struct Transient {
  Run<double> run;
  double reaches = 0.0;  ///< s, instant at which the arm reaches 0.98 m/s
  double peak = 0.0;     ///< m/s
  double settles = 0.0;  ///< s, instant after which |y1'| stays below 0.2 m/s^2
};

constexpr double kDt = 1e-3;

Transient step_of_10_volts(const Model<double>& model) {
  Transient t;
  t.run = run(model, step_command(), instants(2000, kDt));
  EXPECT_TRUE(t.run.finished);
  for (std::size_t k = 0; k < t.run.states.size(); ++k) {
    const double v = t.run.states[k][1], time = kDt * static_cast<double>(k);
    if (t.reaches == 0.0 && v >= 0.98) t.reaches = time;
    t.peak = std::max(t.peak, v);
    if (std::abs(t.run.acceleration[k]) >= 0.2) t.settles = time;
  }
  return t;
}

template <class Change>
Transient changed(Change&& change) {
  Model<double> model = paper_axis();
  change(model.axis);
  return step_of_10_volts(model);
}

/// Half the swing of the acceleration from `begin` to `end` (s).
double swing(const Run<double>& run, double begin, double end) {
  const auto at = [](double t) { return static_cast<std::ptrdiff_t>(std::lround(t / kDt)); };
  const auto [low, high] =
      std::minmax_element(run.acceleration.begin() + at(begin), run.acceleration.begin() + at(end));
  return 0.5 * (*high - *low);
}

constexpr double kSample = 1.01e-3;  // s, how finely the figures were given and are read

TEST(PaperFigures, StepOf10Volts) {
  const Transient t = step_of_10_volts(paper_axis());
  EXPECT_NEAR(t.reaches, 0.601, kSample);
  for (double time = 0.003; time < t.reaches; time += kDt)
    ASSERT_GT(t.run.current[static_cast<std::size_t>(std::lround(time / kDt))], 7.8) << time;
  EXPECT_NEAR(t.peak, 1.036, 0.0005);
  EXPECT_NEAR(t.settles, 0.860, kSample);
}

TEST(PaperFigures, SettlingByBacklashAndStiffness) {
  EXPECT_NEAR(changed([](auto& a) { a.H = 0.0; }).settles, 0.856, kSample);
  EXPECT_NEAR(changed([](auto& a) { a.H = 1e-4; }).settles, 0.890, kSample);
  EXPECT_NEAR(changed([](auto& a) { a.k_g = 2e6; }).settles, 1.019, kSample);
  EXPECT_NEAR(changed([](auto& a) { a.k_g = 1e7; }).settles, 0.789, kSample);
}

TEST(PaperFigures, SlowCompensation) {
  const Transient t = changed([](auto& a) { a.T_p = 0.195; });
  EXPECT_NEAR(t.peak, 1.179, 0.0005);
  EXPECT_NEAR(t.settles, 1.240, kSample);
}

// Statement 1, the linear case, is in linear_test.cpp.

TEST(PaperStatements, TheCurrentIsAtItsLimitThenRingsWhileTheVelocitySettles) {  // statement 2
  const Transient t = step_of_10_volts(paper_axis());
  int at_limit = 0, turns = 0;
  for (std::size_t k = 1; k + 1 < 1000; ++k) {
    const double time = kDt * static_cast<double>(k);
    if (time < t.reaches && t.run.current[k] > 0.97 * 3.0 * 2.7) ++at_limit;
    const double before = t.run.current[k] - t.run.current[k - 1];
    const double after = t.run.current[k + 1] - t.run.current[k];
    if (time > t.reaches && before * after < 0.0) ++turns;
  }
  EXPECT_GT(at_limit, 550);  // of 601 ms
  EXPECT_GT(turns, 10);
  for (std::size_t k = 1500; k <= 2000; ++k) ASSERT_NEAR(t.run.states[k][1], 1.0, 0.002);
}

TEST(PaperStatements, TheRingingDecaysSlowlyWhenTpIsReduced) {  // statement 3
  const double usual = swing(step_of_10_volts(paper_axis()).run, 1.2, 1.4);
  const double reduced = swing(changed([](auto& a) { a.T_p = 0.0071; }).run, 1.2, 1.4);
  std::cout << "swing " << usual << " and " << reduced << " m/s^2\n";
  EXPECT_NEAR(usual, 0.003, 0.0005);
  EXPECT_NEAR(reduced, 0.012, 0.001);
  EXPECT_GT(reduced, 2.0 * usual);
}

TEST(PaperStatements, BacklashMattersLittleAndStiffnessMuch) {  // statement 4
  const double usual = step_of_10_volts(paper_axis()).settles;
  const double tight = changed([](auto& a) { a.H = 0.0; }).settles;
  const double soft = changed([](auto& a) { a.k_g = 2e6; }).settles;
  const double hard = changed([](auto& a) { a.k_g = 1e7; }).settles;
  EXPECT_LT(std::abs(usual - tight), 0.01 * usual);
  EXPECT_GT(soft, 1.15 * usual);
  EXPECT_LT(hard, 0.93 * usual);
}

/// Where the current is at its limit the axis is a mass with friction and a constant force; the
/// gear's ringing averages out over its period.
double saturated_velocity(const Axis<double>& a, double t) {
  const double J = a.J_m + a.r_g * a.r_g * a.M, B = a.B_m + a.r_g * a.r_g * a.B_a;
  const double current = a.K_i * a.V_L * (1.0 - a.R / (a.K_v / a.K_i));
  return a.r_g * a.K_m * current / B * (1.0 - std::exp(-B / J * t));
}

TEST(PaperStatements, SaturationCurrentSetsTheSlopeAndFrictionTheRise) {  // statement 5, first half
  for (const double V_L : {2.0, 2.7})
    for (const double B_a : {100.0, 200.0, 300.0}) {
      Model<double> model = paper_axis();
      model.axis.V_L = V_L;
      model.axis.B_a = B_a;
      const auto r = run(model, step_command(), instants(500, kDt));
      const double slope = (r.states[80][1] - r.states[5][1]) / 0.075;
      const double expected =
          (saturated_velocity(model.axis, 0.08) - saturated_velocity(model.axis, 0.005)) / 0.075;
      EXPECT_NEAR(slope / expected, 1.0, 0.03) << V_L << " " << B_a;
      EXPECT_NEAR(r.states[450][1] / saturated_velocity(model.axis, 0.45), 1.0, 0.01)
          << V_L << " " << B_a;
    }
}

/// Ringing of the gear force: instants at which the acceleration crosses its average upwards, and
/// the ratio of successive swings about it.
struct Ringing {
  double period, decay;  // s, 1/s
};

Ringing ringing(const Model<double>& model) {
  const double dt = 1e-4;
  const auto r = run(model, step_command(), instants(1500, dt));
  // From 10 ms on the current has settled at its limit. The mean falls slowly with the velocity.
  const auto mean = [&](std::size_t k) {
    const Axis<double>& a = model.axis;
    return (saturated_velocity(a, dt * static_cast<double>(k) + 1e-5) -
            saturated_velocity(a, dt * static_cast<double>(k) - 1e-5)) /
           2e-5;
  };
  std::vector<double> crossings, peaks;
  double peak = 0.0;
  for (std::size_t k = 100; k + 1 < r.states.size(); ++k) {
    const double g = r.acceleration[k] - mean(k), next = r.acceleration[k + 1] - mean(k + 1);
    peak = std::max(peak, g);
    if (g < 0.0 && next >= 0.0) {
      crossings.push_back(dt * (static_cast<double>(k) - g / (next - g)));
      peaks.push_back(peak);
      peak = 0.0;
    }
  }
  const std::size_t n = 4;
  return {(crossings[n] - crossings[0]) / static_cast<double>(n),
          std::log(peaks[1] / peaks[n]) / (crossings[n] - crossings[1])};
}

TEST(PaperStatements, StiffnessAndDampingSetTheRingingOfTheGearForce) {  // statement 5, second half
  for (const double k_g : {2e6, 5e6})
    for (const double b_g : {800.0, 1500.0}) {
      Model<double> model = paper_axis();
      model.axis.k_g = k_g;
      model.axis.b_g = b_g;
      const Axis<double>& a = model.axis;
      const double mobility = 1.0 / a.M + 1.0 / motor_mass(a);
      const Ringing found = ringing(model);
      std::cout << "period " << found.period << " decay " << found.decay << " expected "
                << 2.0 * std::numbers::pi / std::sqrt(k_g * mobility) << " " << 0.5 * b_g * mobility
                << "\n";
      EXPECT_NEAR(found.period * std::sqrt(k_g * mobility) / (2.0 * std::numbers::pi), 1.0, 0.03);
      EXPECT_NEAR(found.decay / (0.5 * b_g * mobility), 1.0, 0.1);
    }
}

}  // namespace
}  // namespace axisfit
