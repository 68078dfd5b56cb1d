#include "sim/guards.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/sim/axes.h"

namespace axisfit {
namespace {

/// Guards as the equations have them, with rates by a unit step along f.
GuardValues by_equations(const Equations<double>& equations, const Mode& mode,
                         const State<double>& y, Input<double> input, const Target& slope,
                         double command_slope) {
  GuardValues seen;
  equations.visit_guards(mode, y, input, [&](Guard, double g, double scale) {
    seen.push_back({g, 0.0, scale});
  });
  State<double> ahead = y;
  const State<double> f = equations.rate(mode, y, input);
  for (std::size_t i = 0; i < kStates; ++i) ahead[i] += f[i];
  input.target.move(slope, 1.0);
  input.command += command_slope;
  std::size_t n = 0;
  equations.visit_guards(mode, ahead, input, [&](Guard, double g, double) {
    seen.nodes[n].rate = g - seen.nodes[n].value;
    ++n;
  });
  return seen;
}

/// Expects the forms of one mode to give at every instant within a step what its equations do.
void expect_followed(const Model<double>& model, const Observer& observer, const Mode& mode,
                     std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const Equations<double> equations(model, observer);
  const Matrix<double> a = system_matrix(equations, mode);
  const PerInput<State<double>> b = input_matrix(equations, mode);
  Propagator<double> propagator(
      a, step_levels_for(a, 1e-3, 12),
      {{0, b[kCommandInput]}, {1, b[kTargetVelocityInput]}, {2, b[kTargetPositionInput]}},
      equations.states());
  const LinearGuards guards(equations, mode, a, b, {0, 1, 2});
  constexpr int kLevel = 1, kHalvings = 3;
  const GuardForms forms(guards, propagator, kLevel, kHalvings);
  const Target slope{normal(random), normal(random)};
  const double command_slope = normal(random);
  const Slopes slopes{command_slope, slope.velocity, slope.position};
  State<double> y{0.1 * normal(random), 0.1, 0.0, 20.0, normal(random), 50.0, 3.0};
  if (mode.sliding == 0) y[1] = 0.0;
  y[2] = (y[0] + 1e-5 * mode.contact) / model.axis.r_g;
  Input<double> input{4.0, {0.2, y[0]}, 0.0, {}};
  const auto guard_values = [&] { return guards.guard_values(y, input, slopes); };

  const GuardValues start = guard_values();
  GuardCourse course(start, start, std::size_t{1} << kHalvings, 0.5e-3);
  forms.follow(start, equations.rate(mode, y, input), slopes, course);
  const double* inner = course.inner();
  const double part = propagator.step_levels().length(kLevel + kHalvings);
  for (int k = 1; k < 1 << kHalvings; ++k) {
    y = propagator.advance(y, equations.rate(mode, y, input), slopes, kLevel + kHalvings);
    input.target.move(slope, part);
    input.command += command_slope * part;
    const GuardValues linear = guard_values(),
                      exact = by_equations(equations, mode, y, input, slope, command_slope);
    ASSERT_EQ(linear.count, exact.count);
    for (std::size_t i = 0; i < exact.count; ++i, ++inner) {
      const auto& [value, rate, scale] = exact.nodes[i];
      const double tolerance = 1e-11 * (scale + std::abs(value));
      EXPECT_NEAR(linear.nodes[i].value, value, tolerance) << k << " " << i;
      EXPECT_NEAR(*inner, value, tolerance) << k << " " << i;
      EXPECT_NEAR(inner[exact.count], rate, 1e-9 * (std::abs(rate) + scale / part));
    }
    inner += exact.count;
  }
}

TEST(GuardForms, FollowTheGuardsThroughAStep) {
  std::mt19937_64 random(1);
  for (const int contact : {-1, 0, 1})
    for (const int v_c : {0, 1})
      for (const int v_m : {-1, 0}) {
        Mode mode;
        mode.contact = static_cast<std::int8_t>(contact);
        mode.v_c = static_cast<std::int8_t>(v_c);
        mode.v_m = static_cast<std::int8_t>(v_m);
        mode.sliding = 1;
        expect_followed(paper_axis(), Observer::of_velocity(300.0, true), mode, random);
      }
}

// Only there do guards depend on the target itself, and not only on what it does to the state.
TEST(GuardForms, FollowTheGuardsOfAnArmAtRestThatIsHeldToATarget) {
  std::mt19937_64 random(1);
  Model<double> model = paper_axis();
  add_effect<CoulombFriction>(model).F_c = 25.0;
  for (const Observer& observer :
       {Observer::of_velocity(300.0, true), Observer::of_position(300.0)})
    for (const int contact : {-1, 0, 1}) {
      Mode mode;
      mode.contact = static_cast<std::int8_t>(contact);
      mode.sliding = 0;
      expect_followed(model, observer, mode, random);
    }
}

TEST(Guards, HaveRoomForThoseOfEveryMode) {
  std::size_t most = 0;
  for (const Drive drive : every_drive())
    for (const Transmission transmission : {Transmission::backlash, Transmission::rigid}) {
      Model<double> model = paper_axis();
      model.structure = {drive, transmission, {}};
      model.axis.F_s = 5.0;
      add_effect<LoadFriction>(model).mu = 0.1;
      add_effect<StribeckFriction>(model) = {10.0, 0.05};
      const Equations<double> equations(model);
      for (int m = 0; m < 3 * 3 * 3 * 3 * 2; ++m) {
        const auto side = [&](int divisor) {
          return static_cast<std::int8_t>(m / divisor % 3 - 1);
        };
        const Mode mode{side(1), side(3), side(9), side(27), 1, m >= 81};
        std::size_t count = 0;
        equations.visit_guards(mode, initial_state(model), {},
                               [&](Guard, double, double) { ++count; });
        most = std::max(most, count);
      }
    }
  EXPECT_EQ(most, kGuards);
}

TEST(GuardValues, TakeNoMoreThanThereIsRoomFor) {
  GuardValues seen;
  for (std::size_t i = 0; i < kGuards; ++i) seen.push_back({});
  EXPECT_THROW(seen.push_back({}), std::length_error);
}

TEST(GuardCourse, SeesADipBetweenInstants) {
  const auto crossing = [](double start, double start_rate, double end, double end_rate) {
    GuardValues a, b;
    a.count = b.count = 1;
    a.nodes[0] = {start, start_rate, 0.0};
    b.nodes[0] = {end, end_rate, 0.0};
    return GuardCourse(a, b, 1, 1.0).review(false, {});
  };
  // g = (t - 1/2)^2 - c
  for (const double c : {-0.1, -1e-6})
    EXPECT_EQ(crossing(0.25 - c, -1.0, 0.25 - c, 1.0), Crossing::none);
  for (const double c : {1e-6, 0.1, 0.25})  // the last begins at zero
    EXPECT_EQ(crossing(0.25 - c, -1.0, 0.25 - c, 1.0), Crossing::touched);
  EXPECT_EQ(crossing(1.0, -2.0, -1.0, -2.0), Crossing::passed);
  EXPECT_EQ(crossing(1.0, 1.0, 2.0, 1.0), Crossing::none);
}

// A parabola with its lowest value c between two instants. With a third one the cubic over both
// parts is off by 0.4 at the middle one: a quarter of that is the margin.
TEST(GuardCourse, AllowsForWhatACubicGetsWrong) {
  const auto review = [](std::array<std::array<double, 2>, 3> course, bool doubted) {
    std::array<GuardValues, 3> looks;
    for (std::size_t k = 0; k < 3; ++k) {
      looks[k].count = 1;
      looks[k].nodes[0] = {course[k][0], course[k][1], 0.0};
    }
    GuardCourse guards(looks[0], looks[2], 2, 2.0);
    guards.set(1, looks[1]);
    return guards.review(doubted, {});
  };
  for (const double c : {0.09, 0.11}) {
    const double beside = 0.25 + c, far = 2.05 + c;
    const Crossing doubted = c < 0.1 ? Crossing::touched : Crossing::none;
    EXPECT_EQ(review({{{beside, -1.0}, {beside, 1.0}, {far, 1.0}}}, true), doubted);
    EXPECT_EQ(review({{{far, -1.0}, {beside, -1.0}, {beside, 1.0}}}, true), doubted);
    EXPECT_EQ(review({{{beside, -1.0}, {beside, 1.0}, {far, 1.0}}}, false), Crossing::none);
  }
}

}  // namespace
}  // namespace axisfit
