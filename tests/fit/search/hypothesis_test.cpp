#include "fit/search/hypothesis.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/fit/example.h"
#include "tests/fit/search/hypotheses.h"

namespace axisfit {
namespace {

class WithHypothesis : public testing::Test {
 protected:
  WithHypothesis() {
    job_ = two_recordings(paper_axis(), paper_axis(), {"B_a", "V_L"}, 8.0,
                          {Signal::velocity, Signal::acceleration});
    hypotheses_ = catalogue(job_, scales());
  }
  /// That a job with any of the hypotheses at neutral strength predicts what it does without.
  void expect_the_same(const std::vector<Hypothesis>& hypotheses) const {
    const std::vector<double> values{200.0, 2.7};
    const FitResult without = result_at_start(job_);
    for (const Hypothesis& c : hypotheses) {
      SCOPED_TRACE(c.name);
      for (const auto& setting : c.settings) {
        const FitResult with =
            result_at_start(with_hypothesis(job_, c, values, {c.neutral, setting}));
        for (std::size_t r = 0; r < 2; ++r) {
          const auto& simulated = with.recordings[r].free_running.simulated;
          const auto& expected = without.recordings[r].free_running.simulated;
          if (c.kind != HypothesisKind::constant) {
            ASSERT_EQ(simulated, expected);
            continue;
          }
          // A constant is fitted by its logarithm, which does not give back every bit.
          ASSERT_EQ(simulated.size(), expected.size());
          for (std::size_t m = 0; m < simulated.size(); ++m)
            for (std::size_t n = 0; n < simulated[m].size(); ++n)
              ASSERT_NEAR(simulated[m][n], expected[m][n], 1e-9);
        }
      }
    }
  }

  Job job_;
  std::vector<Hypothesis> hypotheses_;
};

TEST_F(WithHypothesis, AddsItsStrengthsAndShapesAndNothingElse) {
  const std::vector<double> values{150.0, 3.0};
  for (const Hypothesis& c : hypotheses_) {
    SCOPED_TRACE(c.name);
    std::vector<double> strengths;
    for (std::size_t i = 0; i < c.strengths.size(); ++i)
      strengths.push_back(c.kind == HypothesisKind::constant ? 1.1 * c.neutral[i]
                                                             : 1e-3 * static_cast<double>(i + 1));
    const Job job = with_hypothesis(job_, c, values, {strengths, c.settings.back()});
    ASSERT_EQ(job.free.size(), 2 + c.parameters());
    EXPECT_EQ(job.free[0].initial, 150.0);
    EXPECT_EQ(job.free[1].initial, 3.0);
    EXPECT_EQ(job.free[0].lower, job_.free[0].lower);
    for (std::size_t i = 0; i < strengths.size(); ++i) {
      const FreeParameter& p = job.free[2 + i];
      EXPECT_EQ(p.quantity, c.strengths[i]);
      EXPECT_EQ(p.initial, strengths[i]);
      EXPECT_EQ(p.scale, c.kind == HypothesisKind::constant
                             ? free_parameter(quantity_list()[p.quantity].name, 1.0).scale
                             : Scale::linear);
      EXPECT_FALSE(p.recording.has_value());
      EXPECT_LE(p.lower, p.initial);
      EXPECT_GE(p.upper, p.initial);
    }
    Model<double> before = job_.model, after = job.model;
    for (std::size_t i = 0; i < c.shapes.size(); ++i) {
      EXPECT_EQ(*members(after)[c.shapes[i]], c.settings.back()[i]);
      if (i >= c.estimated_shapes().size()) continue;
      const FreeParameter& p = job.free[2 + strengths.size() + i];
      EXPECT_EQ(p.quantity, c.shapes[i]);
      EXPECT_EQ(p.initial, c.settings.back()[i]);
      EXPECT_EQ(p.scale == Scale::logarithmic, quantity_list()[c.shapes[i]].quantity.lower > 0.0);
      EXPECT_LE(p.lower, p.initial);
      EXPECT_GE(p.upper, p.initial);
    }
    // The rest of the model is as it was.
    const std::string& group = quantity_list()[c.strengths[0]].group;
    const bool is_effect = after.structure.effects != before.structure.effects;
    for (const QuantityEntry& entry : quantity_list()) {
      if (is_effect && entry.group == group) continue;
      EXPECT_EQ(*members(after)[entry.index], *members(before)[entry.index]) << entry.name;
    }
    EXPECT_LE((after.structure.effects ^ before.structure.effects).count(), 1u);
    EXPECT_EQ(job.recordings.size(), job_.recordings.size());
    EXPECT_EQ(model_error(job.model), "");
  }
}

TEST_F(WithHypothesis, SeeksAPlaceWhereItsSettingsLie) {
  Hypothesis c = *find(hypotheses_, "force_over_position");
  c.held = 0;
  c.settings = {{-0.1, 0.5}, {0.4, 0.5}};
  const std::vector<double> values{200.0, 2.7}, strengths(c.strengths.size(), 1.0);
  const Job job = with_hypothesis(job_, c, values, {strengths, c.settings[0]});
  const FreeParameter& from = job.free[job.free.size() - 2];
  const FreeParameter& to = job.free.back();
  EXPECT_EQ(from.scale, Scale::linear);
  EXPECT_NEAR(from.lower, -0.15, 1e-15);
  EXPECT_NEAR(from.upper, 0.45, 1e-15);
  EXPECT_EQ(from.initial, -0.1);
  EXPECT_EQ(to.lower, -1e6);  // one setting is no range
  EXPECT_EQ(to.upper, 1e6);
}

// What other values an absent effect had is forgotten: nothing but the hypothesis acts.
TEST_F(WithHypothesis, BringsInNothingElseOfItsEffect) {
  std::get<DirectionalFriction<double>>(job_.model.effects).dF_c = 7.0;
  const Hypothesis& c = *find(hypotheses_, "directional_friction");
  const std::vector<double> values{200.0, 2.7}, strengths{1.0};
  Job job = with_hypothesis(job_, c, values, {strengths, {}});
  EXPECT_EQ(*members(job.model)[quantity_index("directional_friction.dF_c")], 0.0);
}

// But the values of an effect that is there already stay.
TEST_F(WithHypothesis, KeepsTheOtherPartsOfAnEffect) {
  add_effect<PositionFriction>(job_.model).G_c = 7.0;
  const auto list = catalogue(job_, scales());
  const auto viscous = std::ranges::find_if(list, [](const Hypothesis& c) {
    return c.strengths == std::vector{quantity_index("position_friction.G_b")};
  });
  ASSERT_NE(viscous, list.end());
  const std::vector<double> values{200.0, 2.7}, strengths{1.0};
  Job job = with_hypothesis(job_, *viscous, values, {strengths, {}});
  EXPECT_EQ(*members(job.model)[quantity_index("position_friction.G_c")], 7.0);
}

TEST_F(WithHypothesis, KeepsWithinTheBounds) {
  const Hypothesis& c = *find(hypotheses_, "coulomb_friction");
  const std::vector<double> values{1e9, 1e-9}, strengths{-5.0};
  const Job job = with_hypothesis(job_, c, values, {strengths, {}});
  EXPECT_EQ(job.free[0].initial, job_.free[0].upper);
  EXPECT_EQ(job.free[1].initial, job_.free[1].lower);
  EXPECT_EQ(job.free[2].initial, 0.0);
}

TEST_F(WithHypothesis, OfNeutralStrengthPredictsTheSameBitForBit) { expect_the_same(hypotheses_); }

TEST_F(WithHypothesis, ThatExtendsAnEffectPredictsTheSameAtNeutralStrength) {
  add_effect<StribeckFriction>(job_.model) = {12.0, 0.05};
  add_effect<DahlFriction>(job_.model) = {5.0, 1e-3};
  add_effect<QuadraticDrag>(job_.model).c = 60.0;
  auto& force = add_effect<PeriodicForce>(job_.model);
  force.F_s1 = 5.0;
  force.period = 0.05;
  std::vector<Hypothesis> extensions = catalogue(job_, scales());
  std::erase_if(extensions, [&](const Hypothesis& c) {
    return c.kind == HypothesisKind::constant ||
           std::ranges::any_of(hypotheses_,
                               [&](const Hypothesis& old) { return old.strengths == c.strengths; });
  });
  // Two exponents, damping, two second elements, two harmonics; and two changes of dry friction.
  EXPECT_EQ(extensions.size(), 9u);
  expect_the_same(extensions);
}

TEST(Hypothesis, IsTheSameWhateverItsShape) {
  Hypothesis a, b;
  a.strengths = b.strengths = {3, 4};
  a.shapes = {5};
  EXPECT_TRUE(is_same(a, b));
  b.strengths = {4, 3};
  EXPECT_FALSE(is_same(a, b));
}

TEST(Hypothesis, CountsItsShapesUnlessTheyAreHeld) {
  Hypothesis h;
  h.strengths = {1, 2};
  h.shapes = {3, 4};
  EXPECT_EQ(h.parameters(), 4u);
  h.held = 1;
  EXPECT_EQ(h.parameters(), 3u);
}

TEST_F(WithHypothesis, HoldsTheLastShapesAtTheirSetting) {
  const Hypothesis& c = *find(hypotheses_, "stribeck_friction");
  ASSERT_EQ(c.held, 1u);
  Job job = with_hypothesis(job_, c, std::vector{200.0, 2.7}, {{12.0}, {0.03, 2.0}});
  EXPECT_EQ(job.free.size(), job_.free.size() + 2);
  EXPECT_EQ(job.free.back().quantity, c.shapes.front());
  EXPECT_EQ(*members(job.model)[c.shapes.back()], 2.0);
}

TEST(HeldAtSettings, TakesTheNearestOfWhatIsHeld) {
  Hypothesis h;
  h.strengths = {1};
  h.shapes = {2, 3};
  h.held = 1;
  h.settings = {{0.1, 1.0}, {0.2, 2.0}};
  EXPECT_EQ(held_at_settings(h, {{5.0}, {0.13, 1.7}}).shapes, (std::vector{0.13, 2.0}));
  EXPECT_EQ(held_at_settings(h, {{5.0}, {0.13, 0.4}}).shapes, (std::vector{0.13, 1.0}));
}

TEST(DistanceFromNeutral, OfAStiffnessIsTheCompliance) {
  EXPECT_DOUBLE_EQ(distance_from_neutral(1.02, 1.0), 1.02 - 1.0);
  EXPECT_DOUBLE_EQ(distance_from_neutral(500.0, INFINITY), 0.002);
}

TEST_F(WithHypothesis, HasTheValuesThatItWasGiven) {
  const Hypothesis& h = *find(hypotheses_, "periodic_force");
  const HypothesisValues own{{4.0, 3.0}, h.settings.front()};
  const Job job = with_hypothesis(job_, h, std::vector{200.0, 2.7}, own);
  const HypothesisValues found = values_in(job, result_at_start(job), h);
  EXPECT_EQ(found.strengths, own.strengths);
  EXPECT_EQ(found.shapes, own.shapes);
}

TEST_F(WithHypothesis, OfOneRecordingIsItsParameterAlone) {
  job_.recordings[1].role = Role::fit;
  job_.recordings[1].name = "other";
  const std::vector<Hypothesis> hypotheses = catalogue(job_, scales());
  const Hypothesis& own = *find(hypotheses, "coulomb_friction@other");
  const Hypothesis& shared = *find(hypotheses, "coulomb_friction");
  EXPECT_FALSE(is_same(own, shared));
  const Job job = with_hypothesis(job_, own, {}, {{3.0}, {}});
  EXPECT_EQ(job.free.back().id(), own.strength(0));
  EXPECT_EQ(own.strength(0).recording, 1u);
  EXPECT_EQ(values_in(job, result_at_start(job), own).strengths, std::vector{3.0});
  EXPECT_EQ(values_in(job, result_at_start(job), shared).strengths, std::vector{0.0})
      << "of the others";

  // What it is shaped by, too: another recording may have a payload of its own.
  const Hypothesis& payload = *find(hypotheses, "payload_change@other");
  const HypothesisValues picked_up{{2.0}, payload.settings.front()};
  const Job with = with_hypothesis(job_, payload, {}, picked_up);
  EXPECT_EQ(with.free.back().id(), payload.shape(0));
  EXPECT_EQ(payload.shape(0).recording, 1u);
  EXPECT_EQ(values_in(with, result_at_start(with), payload).shapes, picked_up.shapes);
}

TEST_F(WithHypothesis, LeavesFixedShapesOutOfTheFreeParameters) {
  const Hypothesis& h = *find(hypotheses_, "periodic_force");
  const HypothesisValues own{{4.0, 3.0}, h.settings.front()};
  const Job fixed = with_hypothesis(job_, h, {}, own, true);
  EXPECT_EQ(fixed.free.size(), job_.free.size() + h.strengths.size());
  Model<double> model = fixed.model;
  EXPECT_EQ(*members(model)[h.shapes.front()], own.shapes.front());
}

}  // namespace
}  // namespace axisfit
