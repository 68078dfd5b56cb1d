#include "sim/controller.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "sim/rig.h"
#include "tests/sim/experiment.h"

namespace axisfit {
namespace {

TEST(Controller, CommandIsFoundAgainFromReferenceAndEncoder) {
  Rig rig;
  rig.model = paper_axis();
  const MoveMotion move{1.0, 0.9, 2.0};
  RecordingOptions options;
  options.duration = 2.0;
  options.signals = {Signal::position};
  const std::vector<Column> columns = record(rig, move, options);
  const std::vector<double>& times = columns[0].values;
  std::vector<double> reference;
  for (const double t : times) reference.push_back(reference_of(move)(t));
  const Schedule track{times, reference, Hold::linear};
  const std::vector<double> command = command_from_reference(
      rig.model.controller, times,
      track_points(rig.model.controller.timing, [&](double t) { return track.value_at(t); }),
      columns[2].values);
  ASSERT_EQ(command.size(), times.size());
  double error = 0.0;
  // The run ends before the sampling at its last instant.
  for (std::size_t i = 0; i + 1 < times.size(); ++i)
    error = std::max(error, std::abs(command[i] - columns[1].values[i]));
  // The recorded reference is interpolated at the track instants, the original is exact there.
  EXPECT_LT(error, 1e-6);
}

TEST(Controller, EncoderCountsWholeSteps) {
  const double count = 2.0 * 3.14159265358979 * 0.00573 / 4000.0;
  EXPECT_NEAR(encoder_reading(3.7 * count, 0.00573, 4000), 3.0 * count, 1e-15);
  EXPECT_NEAR(encoder_reading(-0.2 * count, 0.00573, 4000), -count, 1e-15);
  EXPECT_EQ(encoder_reading(0.1234, 0.00573, 0), 0.1234);
}

/// A table on a screw with a servo drive: cascade, 2 ms.
Model<double> servo_axis() {
  Model<double> model = paper_axis();
  model.structure = {Drive::motor_current, Transmission::rigid};
  model.structure.closed_loop = true;
  model.axis.M = 20.0;
  model.axis.B_a = 60.0;
  model.axis.K_f = 100.0;
  normalize(model);
  model.controller.timing.period = 2e-3;
  model.controller.gains = {.k_ff = 0.9,
                            .k_p = 25.0,
                            .k_i = 3.0,
                            .gain = 12.0,
                            .k_v = 1.0,
                            .k_n = 15.0,
                            .k_a = 0.15,
                            .limit = 9.0,
                            .speed_limit = 0.8,
                            .u_0 = 0.05};
  return model;
}

/// Steps and ramps that reach both limits.
Schedule reference() {
  Schedule schedule;
  schedule.meaning = Meaning::reference;
  for (int i = 0; i < 400; ++i) {
    const double t = 2e-3 * i;
    schedule.append(t, i < 100 ? 0.0 : i < 250 ? 0.15 : 0.15 - 0.4 * (t - 0.5));
  }
  return schedule;
}

/// At these instants.
std::vector<double> positions_of(const Model<double>& model, const Schedule& schedule,
                                 const std::vector<double>& times) {
  std::vector<double> positions;
  EXPECT_TRUE(simulate(model, schedule, times, [&](std::size_t, const Integrator<double>& axis) {
                positions.push_back(axis.state()[0]);
              }).finished);
  positions.resize(times.size(), NAN);
  return positions;
}

/// A mass with viscous friction under a command that is held: it moves exactly.
struct ExactMass {
  const Axis<double>& axis;
  double x = 0.0, v = 0.0;

  void go_on(double command, double time) {
    const double B = axis.B_a, M = axis.M;
    const double decay = std::exp(-B * time / M), end = axis.K_f * command / B;
    x += end * time + (v - end) * (1.0 - decay) * M / B;
    v = end + (v - end) * decay;
  }
};

/// What the controller of an axis, which moves at the start, makes of the reference.
Experiment in_the_loop(Model<double> model, double dead_time) {
  Experiment experiment;
  experiment.model = std::move(model);
  experiment.model.axis.T_d = dead_time;
  experiment.model.initial = {1e-3, 0.03};
  experiment.command = reference();
  experiment.times = instants(350, 2e-3);
  return experiment;
}

// A mass with viscous friction has an exact recursion from one sample of its controller to the
// next.
TEST(Controller, InTheLoopFollowsTheExactRecursion) {
  const Model<double> model = servo_axis();
  const Schedule schedule = reference();
  const double T = model.controller.timing.period;
  const ControllerGains<double>& g = model.controller.gains;
  std::vector<double> times;
  for (int i = 0; i < 400; ++i) times.push_back(T * i);
  const std::vector<double> positions = positions_of(model, schedule, times);
  ExactMass mass{model.axis};
  const double& x = mass.x;
  double last = 0.0, sum = 0.0, held = 0.0, worst = 0.0;
  int at_limit = 0, at_speed = 0;
  const auto r = [&](int i) { return i < 0 ? 0.0 : schedule.values[static_cast<std::size_t>(i)]; };
  for (int i = 0; i < 400; ++i) {
    worst = std::max(worst, std::abs(positions[static_cast<std::size_t>(i)] - x));
    const double e = r(i) - x;
    sum += e;
    double w = g.k_ff * (r(i) - r(i - 1)) / T + g.k_p * e + g.k_i * T * sum;
    at_speed += std::abs(w) > g.speed_limit ? 1 : 0;
    w = std::clamp(w, -g.speed_limit, g.speed_limit);
    const double s = w - (x - last) / T, most = g.limit / g.gain;
    held = std::clamp(held + g.k_n * T * s, -most, most);
    const double raw =
        g.gain * (s + held) + g.k_a * (r(i) - 2.0 * r(i - 1) + r(i - 2)) / (T * T) + g.u_0;
    const double u = std::clamp(raw, -g.limit, g.limit);
    at_limit += u == raw ? 0 : 1;
    last = x;
    mass.go_on(u, T);
  }
  EXPECT_LT(worst, 1e-12);
  EXPECT_GE(at_limit, 5);
  EXPECT_GT(at_speed, 3);
}

TEST(Controller, InTheLoopHasExactDerivatives) {
  for (const double dead_time : {0.2e-3, 0.7e-3}) {
    SCOPED_TRACE(dead_time);
    Model<double> model = servo_axis();
    add_effect<CoulombFriction>(model).F_c = 30.0;
    expect_derivatives(in_the_loop(std::move(model), dead_time));
  }
}

// Of a motor at the voltage that a proportional law makes of the error, as in hobby servos.
TEST(Controller, OfAHobbyServoHasExactDerivatives) {
  Model<double> m = paper_axis();
  m.structure = {Drive::motor_voltage, Transmission::rigid};
  m.structure.closed_loop = true;
  normalize(m);
  m.controller.timing.period = 2e-3;
  m.controller.gains = {.k_ff = 0.05, .k_p = 1.0, .k_i = 0.0, .gain = 400.0, .limit = 40.0};
  add_effect<CoulombFriction>(m).F_c = 20.0;
  expect_derivatives(in_the_loop(std::move(m), 0.3e-3));
}

/// With a velocity loop of four samples in each period, lags and a notch filter.
Model<double> filtering_axis() {
  Model<double> model = servo_axis();
  model.controller.timing.velocity_samples = 4;
  model.controller.gains.T_v = 0.8e-3;
  model.controller.gains.T_u = 0.3e-3;
  model.controller.gains.notch_depth = 0.2;
  model.controller.gains.notch_frequency = 180.0;
  model.controller.gains.notch_width = 0.7;
  return model;
}

TEST(Controller, WithALoopWithinTheLoopFollowsTheExactRecursion) {
  Model<double> model = filtering_axis();
  model.controller.gains.notch_depth = 1.0;
  const Schedule schedule = reference();
  const double T = model.controller.timing.period, t = T / 4;
  const ControllerGains<double>& g = model.controller.gains;
  std::vector<double> times;
  for (int i = 0; i < 1600; ++i) times.push_back(t * i);
  const std::vector<double> positions = positions_of(model, schedule, times);
  ExactMass mass{model.axis};
  const double& x = mass.x;
  double last = 0.0, sum = 0.0, held = 0.0, worst = 0.0, w = 0.0, k_a = 0.0, speed = 0.0,
         lagged = 0.0;
  const auto r = [&](int i) { return i < 0 ? 0.0 : schedule.values[static_cast<std::size_t>(i)]; };
  for (int n = 0; n < 1600; ++n) {
    worst = std::max(worst, std::abs(positions[static_cast<std::size_t>(n)] - x));
    if (const int i = n / 4; n % 4 == 0) {
      sum += r(i) - x;
      w = g.k_ff * (r(i) - r(i - 1)) / T + g.k_p * (r(i) - x) + g.k_i * T * sum;
      w = std::clamp(w, -g.speed_limit, g.speed_limit);
      k_a = g.k_a * (r(i) - 2.0 * r(i - 1) + r(i - 2)) / (T * T);
    }
    speed = (g.T_v * speed + (x - last)) / (g.T_v + t);
    last = x;
    const double s = w - speed, most = g.limit / g.gain;
    held = std::clamp(held + g.k_n * t * s, -most, most);
    const double u = std::clamp(g.gain * (s + held) + k_a + g.u_0, -g.limit, g.limit);
    lagged = n == 0 ? u : (g.T_u * lagged + t * u) / (g.T_u + t);
    mass.go_on(lagged, t);
  }
  EXPECT_LT(worst, 1e-12);
}

// The filter has the gain that is asked for at its frequency, and none at zero and far above.
TEST(Controller, NotchFilterHasItsDepthAndWidth) {
  const Controller<double> controller = filtering_axis().controller;
  const auto gain_at = [&](double frequency) {
    ControllerMemory<double> memory;
    double in_phase = 0.0, across = 0.0;
    constexpr int kSettled = 4000, kMeasured = 20000;
    for (int n = 0; n < kSettled + kMeasured; ++n) {
      const double angle =
          2.0 * std::numbers::pi * frequency * n * controller.timing.command_period();
      const double passed = notched(controller, std::cos(angle), memory);
      ++memory.commands;
      if (n < kSettled) continue;
      in_phase += 2.0 * passed * std::cos(angle) / kMeasured;
      across += 2.0 * passed * std::sin(angle) / kMeasured;
    }
    return std::hypot(in_phase, across);
  };
  EXPECT_NEAR(gain_at(180.0), 0.2, 1e-6);
  EXPECT_NEAR(gain_at(1.0), 1.0, 1e-3);
  EXPECT_NEAR(gain_at(990.0), 1.0, 1e-3);
  // At the edges of the band the real part of the answer is half-way: sqrt((1 + c^2) / 2). Their
  // frequencies are bent by the bilinear transformation.
  const double T = controller.timing.command_period(), pi = std::numbers::pi;
  const double k = std::tan(pi * 180.0 * T), half = 0.5 * 0.7;
  const double upper = std::atan(k * (half + std::sqrt(1.0 + half * half))) / (pi * T);
  EXPECT_NEAR(gain_at(upper), std::sqrt((1.0 + 0.04) / 2.0), 1e-3);
}

TEST(Controller, NotchFilterBeginsSettled) {
  const Controller<double> controller = filtering_axis().controller;
  ControllerMemory<double> memory;
  for (int n = 0; n < 10; ++n) {
    EXPECT_NEAR(notched(controller, 3.5, memory), 3.5, 1e-14);
    ++memory.commands;
  }
}

TEST(Controller, WithFiltersHasExactDerivatives) {
  Model<double> model = filtering_axis();
  add_effect<CoulombFriction>(model).F_c = 30.0;
  expect_derivatives(in_the_loop(std::move(model), 0.2e-3));
}

// Commands that act several periods after they were written.
TEST(Controller, WithALongDeadTimeFollowsTheExactRecursion) {
  Model<double> model = servo_axis();
  model.controller.gains.k_p = 10.0;
  model.controller.gains.k_i = model.controller.gains.k_n = model.controller.gains.k_a = 0.0;
  model.controller.gains.gain = 4.0;
  const double T = model.controller.timing.period;
  model.axis.T_d = 2.25 * T;
  const Schedule schedule = reference();
  const ControllerGains<double>& g = model.controller.gains;
  std::vector<double> times;
  for (int i = 0; i < 400; ++i) times.push_back(T * i);
  const std::vector<double> positions = positions_of(model, schedule, times);
  ExactMass mass{model.axis};
  const double& x = mass.x;
  double last = 0.0, worst = 0.0;
  std::vector<double> commands{0.0, 0.0, 0.0};  // the ones before the first
  const auto r = [&](int i) { return i < 0 ? 0.0 : schedule.values[static_cast<std::size_t>(i)]; };
  for (int i = 0; i < 400; ++i) {
    worst = std::max(worst, std::abs(positions[static_cast<std::size_t>(i)] - x));
    const double w = std::clamp(g.k_ff * (r(i) - r(i - 1)) / T + g.k_p * (r(i) - x), -g.speed_limit,
                                g.speed_limit);
    commands.push_back(std::clamp(g.gain * (w - (x - last) / T) + g.u_0, -g.limit, g.limit));
    last = x;
    const std::size_t now = commands.size() - 1;
    mass.go_on(commands[now - 3], 0.25 * T);  // until the command of two periods before acts
    mass.go_on(commands[now - 2], 0.75 * T);
  }
  EXPECT_LT(worst, 1e-12);
}

TEST(Controller, WithALongDeadTimeHasExactDerivatives) {
  Model<double> model = servo_axis();
  model.controller.gains.gain = 4.0;
  expect_derivatives(in_the_loop(std::move(model), 5.3e-3));
}

}  // namespace
}  // namespace axisfit
