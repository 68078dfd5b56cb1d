// Fits to a table behind a screw with a gap, of which the encoder of the motor and a linear scale
// were recorded. The recordings are made by a simulation of its own: two masses, a spring and a
// damper with a dead zone between them, semi-implicit Euler steps of 1 us.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/random.h"
#include "fit/estimate/estimate.h"
#include "tests/fit/parameter_ids.h"
#include "tests/sim/axes.h"

namespace axisfit {
namespace {

struct Table {
  double motor = 12.0, mass = 30.0;        // kg, the motor's at the table
  double stiffness = 2e7, damping = 9e3;   // N/m, N s/m
  double gap = 40e-6;                      // m, half of it
  double viscous = 120.0, coulomb = 25.0;  // N s/m, N of the table
  double force = 100.0;                    // N/A
  double sigma = 0.3e-6;                   // m
};

Recording recorded(const Table& truth, Role role) {
  constexpr double kStep = 1e-6, kInterval = 1e-3;
  constexpr int kSamples = 1200;
  Recording recording;
  recording.name = role == Role::fit ? "fit" : "check";
  recording.role = role;
  std::vector<double> times, currents, motor, load;
  double x = 0.0, v = 0.0, q = 0.0, w = 0.0;  // table, motor
  std::mt19937_64 generator(role == Role::fit ? 1 : 2);
  for (int k = 0; k < kSamples; ++k) {
    const double t = kInterval * k, slow = role == Role::fit ? 2.0 : 3.0;
    const double current = 2.0 * std::sin(6.2832 * slow * t) + 1.2 * std::sin(6.2832 * 11.0 * t);
    times.push_back(t);
    currents.push_back(current);
    motor.push_back(q + truth.sigma * normal(generator));
    load.push_back(x + truth.sigma * normal(generator));
    for (int i = 0; i < 1000; ++i) {
      const double apart = q - x;
      double contact = 0.0;
      if (std::abs(apart) > truth.gap)
        contact =
            truth.stiffness * (apart - std::copysign(truth.gap, apart)) + truth.damping * (w - v);
      w += kStep * (truth.force * current - contact) / truth.motor;
      const double free = v + kStep * (contact - truth.viscous * v) / truth.mass;
      v = std::copysign(std::fdim(std::abs(free), kStep * truth.coulomb / truth.mass), free);
      q += kStep * w;
      x += kStep * v;
    }
  }
  recording.times = times;
  recording.command = schedule_from_samples(times, currents);
  for (const auto& [signal, values] :
       {std::pair(Signal::position, motor), {Signal::load_position, load}}) {
    Measurement& m = recording.measurements.emplace_back();
    m.signal = signal;
    m.values = values;
    m.sigma = truth.sigma;
    m.noise = NoiseSource::given;
  }
  return recording;
}

TEST(TwoEncoders, TellGapStiffnessAndBothMasses) {
  const Table truth;
  Job job;
  Model<double>& model = job.model;
  model.structure = {Drive::motor_current, Transmission::backlash};
  add_effect<CoulombFriction>(model).F_c = 10.0;
  model.axis = paper_axis().axis;
  model.axis.K_f = truth.force;
  model.axis.r_g = 1.0;
  model.axis.B_m = model.axis.F_s = 0.0;
  model.axis.J_m = 20.0;
  model.axis.H = 100e-6;
  normalize(model);
  job.recordings = {recorded(truth, Role::fit), recorded(truth, Role::validate)};
  job.free = {free_parameter("M", 20.0),   free_parameter("J_m", 20.0),
              free_parameter("B_a", 60.0), free_parameter("coulomb_friction.F_c", 10.0),
              free_parameter("H", 100e-6), free_parameter("k_g", 6e6),
              free_parameter("b_g", 3e3)};
  const FitResult fit = estimate(job);
  ASSERT_TRUE(fit.is_usable()) << fit.message;
  const double values[]{truth.mass, truth.motor,     truth.viscous, truth.coulomb,
                        truth.gap,  truth.stiffness, truth.damping};
  for (std::size_t i = 0; i < job.free.size(); ++i)
    EXPECT_NEAR(fit.parameters[i].value, values[i], 0.03 * values[i])
        << name_of(fit.parameters[i].id);
  EXPECT_NEAR(fit.parameters[4].value, truth.gap, 0.01 * truth.gap);
}

}  // namespace
}  // namespace axisfit
