#include "sim/controller.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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

// A mass with viscous friction has an exact recursion from one sample of its controller to the
// next.
TEST(Controller, InTheLoopFollowsTheExactRecursion) {
  const Model<double> model = servo_axis();
  const Schedule schedule = reference();
  const double T = model.controller.timing.period, M = model.axis.M, B = model.axis.B_a,
               K = model.axis.K_f;
  const ControllerGains<double>& g = model.controller.gains;
  std::vector<double> times, positions;
  for (int i = 0; i < 400; ++i) times.push_back(T * i);
  ASSERT_TRUE(simulate(model, schedule, times, [&](std::size_t, const Integrator<double>& axis) {
                positions.push_back(axis.state()[0]);
              }).finished);
  double x = 0.0, v = 0.0, last = 0.0, sum = 0.0, held = 0.0, worst = 0.0;
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
    const double decay = std::exp(-B * T / M), end = K * u / B;
    x += end * T + (v - end) * (1.0 - decay) * M / B;
    v = end + (v - end) * decay;
  }
  EXPECT_LT(worst, 1e-12);
  EXPECT_GE(at_limit, 5);
  EXPECT_GT(at_speed, 3);
}

TEST(Controller, InTheLoopHasExactDerivatives) {
  for (const double dead_time : {0.2e-3, 0.7e-3}) {
    SCOPED_TRACE(dead_time);
    Experiment experiment;
    experiment.model = servo_axis();
    experiment.model.axis.T_d = dead_time;
    experiment.model.initial = {1e-3, 0.03};
    add_effect<CoulombFriction>(experiment.model).F_c = 30.0;
    experiment.command = reference();
    experiment.times = instants(350, 2e-3);
    expect_derivatives(experiment);
  }
}

// Of a motor at the voltage that a proportional law makes of the error, as in hobby servos.
TEST(Controller, OfAHobbyServoHasExactDerivatives) {
  Experiment experiment;
  Model<double>& m = experiment.model;
  m = paper_axis();
  m.structure = {Drive::motor_voltage, Transmission::rigid};
  m.structure.closed_loop = true;
  normalize(m);
  m.controller.timing.period = 2e-3;
  m.controller.gains = {.k_ff = 0.05, .k_p = 1.0, .k_i = 0.0, .gain = 400.0, .limit = 40.0};
  m.initial = {1e-3, 0.03};
  m.axis.T_d = 0.3e-3;
  add_effect<CoulombFriction>(m).F_c = 20.0;
  experiment.command = reference();
  experiment.times = instants(350, 2e-3);
  expect_derivatives(experiment);
}

}  // namespace
}  // namespace axisfit
