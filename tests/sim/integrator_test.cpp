#include "sim/integrator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "base/random.h"
#include "tests/sim/axes.h"
#include "tests/sim/reference.h"

namespace axisfit {
namespace {

struct NamedCommand {
  const char* name;
  Schedule schedule;
};

std::vector<NamedCommand> commands() {
  return {
      {"step", step_command()}, {"levels", level_command()}, {"staircase", staircase_command()}};
}

Model<double> axis_with_gain(double K_v) {
  Model<double> model = paper_axis();
  model.axis.K_v = K_v;
  return model;
}

State<double> errors(const std::vector<State<double>>& a, const std::vector<State<double>>& b) {
  EXPECT_EQ(a.size(), b.size());
  const State<double> range = ranges(b);
  State<double> worst{};
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k)
    for (std::size_t i = 0; i < kStates; ++i) {
      const double d = std::abs(a[k][i] - b[k][i]);
      if (d > 0.0) worst[i] = std::max(worst[i], d / range[i]);
    }
  return worst;
}

double largest(const State<double>& e) { return *std::max_element(e.begin(), e.end()); }

/// The reference is believed as far as it converges: with ten times more parts to each step that
/// meets an event it has to come closer to the integrator, and close enough at last.
void expect_reference(double K_v, std::span<const double> times, double step, bool all_commands) {
  const Model<double> model = axis_with_gain(K_v);
  for (const auto& [name, command] : commands()) {
    SCOPED_TRACE(testing::Message() << "K_v " << K_v << ", " << name);
    const auto ours = run(model, command, times);
    ASSERT_TRUE(ours.finished);
    const auto coarse = reference::simulate(model.axis, command, times, step, 10);
    const auto fine = reference::simulate(model.axis, command, times, step, 1000);
    const double from_fine = largest(errors(ours.states, fine));
    const double from_coarse = largest(errors(ours.states, coarse));
    std::cout << "K_v " << K_v << " " << name << ": " << ours.events.back() << " events, "
              << from_coarse << " from the coarse and " << from_fine
              << " from the fine reference\n";
    EXPECT_LT(from_fine, 1e-6);
    EXPECT_LT(from_fine, 0.5 * from_coarse + 1e-9);
    if (!all_commands) break;
  }
}

TEST(Integrator, AgreesWithAnIndependentReference) {
  const auto times = instants(1000, 1e-3);
  for (const double K_v : {10.0, 100.0, 1000.0}) expect_reference(K_v, times, 1e-6, true);
}

TEST(Integrator, AgreesWithAnIndependentReferenceWhereTheCurrentLoopIsStiff) {
  // The reference has to resolve K_v / (K_i L).
  expect_reference(1e4, instants(800, 1e-3), 0.25e-6, false);
  expect_reference(1e5, instants(60, 0.5e-3), 2.5e-8, false);
  expect_reference(1e6, instants(12, 0.5e-3), 2.5e-9, false);
}

TEST(Integrator, DoesNotDependOnItsStepHoweverStiffTheCurrentLoop) {
  const auto times = instants(1000, 1e-3);
  State<double> worst{};
  for (const double K_v : {10.0, 100.0, 1e3, 1e4, 1e5, 1e6}) {
    const Model<double> model = axis_with_gain(K_v);
    for (const auto& [name, command] : commands()) {
      SCOPED_TRACE(testing::Message() << "K_v " << K_v << ", " << name);
      const auto at_default_step = run(model, command, times);
      const auto small = run(model, command, times, {.step = 1e-5});
      ASSERT_TRUE(at_default_step.finished);
      ASSERT_TRUE(small.finished);
      EXPECT_EQ(at_default_step.events.back(), small.events.back());
      const State<double> e = errors(at_default_step.states, small.states);
      for (std::size_t i = 0; i < kStates; ++i) worst[i] = std::max(worst[i], e[i]);
      for (std::size_t i = 0; i < 6; ++i) EXPECT_LT(e[i], 1e-9) << "y" << i;
      // The current follows K_i (y4 + T_z y5): ten thousand volts that cancel down to a few. One
      // rounding of 1e-12 of their range there is 1e-12 * K_i * 1e4 V / 8 A = 4e-9 of its own.
      EXPECT_LT(e[6], 1e-8);
    }
  }
  std::cout << "step 0.5e-3 against 1e-5:";
  for (const double e : worst) std::cout << " " << e;
  std::cout << "\n";
}

TEST(Integrator, OfWhatIsAffineAgreesWithTheRungeKuttaMethod) {
  // A drag of 1e-200 changes nothing, but is not affine: steps of half a millisecond by the
  // Runge-Kutta method, and guards looked at as the equations have them.
  const auto times = instants(1000, 1e-3);
  for (const double K_v : {10.0, 1e3, 1e5}) {
    const Model<double> affine = axis_with_gain(K_v);
    Model<double> smooth = affine;
    add_effect<QuadraticDrag>(smooth).c = 1e-200;
    for (const auto& [name, command] : commands()) {
      SCOPED_TRACE(testing::Message() << "K_v " << K_v << ", " << name);
      const auto fast = run(affine, command, times), slow = run(smooth, command, times);
      ASSERT_TRUE(fast.finished && slow.finished);
      EXPECT_EQ(fast.events.back(), slow.events.back());
      const State<double> e = errors(fast.states, slow.states);
      for (std::size_t i = 0; i < 6; ++i) EXPECT_LT(e[i], 1e-9) << "y" << i;
      EXPECT_LT(e[6], 1e-8);  // as above
    }
  }
}

TEST(Integrator, DoesNotDependOnItsStepWhereTheLoopRings) {
  // At the lower end of T_p the tachometer loop rings at some 2e4 rad/s, faster than the step.
  Model<double> model = paper_axis();
  model.axis.T_p = 0.0071;
  const auto times = instants(1000, 1e-3);
  const auto at_default_step = run(model, step_command(), times);
  const auto small = run(model, step_command(), times, {.step = 1e-5});
  ASSERT_TRUE(at_default_step.finished && small.finished);
  EXPECT_EQ(at_default_step.events.back(), small.events.back());
  EXPECT_LT(largest_difference(at_default_step.states, small.states), 1e-8);
}

TEST(Integrator, PassesAGuardThatIsReachedAndLeftWithinTheShortestStep) {
  // A run that touches the motor voltage's limit so briefly that, at these steps, the state at the
  // event belongs to both sides of it.
  Model<double> model = paper_axis();
  model.axis.T_p = 0.0071;
  model.axis.K_v = 300.0;
  const auto times = instants(900, 1e-3);
  for (const double step : {5e-4, 4e-4, 2e-4, 1e-4, 3e-5})
    EXPECT_TRUE(run(model, step_command(), times, {.step = step}).finished) << step;
}

/// An axis of this drive and transmission, of the paper's rack or a toothed belt, with all that
/// matters to its events drawn within a factor of three of what is usual.
Model<double> drawn_axis(std::mt19937_64& g, Drive drive, Transmission transmission) {
  const auto drawn = [&](double usual) { return usual * std::pow(3.0, 2.0 * uniform(g) - 1.0); };
  Model<double> model = paper_axis();
  model.structure.drive = drive;
  model.structure.transmission = transmission;
  Axis<double>& a = model.axis;
  if (uniform(g) < 0.5) {  // a belt: it has no gap, and rings
    a.r_g = 0.02;
    a.J_m = 2e-4;
    a.H = 0.0;
    a.M = 8.0;
    a.k_g = 2e5;
    a.b_g = 100.0;
  }
  for (double* x : {&a.M, &a.k_g, &a.b_g, &a.B_a, &a.V_L, &a.V_s}) *x = drawn(*x);
  if (uniform(g) < 0.5) a.F_s = drawn(10.0);
  if (uniform(g) < 0.5) add_effect<CoulombFriction>(model).F_c = drawn(15.0);
  return model;
}

/// Levels of all sizes, each held for some 0.1 s.
Schedule drawn_levels(std::mt19937_64& g, double largest) {
  Schedule command;
  for (double t = 0.0; t < 1.0; t += 0.2 * uniform(g))
    command.append(t, largest * (2.0 * uniform(g) - 1.0));
  return command;
}

TEST(Integrator, ReadingsDoNotDependOnHowOftenTheyAreTaken) {
  constexpr int kDraws = 100;
  const std::vector<double> asked = instants(20, 0.05);
  std::vector<double> uneven;  // with those that are asked
  std::mt19937_64 g(61);
  for (const double t : asked) {
    uneven.push_back(t);
    for (double next = t; (next += 1e-3 + 0.02 * uniform(g)) < t + 0.049;) uneven.push_back(next);
  }
  for (const Drive drive : every_drive())
    for (const Transmission transmission : {Transmission::backlash, Transmission::rigid})
      for (int draw = 0; draw < kDraws; ++draw) {
        SCOPED_TRACE(testing::Message() << "drive " << int(drive) << ", transmission "
                                        << int(transmission) << ", draw " << draw);
        const Model<double> model = drawn_axis(g, drive, transmission);
        const bool is_force = drive == Drive::force_source || drive == Drive::motor_current ||
                              drive == Drive::rated_force;
        const Schedule command = drawn_levels(g, is_force ? 400.0 : 10.0);
        const auto at = [&](const std::vector<double>& times) {
          const auto all = run(model, command, times);
          EXPECT_TRUE(all.finished);
          std::vector<State<double>> states;
          for (std::size_t k = 0, i = 0; k < times.size() && i < asked.size(); ++k)
            if (std::abs(times[k] - asked[i]) < 1e-9) {
              states.push_back(all.states[k]);
              ++i;
            }
          return states;
        };
        const auto seldom = at(asked);
        for (const auto& times : {instants(1000, 1e-3), instants(3300, 1.0 / 3300.0), uneven}) {
          const State<double> e = errors(seldom, at(times));
          for (std::size_t i = 0; i < 6; ++i) EXPECT_LT(e[i], 1e-9) << "y" << i;
          EXPECT_LT(e[6], 1e-8);  // as above
        }
      }
}

// The clock of a logger is off in its last digits.
TEST(Integrator, ReadingsThatAreNearlyEvenTakeHardlyMoreStepsThanEvenOnes) {
  std::vector<double> nearly_even = instants(2000, 1e-3);
  for (std::size_t i = 1; i < nearly_even.size(); i += 2) nearly_even[i] += 3e-8;
  const auto count = [](const Model<double>& model, std::span<const double> times) {
    return simulate(model, level_command(), times, [](std::size_t, const Integrator<double>&) {})
        .steps;
  };
  Model<double> affine = driven_mass(20.0);
  affine.axis.B_a = 30.0;
  add_effect<CoulombFriction>(affine).F_c = 2.0;
  Model<double> smooth = affine;
  add_effect<QuadraticDrag>(smooth).c = 50.0;
  for (const Model<double>& model : {affine, smooth}) {
    const long steps = count(model, instants(2000, 1e-3));
    EXPECT_GE(steps, 2000);
    EXPECT_LT(count(model, nearly_even), 1.05 * static_cast<double>(steps));
    const auto at_once = run(model, level_command(), std::vector{0.0, 2.0}, {.step = 1e-5});
    const auto read = run(model, level_command(), nearly_even);
    EXPECT_LT(largest_difference({at_once.states.back()}, {read.states.back()}), 1e-9);
  }
}

TEST(Integrator, Mirrors) {
  // Every equation is odd in the state and the command.
  Model<double> model = paper_axis();
  model.axis.F_s = 30.0;
  add_effect<QuadraticDrag>(model).c = 50.0;
  add_effect<CoulombFriction>(model).F_c = 10.0;
  Schedule mirrored = level_command();
  for (double& value : mirrored.values.edit()) value = -value;
  const auto times = instants(1000, 1e-3);
  const auto there = run(model, level_command(), times);
  auto back = run(model, mirrored, times);
  ASSERT_TRUE(there.finished && back.finished);
  EXPECT_EQ(there.events.back(), back.events.back());
  for (State<double>& y : back.states)
    for (double& value : y) value = -value;
  const State<double> e = errors(there.states, back.states);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_LT(e[i], 1e-9) << "y" << i;
  EXPECT_LT(e[6], 1e-8);
}

/// Two masses with soft teeth between them and strong drag on the arm, thrown to and fro: what the
/// Runge-Kutta part does is not hidden by rounding, and nothing is faster than its steps.
Model<double> dragged_gear() {
  Model<double> model = free_gear();
  model.axis.H = 1e-3;
  model.axis.k_g = 2e4;
  model.axis.b_g = 100.0;
  model.initial[1] = 0.2;
  add_effect<QuadraticDrag>(model).c = 3000.0;
  return model;
}

TEST(Integrator, IsOfFourthOrderAcrossEventsWithSmoothForces) {
  // Events cut the steps around them into pieces, more or fewer by chance, and with them the error
  // of a single run: it is the rms over many runs that falls by 16. The arm never turns: the second
  // derivative of the drag jumps at zero velocity, which costs one order there.
  constexpr int kMembers = 40;
  const Model<double> model = dragged_gear();
  const auto times = instants(12, 0.04);
  const auto member = [&](int i, double step) {
    const double scale = 1.0 + 0.01 * i;
    const Schedule command{{0.0, 0.16, 0.32}, {400.0 * scale, -50.0 * scale, 300.0 * scale}};
    return run(model, command, times, {.step = step});
  };
  double before = 0.0;
  for (const int steps : {16, 32, 64, 128}) {  // of each 0.16 s
    double sum = 0.0;
    int events = 0;
    for (int i = 0; i < kMembers; ++i) {
      const auto exact = member(i, 0.16 / 2048);
      const auto result = member(i, 0.16 / steps);
      ASSERT_TRUE(exact.finished && result.finished);
      ASSERT_EQ(result.events, exact.events);
      events += result.events.back();
      for (const State<double>& y : exact.states) ASSERT_GT(y[1], 0.01);
      for (std::size_t k = 0; k < times.size(); ++k)
        sum += std::pow(result.states[k][1] - exact.states[k][1], 2);
    }
    const double error = std::sqrt(sum / kMembers / static_cast<double>(times.size()));
    std::cout << steps << " steps: error " << error << " m/s, ratio " << before / error << ", "
              << events << " events\n";
    if (steps > 16) {
      EXPECT_GT(before / error, 12.0);
      EXPECT_LT(before / error, 20.0);
    }
    before = error;
  }
}

TEST(Integrator, SmoothForcesAgreeWithAClosedForm) {
  // v' = -(c / m) v^2 - (B / m) v from v0.
  Model<double> model = driven_mass(20.0);
  model.axis.B_a = 15.0;
  model.initial[1] = 2.0;
  add_effect<QuadraticDrag>(model).c = 40.0;
  const auto times = instants(100, 0.01);
  const auto result = run(model, {}, times);
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double e = std::exp(-15.0 / 20.0 * times[k]);
    const double v = 15.0 * 2.0 * e / (15.0 + 40.0 * 2.0 * (1.0 - e));
    ASSERT_NEAR(result.states[k][1], v, 1e-11);
  }
}

TEST(Integrator, ARestIsExact) {
  // With smooth forces in play, too.
  Model<double> model = paper_axis();
  add_effect<QuadraticDrag>(model).c = 100.0;
  const auto result = run(model, {}, instants(10, 0.1));
  for (const State<double>& y : result.states)
    for (const double value : y) EXPECT_EQ(value, 0.0);
}

// A velocity loop near its limits has several events after each step of a command that rises
// smoothly in steps of 5 ms: teeth that part and meet, limits that are reached and left.
TEST(Integrator, FollowsAChirpInStepsWithinTheBudgetOfARecording) {
  Model<double> model = paper_axis();
  model.axis.V_L = 3.276;
  model.axis.B_a = 260.5;
  model.axis.b_g = 1475.0;
  model.axis.k_g = 7.874e6;
  model.axis.T_p = 0.03781;
  constexpr double kDuration = 4.0, kPeriod = 5e-3;
  Schedule chirp;
  for (int k = 0; k < 800; ++k) {
    const double t = k * kPeriod;
    chirp.append(t, 5.0 * std::sin(2.0 * std::numbers::pi * (0.35 + 0.15 * t) * t));
  }
  const std::vector<double> times = instants(4000, kDuration / 4000.0);
  const SimulationResult result = simulate<double>(
      model, chirp, times, [](std::size_t, const Integrator<double>&) {}, {}, {},
      recording_options(times, static_cast<double>(chirp.times.size()), 0.5e-3));
  EXPECT_TRUE(result.finished);
  EXPECT_GT(result.events, 200 + 0.5 * 4000.0) << "one event for two samples is not enough";
}

TEST(Integrator, GivesUpOnANumberThatIsNotFinite) {
  Model<double> model = paper_axis();
  model.initial[4] = INFINITY;
  EXPECT_FALSE(run(model, step_command(), instants(10, 1e-3)).finished);
}

}  // namespace
}  // namespace axisfit
