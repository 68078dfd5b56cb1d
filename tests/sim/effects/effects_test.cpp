// Every effect of the list, by the same tests: at strength zero, and with derivatives.
#include "sim/effects/effects.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <numbers>
#include <string>

#include "tests/sim/experiment.h"

namespace axisfit {
namespace {

std::string name_of(std::size_t effect) { return std::string(kEffectTable[effect].name); }

struct Variant {
  const char* name;
  Drive drive;
  Transmission transmission;
};
constexpr Variant kVariants[] = {
    {"velocity loop with backlash", Drive::velocity_loop, Transmission::backlash},
    {"rigid current source", Drive::current_source, Transmission::rigid},
    {"rigid force source", Drive::force_source, Transmission::rigid},
    {"rigid motor at a voltage", Drive::motor_voltage, Transmission::rigid},
};

/// Gives an effect to a model, at its typical shape and strength, or at strength zero.
void add_typical(Model<double>& model, std::size_t effect, double strength = 1.0) {
  model.structure.effects.set(effect);
  for (const QuantityEntry& entry : quantity_list())
    if (entry.group == name_of(effect))
      *members(model)[entry.index] =
          entry.quantity.shape ? entry.quantity.typical : strength * entry.quantity.typical;
}

/// Two channels, and how they run.
Channels channels() { return kept({{"temperature", "K", 0.0}, {"neighbour", "m", 0.0}}); }

std::vector<ChannelSeries> channel_values(const std::vector<double>& times) {
  std::vector<ChannelSeries> values(2);
  for (const double t : times) {
    values[0].values.push_back(0.3 + 0.5 * std::sin(7.0 * t));
    values[1].values.push_back(0.4 * std::cos(5.0 * t));
  }
  return values;
}

Run<double> run_of(const Experiment& experiment, const Model<double>& model,
                   const IntegratorOptions& options = {}) {
  return run(model, experiment.command, experiment.times, options, {},
             {{}, {}, experiment.channels});
}

/// There, back and to rest, with some dry friction: an arm that slides both ways and sticks.
Experiment to_and_fro(const Variant& variant, bool with_friction) {
  Experiment experiment;
  Model<double>& m = experiment.model;
  m = paper_axis();
  m.structure.drive = variant.drive;
  m.structure.transmission = variant.transmission;
  m.structure.channels = channels();
  if (variant.drive == Drive::force_source) {
    m.axis.K_f = 40.0;
    normalize(m);
    experiment.command = {{0.0, 0.2, 0.75}, {8.0, -7.0, 0.0}};
  } else if (variant.drive == Drive::motor_voltage) {
    experiment.command = {{0.0, 0.2, 0.75}, {20.0, -17.0, 0.1}};
  } else {
    experiment.command = {{0.0, 0.25, 0.6}, {4.0, -3.0, 0.0}};
  }
  if (with_friction) add_effect<CoulombFriction>(m).F_c = 15.0;
  experiment.times = instants(500, 2e-3);
  experiment.channels = channel_values(experiment.times);
  return experiment;
}

class EveryEffect : public testing::TestWithParam<std::size_t> {
 protected:
  std::size_t effect() const { return GetParam(); }
  bool is_friction() const { return name_of(effect()) == "coulomb_friction"; }
  bool is_lag() const { return name_of(effect()) == "drive_lag"; }

  /// The effect's quantities that an axis of this variant uses.
  std::vector<QuantityEntry> quantities(const Variant& variant) const {
    Structure structure{variant.drive, variant.transmission, EffectSet().set(effect())};
    structure.channels = channels();
    std::vector<QuantityEntry> entries;
    for (const QuantityEntry& entry : quantity_list())
      if (entry.group == name_of(effect()) && is_used(entry, structure)) entries.push_back(entry);
    return entries;
  }
  /// For the slow variant: a few of the coefficients of a curve stand for all.
  static std::vector<QuantityEntry> sample(std::vector<QuantityEntry> entries) {
    if (entries.size() > 10)
      std::erase_if(entries, [](const QuantityEntry& entry) {
        const std::string symbol(entry.quantity.symbol);
        return symbol.starts_with("c") && std::stoi(symbol.substr(1)) % 5 != 4;
      });
    return entries;
  }
  void add_to(Model<double>& model, double strength) const {
    add_typical(model, effect(), strength);
  }
};

TEST_P(EveryEffect, IsDescribedInFull) {
  const EffectInfo& info = kEffectTable[effect()];
  EXPECT_FALSE(info.meaning.empty());
  EXPECT_FALSE(info.excitation.empty());
  EXPECT_FALSE(info.search({.speed = 1.0, .end = 1.0, .interval = 1e-3, .periods = {0.1}}).empty());
  for (const QuantityEntry& entry : quantity_list()) {
    if (entry.group != info.name) continue;
    EXPECT_GE(entry.quantity.typical, entry.quantity.lower) << entry.name;
    EXPECT_LE(entry.quantity.typical, entry.quantity.upper) << entry.name;
    EXPECT_NE(entry.quantity.typical, 0.0) << entry.name;
  }
}

TEST_P(EveryEffect, OfStrengthZeroIsNoneBitForBit) {
  for (const Variant& variant : kVariants) {
    SCOPED_TRACE(variant.name);
    if (quantities(variant).empty()) continue;
    for (const bool with_friction : {false, true}) {
      if (with_friction && is_friction()) continue;
      const Experiment experiment = to_and_fro(variant, with_friction);
      const auto without = run_of(experiment, experiment.model);
      Model<double> model = experiment.model;
      add_to(model, 0.0);
      const auto with = run_of(experiment, model);
      ASSERT_TRUE(with.finished);
      EXPECT_EQ(with.states, without.states);
      EXPECT_EQ(with.events, without.events);
      EXPECT_EQ(with.acceleration, without.acceleration);
      EXPECT_EQ(with.encoder, without.encoder);
      // And it is none only then.
      add_to(model, 1.0);
      EXPECT_NE(run_of(experiment, model).encoder, without.encoder);
    }
  }
}

TEST_P(EveryEffect, HasDerivativesByStrengthAndShape) {
  for (const Variant& variant : kVariants) {
    SCOPED_TRACE(variant.name);
    auto entries = quantities(variant);
    if (variant.drive != Drive::force_source) entries = sample(entries);
    if (entries.empty()) continue;
    Experiment experiment = to_and_fro(variant, true);
    add_to(experiment.model, 1.0);
    std::cout << variant.name << ": ";
    expect_derivatives(experiment, entries);
  }
}

TEST_P(EveryEffect, HasADerivativeAtStrengthZero) {
  for (const Variant& variant : kVariants) {
    SCOPED_TRACE(variant.name);
    auto entries = quantities(variant);
    std::erase_if(entries, [](const QuantityEntry& entry) { return entry.quantity.shape; });
    if (variant.drive != Drive::force_source) entries = sample(entries);
    if (entries.empty()) continue;
    Experiment experiment = to_and_fro(variant, !is_friction() && !is_lag());
    // In motion to the end: an arm that comes to rest ever more slowly sticks, as friction goes to
    // zero, ever later.
    experiment.command.values.edit().back() = 2.0;
    if (is_lag()) {
      // A lag is like a delay where it is short against all else. Here nothing is as fast as the
      // differences, as limits, a fast preamplifier or friction at a jump of the force would be.
      Axis<double>& a = experiment.model.axis;
      a.V_L = 1e6;
      a.V_s = 1e5;
      a.K_v = 10.0;
      a.T_r = 0.02;
    }
    add_to(experiment.model, 0.0);
    Worst worst;
    for (const QuantityEntry& entry : entries) {
      // One at a time: another one in play may bring events of its own.
      compare(
          experiment, {entry}, {by_jets<1>(experiment, {entry})},
          [&](std::size_t, const Comparison& c) {
            EXPECT_LT(c.convergence, 1e-4) << c.name;
            EXPECT_LT(c.error, 1e-4 + c.convergence) << c.name;
            worst.add(c);
          },
          [](const QuantityEntry& q, double) { return std::abs(q.quantity.typical); },
          entry.quantity.lower < 0.0 ? Sides::both : Sides::above);
    }
    std::cout << variant.name << ": " << worst << "\n";
  }
}

TEST_P(EveryEffect, DoesNotDependOnTheStep) {
  for (const Variant& variant : kVariants) {
    SCOPED_TRACE(variant.name);
    if (quantities(variant).empty()) continue;
    Experiment experiment = to_and_fro(variant, true);
    add_to(experiment.model, 1.0);
    const auto at_default_step = run_of(experiment, experiment.model);
    const auto small = run_of(experiment, experiment.model, {.step = 1e-4});
    ASSERT_TRUE(at_default_step.finished && small.finished);
    EXPECT_EQ(at_default_step.events.back(), small.events.back());
    // What is affine is exact. Else the current, which follows the preamplifier in microseconds,
    // has an error of its own at the end of a Runge-Kutta step; it does not add up.
    const bool smooth = Equations<double>(experiment.model).has_smooth_forces();
    auto a = at_default_step.states, b = small.states;
    double current = 0.0;
    const double range = ranges(b)[6];
    for (std::size_t k = 0; k < a.size(); ++k) {
      current = std::max(current, std::abs(a[k][6] - b[k][6]));
      a[k][6] = b[k][6] = 0.0;
    }
    const double others = largest_difference(a, b);
    std::cout << variant.name << ": step 0.5e-3 against 1e-4: " << others << ", current "
              << (range > 0.0 ? current / range : 0.0) << "\n";
    EXPECT_LT(others, smooth ? 5e-6 : 1e-9);
    EXPECT_LE(current, (smooth ? 1e-3 : 1e-8) * range);
  }
}

INSTANTIATE_TEST_SUITE_P(Effects, EveryEffect, testing::Range(std::size_t{0}, kEffects),
                         [](const auto& test) { return name_of(test.param); });

// The Runge-Kutta method adds it to what is affine: nothing may be missing, or be there twice.
TEST(EffectsInPairs, HaveASmoothPartThatIsAllThatIsNotAffine) {
  const std::vector<State<double>> states{
      {0.08, 0.3, 14.0, 52.0, 1.2, 40.0, 2.5, 0.8, 2e-4, -0.03},
      {-0.05, -0.2, -8.7, -35.0, -0.7, 10.0, -1.5, -0.4, -1e-4, 0.02}};
  for (const Variant& variant : kVariants)
    for (std::size_t first = 0; first < kEffects; ++first)
      for (std::size_t second = 0; second < first; ++second) {
        Model<double> model = to_and_fro(variant, false).model;
        add_typical(model, first);
        add_typical(model, second);
        const Equations<double> equations(model);
        for (const State<double>& y : states)
          for (const int sliding : {-1, 0, 1}) {
            Mode mode;
            mode.sliding = static_cast<std::int8_t>(sliding);
            mode.contact = equations.parts().has.has_backlash ? 1 : 0;
            const Input<double> input{
                3.0, {}, 0.4, {0.01, {{2.0}}}, {}, {0.3, {0.2, -0.3}, {1.5, 2.0}}};
            const State<double> all = equations.rate(mode, y, input);
            const State<double> affine = equations.rate(mode, y, input, Terms::affine);
            const State<double> smooth = equations.smooth_rate(mode, y, input);
            for (std::size_t i = 0; i < kStates; ++i)
              ASSERT_NEAR(all[i] - affine[i], smooth[i], 1e-12 * (1.0 + std::abs(all[i])))
                  << name_of(first) << " and " << name_of(second) << ", " << variant.name << ", y"
                  << i;
          }
      }
}

// The arm without its elastic part is driven by the force, the drag and the spring.
TEST(EffectsInPairs, AnElasticModeIsShakenByTheDragOfItsArm) {
  Model<double> model = driven_mass(20.0);
  ElasticMode<double>& elastic = add_effect<ElasticMode>(model);
  elastic.m_e = 12.0;
  elastic.f_e = 25.0;
  elastic.zeta_e = 0.03;
  add_effect<QuadraticDrag>(model).c = 60.0;
  const double w = 2.0 * std::numbers::pi * elastic.f_e;
  constexpr double kForce = 80.0;
  using Vector = std::array<double, 4>;  // y0, y1, q, q'
  const auto rate = [&](const Vector& y) -> Vector {
    const double spring = w * w * y[2] + 2.0 * elastic.zeta_e * w * y[3];
    const double a = (kForce - 60.0 * y[1] * std::abs(y[1]) + 12.0 * spring) / (20.0 - 12.0);
    return {y[1], a, y[3], -spring - a};
  };
  const auto along = [](Vector y, double h, const Vector& k) {
    for (std::size_t i = 0; i < 4; ++i) y[i] += h * k[i];
    return y;
  };
  constexpr double kInterval = 5e-3;
  constexpr int kParts = 50;
  const auto times = instants(60, kInterval);
  const auto found = run(model, {{0.0}, {kForce}}, times);
  ASSERT_TRUE(found.finished);
  Vector y{};
  for (std::size_t k = 1; k < times.size(); ++k) {
    constexpr double h = kInterval / kParts;
    for (int part = 0; part < kParts; ++part) {
      const Vector k1 = rate(y), k2 = rate(along(y, 0.5 * h, k1)), k3 = rate(along(y, 0.5 * h, k2)),
                   k4 = rate(along(y, h, k3));
      for (std::size_t i = 0; i < 4; ++i) y[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
    }
    ASSERT_NEAR(found.states[k][0], y[0], 1e-7) << k;
    ASSERT_NEAR(found.states[k][1], y[1], 1e-6) << k;
    ASSERT_NEAR(found.acceleration[k], rate(y)[1], 1e-4) << k;
    ASSERT_NEAR(found.states[k][8], y[2], 1e-8) << k;
  }
}

}  // namespace
}  // namespace axisfit
