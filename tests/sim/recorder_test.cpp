// Lags and delays of instruments against closed forms, and their derivatives against differences.
#include "sim/recorder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include "tests/sim/experiment.h"

namespace axisfit {
namespace {

constexpr double kMass = 12.0;

/// What the instruments of the model show of kRecorded.
Traces<double> shown(const Model<double>& model, const Schedule& command,
                     const std::vector<double>& times) {
  return Experiment{model, command, times, {}, {}, {}}.traces(model);
}

Instrument<double>& instrument(Model<double>& model, Signal signal) {
  return model.instruments[index_of(signal)];
}

/// A mass under a constant force: its velocity is a ramp, its acceleration constant.
Model<double> ramp() { return driven_mass(kMass); }
const Schedule kPush{{0.0}, {24.0}};
constexpr double kSlope = 2.0;  // m/s^2

/// A mass on a spring: its velocity is v cos(w t).
constexpr double kSpeed = 0.5, kOmega = 40.0;
Model<double> oscillation() {
  Model<double> model = driven_mass(kMass);
  add_effect<StrokeSpring>(model).k_s = kMass * kOmega * kOmega;
  model.initial[1] = kSpeed;
  return model;
}

TEST(Recorder, LagOfARampIsExact) {
  // At any ratio of the lag to the sampling interval, and with irregular samples.
  std::vector<double> times = instants(200, 1e-3);
  for (std::size_t k = 1; k < times.size(); k += 3) times[k] += 0.4e-3;
  for (const double lag : {1e-9, 1e-5, 1e-3, 0.02, 1.0}) {
    Model<double> model = ramp();
    instrument(model, Signal::velocity) = {1.1, 0.3, lag, 0.0};
    const auto traces = shown(model, kPush, times);
    for (std::size_t k = 0; k < times.size(); ++k) {
      const double t = times[k];
      const double truth = kSlope * (t - lag + lag * std::exp(-t / lag));
      ASSERT_NEAR(traces.signals[0][k], 1.1 * truth + 0.3, 1e-12) << "lag " << lag << " at " << t;
    }
  }
}

TEST(Recorder, LagOfASineIsThatOfItsClosedFormToSecondOrder) {
  // s' = (v cos(w t) - s) / lag from s = v. Between instants, a fourth of a sample apart, the
  // reading is taken as linear: off by (w h)^2 / 8 at most.
  for (const double dt : {4e-3, 1e-3}) {
    const auto times = instants(static_cast<std::size_t>(std::lround(0.4 / dt)), dt);
    const double allowed = kSpeed * std::pow(kOmega * dt / 4.0, 2) / 8.0 * 1.01;
    for (const double lag : {1e-3, 0.01, 0.1}) {
      Model<double> model = oscillation();
      instrument(model, Signal::velocity).lag = lag;
      const auto traces = shown(model, {}, times);
      const double z = kOmega * lag, share = kSpeed / (1.0 + z * z);
      double worst = 0.0;
      for (std::size_t k = 0; k < times.size(); ++k) {
        const double q = kOmega * times[k];
        const double truth =
            share * (std::cos(q) + z * std::sin(q)) + (kSpeed - share) * std::exp(-times[k] / lag);
        worst = std::max(worst, std::abs(traces.signals[0][k] - truth));
      }
      EXPECT_LT(worst, allowed) << "lag " << lag << ", samples " << dt;
    }
  }
}

TEST(Recorder, DelayShiftsAndHoldsTheEnds) {
  const auto times = instants(200, 1e-3);
  for (const double delay : {0.0137, 1e-3, 0.3e-3, -0.0137, -0.2e-3}) {
    Model<double> model = ramp();
    instrument(model, Signal::velocity).delay = delay;
    const auto traces = shown(model, kPush, times);
    for (std::size_t k = 0; k < times.size(); ++k) {
      const double t = std::clamp(times[k] - delay, times.front(), times.back());
      ASSERT_NEAR(traces.signals[0][k], kSlope * t, 1e-12) << "delay " << delay << " at " << k;
    }
    // Other instruments are not touched.
    ASSERT_NEAR(traces.signals[1].back(), kSlope, 1e-12);
    ASSERT_NEAR(traces.signals[2].back(), 0.5 * kSlope * 0.04, 1e-12);
  }
}

TEST(Recorder, DriftDelaysMoreAndMore) {
  // Whatever the recording's time is at its first sample.
  auto times = instants(200, 1e-3);
  for (double& t : times) t += 0.05;
  for (const double drift : {0.07, -0.04}) {
    Model<double> model = ramp();
    instrument(model, Signal::velocity).drift = drift;
    instrument(model, Signal::velocity).delay = 1.3e-3;
    const auto plain = shown(ramp(), kPush, times), traces = shown(model, kPush, times);
    const double first = plain.signals[0].front();
    for (std::size_t k = 0; k < times.size(); ++k) {
      const double since = times[k] - times.front(), late = 1.3e-3 + drift * since;
      const double t = std::clamp(since - late, 0.0, times.back() - times.front());
      ASSERT_NEAR(traces.signals[0][k], first + kSlope * t, 1e-12) << drift << " at " << k;
    }
    EXPECT_EQ(traces.signals[1].size(), plain.signals[1].size());
    ASSERT_NEAR(traces.signals[1].back(), plain.signals[1].back(), 1e-12);
  }
}

TEST(Recorder, DelayComesAfterTheLag) {
  const auto times = instants(200, 1e-3);
  constexpr double lag = 0.02, delay = 0.0137;
  Model<double> model = ramp();
  instrument(model, Signal::velocity) = {1.0, 0.0, lag, delay};
  const auto traces = shown(model, kPush, times);
  for (std::size_t k = 30; k < times.size(); ++k) {
    const double t = times[k] - delay;
    // The response is not linear between instants: (h / lag)^2 / 8 of kSlope lag.
    ASSERT_NEAR(traces.signals[0][k], kSlope * (t - lag + lag * std::exp(-t / lag)), 1e-6);
  }
}

TEST(Recorder, WithoutLagAndDelayIsTheReadingBitForBit) {
  const Model<double> model = paper_axis();
  const auto times = instants(500, 1e-3);
  const auto traces = shown(model, level_command(), times);
  std::vector<double> velocity;
  simulate(model, level_command(), times, [&](std::size_t, const Integrator<double>& axis) {
    velocity.push_back(
        reading(axis.equations(), Signal::velocity, axis.mode(), axis.state(), axis.input()));
  });
  EXPECT_EQ(traces.signals[0], velocity);
}

TEST(Recorder, ALateInstrumentLeavesTheOthersAlone) {
  // Whatever it needs: the simulation is then read between the samples too.
  Model<double> model = paper_axis();
  const auto times = instants(500, 1e-3);
  const auto without = shown(model, level_command(), times);
  instrument(model, Signal::position) = {1.0, 0.0, 3e-3, 1e-3};
  const auto with = shown(model, level_command(), times);
  EXPECT_EQ(with.events, without.events);
  for (const std::size_t s : {0U, 1U, 3U})
    for (std::size_t k = 0; k < times.size(); ++k)
      ASSERT_NEAR(with.signals[s][k], without.signals[s][k], 1e-7) << s << " " << k;
}

/// The paper's axis there and back, with what the lags and delays act on, and nothing too fast for
/// samples of 0.2 ms.
Experiment late_axis() {
  Experiment experiment;
  experiment.model = paper_axis();
  add_effect<CoulombFriction>(experiment.model).F_c = 15.0;
  experiment.command = {{0.0, 0.08}, {4.0, -3.0}};
  experiment.times = instants(800, 0.2e-3);
  return experiment;
}

std::vector<QuantityEntry> entries(std::initializer_list<const char*> names) {
  std::vector<QuantityEntry> found;
  for (const char* name : names) found.push_back(quantity_list()[quantity_index(name)]);
  return found;
}

TEST(Recorder, HasDerivativesByLagDelayAndAllElse) {
  Experiment experiment = late_axis();
  for (const Signal signal : kRecorded)
    instrument(experiment.model, signal) = {1.1, 0.02, 2.3e-3, 1.71e-3, 1e-9};
  // A delay moves along the lines between instants: within one of them, so that differences see no
  // corner.
  constexpr double kWithin = 1e-5;
  const auto of =
      entries({"velocity.lag", "velocity.delay", "acceleration.lag", "acceleration.delay",
               "position.delay", "position.drift", "motor_current.lag", "motor_current.delay",
               "velocity.gain", "acceleration.bias", "B_a"});
  Worst worst;
  compare(
      experiment, of, {by_jets(experiment, of)},
      [&](std::size_t, const Comparison& c) {
        EXPECT_LT(c.convergence, 1e-4) << c.name;
        EXPECT_LT(c.error, 1e-4 + c.convergence) << c.name;
        worst.add(c);
      },
      [&](const QuantityEntry& entry, double value) {
        const std::string_view symbol = entry.quantity.symbol;
        return symbol == "delay" || symbol == "drift" ? kWithin : natural_size(entry, value);
      });
  std::cout << worst << "\n";
}

TEST(Recorder, HasTheDerivativeToTheRightAtZeroLag) {
  Experiment experiment = late_axis();
  const auto of = entries({"velocity.lag", "position.lag"});
  Worst worst;
  for (const QuantityEntry& entry : of)
    compare(
        experiment, {entry}, {by_jets<1>(experiment, {entry})},
        [&](std::size_t, const Comparison& c) {
          EXPECT_LT(c.convergence, 1e-4) << c.name;
          EXPECT_LT(c.error, 1e-4 + c.convergence) << c.name;
          worst.add(c);
        },
        // So short that exp(-h / lag) is nothing.
        [](const QuantityEntry&, double) { return 1e-6; }, Sides::above);
  std::cout << worst << "\n";
}

TEST(Recorder, HasTheDerivativeToTheRightAtZeroDelay) {
  Experiment experiment = late_axis();
  const auto of = entries({"velocity.delay", "acceleration.delay", "motor_current.delay"});
  Worst worst;
  for (const QuantityEntry& entry : of)
    compare(
        experiment, {entry}, {by_jets<1>(experiment, {entry})},
        [&](std::size_t, const Comparison& c) {
          EXPECT_LT(c.convergence, 1e-4) << c.name;
          EXPECT_LT(c.error, 1e-4 + c.convergence) << c.name;
          worst.add(c);
        },
        [](const QuantityEntry&, double) { return 1e-5; }, Sides::above);
  std::cout << worst << "\n";
}

}  // namespace
}  // namespace axisfit
