// The laws of the effects against closed forms, and against plain Runge-Kutta integrations of laws
// that are written down a second time here.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tests/sim/axes.h"

namespace axisfit {
namespace {

constexpr double kMass = 12.0;
constexpr double kPi = std::numbers::pi;

/// Forward, back, and forward again: N on the driven mass.
Schedule three_pushes() { return {{0.0, 0.3, 0.7}, {30.0, -50.0, 20.0}}; }

double pushing(const Schedule& command, double t) {
  double force = 0.0;
  for (std::size_t k = 0; k < command.times.size() && command.times[k] <= t; ++k)
    force = command.values[k];
  return force;
}

/// y and v at the given instants by the classical Runge-Kutta method in steps of 20 us. The force
/// is asked for at the middle of a step, so that it is that of its own piece where it jumps.
using Law = std::function<double(double t, double y, double v)>;

std::vector<std::array<double, 2>> integrated(const Law& force, double mass,
                                              std::span<const double> times) {
  constexpr double h = 2e-5;
  std::vector<std::array<double, 2>> path;
  double y = 0.0, v = 0.0;
  long step = 0;
  for (const double until : times) {
    for (; static_cast<double>(step) * h < until - 0.5 * h; ++step) {
      const double t = static_cast<double>(step) * h;
      // Just within the step.
      const auto a = [&](double s, double p, double q) {
        return force(t + std::clamp(s, 1e-9 * h, h - 1e-9 * h), p, q) / mass;
      };
      const double v1 = v, a1 = a(0.0, y, v);
      const double v2 = v + 0.5 * h * a1, a2 = a(0.5 * h, y + 0.5 * h * v1, v2);
      const double v3 = v + 0.5 * h * a2, a3 = a(0.5 * h, y + 0.5 * h * v2, v3);
      const double v4 = v + h * a3, a4 = a(h, y + h * v3, v4);
      y += h / 6.0 * (v1 + 2.0 * (v2 + v3) + v4);
      v += h / 6.0 * (a1 + 2.0 * (a2 + a3) + a4);
    }
    path.push_back({y, v});
  }
  return path;
}

/// The cubic cardinal B-spline on 0 ... 4, by the recursion of Cox and de Boor.
double b_spline(double x, int order = 4) {
  if (order == 1) return x >= 0.0 && x < 1.0 ? 1.0 : 0.0;
  return (x * b_spline(x, order - 1) + (order - x) * b_spline(x - 1.0, order - 1)) / (order - 1);
}

/// The curve of the 16 coefficients c at u, which is 0 at its beginning and 1 at its end.
double curve(const std::array<double, 16>& c, double u) {
  u = std::clamp(u, 0.0, 1.0 - 1e-15);
  double sum = 0.0;
  for (int k = 1; k <= 16; ++k)
    sum += c[static_cast<std::size_t>(k - 1)] * b_spline(13.0 * u - k + 4.0);
  return sum;
}

double closed_curve(const std::array<double, 16>& c, double turns) {
  const double s = 16.0 * (turns - std::floor(turns));
  double sum = 0.0;
  for (int k = 1; k <= 16; ++k)  // and once more where it runs over the end of the turn
    sum += c[static_cast<std::size_t>(k - 1)] * (b_spline(s - k + 4.0) + b_spline(s - k - 12.0));
  return sum;
}

std::array<double, 16> coefficients() {
  std::array<double, 16> c{};
  for (std::size_t k = 0; k < c.size(); ++k) c[k] = 10.0 * std::sin(2.0 * static_cast<double>(k));
  return c;
}

struct LawCase {
  std::string name;
  Model<double> model;
  Law law;  ///< N, besides the command
  double tolerance = 1e-9;
};

double sign(double x) { return x < 0.0 ? -1.0 : 1.0; }

std::vector<LawCase> laws() {
  std::vector<LawCase> cases;
  // Where the force jumps within a step, the plain integration is off by the jump times the step.
  constexpr double kJumps = 1e-5;
  const auto add = [&](const char* name, auto&& prepare, Law law, double tolerance = 1e-9) {
    cases.push_back({name, driven_mass(kMass), std::move(law), tolerance});
    prepare(cases.back().model);
  };
  const double r_g = driven_mass(kMass).axis.r_g;
  const auto c = coefficients();
  add(
      "quadratic_drag", [](auto& m) { add_effect<QuadraticDrag>(m).c = 40.0; },
      [](double, double, double v) { return -40.0 * v * std::abs(v); });
  for (const double n : {0.5, 1.3, 3.0})
    add(
        "quadratic_drag.n",
        [=](auto& m) {
          add_effect<QuadraticDrag>(m) = {40.0, n};
        },
        [=](double, double, double v) {
          return -40.0 * v * std::abs(v) * std::pow(v * v + 1e-6, 0.5 * (n - 2.0));
        },
        // The lower it is, the more the force bends at 1 mm/s.
        n < 1.0   ? 1e-5
        : n < 2.0 ? 1e-7
                  : 1e-9);
  add(
      "directional_friction.dB_a",
      [](auto& m) {
        m.axis.B_a = 30.0;
        add_effect<DirectionalFriction>(m).dB_a = 20.0;
      },
      [](double, double, double v) { return -(30.0 + 20.0 * sign(v)) * v; });
  add(
      "position_friction.G_b", [](auto& m) { add_effect<PositionFriction>(m).G_b = 90.0; },
      [](double, double y, double v) { return -90.0 * y * v; });
  add(
      "stroke_spring", [](auto& m) { add_effect<StrokeSpring>(m).k_s = 150.0; },
      [](double, double y, double) { return -150.0 * y; });
  // At both ends with a damping; it pushes, and never pulls.
  add(
      "end_stops",
      [](auto& m) {
        add_effect<EndStops>(m) = {2e4, 0.09, 3e4, -0.02, 2.0};
      },
      [](double, double y, double v) {
        const auto push = [](double k, double depth, double speed) {
          return depth > 0.0 ? k * depth * depth * std::max(0.0, 1.0 + 2.0 * speed) : 0.0;
        };
        return push(3e4, -0.02 - y, -v) - push(2e4, y - 0.09, v);
      },
      1e-7);
  add(
      "payload_change",
      [](auto& m) {
        add_effect<PayloadChange>(m) = {5.0, -4.0, 0.42};
      },
      [](double t, double, double) {
        const double part = 0.5 * (1.0 + std::tanh(50.0 * (t - 0.42)));
        const double force = pushing(three_pushes(), t);
        return kMass * (force - 4.0 * part) / (kMass + 5.0 * part) - force;
      },
      1e-7);
  add(
      "pendulum_gravity",
      [](auto& m) {
        add_effect<PendulumGravity>(m) = {25.0, -9.0};
      },
      [](double, double y, double) { return -25.0 * std::sin(y) + 9.0 * std::cos(y); });
  add(
      "periodic_force",
      [](auto& m) { add_effect<PeriodicForce>(m) = {12.0, -7.0, 4.0, 3.0, 2.0, -1.5, 0.05}; },
      [](double, double y, double) {
        const double q = 2.0 * kPi * y / 0.05;
        return 12.0 * std::sin(q) - 7.0 * std::cos(q) + 4.0 * std::sin(2.0 * q) +
               3.0 * std::cos(2.0 * q) + 2.0 * std::sin(3.0 * q) - 1.5 * std::cos(3.0 * q);
      });
  add(
      "cogging_torque",
      [](auto& m) {
        add_effect<CoggingTorque>(m) = {0.04, -0.03, 2.0};
      },
      [=](double, double y, double) {
        return (0.04 * std::sin(2.0 * y / r_g) - 0.03 * std::cos(2.0 * y / r_g)) / r_g;
      });
  add(
      "torque_fade", [](auto& m) { add_effect<TorqueFade>(m).c_t = 0.4; },
      [](double t, double, double) {
        return pushing(three_pushes(), t) * (1.0 / (1.0 + 0.4 * t) - 1.0);
      });
  for (const double a_t : {1e-3, 2.0})
    add(
        "torque_fade.a_t",
        [=](auto& m) {
          add_effect<TorqueFade>(m) = {0.4, a_t};
        },
        [=](double t, double, double) {
          const double loss = -0.4 * std::expm1(-a_t * t) / a_t;
          return pushing(three_pushes(), t) * (1.0 / (1.0 + loss) - 1.0);
        });
  add(
      "force_droop", [](auto& m) { add_effect<ForceDroop>(m).c_f = 4e-3; },
      [](double t, double, double) {
        const double force = pushing(three_pushes(), t);
        return -4e-3 * force * std::abs(force);
      });
  add(
      "force_droop.c_q",
      [](auto& m) {
        add_effect<ForceDroop>(m) = {1e-3, 2e-5};
      },
      [](double t, double, double) {
        const double force = pushing(three_pushes(), t);
        return force * (1.0 / std::sqrt(1.0 + 4e-5 * force * force) - 1e-3 * std::abs(force) - 1.0);
      });
  add(
      "force_over_velocity",
      [=](auto& m) {
        add_effect<ForceOverVelocity>(m) = {c, -2.0, 2.0};
      },
      [=](double, double, double v) { return curve(c, (v + 2.0) / 4.0); });
  add(
      "force_over_position",
      [=](auto& m) {
        add_effect<ForceOverPosition>(m) = {c, -1.0, 1.0};
      },
      [=](double, double y, double) { return curve(c, (y + 1.0) / 2.0); });
  add(
      "force_over_motor_angle", [=](auto& m) { add_effect<ForceOverMotorAngle>(m).c = c; },
      [=](double, double y, double) { return closed_curve(c, y / r_g / (2.0 * kPi)); }, 1e-7);
  // Constant beyond its ends.
  add(
      "force_over_time",
      [=](auto& m) {
        add_effect<ForceOverTime>(m) = {c, 0.2, 0.8};
      },
      [=](double t, double, double) { return curve(c, (t - 0.2) / 0.6); });
  auto level = c;
  for (double& x : level) x = 8.0 + 0.3 * x;
  add(
      "friction_over_velocity",
      [=](auto& m) {
        add_effect<FrictionOverVelocity>(m) = {level, -0.1, 1.2};
      },
      [=](double, double, double v) { return -sign(v) * curve(level, (std::abs(v) + 0.1) / 1.3); },
      kJumps);
  add(
      "friction_over_position",
      [=](auto& m) {
        add_effect<FrictionOverPosition>(m) = {level, -0.2, 0.3};
      },
      [=](double, double y, double v) { return -sign(v) * curve(level, (y + 0.2) / 0.5); }, kJumps);
  add(
      "command_offset", [](auto& m) { add_effect<CommandOffset>(m).U_0 = 6.0; },
      [](double, double, double) { return 6.0; });
  add(
      "added_mass", [](auto& m) { m.axis.M -= add_effect<AddedMass>(m).dM = 5.0; },
      [](double, double, double) { return 0.0; });
  const auto lagging = [](double t) {
    double y = 0.0, since = 0.0, input = 0.0;
    const Schedule command = three_pushes();
    for (std::size_t k = 0; k < command.times.size() && command.times[k] <= t; ++k) {
      y = input + (y - input) * std::exp(-(command.times[k] - since) / 0.03);
      since = command.times[k];
      input = command.values[k];
    }
    return input + (y - input) * std::exp(-(t - since) / 0.03);
  };
  add(
      "drive_lag", [](auto& m) { add_effect<DriveLag>(m).T_l = 0.03; },
      [=](double t, double, double) { return lagging(t) - pushing(three_pushes(), t); });
  add(
      "load_friction", [](auto& m) { add_effect<LoadFriction>(m).mu = 0.2; },
      [](double t, double, double v) {
        return -0.2 * sign(v) * std::abs(pushing(three_pushes(), t));
      },
      kJumps);
  add(
      "quadratic_load_friction", [](auto& m) { add_effect<QuadraticLoadFriction>(m).mu_q = 4e-3; },
      [](double t, double, double v) {
        return -4e-3 * sign(v) * std::pow(pushing(three_pushes(), t), 2);
      },
      kJumps);
  add(
      "stribeck_load_friction",
      [](auto& m) {
        add_effect<StribeckLoadFriction>(m) = {0.2, 0.3};
      },
      [](double t, double, double v) {
        return -0.2 * sign(v) * std::abs(pushing(three_pushes(), t)) * std::exp(-std::abs(v) / 0.3);
      },
      kJumps);
  add(
      "warming_friction and warming_grease",
      [](auto& m) {
        add_effect<WarmingFriction>(m) = {8.0, 0.4};
        add_effect<WarmingGrease>(m) = {25.0, 0.7};
      },
      [](double t, double, double v) {
        return -8.0 * sign(v) * std::exp(-t / 0.4) - 25.0 * v * std::exp(-t / 0.7);
      },
      kJumps);
  // The force passes zero between two switches.
  add(
      "load_friction with drive_lag",
      [](auto& m) {
        add_effect<LoadFriction>(m).mu = 0.2;
        add_effect<DriveLag>(m).T_l = 0.03;
      },
      [=](double t, double, double v) {
        const double force = lagging(t);
        return force - pushing(three_pushes(), t) - 0.2 * sign(v) * std::abs(force);
      },
      kJumps);
  add(
      "stribeck_load_friction with drive_lag",
      [](auto& m) {
        add_effect<StribeckLoadFriction>(m) = {0.2, 0.3};
        add_effect<DriveLag>(m).T_l = 0.03;
      },
      [=](double t, double, double v) {
        const double force = lagging(t);
        return force - pushing(three_pushes(), t) -
               0.2 * sign(v) * std::abs(force) * std::exp(-std::abs(v) / 0.3);
      },
      3.0 * kJumps);
  return cases;
}

TEST(ForceLaw, MovesAMassAsAPlainIntegrationDoes) {
  const auto times = instants(100, 0.01);
  for (const auto& [name, model, law, tolerance] : laws()) {
    SCOPED_TRACE(name);
    const auto r = run(model, three_pushes(), times);
    ASSERT_TRUE(r.finished);
    const Schedule command = three_pushes();
    const auto force = [&, &law = law](double t, double y, double v) {
      return pushing(command, t) + law(t, y, v);
    };
    const auto path = integrated(force, kMass, times);
    bool turned = false;
    double worst = 0.0;
    for (std::size_t k = 0; k < times.size(); ++k) {
      worst = std::max(
          {worst, std::abs(r.states[k][0] - path[k][0]), std::abs(r.states[k][1] - path[k][1])});
      turned |= k > 0 && path[k][1] < 0.0;
    }
    EXPECT_TRUE(turned);
    std::cout << name << ": off by " << worst << "\n";
    EXPECT_LT(worst, tolerance);
  }
}

/// A mass with dry friction, besides what the test adds.
Model<double> rubbing_mass(double F_c) {
  Model<double> model = driven_mass(kMass);
  add_effect<CoulombFriction>(model).F_c = F_c;
  return model;
}

/// Whether a force from rest on sets the mass in motion.
bool moves(const Model<double>& model, double force) {
  return run(model, {{0.0}, {force}}, std::vector<double>{0.0, 0.05}).states.back()[1] != 0.0;
}

TEST(ForceLaw, OfStribeckFrictionHoldsAndSlides) {
  for (const auto& [F_st, n] : {std::pair{12.0, 1.0}, {-12.0, 1.0}, {12.0, 0.5}, {12.0, 2.0}}) {
    SCOPED_TRACE(n);
    constexpr double F_c = 20.0, v_st = 0.05, F = 40.0;
    Model<double> model = rubbing_mass(F_c);
    add_effect<StribeckFriction>(model) = {F_st, v_st, n};
    const auto left = [&, F_st = F_st, n = n](double v) {
      const double x = v / v_st;
      return n == 1.0 ? F_st * std::exp(-x)
                      : F_st * std::exp(-x * std::pow(x * x + 1e-4, 0.5 * (n - 1.0)));
    };
    for (const double way : {1.0, -1.0}) {
      EXPECT_FALSE(moves(model, way * (F_c + F_st - 1e-6)));
      EXPECT_TRUE(moves(model, way * (F_c + F_st + 1e-6)));
      const auto times = instants(50, 0.01);
      const auto r = run(model, {{0.0}, {way * F}}, times);
      const auto path =
          integrated([&](double, double, double v) { return F - F_c - left(v); }, kMass, times);
      for (std::size_t k = 0; k < times.size(); ++k) {
        ASSERT_NEAR(way * r.states[k][0], path[k][0], n < 1.0 ? 1e-7 : 1e-9) << k;
        ASSERT_NEAR(way * r.states[k][1], path[k][1], n < 1.0 ? 1e-6 : 1e-9) << k;
      }
    }
  }
}

TEST(ForceLaw, OfDragHasAnExponent) {
  Instant<double> at{};
  for (const double n : {0.3, 0.7, 1.2, 1.7, 2.0, 2.5, 4.0})
    for (const double v : {-2.0, -0.3, 0.02, 0.5}) {
      at.velocity = v;
      const double drag = 60.0 * std::pow(std::abs(v), n);
      EXPECT_NEAR(QuadraticDrag<double>({60.0, n}).arm_force(at), -sign(v) * drag, 0.01 * drag)
          << n << ' ' << v;
    }
}

TEST(ForceLaw, OfStribeckFrictionHasAnExponent) {
  Instant<double> at{};
  at.direction = -1;
  for (const double n : {0.5, 0.8, 1.0, 1.6, 2.0})
    for (const double x : {0.1, 0.3, 1.0, 3.0}) {
      at.velocity = -0.05 * x;
      const double power = std::pow(x, n);
      EXPECT_NEAR(StribeckFriction<double>({12.0, 0.05, n}).friction_curve(at),
                  12.0 * std::exp(-power), 12.0 * 0.005 * power * std::exp(-power))
          << n << ' ' << x;
    }
}

TEST(ForceLaw, OfPositionFrictionIsAHarmonicStop) {
  // M y'' = -(F_c + G_c y) from y' = v until it rests, and there it holds against as much.
  constexpr double F_c = 20.0, G_c = 90.0, v = 0.7;
  Model<double> model = rubbing_mass(F_c);
  add_effect<PositionFriction>(model).G_c = G_c;
  model.initial[1] = v;
  const double w = std::sqrt(G_c / kMass), stop = std::atan(v * G_c / (F_c * w)) / w;
  const auto place = [&](double t) {
    return F_c / G_c * (std::cos(w * t) - 1.0) + v / w * std::sin(w * t);
  };
  const auto times = instants(200, 5e-3);
  const auto r = run(model, {}, times);
  ASSERT_LT(stop, 0.9);
  for (std::size_t k = 0; k < times.size(); ++k)
    ASSERT_NEAR(r.states[k][0], place(std::min(times[k], stop)), 1e-12) << k;
  EXPECT_EQ(r.states.back()[1], 0.0);
  const double holds = F_c + G_c * place(stop);
  const auto later = [&](double force) {
    return run(model, {{1.0}, {force}}, std::vector<double>{0.0, 1.1}).states.back()[1];
  };
  EXPECT_EQ(later(-holds + 1e-6), 0.0);
  EXPECT_LT(later(-holds - 1e-6), 0.0);
}

TEST(ForceLaw, OfFrictionBumpTakesAGaussianOfWork) {
  // From one end to the other: M v^2 / 2 falls by the work of friction, and the bump holds at rest.
  constexpr double F_c = 5.0, F_b = 15.0, y_b = 0.1, w_b = 0.03, v = 0.9;
  for (const double way : {1.0, -1.0}) {
    Model<double> model = rubbing_mass(F_c);
    add_effect<FrictionBump>(model) = {F_b, way * y_b, w_b};
    model.initial[1] = way * v;
    const auto times = instants(50, 5e-3);
    const auto r = run(model, {}, times);
    ASSERT_GT(way * r.states.back()[0], y_b + 2.0 * w_b);
    for (std::size_t k = 0; k < times.size(); ++k) {
      const double y = way * r.states[k][0], speed = way * r.states[k][1];
      const double work = F_c * y + F_b * w_b * std::sqrt(kPi) / 2.0 *
                                        (std::erf((y - y_b) / w_b) + std::erf(y_b / w_b));
      ASSERT_NEAR(speed, std::sqrt(v * v - 2.0 * work / kMass), 1e-9) << k;
    }
    model.initial = {way * (y_b + 0.5 * w_b)};
    const double holds = F_c + F_b * std::exp(-0.25);
    for (const double push : {1.0, -1.0}) {
      EXPECT_FALSE(moves(model, push * (holds - 1e-6)));
      EXPECT_TRUE(moves(model, push * (holds + 1e-6)));
    }
  }
}

TEST(ForceLaw, OfDirectionalDryFrictionIsAConstantForce) {
  for (const double F_c : {15.0, 2.0}) {  // more and less than the difference
    Model<double> directional = paper_axis();
    directional.axis.F_s = 10.0;
    add_effect<CoulombFriction>(directional).F_c = F_c;
    Model<double> constant = directional;
    add_effect<DirectionalFriction>(directional).dF_c = 5.0;
    add_effect<ConstantForce>(constant).F_0 = -5.0;
    const auto times = instants(1000, 1e-3);
    const auto a = run(directional, level_command(), times);
    const auto b = run(constant, level_command(), times);
    ASSERT_TRUE(a.finished && b.finished);
    EXPECT_EQ(a.events, b.events);
    EXPECT_EQ(a.modes, b.modes);
    EXPECT_LT(largest_difference(a.states, b.states), 1e-8);
  }
}

TEST(ForceLaw, OfLoadFrictionTakesItsShareOfTheToothForce) {
  // Motor and arm under a constant force, once the gear has settled: F - f_g = m a,
  // f_g - mu |f_g| sign(v) = M a.
  constexpr double mu = 0.1, F = 300.0;
  for (const double way : {1.0, -1.0}) {
    Model<double> model = free_gear();
    model.axis.b_g = 2e4;
    add_effect<LoadFriction>(model).mu = mu;
    const auto r = run(model, {{0.0}, {way * F}}, instants(100, 0.01));
    const double m = motor_mass(model.axis), a = way * F / (m + model.axis.M / (1.0 - mu));
    EXPECT_NEAR(r.acceleration.back(), a, 1e-9);
    // Braked by the motor it is the other flank that carries, and friction helps.
    const auto braked = run(model, {{0.0, 0.5}, {way * F, -way * F}}, instants(80, 0.01));
    EXPECT_NEAR(braked.acceleration.back(), -way * F / (m + model.axis.M / (1.0 + mu)), 1e-9);
  }
}

TEST(ForceLaw, OfLoadFrictionHoldsARigidAxis) {
  Model<double> plain = driven_mass(kMass);
  add_effect<ConstantForce>(plain).F_0 = -30.0;
  Model<double> at_low_speed = plain;
  add_effect<LoadFriction>(plain).mu = 0.3;
  add_effect<StribeckLoadFriction>(at_low_speed) = {0.3, 0.05};
  for (const Model<double>& model : {plain, at_low_speed}) {
    EXPECT_TRUE(moves(model, 0.0));  // nothing holds without a load
    EXPECT_FALSE(moves(model, 25.0));
    EXPECT_FALSE(moves(model, 40.0));  // 10 N against 12 N
    EXPECT_TRUE(moves(model, 43.0));   // 13 N against 12.9 N
    EXPECT_TRUE(moves(model, 23.0));   // -7 N against 6.9 N
  }
}

TEST(ForceLaw, OfQuadraticLoadFrictionTakesItsShareOfTheToothForce) {
  // As that of load friction: F - f_g = m a, f_g - mu_q f_g^2 = M a.
  constexpr double mu_q = 1e-3, F = 300.0;
  for (const double way : {1.0, -1.0}) {
    Model<double> model = free_gear();
    model.axis.b_g = 2e4;
    add_effect<QuadraticLoadFriction>(model).mu_q = mu_q;
    const auto r = run(model, {{0.0}, {way * F}}, instants(100, 0.01));
    const double m = motor_mass(model.axis), share = 1.0 + model.axis.M / m;
    const double f_g =
        (share - std::sqrt(share * share - 4.0 * mu_q * F * model.axis.M / m)) / (2.0 * mu_q);
    EXPECT_NEAR(r.acceleration.back(), way * (F - f_g) / m, 1e-7);
    EXPECT_NEAR(std::abs(r.acceleration.back()) * model.axis.M, f_g - mu_q * f_g * f_g, 1e-6);
  }
}

TEST(ForceLaw, OfQuadraticLoadFrictionHoldsARigidAxis) {
  Model<double> model = driven_mass(kMass);
  add_effect<QuadraticLoadFriction>(model).mu_q = 0.01;
  add_effect<ConstantForce>(model).F_0 = -30.0;
  EXPECT_TRUE(moves(model, 0.0));
  EXPECT_FALSE(moves(model, 25.0));  // -5 N against 6.25 N
  EXPECT_TRUE(moves(model, 23.0));   // -7 N against 5.29 N
  EXPECT_FALSE(moves(model, 43.0));  // 13 N against 18.49 N
  EXPECT_FALSE(moves(model, 60.0));  // it locks itself: 30 N against 36 N
}

TEST(ForceLaw, OfRunningInFrictionCountsTheWayForthAndBack) {
  // M v^2 / 2 falls by F_c s + F_r l_r (1 - exp(-s / l_r)) over the travel s, until it rests; then
  // it is pushed back and goes on from there.
  constexpr double F_c = 5.0, F_r = 15.0, l_r = 0.1, v = 0.7, F = 40.0;
  const auto work = [](double s) { return F_c * s + F_r * l_r * (1.0 - std::exp(-s / l_r)); };
  Model<double> model = rubbing_mass(F_c);
  add_effect<RunningInFriction>(model) = {F_r, l_r};
  model.initial[1] = v;
  const auto times = instants(200, 0.01);
  const auto r = run(model, {{1.4}, {-F}}, times);
  const auto at = [&](std::size_t k) { return r.states[k]; };
  double stop = 0.0;
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (times[k] > 1.4) {
      const double back = stop - at(k)[0];
      const double energy = F * back - (work(stop + back) - work(stop));
      ASSERT_NEAR(at(k)[1], -std::sqrt(2.0 * energy / kMass), 1e-9) << k;
    } else if (at(k)[1] != 0.0) {
      ASSERT_NEAR(at(k)[1], std::sqrt(v * v - 2.0 * work(at(k)[0]) / kMass), 1e-9) << k;
    } else {
      stop = at(k)[0];
      ASSERT_NEAR(work(stop), 0.5 * kMass * v * v, 1e-9);
    }
  }
  ASSERT_GT(stop, 0.0);
  EXPECT_LT(at(200)[0], 0.0);
}

TEST(ForceLaw, OfDahlFrictionIsTheHysteresisOfItsEquation) {
  // dz/dy = (direction - z) / l_d over a travel forth and back, from any state.
  const DahlFriction<double> dahl{10.0, 2e-4, 30.0};
  for (const double start : {0.0, 0.4, -1.0})
    for (const int way : {1, -1}) {
      constexpr int kSteps = 1000;
      constexpr double kTravel = 5e-4;
      double z = start;
      Instant<double> at{};
      at.direction = way;
      at.velocity = 0.2 * way;
      at.memory = {0.01, start};
      const double h = kTravel / kSteps;
      for (int i = 1; i <= kSteps; ++i) {
        const auto rate = [&](double value) { return (way - value) / dahl.l_d * way; };
        const double k1 = rate(z), k2 = rate(z + 0.5 * way * h * k1),
                     k3 = rate(z + 0.5 * way * h * k2), k4 = rate(z + way * h * k3);
        z += way * h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
        at.position = 0.01 + way * i * h;
        ASSERT_NEAR(dahl.hysteresis(at), z, 1e-9);
        const double bending = 0.2 * way * dahl.l_d * rate(z);  // l_d z', m/s
        ASSERT_NEAR(dahl.arm_force(at), -10.0 * z - 30.0 * bending, 1e-8);
      }
    }
}

// As an observer may move the axis, against its velocity.
TEST(ForceLaw, OfDahlFrictionWaitsWhereTheAxisIsMovedBack) {
  const DahlFriction<double> dahl{10.0, 2e-4, 0.0};
  for (const int way : {-1, 1}) {
    Instant<double> at{};
    at.memory.hysteresis = -0.3 * way;
    at.direction = way;
    at.position = -way * 1.0;
    EXPECT_EQ(dahl.hysteresis(at), at.memory.hysteresis);
    at.position = way * 1.0;
    EXPECT_NEAR(dahl.hysteresis(at), way, 1e-12);
  }
}

TEST(ForceLaw, OfDahlFrictionFollowsTheMotion) {
  // Two elements together with Coulomb friction, through reversals and rests, with each z
  // integrated as a state.
  constexpr double F_c = 3.0, F_d = 7.0, l_d = 2e-3, B_d = 40.0, F_d2 = 3.0, l_d2 = 8e-3;
  Model<double> model = rubbing_mass(F_c);
  add_effect<DahlFriction>(model) = {F_d, l_d, B_d};
  add_effect<SecondDahlFriction>(model) = {F_d2, l_d2};
  const Schedule command{{0.0, 0.2, 0.5, 0.6, 0.8}, {20.0, -15.0, -5.0, 9.0, 0.0}};
  const auto times = instants(120, 0.01);
  const auto r = run(model, command, times);
  ASSERT_TRUE(r.finished);
  constexpr double h = 1e-6;
  double y = 0.0, v = 0.0, z = 0.0, z2 = 0.0;
  int rests = 0;
  for (std::size_t k = 1; k < times.size(); ++k) {
    for (int i = 0; i < 10000; ++i) {  // symplectic steps: first order, but tiny
      const double t = times[k - 1] + (i + 0.5) * h;
      const double bending = v * (1.0 - sign(v) * z);
      const double rest = pushing(command, t) - F_d * z - B_d * bending - F_d2 * z2;
      if (v == 0.0 && std::abs(rest) <= F_c) continue;
      const double s = v != 0.0 ? sign(v) : sign(rest);
      const double after = v + h * (rest - s * F_c) / kMass;
      if (v != 0.0 && v * after < 0.0) {
        v = 0.0;
        ++rests;
        continue;
      }
      v = after;
      y += h * v;
      z += h * v / l_d * (s - z) * s;
      z2 += h * v / l_d2 * (s - z2) * s;
    }
    ASSERT_NEAR(r.states[k][0], y, 2e-5) << times[k];
    ASSERT_NEAR(r.states[k][1], v, 5e-5) << times[k];
  }
  EXPECT_GT(rests, 3);
}

TEST(ForceLaw, OfDahlFrictionIsASpringAtATurn) {
  // F_d / l_d holds a mass that is pushed a little, as a spring does.
  constexpr double F_d = 50.0, l_d = 1e-3, F = 0.01;
  Model<double> model = driven_mass(kMass);
  add_effect<DahlFriction>(model) = {F_d, l_d};
  const double w = std::sqrt(F_d / l_d / kMass);
  const auto times = instants(40, kPi / w / 40.0);
  const auto r = run(model, {{0.0}, {F}}, times);
  for (std::size_t k = 0; k < times.size(); ++k)
    ASSERT_NEAR(r.states[k][0], F / (kMass * w * w) * (1.0 - std::cos(w * times[k])),
                1e-3 * F / (kMass * w * w));
}

TEST(ForceLaw, OfAnElasticModeIsThatOfTwoMasses) {
  // q'' + 2 d q' + W^2 q = -F / (M - m), M y1 + m q' = F t: W = w / sqrt(1 - m / M) when free.
  constexpr double F = 30.0, m = 3.0, f = 8.0, zeta = 0.03;
  Model<double> model = driven_mass(kMass);
  add_effect<ElasticMode>(model) = {m, f, zeta};
  const double w = 2.0 * kPi * f, carrier = kMass - m, W = w / std::sqrt(1.0 - m / kMass);
  const double d = zeta * w * kMass / carrier, damped = std::sqrt(W * W - d * d);
  const auto times = instants(500, 1e-3);
  const auto r = run(model, {{0.0}, {F}}, times);
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double t = times[k];
    const double dq = -F / carrier / damped * std::exp(-d * t) * std::sin(damped * t);
    ASSERT_NEAR(r.states[k][9], dq, 1e-12);
    ASSERT_NEAR(r.states[k][1], (F * t - m * dq) / kMass, 1e-12);
  }
}

TEST(ForceLaw, OfAddedMassIsThatOfTheArmBitForBit) {
  Model<double> heavier = paper_axis(), loaded = paper_axis();
  heavier.axis.M = 154.0;
  add_effect<AddedMass>(loaded).dM = 8.0;
  const auto times = instants(500, 1e-3);
  const auto a = run(heavier, level_command(), times), b = run(loaded, level_command(), times);
  EXPECT_EQ(a.states, b.states);
  EXPECT_EQ(a.events, b.events);
}

TEST(ForceLaw, OfASupplyResistanceIsThatOfTheMotorAtItsLimit) {
  // A command beyond what V_s can drive: the motor hangs on the supply throughout.
  constexpr double R_v = 0.8;
  for (const double way : {1.0, -1.0}) {
    Model<double> soft = paper_axis(), weak = paper_axis();
    soft.axis.V_s = weak.axis.V_s = 4.0;
    add_effect<SupplyResistance>(soft).R_v = R_v;
    weak.axis.R += R_v;
    const auto times = instants(500, 1e-3);
    const auto a = run(soft, {{0.0}, {way * 10.0}}, times),
               b = run(weak, {{0.0}, {way * 10.0}}, times);
    EXPECT_EQ(a.modes.back().v_m, way);
    EXPECT_LT(largest_difference(a.states, b.states), 1e-5);
    EXPECT_GT(std::abs(a.states.back()[1]), 0.01);
  }
}

TEST(ForceLaw, OfASupplyResistanceIsNothingBelowTheLimit) {
  Model<double> soft = paper_axis();
  soft.axis.K_v = 10.0;
  soft.axis.V_s = 1e4;
  const auto times = instants(500, 1e-3);
  const auto without = run(soft, level_command(), times);
  add_effect<SupplyResistance>(soft).R_v = 2.0;
  EXPECT_LT(largest_difference(run(soft, level_command(), times).states, without.states), 1e-12);
}

TEST(ForceLaw, OfASoftTransmissionIsThatOfASlowGear) {
  // A motor pushes an arm against viscous friction, so slowly that the gear is at its equilibrium:
  // the encoder is ahead by H + f_g / k_g.
  constexpr double H = 2e-4, k_g = 1e5, F = 120.0;
  Model<double> gear = free_gear();
  gear.axis.H = H;
  gear.axis.k_g = k_g;
  gear.axis.B_a = 400.0;
  gear.axis.b_g = 6e3;
  Model<double> rigid = gear;
  rigid.structure.transmission = Transmission::rigid;
  rigid.axis.J_m = gear.axis.J_m;
  add_effect<SoftTransmission>(rigid) = {1.0 / k_g, H};
  rigid.axis.r_g = gear.axis.r_g;
  for (const double way : {1.0, -1.0}) {
    const auto times = instants(150, 0.01);
    const Schedule push{{0.0}, {way * F}};
    const auto a = run(gear, push, times), b = run(rigid, push, times);
    ASSERT_TRUE(a.finished && b.finished);
    const double m = motor_mass(gear.axis), r_g = gear.axis.r_g;
    for (std::size_t k = 50; k < times.size(); ++k) {
      // The force at the arm, from each run's own acceleration.
      const double f = way * F - m * b.acceleration[k];
      ASSERT_NEAR(b.encoder[k], b.states[k][0] + f / k_g + way * H, 1e-12) << k;
      ASSERT_NEAR(r_g * a.states[k][2] - a.states[k][0], b.encoder[k] - b.states[k][0], 2e-5) << k;
    }
  }
}

TEST(ForceLaw, OfADriveLagIsAThirdPole) {
  // Current source without feedback, its zero out of the way: three lags in a row.
  constexpr double T_l = 0.013, U = 1e-3;
  Model<double> model = paper_axis();
  model.structure = {Drive::current_source, Transmission::rigid, {}};
  Axis<double>& a = model.axis;
  a.K_2 = a.T_z = 0.0;
  a.V_L = 1e6;
  add_effect<DriveLag>(model).T_l = T_l;
  const auto times = instants(300, 1e-3);
  const auto r = run(model, {{0.0}, {U}}, times);
  const double T[] = {a.T_p, a.T_r, T_l};
  for (std::size_t k = 0; k < times.size(); ++k) {
    double rise = 1.0;
    for (int i = 0; i < 3; ++i) {
      const double x = T[i], y = T[(i + 1) % 3], z = T[(i + 2) % 3];
      rise -= std::exp(-times[k] / x) * x * x / ((x - y) * (x - z));
    }
    ASSERT_NEAR(r.current[k], a.K_i * a.K_1 * U * rise, 1e-11);
  }
}

TEST(ForceLaw, OfTorquesIsInTheForceOfTheDrive) {
  // At every sample, from the current and the angle there.
  const auto times = instants(300, 2e-3);
  const auto compare = [&](const char* name, auto&& prepare, auto&& factor) {
    SCOPED_TRACE(name);
    for (const Transmission transmission : {Transmission::backlash, Transmission::rigid}) {
      Model<double> model = paper_axis();
      model.structure.transmission = transmission;
      prepare(model);
      const Axis<double>& a = model.axis;
      const auto simulation_result = simulate(
          model, level_command(), times, [&](std::size_t k, const Integrator<double>& axis) {
            const auto read = [&](Signal signal) {
              return reading(axis.equations(), signal, axis.mode(), axis.state(), axis.input());
            };
            const double current = read(Signal::motor_current), angle = axis.state()[2];
            const double force = a.K_m * current * factor(current, angle, times[k]) / a.r_g;
            ASSERT_NEAR(read(Signal::drive_force), force, 1e-9);
            const double friction = a.B_a + a.B_m / (a.r_g * a.r_g);
            if (transmission == Transmission::rigid) {
              ASSERT_NEAR((a.M + motor_mass(a)) * read(Signal::acceleration),
                          force - friction * axis.state()[1], 1e-9);
            }
          });
      EXPECT_TRUE(simulation_result.finished);
    }
  };
  compare(
      "torque_ripple",
      [](auto& m) {
        add_effect<TorqueRipple>(m) = {0.03, -0.02, 2.0};
      },
      [](double, double q, double) {
        return 1.0 + 0.03 * std::sin(2.0 * q) - 0.02 * std::cos(2.0 * q);
      });
  compare(
      "torque_droop", [](auto& m) { add_effect<TorqueDroop>(m).c_i = 0.02; },
      [](double i, double, double) { return 1.0 - 0.02 * std::abs(i); });
  compare(
      "torque_droop.c_q",
      [](auto& m) {
        add_effect<TorqueDroop>(m) = {0.01, 2e-3};
      },
      [](double i, double, double) {
        return 1.0 / std::sqrt(1.0 + 4e-3 * i * i) - 0.01 * std::abs(i);
      });
  compare(
      "torque_fade", [](auto& m) { add_effect<TorqueFade>(m).c_t = 0.3; },
      [](double, double, double t) { return 1.0 / (1.0 + 0.3 * t); });
}

}  // namespace
}  // namespace axisfit
