// The laws of what channels change, against closed forms.
#include "sim/effects/channel_effect.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "tests/sim/axes.h"

namespace axisfit {
namespace {

constexpr double kMass = 12.0, kForce = 30.0;

/// A mass with one channel, pushed by a constant force while the channel runs straight.
struct Pushed {
  Model<double> model = driven_mass(kMass);
  std::vector<double> times = instants(200, 5e-3);

  Pushed() { model.structure.channels = kept({{"oil", "degC", 20.0}}); }

  Run<double> run(const std::function<double(double)>& channel, const Observer& observer = {},
                  const std::vector<double>& velocity = {}) const {
    std::vector<ChannelSeries> values(1);
    for (const double t : times) values[0].values.push_back(channel(t));
    const auto result =
        axisfit::run(model, {{0.0}, {kForce}}, times, {}, observer, {velocity, {}, values});
    EXPECT_TRUE(result.finished);
    return result;
  }
};

void expect_velocity(const Pushed& pushed, const Run<double>& found,
                     const std::function<double(double)>& truth, double tolerance) {
  for (std::size_t k = 0; k < pushed.times.size(); ++k)
    ASSERT_NEAR(found.states[k][1], truth(pushed.times[k]), tolerance) << pushed.times[k];
}

const auto kRising = [](double t) { return 0.5 + 3.0 * t; };

TEST(ChannelEffect, AForceIsInProportion) {
  Pushed pushed;
  add_effect<ChannelForce>(pushed.model).k[0] = -4.0;
  expect_velocity(
      pushed, pushed.run(kRising),
      [](double t) { return ((kForce - 2.0) * t - 6.0 * t * t) / kMass; }, 1e-12);
}

TEST(ChannelEffect, AGainIsRelative) {
  Pushed pushed;
  add_effect<ChannelGain>(pushed.model).k[0] = 0.1;
  expect_velocity(
      pushed, pushed.run(kRising),
      [](double t) { return kForce * (1.05 * t + 0.15 * t * t) / kMass; }, 1e-12);
}

TEST(ChannelEffect, DampingIsAddedToThatOfTheArm) {
  Pushed pushed;
  pushed.model.axis.B_a = 20.0;
  add_effect<ChannelDamping>(pushed.model).k[0] = 8.0;
  const double damping = 20.0 + 8.0 * 1.5;
  expect_velocity(
      pushed, pushed.run([](double) { return 1.5; }),
      [&](double t) { return kForce / damping * (1.0 - std::exp(-damping * t / kMass)); }, 1e-8);
}

TEST(ChannelEffect, FrictionLetsGoWhenItFallsBelowTheForce) {
  Pushed pushed;
  add_effect<CoulombFriction>(pushed.model).F_c = 42.0;
  add_effect<ChannelFriction>(pushed.model).k[0] = -16.0;
  // 42 N - 16 c, c = 2.5 t: below 30 N from 0.3 s on.
  expect_velocity(
      pushed, pushed.run([](double t) { return 2.5 * t; }),
      [](double t) {
        const double since = std::max(0.0, t - 0.3);
        return 20.0 * since * since / kMass;
      },
      1e-9);
}

TEST(ChannelEffect, AMassThatChangesKeepsItsMomentum) {
  Pushed pushed;
  add_effect<ChannelMass>(pushed.model).k[0] = 2.0;
  expect_velocity(
      pushed, pushed.run(kRising),
      [](double t) { return kForce * t / (kMass + 2.0 * (0.5 + 3.0 * t)); }, 1e-9);
}

TEST(ChannelEffect, AnObserverMovesTheMassThatThereIs) {
  // The observer holds an arm with friction near a velocity that it would not reach: no chatter
  // between sticking and sliding, and the force that is told is that of the whole mass.
  Pushed pushed;
  add_effect<CoulombFriction>(pushed.model).F_c = 25.0;
  add_effect<ChannelMass>(pushed.model).k[0] = 6.0;
  std::vector<double> velocity;
  for (const double t : pushed.times) velocity.push_back(0.2 * std::sin(9.0 * t));
  const auto found = pushed.run(kRising, Observer::of_velocity(200.0, false), velocity);
  EXPECT_LT(found.events.back(), 40);
  for (std::size_t k = 20; k < pushed.times.size(); ++k)
    ASSERT_NEAR(found.states[k][1], velocity[k], 0.05) << pushed.times[k];
}

TEST(ChannelEffect, OfAChannelThatIsNotKnownIsNone) {
  Pushed pushed;
  add_effect<ChannelForce>(pushed.model).k[0] = -4.0;
  const auto found = run(pushed.model, {{0.0}, {kForce}}, pushed.times);
  expect_velocity(
      pushed, found, [](double t) { return kForce * t / kMass; }, 1e-12);
}

TEST(Channels, GiveQuantitiesTheirNamesAndUnits) {
  const Vocabulary sliding(Joint::prismatic, Command::voltage,
                           kept({{"oil", "degC", 20.0}, {"y", "m", 0.0}, {"share", "1", 0.0}}));
  const auto unit = [&](const char* name, Vocabulary vocabulary) {
    const QuantityEntry* entry = find_quantity(name, vocabulary);
    return entry == nullptr ? "none" : std::string(entry->quantity.unit);
  };
  EXPECT_EQ(unit("channel_friction.oil", sliding), "N/K");
  EXPECT_EQ(unit("channel_mass.y", sliding), "kg/m");
  EXPECT_EQ(unit("channel_damping.y", sliding), "N s/m/m");
  EXPECT_EQ(unit("channel_force.share", sliding), "N");
  EXPECT_EQ(unit("channel_gain.oil", sliding), "1/K");
  EXPECT_EQ(unit("channel_gain.share", sliding), "1");
  Vocabulary turning = sliding;
  turning.joint = Joint::revolute;
  EXPECT_EQ(unit("channel_torque.oil", turning), "N m/K");
  EXPECT_EQ(unit("channel_inertia.y", turning), "kg m^2/m");
  EXPECT_EQ(unit("channel_force.oil", turning), "none");
}

TEST(Channels, AreInTheModelByTheirNumber) {
  Structure structure;
  structure.effects.set();
  const auto is_there = [&](const char* name) {
    return is_used(quantity_list()[quantity_index(name)], structure);
  };
  EXPECT_FALSE(is_there("channel_force.k_1"));
  structure.channels = kept({{"oil", "degC", 20.0}});
  EXPECT_TRUE(is_there("channel_force.k_1"));
  EXPECT_FALSE(is_there("channel_force.k_2"));
  EXPECT_EQ(structure.channels, kept({{"oil", "degC", 20.0}}));
  EXPECT_NE(structure.channels, kept({{"oil", "degC", 25.0}}));
  EXPECT_EQ(kept({}), nullptr);
}

}  // namespace
}  // namespace axisfit
