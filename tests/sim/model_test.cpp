#include "sim/model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <string>

#include "fit/solve/jet.h"
#include "tests/sim/axes.h"

namespace axisfit {
namespace {

/// Names of all quantities of the effects of an axis.
std::set<std::string> names_of_effects(const EffectSet& present = EffectSet().set()) {
  std::set<std::string> names;
  const Effects<double> effects{};
  visit_effects(effects, [&](std::size_t index, const auto& effect) {
    if (!present[index]) return;
    effect.visit(effect, [&](const Quantity& quantity, double) {
      names.insert(full_name(effect.name, quantity));
    });
  });
  return names;
}

TEST(QuantityList, HasUniqueNamesInTheOrderOfTheMembers) {
  std::set<std::string> names;
  std::size_t index = 0;
  for (const QuantityEntry& entry : quantity_list()) {
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
    EXPECT_EQ(entry.index, index++);
    EXPECT_EQ(find_quantity(entry.name, kSourceVocabulary), &entry);
  }
  Model<double> model = paper_axis();
  EXPECT_EQ(members(model).size(), quantity_list().size());
  EXPECT_EQ(members(model)[quantity_index("B_a")], &model.axis.B_a);
  EXPECT_EQ(members(model)[quantity_index("coulomb_friction.F_c")],
            &std::get<CoulombFriction<double>>(model.effects).F_c);
  EXPECT_EQ(members(model)[quantity_index("velocity.bias")],
            &model.instruments[index_of(Signal::velocity)].bias);
  EXPECT_EQ(members(model)[quantity_index("initial.y6")], &model.initial[6]);
}

TEST(QuantityList, DescribesEveryQuantity) {
  for (const QuantityEntry& entry : quantity_list()) {
    const Quantity& q = entry.quantity;
    EXPECT_FALSE(q.symbol.empty());
    EXPECT_FALSE(q.unit.empty()) << entry.name;
    EXPECT_FALSE(q.meaning.empty()) << entry.name;
    EXPECT_LT(q.lower, q.upper) << entry.name;
    if (!std::isnan(q.default_value)) {
      EXPECT_GE(q.default_value, q.lower) << entry.name;
      EXPECT_LE(q.default_value, q.upper) << entry.name;
    }
  }
}

TEST(QuantityList, RangesHoldThePapersAxis) {
  Model<double> model = paper_axis();
  for (const QuantityEntry& entry : quantity_list()) {
    // An axis without an effect has its strength, zero, but no shape.
    if (entry.quantity.shape) continue;
    const double value = *members(model)[entry.index];
    EXPECT_GE(value, entry.quantity.lower) << entry.name;
    EXPECT_LE(value, entry.quantity.upper) << entry.name;
  }
}

TEST(QuantityList, HasStrengthsAndShapesOfEffects) {
  const Model<double> model;
  visit_effects(model.effects, [&](std::size_t, const auto& effect) {
    int strengths = 0;
    effect.visit(effect,
                 [&](const Quantity& quantity, double) { strengths += quantity.shape ? 0 : 1; });
    EXPECT_GT(strengths, 0) << effect.name;
  });
  for (const QuantityEntry& entry : quantity_list())
    if (entry.quantity.shape) {
      EXPECT_TRUE(names_of_effects().contains(entry.name)) << entry.name;
    }
}

TEST(QuantityList, DoesNotKnowOtherNames) {
  for (const char* name : {"", "b_a", "F_c", "initial.y2", "velocity", "velocity.", ".B_a"})
    EXPECT_THROW(quantity_index(name), std::logic_error) << name;
}

TEST(Convert, GoesThereAndBackWithoutLoss) {
  using J = ceres::Jet<double, 2>;
  Model<double> model = paper_axis();
  model.structure = {Drive::current_source, Transmission::rigid, EffectSet(0b101)};
  double value = 0.1;
  for (double* member : members(model)) *member = value *= -1.03;
  const Model<J> differentiated = convert<J>(model);
  const Model<double> back = convert<double>(differentiated);
  EXPECT_EQ(back.structure.drive, model.structure.drive);
  EXPECT_EQ(back.structure.transmission, model.structure.transmission);
  EXPECT_EQ(back.structure.effects, model.structure.effects);
  std::vector<double> before, after;
  visit_quantities(model, [&](auto, const auto&, double x) { before.push_back(x); });
  visit_quantities(back, [&](auto, const auto&, double x) { after.push_back(x); });
  EXPECT_EQ(before, after);
  visit_quantities(differentiated, [&](auto, const auto&, const J& x) {
    EXPECT_FALSE(ScalarTraits<J>::has_derivative(x));
  });
}

TEST(InitialState, PutsTheMotorWhereTheArmIs) {
  Model<double> model = paper_axis();
  model.initial = {0.3, 0.2, 5e-6, 0.01, 1.0, 2.0, 3.0};
  const State<double> y = initial_state(model);
  EXPECT_EQ(y[0], 0.3);
  EXPECT_EQ(y[1], 0.2);
  EXPECT_NEAR(model.axis.r_g * y[2] - y[0], 5e-6, 1e-16);
  EXPECT_NEAR(model.axis.r_g * y[3] - y[1], 0.01, 1e-15);
  EXPECT_EQ(y[4], 1.0);
  EXPECT_EQ(y[5], 2.0);
  EXPECT_EQ(y[6], 3.0);
}

/// In a closed loop, where the controller has a part.
std::set<std::string> unused_of(Structure structure) {
  structure.closed_loop = true;
  std::set<std::string> names;
  for (const QuantityEntry& entry : quantity_list())
    if (!is_used(entry, structure)) names.insert(entry.name);
  return names;
}

using Names = std::set<std::string>;

Names operator+(Names a, const Names& b) {
  a.insert(b.begin(), b.end());
  return a;
}

Names operator-(Names a, const Names& b) {
  for (const std::string& name : b) a.erase(name);
  return a;
}

TEST(IsUsed, FollowsTheStructure) {
  const Names selection{"R", "L", "K_e", "V_s", "K_v", "initial.y6"};
  const Names soft{"soft_transmission.c_g", "soft_transmission.H_g"};
  const Names supply{"supply_resistance.R_v"}, force{"force_droop.c_f", "force_droop.c_q"};
  const Names gear{"H", "b_g", "k_g", "initial.x", "initial.dx"};
  const Names electric{"K_m", "K_t", "T_z", "T_p",        "T_r",       "K_1",
                       "K_2", "K_i", "V_L", "initial.y4", "initial.y5"};
  const Names motor{"J_m", "B_m", "r_g"};
  Names of_electric{"torque_ripple.r_s", "torque_ripple.r_c", "torque_ripple.order",
                    "torque_droop.c_i", "torque_droop.c_q"};
  Names of_motor{"cogging_torque.T_s", "cogging_torque.T_c", "cogging_torque.order"};
  for (int k = 1; k <= 16; ++k) of_motor.insert("force_over_motor_angle.c" + std::to_string(k));
  const EffectSet none, all = EffectSet().set();
  const struct {
    Drive drive;
    Transmission transmission;
    Names of_axis, of_effects;  // left out by this structure
  } variants[] = {
      {Drive::velocity_loop, Transmission::backlash, {"K_f"}, force + soft},
      {Drive::current_source, Transmission::backlash, selection + Names{"K_f"},
       force + supply + soft},
      {Drive::force_source, Transmission::backlash, selection + electric,
       of_electric + supply + soft},
      {Drive::motor_current, Transmission::backlash, selection + electric,
       of_electric + supply + soft},
      {Drive::rated_force, Transmission::backlash, selection + electric,
       of_electric + supply + soft},
      {Drive::motor_voltage, Transmission::backlash,
       selection - Names{"R"} + electric - Names{"K_m"} + Names{"K_f"}, force + supply + soft},
      {Drive::velocity_loop, Transmission::rigid, gear + Names{"K_f"}, force},
      {Drive::current_source, Transmission::rigid, gear + selection + Names{"K_f"}, force + supply},
      {Drive::force_source, Transmission::rigid, gear + selection + electric + motor,
       of_electric + of_motor + supply},
  };
  for (const auto& [drive, transmission, of_axis, of_effects] : variants) {
    SCOPED_TRACE(testing::Message() << "drive " << static_cast<int>(drive) << ", transmission "
                                    << static_cast<int>(transmission));
    const auto unused_with = [&](const EffectSet& effects) {
      Structure structure{drive, transmission, effects};
      structure.channels = kept(ChannelList{{"a", "1"}, {"b", "1"}, {"c", "1"}, {"d", "1"}});
      return unused_of(structure);
    };
    EXPECT_EQ(unused_with(none), of_axis + names_of_effects());
    EXPECT_EQ(unused_with(all), of_axis + of_effects);
    for (std::size_t e = 0; e < kEffects; ++e) {
      const EffectSet one = EffectSet().set(e);
      EXPECT_EQ(unused_with(one),
                of_axis + of_effects + (names_of_effects() - names_of_effects(one)));
    }
  }
}

TEST(IsUsed, WhatIsNotUsedHasNoInfluence) {
  const auto times = instants(100, 1e-3);
  for (const Drive drive : every_drive())
    for (const Transmission transmission : {Transmission::backlash, Transmission::rigid}) {
      Model<double> model = paper_axis();
      model.structure = {drive, transmission, {}};
      normalize(model);
      const auto before = run(model, step_command(), times);
      for (const QuantityEntry& entry : quantity_list()) {
        if (is_used(entry, model.structure) || entry.group == "initial") continue;
        if (capabilities(model.structure).is_force_driven && transmission == Transmission::rigid &&
            (entry.name == "J_m" || entry.name == "B_m" || entry.name == "r_g"))
          continue;
        Model<double> changed = model;
        *members(changed)[entry.index] = 1.7;
        const auto after = run(changed, step_command(), times);
        for (std::size_t k = 0; k < times.size(); ++k)
          for (std::size_t i : {0U, 1U, 2U, 3U, 6U})
            ASSERT_NEAR(after.states[k][i], before.states[k][i],
                        1e-8 * (1e-3 + std::abs(before.states[k][i])))
                << entry.name << " y" << i;
      }
    }
}

TEST(Normalize, LeavesOutWhatTheStructureDoesNotUse) {
  Model<double> model = paper_axis();
  model.structure = {Drive::force_source, Transmission::rigid, {}};
  model.initial.fill(0.3);
  model.instruments[0].gain = 1.1;
  std::get<ConstantForce<double>>(model.effects).F_0 = 5.0;
  normalize(model);
  const Axis<double>& a = model.axis;
  EXPECT_EQ(a.r_g, 1.0);
  for (const double left_out : {a.J_m, a.B_m, a.H, a.k_g, a.K_m, a.V_L, a.R})
    EXPECT_EQ(left_out, 0.0);
  EXPECT_EQ(a.M, 146.0);
  EXPECT_EQ(a.K_f, 1.0);
  EXPECT_EQ(model.initial, (std::array<double, kPaperStates>{0.3, 0.3}));
  EXPECT_EQ(model.instruments[0].gain, 1.1);
  EXPECT_EQ(std::get<ConstantForce<double>>(model.effects).F_0, 5.0);
}

TEST(Normalize, KeepsWhatTheStructureUses) {
  Model<double> model = paper_axis();
  normalize(model);
  Model<double> wanted = paper_axis();
  wanted.axis.K_f = 0.0;
  const auto member = members(model), expected = members(wanted);
  for (const QuantityEntry& entry : quantity_list())
    EXPECT_EQ(*member[entry.index], *expected[entry.index]) << entry.name;
}

TEST(Refusal, OfAGearWithoutMotorInertia) {
  Model<double> model = paper_axis();
  EXPECT_EQ(model_error(model), "");
  model.axis.J_m = 0.0;
  EXPECT_NE(model_error(model).find("J_m"), std::string::npos);
  model.structure.transmission = Transmission::rigid;
  EXPECT_EQ(model_error(model), "");
}

// A lead, a ratio and the radius that they come to are one axis.
TEST(Gearing, IsGivenByRadiusLeadOrRatio) {
  for (const Joint joint : kJoints) {
    Model<double> radius = paper_axis(), turns = radius;
    radius.structure.joint = turns.structure.joint = joint;
    turns.structure.gearing = Gearing::turns;
    const double r_g = radius.axis.r_g;
    turns.axis.r_g = joint == Joint::prismatic ? 2.0 * std::numbers::pi * r_g : 1.0 / r_g;
    EXPECT_NEAR(motor_radius(turns), r_g, 1e-15);
    radius.initial[0] = turns.initial[0] = 0.1;
    EXPECT_NEAR(initial_state(turns)[2], initial_state(radius)[2], 1e-12);
    const auto& entry = quantity_list(vocabulary_of(turns.structure))[quantity_index("r_g")];
    EXPECT_EQ(entry.name, joint == Joint::prismatic ? "lead" : "gear_ratio");
    EXPECT_EQ(entry.quantity.unit, joint == Joint::prismatic ? "m" : "1");
  }
}

}  // namespace
}  // namespace axisfit
