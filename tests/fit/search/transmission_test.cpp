#include "fit/search/transmission.h"

#include <gtest/gtest.h>

#include "tests/fit/search/selection.h"

namespace axisfit {
namespace {

SearchScales scales(double mass) {
  SearchScales s;
  s.position_low = -0.1;
  s.position_high = 0.3;
  s.mass = mass;
  return s;
}

/// A slide as an axis file describes it: with no pinion.
Model<double> rigid_slide() {
  Model<double> model = slide();
  model.axis.r_g = 1.0;
  return model;
}

/// That, if its motor has 8 kg of 20 and drives the rest through a soft coupling with a gap.
Model<double> loose_slide() {
  Model<double> model = rigid_slide();
  model.structure.transmission = Transmission::backlash;
  model.axis.M = 12.0;
  model.axis.J_m = 8.0;
  model.axis.B_m = 0.0;
  model.axis.H = 1e-3;
  model.axis.k_g = 8e4;
  model.axis.b_g = 100.0;
  return model;
}

std::vector<std::string> names_of(const std::vector<std::size_t>& quantities) {
  std::vector<std::string> names;
  for (const std::size_t q : quantities) names.push_back(quantity_list()[q].name);
  return names;
}

using Names = std::vector<std::string>;
using Set = std::set<std::string>;

TEST(Backlash, IsOfferedToARigidTransmissionThatMoves) {
  Job job;
  job.model = motor_axis();
  const auto list = transmission_hypotheses(job, scales(170.0));
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[0].name, "compliance");
  EXPECT_EQ(names_of(list[0].strengths), Names{"k_g"});
  EXPECT_EQ(names_of(list[0].shapes), Names{"b_g"});
  EXPECT_EQ(list[1].name, "backlash");
  EXPECT_EQ(names_of(list[1].strengths), Names{"H"});
  EXPECT_EQ(names_of(list[1].shapes), (Names{"k_g", "b_g"}));
  for (const Hypothesis& c : list) EXPECT_FALSE(c.settings.empty() || c.probes.empty());

  SearchScales at_rest = scales(170.0);
  at_rest.position_high = at_rest.position_low;
  EXPECT_TRUE(transmission_hypotheses(job, at_rest).empty());
  job.model.structure.effects.set(*effect_named("soft_transmission"));
  EXPECT_TRUE(transmission_hypotheses(job, scales(170.0)).empty());
}

// A transmission that is known to give way may have a gap, too, and depends on what gives way.
TEST(Backlash, IsOfferedBesideCompliance) {
  Job job;
  job.model = paper_axis();
  EXPECT_TRUE(transmission_hypotheses(job, scales(170.0)).empty());
  job.model.axis.H = 0.0;
  const auto list = transmission_hypotheses(job, scales(170.0));
  ASSERT_EQ(list.size(), 1u);
  EXPECT_EQ(list[0].name, "backlash");
  EXPECT_EQ(list[0].parameters(), 1u);
  Job rigid;
  rigid.model = motor_axis();
  EXPECT_TRUE(is_part_of(list[0], transmission_hypotheses(rigid, scales(170.0))[0]));
}

// Of a force source nobody has said what of the mass is the motor's.
TEST(Backlash, SplitsTheMassOfAForceSource) {
  Job job;
  job.model = rigid_slide();
  ASSERT_EQ(transmission_hypotheses(job, scales(20.0)).size(), 2u);
  for (const Hypothesis& c : transmission_hypotheses(job, scales(20.0)))
    EXPECT_EQ(names_of(c.shapes).back(), "M");
  job.free = {free_parameter("M", 20.0)};
  job.free[0].prior = Prior{20.0, 0.1};
  const auto list = transmission_hypotheses(job, scales(20.0));
  ASSERT_EQ(list.size(), 2u);
  for (const Hypothesis& c : list) {
    SCOPED_TRACE(c.name);
    EXPECT_EQ(names_of(c.shapes).back(), "J_m");
    for (const auto& setting : c.settings) {
      const Job loose =
          with_hypothesis(job, c, std::vector{20.0}, {std::vector{c.probes[0]}, setting});
      ASSERT_EQ(loose.free.size(), 2 + c.shapes.size());
      EXPECT_EQ(loose.model.structure.transmission, Transmission::backlash);
      EXPECT_EQ(model_error(loose.model), "");
      const double motor = setting.back();
      EXPECT_DOUBLE_EQ(loose.free[0].initial + motor, 20.0);
      EXPECT_DOUBLE_EQ(loose.model.axis.M + motor, 20.0);
      EXPECT_FALSE(loose.free[0].prior);  // it was one of motor and arm
      EXPECT_DOUBLE_EQ(mass_of_motor(job.model.structure, loose.model), motor);
    }
  }
  EXPECT_EQ(mass_of_motor(job.model.structure, job.model), 0.0);
  Model<double> loose = motor_axis();
  const Structure rigid = loose.structure;
  loose.structure.transmission = Transmission::backlash;
  EXPECT_EQ(mass_of_motor(rigid, loose), 0.0);  // M never held the motor
}

// Sampled at 1 kHz: 500 Hz is the fastest swing that shows.
TEST(Backlash, IsNoStifferThanTheRecordingsShow) {
  Job job;
  job.model = rigid_slide();
  job.free = {free_parameter("M", 20.0)};
  Recording& r = job.recordings.emplace_back();
  for (int i = 0; i < 100; ++i) r.times.edit().push_back(1e-3 * i);
  const Hypothesis soft = transmission_hypotheses(job, scales(20.0)).front();
  for (const auto& setting : soft.settings) {
    const Job stiff = with_hypothesis(job, soft, std::vector{20.0}, {{1e12}, setting});
    const auto k_g = std::ranges::find(stiff.free, quantity_index("k_g"), &FreeParameter::quantity);
    ASSERT_NE(k_g, stiff.free.end());
    const double motor = setting.back(), arm = 20.0 - motor, swing = 2.0 * 3.14159265358979 * 500.0;
    EXPECT_NEAR(k_g->upper, motor * arm / 20.0 * swing * swing, 1e-6 * k_g->upper);
    EXPECT_EQ(k_g->initial, k_g->upper);
  }
}

// The encoder of the motor alone shows what of the mass is behind the gap.
TEST(Backlash, IsFoundByTheEncoderOfTheMotor) {
  const EffectSelection selection =
      close(two_recordings(loose_slide(), rigid_slide(), {"M", "B_a"}, 6.0, {Signal::position}));
  EXPECT_EQ(accepted(selection), (Set{"backlash", "compliance"}));
  EXPECT_TRUE(selection.explained);
  EXPECT_EQ(selection.result.job.model.structure.transmission, Transmission::backlash);
  expect_found(selection, "H", 1e-3);
  expect_found(selection, "M", 12.0);
  expect_found(selection, "J_m", 8.0);
  expect_found(selection, "B_a", 30.0);
}

// A soft coupling by itself, which is not called backlash.
TEST(Backlash, IsNotFoundWhereTheCouplingIsOnlySoft) {
  Model<double> truth = loose_slide();
  truth.axis.H = 0.0;
  truth.axis.k_g = 3e4;
  const EffectSelection selection =
      close(two_recordings(truth, rigid_slide(), {"M", "B_a"}, 6.0, {Signal::position}));
  EXPECT_EQ(accepted(selection), Set{"compliance"});
  EXPECT_TRUE(selection.explained);
  expect_found(selection, "k_g", 3e4);
  expect_found(selection, "M", 12.0);
  expect_found(selection, "J_m", 8.0);
}

// What was accepted before has to stand up beside it, and is taken out on trial: then the declared
// mass is that of motor and arm again.
TEST(Backlash, IsFoundBesideAnotherEffect) {
  Model<double> truth = loose_slide();
  add_effect<CoulombFriction>(truth).F_c = 8.0;
  const EffectSelection selection = close(two_recordings(truth, rigid_slide(), {"M", "B_a"}, 6.0,
                                                         {Signal::position, Signal::velocity}));
  EXPECT_EQ(accepted(selection), (Set{"backlash", "coulomb_friction"}));
  EXPECT_TRUE(selection.explained);
  expect_found(selection, "H", 1e-3);
  expect_found(selection, "M", 12.0);
  expect_found(selection, "coulomb_friction.F_c", 8.0);
}

}  // namespace
}  // namespace axisfit
