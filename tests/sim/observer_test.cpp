#include "sim/observer.h"

#include <gtest/gtest.h>

#include <iostream>
#include <numeric>

#include "tests/sim/axes.h"

namespace axisfit {
namespace {

struct Recorded {
  std::vector<double> velocity, position;
};

Recorded recorded(const Model<double>& model, const Schedule& command,
                  std::span<const double> times) {
  Recorded result;
  const auto simulation_result =
      simulate(model, command, times, [&](std::size_t, const Integrator<double>& axis) {
        const auto read = [&](Signal signal) {
          return reading(axis.equations(), signal, axis.mode(), axis.state(), axis.input());
        };
        result.velocity.push_back(read(Signal::velocity));
        result.position.push_back(read(Signal::position));
      });
  EXPECT_TRUE(simulation_result.finished);
  return result;
}

/// Observer force at every instant, N.
std::vector<double> observer_forces(const Model<double>& model, const Schedule& command,
                                    std::span<const double> times, const Observer& observer,
                                    const Recorded& data) {
  std::vector<double> forces;
  const auto simulation_result = simulate(
      model, command, times,
      [&](std::size_t, const Integrator<double>& axis) {
        forces.push_back(axis.equations().observer_force(axis.mode(), axis.state(), axis.input()));
      },
      observer, MeasuredSeries{data.velocity, data.position});
  EXPECT_TRUE(simulation_result.finished);
  return forces;
}

double rms(const std::vector<double>& values) {
  return std::sqrt(std::inner_product(values.begin(), values.end(), values.begin(), 0.0) /
                   static_cast<double>(values.size()));
}

const Observer kCouplings[] = {Observer::of_velocity(30.0, false),
                               Observer::of_velocity(1000.0, true), Observer::of_position(100.0)};

// A parabola: the line through the corners is right in the mean over each interval of an even
// sampling, and over all of them of an uneven one.
TEST(TargetCorners, AreRightInTheMean) {
  const auto square = [](double t) { return t * t; };
  const auto mean_error = [&](const std::vector<double>& times) {
    std::vector<double> values;
    for (const double t : times) values.push_back(square(t));
    const auto corners = target_corners(times, values);
    std::vector<double> errors;  // of the integral over each interval
    for (std::size_t i = 1; i < times.size(); ++i) {
      const double a = times[i - 1], b = times[i];
      errors.push_back(0.5 * (corners[i - 1] + corners[i]) * (b - a) - (b * b * b - a * a * a) / 3);
    }
    return errors;
  };
  for (const double e : mean_error({0.0, 0.1, 0.2, 0.3, 0.4})) EXPECT_NEAR(e, 0.0, 1e-15);
  const auto uneven = mean_error({0.0, 0.1, 0.25, 0.3, 0.4, 0.6});
  EXPECT_NEAR(std::accumulate(uneven.begin(), uneven.end(), 0.0), 0.0, 1e-15);
}

TEST(TargetCorners, StayNearTheSamplesBesideAGap) {
  // 10 ms at rest, nothing for a second, 10 ms at rest a metre on.
  std::vector<double> times, values;
  for (int i = 0; i <= 20; ++i) {
    times.push_back(1e-3 * i + (i > 10 ? 1.0 : 0.0));
    values.push_back(i > 10 ? 1.0 : 0.0);
  }
  const auto corners = target_corners(times, values);
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(corners[i], values[i], 2e-6);
}

TEST(TargetCorners, OfTwoSamplesAreTheSamples) {
  const std::vector<double> times{0.0, 1.0}, values{2.0, 3.0};
  EXPECT_EQ(target_corners(times, values), values);
}

TEST(Observer, DoesNothingToAModelThatIsRight) {
  const Model<double> model = paper_axis();
  for (const Observer& observer : kCouplings) {
    SCOPED_TRACE(testing::Message()
                 << observer.velocity << " " << observer.position << " " << observer.acceleration);
    // What is left is the error of the line between samples: it falls with the square of their
    // distance, down to which the motion has to be smooth.
    double before = 0.0;
    for (const double dt : {2e-4, 1e-4, 0.5e-4}) {
      const auto times = instants(static_cast<std::size_t>(std::lround(0.4 / dt)), dt);
      const Recorded data = recorded(model, step_command(), times);
      const double force = rms(observer_forces(model, step_command(), times, observer, data));
      std::cout << "dt " << dt << ": " << force << " N\n";
      EXPECT_LT(force, 0.02 * 408.0);
      if (before > 0.0) {
        EXPECT_LT(force, 0.35 * before);
      }
      before = force;
    }
  }
}

TEST(Observer, StaysOnAMotionThatIsALineBetweenSamplesExactly) {
  // Constant acceleration, velocity recorded: the line is the motion.
  Model<double> model = driven_mass(12.0);
  const auto times = instants(500, 1e-3);
  const Schedule command{{0.0}, {24.0}};
  const Recorded data = recorded(model, command, times);
  for (const double force :
       observer_forces(model, command, times, Observer::of_velocity(1000.0, false), data))
    ASSERT_NEAR(force, 0.0, 1e-10);
}

TEST(Observer, ForceConvergesToWhatTheModelLacks) {
  constexpr double F = 35.0;
  Model<double> truth = paper_axis();
  add_effect<ConstantForce>(truth).F_0 = F;
  const auto times = instants(500, 1e-3);
  const Recorded data = recorded(truth, step_command(), times);
  // An arm held to a velocity has the missing force after some time constants, as far as the rest
  // of it (the motor behind the teeth) has settled; one held to position needs the motor as well.
  const auto forces = observer_forces(paper_axis(), step_command(), times,
                                      Observer::of_velocity(200.0, false), data);
  double mean = 0.0;
  for (std::size_t k = 300; k < 500; ++k) mean += forces[k] / 200.0;
  std::cout << "mean force " << mean << " N\n";
  EXPECT_NEAR(mean, F, 0.01 * F);

  // Without gear or controller the approach has a closed form, F (1 - exp(-rate t)).
  Model<double> mass = driven_mass(12.0);
  const Schedule push{{0.0}, {24.0}};
  Model<double> pushed = mass;
  add_effect<ConstantForce>(pushed).F_0 = F;
  const Recorded line = recorded(pushed, push, times);
  const auto approach =
      observer_forces(mass, push, times, Observer::of_velocity(50.0, false), line);
  for (std::size_t k = 0; k < times.size(); ++k)
    ASSERT_NEAR(approach[k], F * (1.0 - std::exp(-50.0 * times[k])), 1e-9 * F);
}

TEST(Observer, ToPositionIsCriticallyDamped) {
  // A mass at rest with its recorded position a step away: e = (1 + ...) exp(-w t), no overshoot.
  const Model<double> mass = driven_mass(12.0);
  constexpr double w = 40.0, away = 0.01;
  const auto times = instants(400, 1e-3);
  const std::vector<double> position(times.size(), away);
  const auto r = run(mass, {}, times, {}, Observer::of_position(w), MeasuredSeries{{}, position});
  ASSERT_TRUE(r.finished);
  for (std::size_t k = 0; k < times.size(); ++k) {
    // e' = -v - 2 w e, v' = w^2 e from e = away, v = 0.
    const double e = away * (1.0 - w * times[k]) * std::exp(-w * times[k]);
    ASSERT_NEAR(r.states[k][0], away - e, 1e-11);
    ASSERT_NEAR(r.states[k][2] * mass.axis.r_g, r.states[k][0], 1e-13);
  }
}

TEST(Observer, SeesThroughTheInstruments) {
  // Gain and bias of what was recorded do not make a force.
  Model<double> model = driven_mass(12.0);
  model.instruments[index_of(Signal::velocity)] = {1.2, 0.05};
  model.instruments[index_of(Signal::position)] = {-0.8, 0.3};
  const auto times = instants(300, 1e-3);
  const Schedule command{{0.0}, {0.0}};
  model.initial[1] = 0.4;
  const Recorded data = recorded(model, command, times);
  for (const Observer& observer : kCouplings)
    for (const double force : observer_forces(model, command, times, observer, data))
      ASSERT_NEAR(force, 0.0, 1e-9);
}

TEST(Observer, LeavesTheGearForceAlone) {
  // The place of the axis is corrected, arm and motor together.
  Model<double> model = paper_axis();
  const auto times = instants(100, 1e-3);
  const auto free = run(model, step_command(), times);
  std::vector<double> position;
  for (const State<double>& y : free.states) position.push_back(y[2] * model.axis.r_g + 0.02);
  const auto tracking =
      run(model, step_command(), times, {}, Observer{0.0, 50.0, 0.0}, MeasuredSeries{{}, position});
  for (std::size_t k = 0; k < times.size(); ++k) {
    const auto gear = [&](const State<double>& y) { return model.axis.r_g * y[2] - y[0]; };
    ASSERT_NEAR(gear(tracking.states[k]), gear(free.states[k]), 1e-12);
    ASSERT_NEAR(tracking.states[k][1], free.states[k][1], 1e-10);
  }
}

}  // namespace
}  // namespace axisfit
