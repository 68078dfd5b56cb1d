#include "fit/search/catalogue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "tests/fit/example.h"
#include "tests/fit/search/hypotheses.h"

namespace axisfit {
namespace {

/// The paper's axis, of which these signals were recorded; nothing was simulated.
Job job_with(const std::vector<Signal>& signals) {
  Job job;
  job.model = paper_axis();
  Recording& r = job.recordings.emplace_back();
  r.times = {0.0, 1e-3};
  for (const Signal signal : signals) {
    r.measurements.emplace_back().signal = signal;
    r.measurements.back().sigma = 1.0;
  }
  return job;
}

/// Whether a quantity is among the strengths of any effect.
bool offers(const std::vector<Hypothesis>& list, const char* quantity) {
  return std::ranges::any_of(list, [&](const Hypothesis& c) {
    return c.kind != HypothesisKind::constant &&
           std::ranges::find(c.strengths, quantity_index(quantity)) != c.strengths.end();
  });
}

bool offers_constant(const std::vector<Hypothesis>& list, const char* quantity) {
  const Hypothesis* c = find(list, quantity);
  return c != nullptr && c->kind == HypothesisKind::constant;
}

std::vector<std::string> of_single_recordings(const Job& job) {
  std::vector<std::string> names;
  for (const Hypothesis& c : catalogue(job, scales()))
    if (c.recording) names.push_back(c.name);
  return names;
}

TEST(Catalogue, OffersWhatOneRecordingHasAlone) {
  using Names = std::vector<std::string>;
  Job job = job_with({Signal::velocity});
  EXPECT_EQ(of_single_recordings(job), Names{}) << "one has nothing to differ from";
  job.recordings.push_back(job.recordings[0]);
  job.recordings[0].name = "a";
  job.recordings[1].name = "b";
  job.recordings[1].role = Role::validate;
  EXPECT_EQ(of_single_recordings(job), Names{}) << "nor has it from one that is not fitted";
  job.recordings[1].role = Role::fit;
  EXPECT_EQ(
      of_single_recordings(job),
      (Names{"added_mass@a", "added_mass@b", "payload_change@a", "payload_change@b",
             "constant_force@a", "constant_force@b", "coulomb_friction@a", "coulomb_friction@b"}));
  job.free = {free_parameter("M", 146.0)};
  EXPECT_EQ(of_single_recordings(job).front(), "added_mass@b") << "the other has M";
  add_effect<ConstantForce>(job.model);
  job.free.push_back(free_parameter("constant_force.F_0", 1.0));
  EXPECT_EQ(of_single_recordings(job),
            (Names{"added_mass@b", "payload_change@a", "payload_change@b", "coulomb_friction@a",
                   "coulomb_friction@b"}));
}

TEST(Catalogue, HasEveryEffectOfTheList) {
  Job job = job_with({Signal::velocity});
  const Channels channels = kept({{"oil", "degC", 20.0}});
  job.model.structure.channels = channels;
  const auto list = catalogue(job, scales());
  job.model = slide();
  job.model.structure.channels = channels;
  const auto of_slide = catalogue(job, scales());
  const Effects<double> effects{};
  visit_effects(effects, [&](std::size_t, const auto& effect) {
    const bool extends = std::ranges::all_of(effect.search(scales()), [](const SearchEntry& entry) {
      return !entry.extends.empty() || entry.changes_dry_friction;
    });
    const std::string of_channel = std::string(effect.name) + ".oil";
    const bool offered = find(list, effect.name) || find(of_slide, effect.name) ||
                         find(list, of_channel) || find(of_slide, of_channel);
    EXPECT_NE(offered, extends) << effect.name << " offers nothing, or what it should not";
  });
}

TEST(Catalogue, HasOneEffectForEachChannel) {
  Job job = job_with({Signal::velocity});
  job.model.structure.channels = kept({{"oil", "degC", 20.0}, {"y", "m", 0.0}});
  const auto list = catalogue(job, scales());
  for (const char* name : {"channel_force.oil", "channel_force.y", "channel_mass.y"}) {
    const Hypothesis* found = find(list, name);
    ASSERT_NE(found, nullptr) << name;
    EXPECT_EQ(found->strengths.size(), 1u);
  }
  EXPECT_EQ(find(list, "channel_force"), nullptr);
  // One that is there already is a constant that may be wrong.
  add_effect<ChannelForce>(job.model).k[0] = 2.0;
  const auto rest = catalogue(job, scales());
  EXPECT_TRUE(offers_constant(rest, "channel_force.oil"));
  EXPECT_NE(find(rest, "channel_force.y"), nullptr);
  job.model.structure.channels = nullptr;
  for (const Hypothesis& c : catalogue(job, scales())) EXPECT_FALSE(c.name.starts_with("channel_"));
}

TEST(Catalogue, HasChangesOfDryFrictionWhereThereIsSome) {
  Job job = job_with({Signal::velocity});
  job.model = slide();
  for (const bool has_dry_friction : {false, true}) {
    if (has_dry_friction) add_effect<CoulombFriction>(job.model).F_c = 12.0;
    const auto list = catalogue(job, scales());
    EXPECT_EQ(find(list, "warming_friction") != nullptr, has_dry_friction);
    EXPECT_EQ(find(list, "running_in_friction") != nullptr, has_dry_friction);
  }
}

// Or the loop leaves both undecided, and can accept neither.
TEST(Catalogue, HasOneConstantForceOfAForceSource) {
  Job job = job_with({Signal::velocity});
  EXPECT_NE(find(catalogue(job, scales()), "command_offset"), nullptr);
  job.model = slide();
  EXPECT_NE(find(catalogue(job, scales()), "constant_force"), nullptr);
  EXPECT_EQ(find(catalogue(job, scales()), "command_offset"), nullptr);
}

TEST(Catalogue, EntriesAreComplete) {
  const auto list = catalogue(job_with({Signal::velocity, Signal::position}), scales());
  const auto& quantities = quantity_list();
  std::set<std::pair<std::vector<std::size_t>, std::vector<std::size_t>>> seen;
  for (const Hypothesis& c : list) {
    SCOPED_TRACE(c.name);
    EXPECT_FALSE(c.meaning.empty());
    EXPECT_FALSE(c.acts_on.empty());
    ASSERT_FALSE(c.strengths.empty());
    EXPECT_TRUE(seen.insert({c.strengths, c.shapes}).second) << "twice in the catalogue";
    ASSERT_FALSE(c.settings.empty());
    for (const auto& setting : c.settings) {
      ASSERT_EQ(setting.size(), c.shapes.size());
      for (std::size_t i = 0; i < setting.size(); ++i) {
        EXPECT_GE(setting[i], quantities[c.shapes[i]].quantity.lower);
        EXPECT_LE(setting[i], quantities[c.shapes[i]].quantity.upper);
      }
    }
    for (const std::size_t q : c.strengths) EXPECT_FALSE(quantities[q].quantity.shape);
    for (const std::size_t q : c.shapes) EXPECT_TRUE(quantities[q].quantity.shape);
    // Every shape of an effect that is offered is set, if it has no other value.
    for (const QuantityEntry& entry : quantities) {
      if (!std::isnan(entry.quantity.default_value)) continue;
      if (!entry.quantity.shape || entry.group != quantities[c.strengths[0]].group) continue;
      EXPECT_NE(std::ranges::find(c.shapes, entry.index), c.shapes.end()) << entry.name;
    }
    EXPECT_EQ(c.kind == HypothesisKind::curve, c.name.find("_over_") != std::string::npos);
  }
}

TEST(Catalogue, SeeksPeriodsWhereTheSpectrumShowsThem) {
  const Job job = job_with({Signal::velocity});
  SearchScales s = scales();
  s.drive_periods = {0.01};
  const auto list = catalogue(job, s);
  EXPECT_EQ(find(list, "periodic_force")->settings,
            (std::vector<std::vector<double>>{{0.05}, {0.02}}));
  const auto has_order = [&](const char* name, double period) {
    const double order = 2.0 * std::numbers::pi * job.model.axis.r_g / period;
    return std::ranges::any_of(find(list, name)->settings, [&](const auto& setting) {
      return std::abs(setting[0] - order) < 1e-12;
    });
  };
  EXPECT_TRUE(has_order("cogging_torque", 0.05));
  EXPECT_TRUE(has_order("cogging_torque", 0.02));
  EXPECT_TRUE(has_order("torque_ripple", 0.01));
  SearchScales none = scales();
  none.periods.clear();
  EXPECT_EQ(find(catalogue(job, none), "periodic_force"), nullptr);
}

TEST(Catalogue, CurvesSpanTheMotion) {
  const auto list = catalogue(job_with({Signal::velocity}), scales());
  EXPECT_EQ(find(list, "force_over_velocity")->settings,
            (std::vector<std::vector<double>>{{-1.2, 1.0}}));
  EXPECT_EQ(find(list, "force_over_position")->settings,
            (std::vector<std::vector<double>>{{-0.1, 0.5}}));
  EXPECT_EQ(find(list, "force_over_time")->settings,
            (std::vector<std::vector<double>>{{0.0, 1.2}}));
  EXPECT_TRUE(find(list, "force_over_motor_angle")->shapes.empty());
  EXPECT_EQ(find(list, "friction_over_velocity")->settings,
            (std::vector<std::vector<double>>{{0.0, 1.2}}));
  EXPECT_EQ(find(list, "friction_over_position")->settings,
            (std::vector<std::vector<double>>{{-0.1, 0.5}}));
}

TEST(Catalogue, OffersGravityOfAPendulumOnlyWhereItTurns) {
  const Job job = job_with({Signal::velocity});
  EXPECT_NE(find(catalogue(job, scales()), "pendulum_gravity"), nullptr);
  SearchScales s = scales();
  s.position_high = 0.3;
  EXPECT_EQ(find(catalogue(job, s), "pendulum_gravity"), nullptr);
}

TEST(Catalogue, OffersNothingThatIsFree) {
  Job job = job_with({Signal::velocity});
  ASSERT_TRUE(offers(catalogue(job, scales()), "T_d"));
  ASSERT_TRUE(offers(catalogue(job, scales()), "velocity.bias"));
  add_effect<CoulombFriction>(job.model);
  job.free = {free_parameter("T_d", 1e-3), free_parameter("velocity.bias", 1e-3),
              free_parameter("coulomb_friction.F_c", 5.0)};
  const auto list = catalogue(job, scales());
  for (const char* name : {"T_d", "velocity.bias", "coulomb_friction.F_c"})
    EXPECT_FALSE(offers(list, name)) << name;
  EXPECT_TRUE(offers(list, "velocity.lag"));
}

// One value for all recordings would fight with that of one of them.
TEST(Catalogue, OffersNothingThatIsFreeInOneRecording) {
  Job job = job_with({Signal::velocity});
  job.free = {free_parameter("velocity.bias", 1e-3)};
  job.free[0].recording = 0;
  EXPECT_FALSE(offers(catalogue(job, scales()), "velocity.bias"));
}

TEST(Catalogue, OffersNothingThatARecordingHasAValueOf) {
  Job job = job_with({Signal::velocity});
  job.recordings[0].overrides.emplace_back(quantity_index("velocity.bias"), 0.1);
  EXPECT_FALSE(offers(catalogue(job, scales()), "velocity.bias"));
}

TEST(Catalogue, OffersNothingThatHasAValue) {
  Job job = job_with({Signal::velocity});
  job.model.axis.T_d = 1e-3;
  job.model.instruments[index_of(Signal::velocity)].gain = 1.01;
  add_effect<ConstantForce>(job.model).F_0 = 10.0;
  add_effect<StrokeSpring>(job.model).k_s = 0.0;  // written, but as good as absent
  const auto list = catalogue(job, scales());
  for (const char* name : {"T_d", "velocity.gain", "constant_force.F_0"})
    EXPECT_FALSE(offers(list, name)) << name;
  EXPECT_TRUE(offers(list, "stroke_spring.k_s"));
}

// What is left in the members of an effect that is not there says nothing.
TEST(Catalogue, OffersAnAbsentEffectWhateverItsMembersHold) {
  Job job = job_with({Signal::velocity});
  std::get<ConstantForce<double>>(job.model.effects).F_0 = 10.0;
  EXPECT_TRUE(offers(catalogue(job, scales()), "constant_force.F_0"));
}

TEST(Catalogue, OffersHigherHarmonicsOnlyBesideTheFirst) {
  Job job = job_with({Signal::velocity});
  EXPECT_FALSE(offers(catalogue(job, scales()), "periodic_force.F_s2"));
  EXPECT_FALSE(offers(catalogue(job, scales()), "periodic_force.F_s3"));
  auto& force = add_effect<PeriodicForce>(job.model);
  force.F_s1 = 5.0;
  force.period = 0.05;
  const auto list = catalogue(job, scales());
  EXPECT_TRUE(offers(list, "periodic_force.F_s2"));
  EXPECT_TRUE(offers(list, "periodic_force.F_s3"));
  EXPECT_FALSE(offers(list, "periodic_force.F_s1"));
}

/// That the catalogue offers the exponent of an effect beside that effect alone.
template <template <class> class Effect>
void expect_exponent(double neutral, const Effect<double>& effect, double declared) {
  Job job = job_with({Signal::velocity});
  const std::string name = std::string(Effect<double>::name) + ".n";
  const auto exponent_in = [&] {
    const auto list = catalogue(job, scales());
    const auto found = std::ranges::find_if(list, [&](const Hypothesis& c) {
      return c.strengths == std::vector{quantity_index(name)};
    });
    return found == list.end() ? std::optional<Hypothesis>() : *found;
  };
  EXPECT_FALSE(exponent_in());
  add_effect<Effect>(job.model) = effect;
  const std::optional<Hypothesis> exponent = exponent_in();
  ASSERT_TRUE(exponent);
  EXPECT_EQ(exponent->neutral, std::vector{neutral});
  EXPECT_EQ(exponent->parameters(), 1u);
  std::get<Effect<double>>(job.model.effects).n = declared;  // another may be the machine's
  EXPECT_EQ(exponent_in()->neutral, std::vector{declared});
}

TEST(Catalogue, OffersAnExponentOnlyBesideItsEffect) {
  expect_exponent<StribeckFriction>(1.0, {12.0, 0.05}, 2.0);
  expect_exponent<QuadraticDrag>(2.0, {60.0}, 1.5);
}

// Tustin's law and the Gaussian have as many parameters, and the recordings choose.
TEST(Catalogue, HoldsTheExponentOfStribeckFriction) {
  const auto list = catalogue(job_with({Signal::velocity}), scales());
  const Hypothesis* stribeck = find(list, "stribeck_friction");
  ASSERT_NE(stribeck, nullptr);
  EXPECT_EQ(stribeck->parameters(), 2u);
  std::set<double> exponents;
  for (const auto& setting : stribeck->settings) exponents.insert(setting.back());
  EXPECT_EQ(exponents, (std::set{1.0, 2.0}));
}

TEST(Catalogue, OffersATorqueThatFadesStraightAndWithATimeConstant) {
  const auto list = catalogue(job_with({Signal::velocity}), scales());
  std::vector<std::size_t> parameters;
  for (const Hypothesis& h : list)
    if (h.name == "torque_fade") parameters.push_back(h.parameters());
  EXPECT_EQ(parameters, (std::vector<std::size_t>{1, 2}));
}

// "The model lacked position_friction, position_friction" tells nobody what was added.
TEST(Catalogue, NamesMoreOfAnEffectByItsQuantity) {
  Job job = job_with({Signal::velocity});
  EXPECT_EQ(find(catalogue(job, scales()), "position_friction.G_b"), nullptr);
  add_effect<PositionFriction>(job.model).G_c = 5.0;
  const auto list = catalogue(job, scales());
  EXPECT_EQ(find(list, "position_friction"), nullptr);
  EXPECT_NE(find(list, "position_friction.G_q"), nullptr);
  EXPECT_NE(find(list, "position_friction.G_b"), nullptr);
}

TEST(Catalogue, OffersASecondDahlElementOnlyBesideTheFirst) {
  Job job = job_with({Signal::velocity});
  EXPECT_FALSE(offers(catalogue(job, scales()), "second_dahl_friction.F_d"));
  EXPECT_FALSE(offers(catalogue(job, scales()), "dahl_friction.B_d"));
  add_effect<DahlFriction>(job.model) = {12.0, 1e-3};
  const auto list = catalogue(job, scales());
  EXPECT_TRUE(offers(list, "second_dahl_friction.F_d"));
  EXPECT_TRUE(offers(list, "dahl_friction.B_d"));
  EXPECT_FALSE(offers(list, "second_dahl_friction.B_d"));
}

TEST(Catalogue, OffersEveryConstantOfTheAxisFile) {
  Job job = job_with({Signal::velocity});
  job.free = {free_parameter("B_a", 100.0)};
  job.model.instruments[index_of(Signal::velocity)].gain = 1.01;
  job.model.instruments[index_of(Signal::motor_current)].gain = 1.01;  // not recorded
  add_effect<ConstantForce>(job.model).F_0 = 10.0;
  const auto list = catalogue(job, scales());
  for (const char* name : {"T_z", "J_m", "r_g", "K_m", "velocity.gain", "constant_force.F_0"})
    EXPECT_TRUE(offers_constant(list, name)) << name;
  EXPECT_EQ(find(list, "T_z")->neutral, std::vector{job.model.axis.T_z});
  // Free, neutral, of an instrument that nobody reads, and what added_mass says as well.
  for (const char* name : {"B_a", "T_d", "motor_current.gain", "M"})
    EXPECT_FALSE(offers_constant(list, name)) << name;
  ASSERT_NE(find(list, "added_mass"), nullptr);
}

TEST(Catalogue, OffersNothingThatTheStructureDoesNotUse) {
  Job job = job_with({Signal::velocity});
  job.model = slide();
  const auto list = catalogue(job, scales());
  for (const char* name : {"cogging_torque", "torque_ripple", "torque_droop", "supply_resistance",
                           "force_over_motor_angle"})
    EXPECT_EQ(find(list, name), nullptr) << name;
  for (const char* name : {"torque_fade", "force_droop", "drive_lag", "dead_time"})
    EXPECT_NE(find(list, name), nullptr) << name;
  for (const Hypothesis& c : list) {
    Structure structure = job.model.structure;
    structure.effects.set();
    for (const std::size_t q : c.strengths)
      EXPECT_TRUE(is_used(quantity_list()[q], structure)) << c.name;
  }
}

TEST(Catalogue, OffersOnlyInstrumentsThatTheFitReads) {
  Job job = job_with({Signal::velocity, Signal::motor_current});
  job.recordings[0].measurements[1].fitted = false;  // compared only
  Recording validate = job_with({Signal::tachometer}).recordings[0];
  validate.role = Role::validate;
  job.recordings.push_back(validate);
  const auto list = catalogue(job, scales());
  for (const char* part : {"bias", "gain", "lag", "delay", "drift"}) {
    const auto of = [&](const char* signal) { return std::string(signal) + "." + part; };
    EXPECT_NE(find(list, of("velocity")), nullptr);
    for (const char* signal : {"motor_current", "tachometer", "acceleration", "position"})
      EXPECT_EQ(find(list, of(signal)), nullptr) << of(signal);
  }
}

}  // namespace
}  // namespace axisfit
