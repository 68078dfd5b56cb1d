// Events with closed forms: friction, reversal, contact, delay, coincidence.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>

#include "fit/solve/jet.h"
#include "sim/integrator.h"
#include "tests/sim/axes.h"

namespace axisfit {
namespace {

constexpr double kMass = 12.0;

/// State at the one instant t.
State<double> state_at(const Model<double>& model, const Schedule& command, double t) {
  const std::vector<double> times{0.0, t};
  const auto result = run(model, command, times);
  EXPECT_TRUE(result.finished);
  return result.states.back();
}

/// First instant between low and high at which the mode has the property, by bisection.
template <class Property>
double instant_of(const Model<double>& model, double command, double low, double high,
                  Property&& property) {
  while (high - low > 1e-13) {
    const double middle = 0.5 * (low + high);
    Integrator<double> axis(model, {}, {});
    axis.start(0.0, command, {});
    EXPECT_TRUE(axis.advance_to(middle));
    (property(axis.mode()) ? high : low) = middle;
  }
  return high;
}

Model<double> rubbing_mass(double F_c) {
  Model<double> model = driven_mass(kMass);
  add_effect<CoulombFriction>(model).F_c = F_c;
  return model;
}

TEST(DryFriction, BringsAMassToRestAtTheAnalyticInstantAndPlace) {
  constexpr double v = 0.7, F_c = 20.0;
  Model<double> model = rubbing_mass(F_c);
  for (const double sign : {1.0, -1.0}) {
    model.initial[1] = sign * v;
    const double stop = kMass * v / F_c;
    EXPECT_NEAR(instant_of(model, 0.0, 0.0, 1.0, [](const Mode& m) { return m.sliding == 0; }),
                stop, 1e-12);
    const auto r = run(model, {}, instants(1000, 1e-3));
    for (std::size_t k = 0; k < r.states.size(); ++k) {
      const double t = std::min(1e-3 * static_cast<double>(k), stop);
      ASSERT_NEAR(r.states[k][0], sign * (v * t - 0.5 * F_c / kMass * t * t), 1e-12);
      if (t < stop)
        ASSERT_NEAR(r.states[k][1], sign * (v - F_c / kMass * t), 1e-12);
      else
        ASSERT_EQ(r.states[k][1], 0.0);
    }
    EXPECT_EQ(r.acceleration.back(), 0.0);
    EXPECT_EQ(r.events.back(), 1);
  }
}

// A mass that a blow has set in motion comes to rest over two thousand cycles of an elastic mode,
// which the blow has set off, too. What is left of that still makes the velocity touch zero two
// cycles before its mean does: there the mass stops first, however far apart the readings are.
TEST(DryFriction, StopsAtTheFirstTouchOfATrembleThatHasAllButDiedAway) {
  constexpr double kWhole = 20.0, kElastic = 8.0, kSpeed = 4e-3, kBlow = 1e-3, kStop = 7.0;
  Model<double> model = rubbing_mass(20.0);
  model.axis.M = kWhole;
  ElasticMode<double>& elastic = add_effect<ElasticMode>(model);
  elastic.m_e = kElastic;
  elastic.f_e = 200.0;
  const double share = kElastic / kWhole, w = 2.0 * std::numbers::pi * elastic.f_e;
  elastic.zeta_e = 6.0 * (1.0 - share) / (w * kStop);  // e^-6 of it is left at the stop
  const Schedule command{{0.0, kBlow},
                         {20.0 + kWhole * kSpeed / kBlow, 20.0 - kWhole * kSpeed / kStop}};
  const auto first_stop = [&](double interval) {
    std::vector<ModeChange> modes;
    IntegratorOptions options;
    options.modes = &modes;
    const auto n = static_cast<std::size_t>(std::ceil(1.1 * kStop / interval));
    EXPECT_TRUE(run(model, command, instants(n, interval), options).finished);
    const auto stop = std::ranges::find_if(
        modes, [&](const ModeChange& m) { return m.time > kBlow && m.mode.sliding == 0; });
    return stop == modes.end() ? INFINITY : stop->time;
  };
  const double often = first_stop(5e-4);
  EXPECT_LT(often, kStop - 0.005);
  EXPECT_GT(often, kStop - 0.05);
  for (double interval = 0.05; interval < 0.6; interval += 0.013)
    EXPECT_NEAR(first_stop(interval), often, 1e-9) << interval;
}

TEST(ModeLog, HoldsEveryModeFromTheInstantItBegins) {
  Model<double> model = rubbing_mass(20.0);
  model.initial[1] = 0.7;
  std::vector<ModeChange> modes;
  IntegratorOptions options;
  options.modes = &modes;
  // At rest after 0.42 s; 30 N set it in motion again at 0.6 s.
  const Schedule command{{0.0, 0.6}, {0.0, 30.0}};
  EXPECT_TRUE(run(model, command, instants(100, 1e-2), options).finished);
  ASSERT_EQ(modes.size(), 3u);
  EXPECT_EQ(modes[0].time, 0.0);
  EXPECT_EQ(modes[0].mode.sliding, 1);
  EXPECT_NEAR(modes[1].time, kMass * 0.7 / 20.0, 1e-12);
  EXPECT_EQ(modes[1].mode.sliding, 0);
  EXPECT_NEAR(modes[2].time, 0.6, 1e-12);
  EXPECT_EQ(modes[2].mode.sliding, 1);
}

TEST(DryFriction, HoldsUpToItsLevelAndNotBeyond) {
  const Model<double> model = rubbing_mass(20.0);
  // A staircase of 1 N every 10 ms: the step beyond 20 N sets the mass in motion, at its instant.
  Schedule ramp;
  for (int k = 0; k < 40; ++k) {
    ramp.append(0.01 * k, k + 0.5);
  }
  const double start = 0.20;
  for (const double t : {0.0, 0.05, 0.195, 0.2}) {
    EXPECT_EQ(state_at(model, ramp, t)[1], 0.0) << t;
    EXPECT_EQ(state_at(model, ramp, t)[0], 0.0) << t;
  }
  // From then on 0.5 N, 1.5 N, 2.5 N ... above the friction.
  double v = 0.0;
  for (int k = 0; k < 10; ++k) {
    v += (k + 0.5) * 0.01 / kMass;
    EXPECT_NEAR(state_at(model, ramp, start + 0.01 * (k + 1))[1], v, 1e-12);
  }
}

/// The preamplifier of a motor that stands still, as a force at the rack, N.
double standing_force(const Axis<double>& a, double U, double t) {
  const double p = std::exp(-t / a.T_p), r = std::exp(-t / a.T_r);
  const double y4 = a.K_1 * U * (1.0 - (a.T_p * p - a.T_r * r) / (a.T_p - a.T_r));
  const double y5 = a.K_1 * U * (p - r) / (a.T_p - a.T_r);
  return a.K_m * a.K_i * (y4 + a.T_z * y5) / a.r_g;
}

TEST(DryFriction, BreaksAwayAtTheAnalyticInstant) {
  for (const double sign : {1.0, -1.0}) {
    Model<double> model = paper_axis();
    model.structure.drive = Drive::current_source;
    model.structure.transmission = Transmission::rigid;
    model.axis.V_L = 1e6;
    model.axis.T_p = 0.195;
    model.axis.F_s = 30.0;
    add_effect<CoulombFriction>(model).F_c = 25.0;
    const double U = 0.001 * sign;  // V; 154 N in the end
    double low = 0.0, high = 1.0;
    while (high - low > 1e-15) {
      const double middle = 0.5 * (low + high);
      (std::abs(standing_force(model.axis, U, middle)) > 55.0 ? high : low) = middle;
    }
    ASSERT_GT(low, 0.01);
    const double found =
        instant_of(model, U, 0.0, 1.0, [](const Mode& m) { return m.sliding != 0; });
    EXPECT_NEAR(found, low, 1e-11);
    const State<double> before = state_at(model, {{0.0}, {U}}, low - 1e-9);
    EXPECT_EQ(before[0], 0.0);
    EXPECT_EQ(before[1], 0.0);
    EXPECT_EQ(before[3], 0.0);
    EXPECT_GT(sign * state_at(model, {{0.0}, {U}}, low + 1e-3)[1], 0.0);
  }
}

TEST(DryFriction, DoubletActsBelowItsSpeedOnly) {
  // F_s within |y1| < w on top of F_c: braked through w to rest, then off again through w.
  constexpr double v = 0.05, w = 0.01, F_c = 6.0, F_s = 18.0, F = 40.0;
  Model<double> model = rubbing_mass(F_c);
  model.axis.F_s = F_s;
  model.axis.w = w;
  model.initial[1] = v;
  const double to_w = kMass * (v - w) / F_c, to_rest = kMass * w / (F_c + F_s);
  const double place_w = 0.5 * (v + w) * to_w, place = place_w + 0.5 * w * to_rest;
  const double stop = to_w + to_rest;
  const auto is_in = [](const Mode& m) { return m.doublet || m.sliding == 0; };
  EXPECT_NEAR(instant_of(model, 0.0, 0.0, stop - 1e-3, is_in), to_w, 1e-12);
  EXPECT_NEAR(instant_of(model, 0.0, 0.0, 1.0, [](const Mode& m) { return m.sliding == 0; }), stop,
              1e-12);
  EXPECT_NEAR(state_at(model, {}, 0.5)[0], place, 1e-12);
  EXPECT_EQ(state_at(model, {}, 0.5)[1], 0.0);
  // Less than F_c + F_s does not move it.
  EXPECT_EQ(state_at(model, {{0.3}, {F_c + F_s - 0.01}}, 0.5)[1], 0.0);
  // More does: through w with one acceleration, with another beyond.
  const double out = kMass * w / (F - F_c - F_s);
  EXPECT_NEAR(state_at(model, {{0.3}, {F}}, 0.3 + 0.5 * out)[1], 0.5 * w, 1e-12);
  EXPECT_NEAR(state_at(model, {{0.3}, {F}}, 0.5)[1], w + (F - F_c) / kMass * (0.2 - out), 1e-12);
}

TEST(DryFriction, ReversesThroughZero) {
  constexpr double v = 0.3, F_c = 15.0, F = 50.0;
  Model<double> model = rubbing_mass(F_c);
  model.initial[1] = v;
  const Schedule command{{0.0}, {-F}};
  const double turn = kMass * v / (F + F_c);
  EXPECT_NEAR(state_at(model, command, 0.5 * turn)[1], 0.5 * v, 1e-12);
  EXPECT_NEAR(state_at(model, command, 0.4)[1], -(F - F_c) / kMass * (0.4 - turn), 1e-12);
  EXPECT_NEAR(state_at(model, command, 0.4)[0],
              0.5 * v * turn - 0.5 * (F - F_c) / kMass * std::pow(0.4 - turn, 2), 1e-12);
}

TEST(DryFriction, OfZeroChangesNothing) {
  const auto times = instants(500, 1e-3);
  const Schedule command{{0.0, 0.1, 0.3}, {10.0, -5.0, 2.0}};
  Model<double> model = paper_axis();
  const auto without = run(model, command, times);
  add_effect<CoulombFriction>(model).F_c = 0.0;
  const auto with = run(model, command, times);
  ASSERT_TRUE(with.finished);
  // The current is the difference of large voltages: see DoesNotDependOnItsStep.
  EXPECT_LT(largest_difference(with.states, without.states), 1e-8);
}

TEST(DryFriction, IsARegularPointAtZeroToo) {
  // A friction of zero that is being differentiated must leave the motion as it is.
  using J = ceres::Jet<double, 1>;
  const auto times = instants(300, 1e-3);
  const Schedule command{{0.01}, {10.0}};  // from rest, with nothing to hold the arm
  for (const Transmission transmission : {Transmission::backlash, Transmission::rigid})
    for (const bool doublet : {false, true}) {
      SCOPED_TRACE(testing::Message() << (doublet ? "F_s" : "F_c") << ", transmission "
                                      << static_cast<int>(transmission));
      Model<double> model = paper_axis();
      model.structure.transmission = transmission;
      if (transmission == Transmission::rigid) {
        // No event sets this arm in motion: the force on it grows from zero without a jump.
        model.structure.drive = Drive::current_source;
        model.axis.V_L = 1e6;
      }
      const auto plain = run(model, command, times);
      if (!doublet) add_effect<CoulombFriction>(model).F_c = 0.0;
      Model<J> differentiated = convert<J>(model);
      if (doublet)
        differentiated.axis.F_s.v[0] = 1.0;
      else
        std::get<CoulombFriction<J>>(differentiated.effects).F_c.v[0] = 1.0;
      const auto r = run(differentiated, command, times);
      ASSERT_TRUE(r.finished);
      for (std::size_t k = 0; k < times.size(); ++k)
        ASSERT_NEAR(value_of(r.states[k][1]), plain.states[k][1], 1e-9) << k;
      // Friction is not negative: the derivative is the one to the right.
      constexpr double kSmall = 0.05;  // N
      const auto rubbing = [&](double friction) {
        if (doublet)
          model.axis.F_s = friction;
        else
          std::get<CoulombFriction<double>>(model.effects).F_c = friction;
        return run(model, command, times);
      };
      const auto once = rubbing(kSmall), twice = rubbing(2.0 * kSmall);
      double off = 0.0, all = 0.0;
      for (std::size_t k = 0; k < times.size(); ++k) {
        const double expected =
            (4.0 * once.states[k][1] - twice.states[k][1] - 3.0 * plain.states[k][1]) /
            (2.0 * kSmall);
        off += std::pow(r.states[k][1].v[0] - expected, 2);
        all += expected * expected;
      }
      EXPECT_GT(all, 0.0);
      EXPECT_LT(std::sqrt(off / all), 1e-3);
    }
}

TEST(ConstantForce, IsHeldByFrictionOrSlides) {
  Model<double> model = driven_mass(kMass);
  add_effect<ConstantForce>(model).F_0 = -50.0;
  CoulombFriction<double>& friction = add_effect<CoulombFriction>(model);
  friction.F_c = 60.0;
  EXPECT_EQ(state_at(model, {}, 1.0)[0], 0.0);
  EXPECT_EQ(state_at(model, {}, 1.0)[1], 0.0);
  friction.F_c = 40.0;
  EXPECT_NEAR(state_at(model, {}, 1.0)[1], -10.0 / kMass, 1e-12);
  EXPECT_NEAR(state_at(model, {}, 1.0)[0], -5.0 / kMass, 1e-12);
  // Thrown up against it: up with gravity and friction, down with gravity less friction.
  model.initial[1] = 1.0;
  const double top = kMass / 90.0, height = 0.5 * top;
  EXPECT_NEAR(state_at(model, {}, 0.5)[1], -10.0 / kMass * (0.5 - top), 1e-12);
  EXPECT_NEAR(state_at(model, {}, 0.5)[0], height - 5.0 / kMass * std::pow(0.5 - top, 2), 1e-12);
  // And held where it stops.
  friction.F_c = 60.0;
  EXPECT_NEAR(state_at(model, {}, 0.5)[0], 0.5 * kMass / 110.0, 1e-12);
}

/// Relative motion of two free masses between the teeth, from the middle of the gap at the speed u.
struct Bounce {
  double u, flight, contact, exit;  // m/s; s from middle to tooth; s in contact; exit / entry speed
};

Bounce bounce(const Axis<double>& a, double u) {
  const double mobility = 1.0 / a.M + 1.0 / motor_mass(a);
  const double d = 0.5 * a.b_g * mobility;
  const double w = std::sqrt(a.k_g * mobility - d * d);
  // x - H = (u / w) exp(-d t) sin(w t): the teeth part, by (5), at x = H.
  const double half = std::numbers::pi / w;
  return {u, a.H / u, half, std::exp(-d * half)};
}

Model<double> bouncing_gear(double u) {
  Model<double> model = free_gear();
  // The motor gets the speed, the arm so much of the opposite that the pair stays where it is.
  const double m = motor_mass(model.axis), M = model.axis.M;
  model.initial[1] = -u * m / (m + M);
  model.initial[3] = u;
  return model;
}

TEST(Contact, BouncesWithTheAnalyticPeriod) {
  constexpr double u = 0.02;
  const Model<double> model = bouncing_gear(u);
  const Bounce b = bounce(model.axis, u);
  const double period = 4.0 * b.flight + 2.0 * b.contact;
  for (const int n : {1, 2, 10}) {
    const State<double> y = state_at(model, {}, n * period);
    const double r_g = model.axis.r_g;
    EXPECT_NEAR(r_g * y[2] - y[0], 0.0, 1e-9 * model.axis.H) << n;
    EXPECT_NEAR(r_g * y[3] - y[1], u, 1e-9 * u) << n;
    const State<double> half = state_at(model, {}, (n - 0.5) * period);
    EXPECT_NEAR(r_g * half[3] - half[1], -u, 1e-9 * u) << n;
  }
  const auto r = run(model, {}, std::vector<double>{0.0, 10.0 * period - 0.5 * b.flight});
  EXPECT_EQ(r.events.back(), 40);
}

TEST(Contact, LosesSpeedAsTheDampingSays) {
  constexpr double u = 0.02;
  Model<double> model = bouncing_gear(u);
  model.axis.b_g = 1500.0;
  double t = 0.0, speed = u;
  for (int n = 0; n < 6; ++n) {
    const Bounce b = bounce(model.axis, speed);
    t += b.flight + b.contact;
    speed *= b.exit;
    t += model.axis.H / speed;  // back in the middle
    const State<double> y = state_at(model, {}, t);
    EXPECT_NEAR(model.axis.r_g * y[2] - y[0], 0.0, 1e-8 * model.axis.H) << n;
    EXPECT_NEAR(model.axis.r_g * y[3] - y[1], n % 2 == 0 ? -speed : speed, 1e-9 * speed) << n;
  }
}

double energy(const Axis<double>& a, const State<double>& y) {
  const double x = a.r_g * y[2] - y[0], squeeze = std::max(0.0, std::abs(x) - a.H);
  return 0.5 * (a.M * y[1] * y[1] + a.J_m * y[3] * y[3] + a.k_g * squeeze * squeeze);
}

TEST(Contact, KeepsEnergyAndMomentum) {
  Model<double> model = bouncing_gear(0.02);
  model.initial[1] += 0.05;
  const auto r = run(model, {}, instants(1000, 1e-3));
  const Axis<double>& a = model.axis;
  const auto momentum = [&](const State<double>& y) { return a.M * y[1] + a.J_m / a.r_g * y[3]; };
  ASSERT_GT(r.events.back(), 100);
  double worst = 0.0;
  for (const State<double>& y : r.states) {
    worst = std::max(worst, std::abs(energy(a, y) / energy(a, r.states[0]) - 1.0));
    ASSERT_NEAR(momentum(y), momentum(r.states[0]), 1e-11 * momentum(r.states[0]));
  }
  std::cout << "energy kept to " << worst << " over " << r.events.back() << " events\n";
  EXPECT_LT(worst, 1e-10);
}

TEST(Contact, LosesEnergyByFrictionOnly) {
  Model<double> model = bouncing_gear(0.02);
  model.initial[1] += 0.05;
  model.axis.b_g = 1500.0;
  model.axis.B_a = 200.0;
  model.axis.B_m = 0.000733;
  const Axis<double>& a = model.axis;
  const double dt = 2e-6;
  const auto r = run(model, {}, instants(20000, dt));
  const auto power = [&](std::size_t k) {
    const State<double>& y = r.states[k];
    const double u = a.r_g * y[3] - y[1];
    return a.B_a * y[1] * y[1] + a.B_m * y[3] * y[3] +
           (r.modes[k].contact != 0 ? a.b_g * u * u : 0.0);
  };
  double lost = 0.0, jumps = 0.0;
  for (std::size_t k = 1; k < r.states.size(); ++k) {
    lost += 0.5 * dt * (power(k - 1) + power(k));
    // Where the teeth meet or part within an interval the trapezoid is off by half of it at most.
    if (r.events[k] != r.events[k - 1]) jumps += 0.5 * dt * std::abs(power(k) - power(k - 1));
  }
  const double all = energy(a, r.states.front()) - energy(a, r.states.back());
  EXPECT_GT(all, 0.1 * energy(a, r.states.front()));
  EXPECT_NEAR(lost, all, jumps + 1e-6 * all);
  EXPECT_LT(jumps, 0.01 * all);
}

TEST(Contact, WithoutBacklashIsASpring) {
  // H = 0, where both contacts coincide: the pair is a linear oscillator through every crossing.
  constexpr double u = 0.02;
  Model<double> model = bouncing_gear(u);
  model.axis.H = 0.0;
  model.axis.b_g = 300.0;
  const Axis<double>& a = model.axis;
  const double mobility = 1.0 / a.M + 1.0 / motor_mass(a);
  const double d = 0.5 * a.b_g * mobility, w = std::sqrt(a.k_g * mobility - d * d);
  const auto times = instants(200, 1e-3);
  const auto r = run(model, {}, times);
  ASSERT_TRUE(r.finished);
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double t = times[k];
    ASSERT_NEAR(a.r_g * r.states[k][2] - r.states[k][0], u / w * std::exp(-d * t) * std::sin(w * t),
                1e-9 * u / w);
  }
}

// The force pulls to one side, and within the first step to the other, while the arm sticks.
TEST(Contact, WithoutBacklashIsASpringFromRestToo) {
  constexpr double first = -1.2, slope = 3600.0;  // N, N/s
  Model<double> model = free_gear();
  add_effect<CoulombFriction>(model).F_c = 100.0;
  model.axis.H = 0.0;
  model.axis.b_g = 500.0;
  model.axis.k_g = 1e6;
  model.axis.J_m = 17.0 * model.axis.r_g * model.axis.r_g;
  const Axis<double>& a = model.axis;
  const double m = motor_mass(a);
  const double d = 0.5 * a.b_g / m, w0 = std::sqrt(a.k_g / m), w = std::sqrt(w0 * w0 - d * d);
  const double B = slope / a.k_g, A = first / a.k_g - 2.0 * d * B / (w0 * w0);
  const auto times = instants(10, 2e-3);
  Schedule force{{0.0, times.back()}, {first, first + slope * times.back()}};
  force.hold = Hold::linear;
  const auto r = run(model, force, times, {.interval = 2e-3});
  ASSERT_TRUE(r.finished);
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double t = times[k];
    const double free = -A * std::cos(w * t) - (d * A + B) / w * std::sin(w * t);
    ASSERT_EQ(r.states[k][0], 0.0);
    ASSERT_NEAR(a.r_g * r.states[k][2], A + B * t + std::exp(-d * t) * free, 1e-9 * B * 0.02);
  }
}

TEST(Coincidence, OfBothVoltageLimitsIsContinuous) {
  // Where the motor voltage meets its limit, put the preamplifier's limit at that very voltage.
  Model<double> model = paper_axis();
  model.axis.K_v = 100.0;
  model.axis.V_L = 1e4;
  const double t = instant_of(model, 1.0, 0.0, 0.01, [](const Mode& m) { return m.v_m != 0; });
  const State<double> y = state_at(model, {{0.0}, {1.0}}, t);
  const double V = y[4] + model.axis.T_z * y[5];
  const auto times = instants(50, 1e-3);
  const auto with = [&](double V_L) {
    model.axis.V_L = V_L;
    const auto r = run(model, {{0.0}, {1.0}}, times);
    EXPECT_TRUE(r.finished);
    return r.states;
  };
  const auto at = with(V);
  EXPECT_LT(largest_difference(with(V * (1.0 + 1e-10)), at), 1e-7);
  EXPECT_LT(largest_difference(with(V * (1.0 - 1e-10)), at), 1e-7);
}

TEST(Coincidence, OfAStopAndACommandIsContinuous) {
  constexpr double F_c = 20.0, stop = 0.25;
  Model<double> model = rubbing_mass(F_c);
  model.initial[1] = F_c * stop / kMass;
  for (const double delay : {-1e-9, -1e-15, 0.0, 1e-15, 1e-9}) {
    const Schedule command{{stop + delay}, {-50.0}};
    EXPECT_NEAR(state_at(model, command, 0.5)[1], -30.0 / kMass * (0.5 - stop), 1e-7) << delay;
    EXPECT_NEAR(state_at(model, command, stop)[1], 0.0, 1e-7) << delay;
  }
}

TEST(Coincidence, OfAStopAndACollisionIsContinuous) {
  // The arm comes to rest at the very instant at which the motor's tooth arrives.
  Model<double> model = free_gear();
  Axis<double>& a = model.axis;
  a.H = 1e-3;
  a.b_g = 1500.0;
  constexpr double F_c = 20.0, stop = 0.05;
  add_effect<CoulombFriction>(model).F_c = F_c;
  const double v = F_c * stop / a.M;
  const auto after = [&](double delay) {
    model.initial[1] = v;
    // y3 r_g (stop + delay) = v stop / 2 + H, with dx in place of y3.
    model.initial[3] = (0.5 * v * stop + a.H) / (stop + delay) - v;
    return state_at(model, {}, 0.08);
  };
  const State<double> at = after(0.0);
  EXPECT_GT(at[1], 0.0);
  for (const double delay : {-1e-9, 1e-9}) {
    const State<double> y = after(delay);
    EXPECT_NEAR(y[1], at[1], 1e-7 * std::abs(v));
    EXPECT_NEAR(y[3], at[3], 1e-6 * std::abs(at[3]));
  }
}

TEST(Delay, ShiftsTheResponse) {
  constexpr double delay = 0.0123;
  Model<double> model = paper_axis();
  std::vector<double> early = instants(600, 1e-3), late = early;
  for (double& t : late) t += delay;
  early.insert(early.begin(), -delay);
  late.insert(late.begin(), 0.0);
  const auto at_once = run(model, level_command(), early);
  model.axis.T_d = delay;
  const auto delayed = run(model, level_command(), late);
  const State<double> range = ranges(at_once.states);
  for (std::size_t k = 0; k < late.size(); ++k)
    for (std::size_t i = 0; i < 6; ++i)
      ASSERT_NEAR(delayed.states[k][i], at_once.states[k][i], 1e-10 * range[i]) << k << " y" << i;
}

TEST(Delay, HasMinusTheTimeDerivative) {
  using J = ceres::Jet<double, 1>;
  Model<J> model = convert<J>(paper_axis());
  model.axis.T_d = J(0.0123, 0);
  const auto times = instants(600, 1e-3);
  double worst = 0.0;
  State<double> range{};
  std::vector<State<double>> error;
  const auto simulation_result =
      simulate(model, level_command(), times, [&](std::size_t, const Integrator<J>& axis) {
        const State<J> f = axis.equations().rate(axis.mode(), axis.state(), axis.input());
        State<double> e;
        for (std::size_t i = 0; i < kStates; ++i) {
          range[i] = std::max(range[i], std::abs(f[i].a));
          e[i] = axis.state()[i].v[0] + f[i].a;
        }
        error.push_back(e);
      });
  ASSERT_TRUE(simulation_result.finished);
  for (const State<double>& e : error)
    for (std::size_t i = 0; i < kStates; ++i) worst = std::max(worst, std::abs(e[i]) / range[i]);
  std::cout << "derivative by T_d off by " << worst << "\n";
  EXPECT_LT(worst, 1e-7);
}

TEST(LinearCommand, IsIntegratedExactly) {
  // From -0.1 s on a force of 3 + 40 t, to the corner at 0.25 s, then falling to zero at 0.35 s and
  // kept there.
  const Model<double> model = driven_mass(kMass);
  const Schedule command{{-0.1, 0.25, 0.35}, {-1.0, 13.0, 0.0}, Hold::linear};
  const auto r = run(model, command, std::vector<double>{0.0, 0.1, 0.2503, 0.35, 0.5});
  const auto rising = [](double t) { return 3.0 * t + 20.0 * t * t; };
  const auto falling = [](double t) { return 13.0 * t - 65.0 * t * t; };
  EXPECT_NEAR(r.states[1][1], rising(0.1) / kMass, 1e-13);
  EXPECT_NEAR(r.states[1][0], (1.5 * 0.01 + 20.0 / 3.0 * 0.001) / kMass, 1e-13);
  EXPECT_NEAR(r.states[2][1], (rising(0.25) + falling(0.0003)) / kMass, 1e-13);
  EXPECT_NEAR(r.states[3][1], (rising(0.25) + falling(0.1)) / kMass, 1e-13);
  EXPECT_NEAR(r.states[4][1], r.states[3][1], 1e-13);
}

TEST(LinearCommand, HasItsFirstValueBefore) {
  const Schedule command{{0.2, 0.3}, {12.0, 0.0}, Hold::linear};
  const auto r = run(driven_mass(kMass), command, std::vector<double>{0.0, 0.2, 0.3});
  EXPECT_NEAR(r.states[1][1], 12.0 * 0.2 / kMass, 1e-13);
  EXPECT_NEAR(r.states[2][1], 12.0 * 0.25 / kMass, 1e-13);
}

TEST(LinearCommand, BreaksAwayAtTheAnalyticInstant) {
  // 50 t beyond 20 N at 0.4 s; then m v' = 50 (t - 0.4), with the observer or without.
  const Model<double> model = rubbing_mass(20.0);
  Schedule command{{0.0}, {0.0}, Hold::linear};
  for (int k = 1; k <= 60; ++k) command.append(0.01 * k, 0.5 * k);
  for (const double t : {0.3, 0.39999}) EXPECT_EQ(state_at(model, command, t)[1], 0.0);
  for (const double t : {0.41, 0.5, 0.6})
    EXPECT_NEAR(state_at(model, command, t)[1], 25.0 * (t - 0.4) * (t - 0.4) / kMass, 1e-12) << t;
}

TEST(LinearCommand, DerivativeByADeadTimeOfEitherSign) {
  // x'' = F(t - T_d) / m with F = 40 t from zero to 1 s: v = 20 (t - T_d)^2 / m + the first value.
  using J = ceres::Jet<double, 1>;
  for (const double delay : {-0.0123, 0.0, 0.0123}) {
    Model<J> model = convert<J>(driven_mass(kMass));
    model.axis.T_d = J(delay, 0);
    Schedule command{{-1.0}, {-40.0}, Hold::linear};
    for (int k = -99; k <= 100; ++k) command.append(0.01 * k, 0.4 * k);
    const auto result =
        simulate(model, command, instants(600, 1e-3), [&](std::size_t, const Integrator<J>& axis) {
          const double t = value_of(axis.time());
          EXPECT_NEAR(axis.state()[1].a, 20.0 * (t * t - 2.0 * t * delay) / kMass, 1e-12);
          EXPECT_NEAR(axis.state()[1].v[0], -40.0 * t / kMass, 1e-11);
        });
    EXPECT_TRUE(result.finished);
  }
}

TEST(Delay, OfACommandThatPrecedesTheRecording) {
  // What was commanded before the first instant is in force from the start.
  Model<double> model = driven_mass(kMass);
  model.axis.T_d = 0.1;
  const Schedule command{{-1.0, -0.15, -0.05, 0.2}, {5.0, 6.0, 12.0, 0.0}};
  const auto r = run(model, command, std::vector<double>{0.0, 0.05, 0.3, 0.5});
  EXPECT_NEAR(r.states[1][1], 0.05 * 6.0 / kMass, 1e-14);
  EXPECT_NEAR(r.states[2][1], (0.05 * 6.0 + 0.25 * 12.0) / kMass, 1e-14);
  EXPECT_NEAR(r.states[3][1], (0.05 * 6.0 + 0.25 * 12.0) / kMass, 1e-14);
}

}  // namespace
}  // namespace axisfit
