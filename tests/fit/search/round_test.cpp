#include "fit/search/round.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "fit/estimate/estimate.h"
#include "tests/fit/search/selection.h"

namespace axisfit {
namespace {

FittedModel declared_model(const Job& job) { return {"", job, estimate(job)}; }

void expect_same(const RoundResult& a, const RoundResult& b) {
  EXPECT_EQ(a.best, b.best);
  EXPECT_EQ(a.tried, b.tried);
  ASSERT_EQ(a.models.size(), b.models.size());
  for (std::size_t i = 0; i < a.models.size(); ++i) {
    EXPECT_EQ(a.models[i].hypothesis.name, b.models[i].hypothesis.name);
    EXPECT_EQ(values_of(a.models[i].fit), values_of(b.models[i].fit));
    EXPECT_EQ(a.models[i].gain.p_value, b.models[i].gain.p_value);
  }
}

class RoundOfAModel : public testing::Test {
 protected:
  RoundResult round(const RoundOptions& options, RoundMemory& memory) {
    phases_.clear();
    const SearchContext context{
        {}, {nullptr, nullptr, [&](const Progress& p) { phases_.insert(p.phase); }}};
    return try_round(model_, options, memory, context);
  }
  bool has_scored() const { return phases_.contains("scoring effects"); }

  FittedModel model_ = declared_model(hidden_effect_named("coulomb_friction").job());
  std::set<std::string> phases_;
};

TEST_F(RoundOfAModel, IsTheSameFromMemory) {
  RoundMemory memory;
  const RoundResult first = round({}, memory);
  EXPECT_TRUE(has_scored());
  ASSERT_TRUE(first.best);
  EXPECT_EQ(first.models[*first.best].hypothesis.name, "coulomb_friction");
  const RoundResult again = round({}, memory);
  EXPECT_FALSE(has_scored());
  expect_same(first, again);
}

TEST_F(RoundOfAModel, ComputesWhatAnotherDidNotNeed) {
  RoundMemory memory;
  const RoundResult all = round({}, memory);
  RoundOptions options;
  options.excluded = {all.models[*all.best].hypothesis};
  const RoundResult rest = round(options, memory);
  EXPECT_EQ(has_scored(), memory.is_whole);  // no more than the gains that were left
  RoundMemory none;
  expect_same(rest, round(options, none));
  EXPECT_TRUE(has_scored());
}

// A friction as large as half of the force: to first order a bump as wide as the stroke, or one
// that depends on the load, explains more of it. The plain law is refitted before these.
TEST(RoundTest, EndsWithThePlainLawWhereThatLeavesNothing) {
  Model<double> truth = slide();
  add_effect<CoulombFriction>(truth).F_c = 12.0;
  const Job job = two_recordings(truth, slide(), {"M", "B_a"});
  RoundMemory memory;
  const RoundResult found = try_round(declared_model(job), {}, memory, {});
  ASSERT_TRUE(found.best);
  EXPECT_EQ(found.models[*found.best].hypothesis.name, "coulomb_friction");
  const auto named = [](const char* name) {
    return [name](const auto& one) {
      if constexpr (requires { one.hypothesis->name; })
        return one.hypothesis->name == name;
      else
        return one.hypothesis.name == name;
    };
  };
  // What promised as much is a rival, to be looked at when all else is known.
  EXPECT_TRUE(std::ranges::none_of(found.models, named("dahl_friction")));
  EXPECT_TRUE(std::ranges::any_of(found.unrefitted, named("dahl_friction")));
}

// A torque that fades with a time constant: the straight form, of fewer numbers, passes first, and
// leaves more than noise.
TEST(RoundTest, GoesOnFromAPlainFormToARicherOne) {
  const HiddenEffect on_motor = hidden_effect_named("torque_ripple");
  Model<double> truth = on_motor.declared();
  add_effect<TorqueFade>(truth) = {0.4, 1.5};
  RoundMemory memory;
  const RoundResult found = try_round(
      declared_model(two_recordings(truth, on_motor.declared(), on_motor.free)), {}, memory, {});
  ASSERT_TRUE(found.best);
  const Hypothesis& best = found.models[*found.best].hypothesis;
  EXPECT_EQ(best.name, "torque_fade");
  EXPECT_EQ(best.shapes.size(), 1u);
}

// A refit that begins with a period too many along the stroke ends there.
TEST(RoundTest, TriesOnePeriodMoreOrLess) {
  constexpr double kPeriod = 0.015;
  Model<double> truth = slide();
  auto& wave = add_effect<PeriodicForce>(truth);
  wave.F_s1 = 12.0;
  wave.period = kPeriod;
  const FittedModel model = declared_model(two_recordings(truth, slide(), {"M", "B_a"}));
  RoundMemory memory;
  const RoundResult first = try_round(model, {}, memory, {});
  ASSERT_TRUE(first.best);
  const Tried& right = first.models[*first.best];
  ASSERT_EQ(right.hypothesis.name, "periodic_force");
  const double count = periods_passed(right.job, right.fit, right.hypothesis);
  Scored start;
  start.hypothesis = std::make_shared<const Hypothesis>(right.hypothesis);
  start.own = {{1.0, 1.0}, {kPeriod * count / (count + 1.0)}};
  start.others = values_of(model.fit);
  start.scaled_gain = start.promise = 1e4;
  EXPECT_LT(values_in(try_hypothesis(model.job, start)).shapes[0], 0.97 * kPeriod);
  Shortlist list;
  list.entries = {start};
  memory = {.of = model.values(), .list = list, .is_compared = true, .is_whole = true};
  memory.refits.resize(1);
  const RoundResult found = try_round(model, {}, memory, {});
  ASSERT_TRUE(found.best);
  EXPECT_NEAR(values_in(found.models[*found.best]).shapes[0], kPeriod, 1e-4);
}

// A friction with an offset: each explains a part, only both explain most of what is missing.
TEST(RoundTest, TriesTwoAtOnceWhereOnlyTheyExplainMost) {
  Model<double> truth = slide();
  add_effect<CoulombFriction>(truth).F_c = 10.0;
  add_effect<ConstantForce>(truth).F_0 = 6.0;
  const FittedModel model = declared_model(two_recordings(truth, slide(), {"M", "B_a"}));
  RoundMemory memory, of_singles;
  const RoundResult found = try_round(model, {.pairs = true}, memory, {});
  ASSERT_TRUE(found.pair);
  const std::set<std::string> names{found.pair->first.hypothesis.name,
                                    found.pair->second.hypothesis.name};
  EXPECT_EQ(names, (std::set<std::string>{"coulomb_friction", "constant_force"}));
  EXPECT_TRUE(found.models.empty());
  EXPECT_FALSE(try_round(model, {}, of_singles, {}).pair);
}

TEST(RoundTest, TriesOneAloneThatExplainsMost) {
  RoundMemory memory;
  const FittedModel model = declared_model(hidden_effect_named("coulomb_friction").job());
  const RoundResult found = try_round(model, {.pairs = true}, memory, {});
  EXPECT_FALSE(found.pair);
  EXPECT_TRUE(found.best);
}

// A disturbance that no effect of the catalogue makes: some promise a part of what the test asks.
TEST(RoundTest, RefitsNothingThatIsHopeless) {
  Job job = two_recordings(slide(), slide(), {"M", "B_a"});
  for (Recording& r : job.recordings)
    for (Measurement& m : r.measurements) {
      std::vector<double> values(m.values);
      for (std::size_t i = 0; i < values.size(); ++i)
        values[i] += 3.0 * m.sigma * std::sin(20.0 * r.times[i] * r.times[i]);
      m.values = values;
    }
  RoundMemory memory;
  const FittedModel model = declared_model(job);
  const RoundResult found = try_round(model, {}, memory, {});
  EXPECT_FALSE(found.best);
  ASSERT_TRUE(memory.list);
  const double samples = samples_of(residual_series(model.job, model.fit));
  std::size_t hopeless = 0;
  for (std::size_t i = 0; i < memory.refits.size(); ++i) {
    const Scored& entry = memory.list->entries[i];
    const double least = least_gain(*entry.hypothesis, samples, found.tried);
    const bool may_pass = entry.promise >= 0.4 * least || entry.scaled_gain >= 10.0 * least;
    EXPECT_EQ(memory.refits[i].has_value(), may_pass) << entry.hypothesis->name;
    hopeless += may_pass ? 0 : 1;
  }
  EXPECT_GT(hopeless, 0u);
}

// One gain tells enough of a model whose one lack is plain, and all are asked where nothing passes.
TEST_F(RoundOfAModel, ScoresAtOtherGainsOnlyWhereItMust) {
  RoundMemory memory;
  ASSERT_TRUE(round({}, memory).best);
  EXPECT_TRUE(memory.list->has_most);
  EXPECT_EQ(memory.list->observer_gains.size(), 1u);
  RoundOptions options;
  for (const Scored& entry : memory.list->entries) options.excluded.push_back(*entry.hypothesis);
  round(options, memory);
  EXPECT_GT(memory.list->observer_gains.size(), 1u);
  EXPECT_TRUE(has_scored());
}

/// Gains at which a round scores where nothing passes, and the reduced chi-square of the model.
std::pair<std::vector<double>, double> gains_with_friction(double level) {
  Model<double> truth = slide();
  add_effect<CoulombFriction>(truth).F_c = level;
  const FittedModel model = declared_model(two_recordings(truth, slide(), {"M"}));
  RoundMemory memory;
  RoundOptions options;
  try_round(model, options, memory, {});
  for (const Scored& entry : memory.list->entries) options.excluded.push_back(*entry.hypothesis);
  try_round(model, options, memory, {});
  return {memory.list->observer_gains, model.fit.reduced_chi_square};
}

// The noise of the readings drives a simulation that tracks.
TEST(RoundTest, ScoresTheFreeRunAloneWhereLittleIsLeft) {
  const auto [gains, chi_square] = gains_with_friction(0.3);
  ASSERT_GT(chi_square, 1.2);
  ASSERT_LT(chi_square, 2.0);
  EXPECT_EQ(gains, std::vector{0.0});
}

TEST(RoundTest, ScoresTheFreeRunFirstWhereItIsNear) {
  const auto [gains, chi_square] = gains_with_friction(0.7);
  ASSERT_GT(chi_square, 2.0);
  ASSERT_LT(chi_square, 5.0);
  EXPECT_EQ(gains.front(), 0.0);
  EXPECT_GT(gains.size(), 1u);
}

TEST(RoundTest, ScoresTheFreeRunSecondWhereItIsClose) {
  const auto [gains, chi_square] = gains_with_friction(1.4);
  ASSERT_GT(chi_square, 5.0);
  ASSERT_LT(chi_square, 25.0);
  ASSERT_GE(gains.size(), 2u);
  EXPECT_GT(gains[0], 0.0);
  EXPECT_EQ(gains[1], 0.0);
}

TEST_F(RoundOfAModel, RemembersNothingOfAnotherModel) {
  RoundMemory memory;
  round({}, memory);
  model_.fit.parameters.front().value *= 1.0 + 1e-12;
  round({}, memory);
  EXPECT_TRUE(has_scored());
}

}  // namespace
}  // namespace axisfit
