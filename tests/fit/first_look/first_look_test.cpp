// The first look, at masses that are integrated in small steps, without the project's simulation.
#include "fit/first_look/first_look.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "tests/base/noise.h"

namespace axisfit {
namespace {

struct Machine {
  double mass = 12.0, viscous = 40.0, coulomb = 15.0, constant = 4.0;
  double sine = 0.0, cosine = 0.0;
  double delay = 0.0;       ///< s
  double presliding = 0.0;  ///< m, over which friction builds up; zero: at once
};

struct Recorded {
  std::vector<double> times, position, velocity, input;

  DrivenMotion by_position() const { return {times, position, {}, input}; }
  DrivenMotion by_velocity() const { return {times, {}, velocity, input}; }
};

double wave(double t) { return 70.0 * std::sin(9.0 * t) + 40.0 * std::sin(23.0 * t); }

Recorded record(const Machine& machine, const std::function<double(double)>& force = wave,
                double duration = 4.0, double interval = 1e-3, double noise = 0.0,
                std::uint64_t seed = 1) {
  constexpr double kStep = 2e-5;
  Recorded run;
  Normal normal(seed);
  double x = 0.2, v = 0.0, z = 0.0, next = 0.0;
  for (double t = 0.0; t < duration; t += kStep) {
    if (t >= next - 0.5 * kStep) {
      run.times.push_back(t);
      run.position.push_back(x + noise * normal());
      run.velocity.push_back(v + 100.0 * noise * normal());
      run.input.push_back(force(t));
      next += interval;
    }
    const double drive = force(t - machine.delay);
    double load = drive - machine.viscous * v - machine.constant - machine.sine * std::sin(x) -
                  machine.cosine * std::cos(x);
    if (machine.presliding > 0.0) {
      z += kStep * (v - std::abs(v) * z) / machine.presliding;
      v += kStep * (load - machine.coulomb * z) / machine.mass;
    } else {
      const double friction = v == 0.0 ? std::clamp(load, -machine.coulomb, machine.coulomb)
                                       : std::copysign(machine.coulomb, v);
      const double before = v;
      v += kStep * (load - friction) / machine.mass;
      if (before * v < 0.0) v = 0.0;
    }
    x += kStep * v;
  }
  return run;
}

void expect_near(const FirstLook::Term& found, double truth, double part) {
  EXPECT_NEAR(found.value, truth, part * std::max(std::abs(truth), 1.0));
}

TEST(FirstLook, FindsEveryTerm) {
  const Machine machine;
  const Recorded run = record(machine, wave, 4.0, 1e-3, 1e-5);
  for (const DrivenMotion& motion : {run.by_position(), run.by_velocity()}) {
    const auto look = first_look(std::span(&motion, 1));
    ASSERT_TRUE(look);
    expect_near(look->mass, machine.mass, 0.03);
    expect_near(look->viscous, machine.viscous, 0.05);
    expect_near(look->coulomb, machine.coulomb, 0.1);
    expect_near(look->constant, machine.constant, 0.1);
    EXPECT_LT(look->unexplained, 0.03);
    EXPECT_NEAR(look->delay.value, 0.0, 3e-4);
    EXPECT_EQ(look->direction, FirstLook::Direction::along);
    EXPECT_TRUE(look->shows_mass());
    EXPECT_FALSE(look->shows_delay(1e-3));
  }
}

// The scatter of estimates over many noises is that of their errors.
TEST(FirstLook, ErrsAsItsErrorsSay) {
  Machine machine;
  machine.coulomb = 0.0;
  const Recorded exact = record(machine);
  constexpr int kTrials = 60;
  double mass = 0.0, viscous = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Recorded run = exact;
    Normal normal(static_cast<std::uint64_t>(trial) + 1);
    for (double& x : run.position) x += 2e-4 * normal();
    const DrivenMotion motion = run.by_position();
    const auto look = first_look(std::span(&motion, 1));
    ASSERT_TRUE(look);
    mass += std::pow((look->mass.value - machine.mass) / look->mass.error, 2) / kTrials;
    viscous += std::pow((look->viscous.value - machine.viscous) / look->viscous.error, 2) / kTrials;
  }
  // The noise of the sign of the speed biases friction a little, and windows are chosen.
  EXPECT_GT(mass, 0.3);
  EXPECT_LT(mass, 2.5);
  EXPECT_GT(viscous, 0.3);
  EXPECT_LT(viscous, 2.5);
}

TEST(FirstLook, FindsADelay) {
  for (const double delay : {-0.1, -0.004, 0.0025, 0.03, 0.2}) {
    Machine machine;
    machine.delay = delay;
    const Recorded run = record(machine, wave, 6.0);
    const DrivenMotion motion = run.by_position();
    const auto look = first_look(std::span(&motion, 1));
    ASSERT_TRUE(look) << delay;
    EXPECT_NEAR(look->delay.value, delay, 4e-4);
    EXPECT_TRUE(look->shows_delay(1e-3)) << delay;
    expect_near(look->mass, machine.mass, 0.05);
  }
}

TEST(FirstLook, TurnsAnInputThatFrictionWouldDrive) {
  Recorded run = record({});
  for (double& u : run.input) u = -u;
  const DrivenMotion motion = run.by_position();
  const auto look = first_look(std::span(&motion, 1));
  ASSERT_TRUE(look);
  EXPECT_EQ(look->direction, FirstLook::Direction::turned);
  EXPECT_LT(look->dissipation.value, 0.0);
  expect_near(look->mass, -12.0, 0.05);
}

// The mass of a joint that hardly accelerates is lost in noise, and comes out on either side of
// zero; the energy that friction takes does not.
TEST(FirstLook, KnowsTheDirectionByEnergyWhereTheMassIsNoise) {
  Machine machine;
  machine.mass = 0.02;
  int below = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Recorded run = record(
        machine, [](double t) { return 90.0 * std::sin(1.5 * t) + 15.0 * std::sin(4.1 * t); }, 8.0,
        1e-2, 1e-3, seed);
    const DrivenMotion motion = run.by_position();
    const auto look = first_look(std::span(&motion, 1));
    ASSERT_TRUE(look);
    below += look->mass.value < 0.0 ? 1 : 0;
    EXPECT_EQ(look->direction, FirstLook::Direction::along) << seed;
    EXPECT_FALSE(look->shows_mass()) << seed;
    for (double& u : run.input) u = -u;
    const DrivenMotion turned = run.by_position();
    EXPECT_EQ(first_look(std::span(&turned, 1))->direction, FirstLook::Direction::turned) << seed;
  }
  EXPECT_GT(below, 0) << "by its mass alone it would have been turned";
}

TEST(FirstLook, SeesAWeight) {
  Machine machine{.mass = 0.5, .viscous = 0.8, .coulomb = 0.2, .constant = 0.0};
  machine.sine = 6.0;
  machine.cosine = -2.0;
  const Recorded run = record(
      machine, [](double t) { return 8.0 * std::sin(1.3 * t) + 4.0 * std::sin(7.0 * t); }, 12.0);
  const DrivenMotion motion = run.by_position();
  const auto look = first_look(std::span(&motion, 1), {.with_gravity = true});
  ASSERT_TRUE(look);
  expect_near(look->gravity_sine, 6.0, 0.05);
  expect_near(look->gravity_cosine, -2.0, 0.05);
  expect_near(look->mass, 0.5, 0.05);
  EXPECT_LT(look->unexplained, 0.3 * first_look(std::span(&motion, 1))->unexplained);
}

// Of steps of one size, friction that dies out and friction that stays say the same.
TEST(FirstLook, ClaimsNothingThatOneStepCannotShow) {
  const Recorded run = record(
      {}, [](double t) { return t > 0.0 ? 60.0 : 0.0; }, 1.0, 5e-3);
  const DrivenMotion motion = run.by_position();
  const auto look = first_look(std::span(&motion, 1));
  const bool claims = look && look->shows_mass() && std::abs(look->coulomb.distance()) > 4.0;
  EXPECT_FALSE(claims && std::abs(look->coulomb.value - 15.0) > 4.0 * look->coulomb.error);
}

// Dry friction that bends before it slips looks like next to nothing of all that it is not: a
// spring, a heavy mass, a weight.
TEST(FirstLook, SeesFrictionThatBuildsUp) {
  const auto force = [](double t) {
    return 22.0 * std::sin(2.6 * t) + 17.0 * std::sin(5.3 * t) * std::sin(0.37 * t);
  };
  for (const double travel : {0.01, 0.04}) {
    Machine machine{.mass = 0.5, .viscous = 20.0, .coulomb = 22.0, .constant = 1.0};
    machine.presliding = travel;
    const Recorded run = record(machine, force, 20.0, 1e-2, 1e-5);
    for (const DrivenMotion& motion : {run.by_position(), run.by_velocity()}) {
      for (const Joint joint : {Joint::prismatic, Joint::revolute}) {
        const auto look = first_look(std::span(&motion, 1), joint);
        ASSERT_TRUE(look);
        EXPECT_NEAR(look->presliding, travel, 0.1 * travel);
        expect_near(look->coulomb, machine.coulomb, 0.05);
        expect_near(look->viscous, machine.viscous, 0.1);
        EXPECT_LT(look->unexplained, 0.1);
        EXPECT_EQ(look->direction, FirstLook::Direction::along);
      }
    }
  }
}

// What leaves much of the input for another reason is not taken for it.
TEST(FirstLook, TakesNothingElseForFrictionThatBuildsUp) {
  const Recorded sliding = record({});
  Recorded sprung = record({.coulomb = 0.0}), noisy = sliding, pulled = sliding;
  Normal normal(5);
  for (std::size_t i = 0; i < noisy.input.size(); ++i) {
    sprung.input[i] += 900.0 * (sprung.position[i] - 0.2);
    noisy.input[i] += 40.0 * normal();
    pulled.input[i] += noisy.times[i] > 2.0 ? 60.0 : 0.0;
  }
  for (const auto& run : {sliding, sprung, noisy, pulled}) {
    const DrivenMotion motion = run.by_position();
    const auto look = first_look(std::span(&motion, 1), Joint::prismatic);
    ASSERT_TRUE(look);
    EXPECT_EQ(look->presliding, 0.0);
  }
}

TEST(FirstLook, TakesAllRecordingsTogether) {
  // One of them never reverses, so that it does not tell the friction from a constant force.
  const Recorded up = record(
                     {}, [](double t) { return 80.0 + 20.0 * std::sin(8.0 * t); }, 2.0),
                 down = record(
                     {}, [](double t) { return -80.0 + 20.0 * std::sin(8.0 * t); }, 2.0);
  const std::vector<DrivenMotion> both{up.by_position(), down.by_position()};
  const auto look = first_look(both);
  ASSERT_TRUE(look);
  expect_near(look->coulomb, 15.0, 0.1);
  expect_near(look->constant, 4.0, 0.1);
  const auto one = first_look(std::span(both).first(1));
  ASSERT_TRUE(one);
  EXPECT_FALSE(std::abs(one->coulomb.distance()) > 4.0 && std::abs(one->constant.distance()) > 4.0);
}

TEST(FirstLook, NeedsAnInputThatChangesAndAMotion) {
  Recorded run = record({});
  Recorded still = run;
  still.position.assign(still.position.size(), 0.3);
  const DrivenMotion at_rest = still.by_position();
  EXPECT_FALSE(first_look(std::span(&at_rest, 1)));
  run.input.assign(run.input.size(), 5.0);
  const DrivenMotion constant = run.by_position();
  EXPECT_FALSE(first_look(std::span(&constant, 1)));
  EXPECT_FALSE(first_look({}));
}

}  // namespace
}  // namespace axisfit
