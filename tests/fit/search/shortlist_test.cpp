#include "fit/search/shortlist.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "fit/criterion/gains.h"
#include "fit/search/tried.h"
#include "tests/fit/example.h"

namespace axisfit {
namespace {

std::set<std::string> names_in(const Shortlist& list, bool with_second = true) {
  std::set<std::string> names;
  for (const Scored& entry : list.entries)
    if (with_second || !entry.is_second) names.insert(entry.hypothesis->name);
  return names;
}

Job with_friction(double level) {
  Model<double> truth = slide();
  add_effect<CoulombFriction>(truth).F_c = level;
  return two_recordings(truth, slide(), {"M", "B_a"});
}

const std::vector<double> kValues{20.0, 30.0};

TEST(Shortlist, HasTheBestOfEachGainAndNothingThatIsChance) {
  const Job job = with_friction(0.5);
  const auto gains = score_gains(job);
  const Shortlist list = shortlist(job, kValues, gains, false);
  const std::set<std::string> names = names_in(list);
  EXPECT_TRUE(names.contains("coulomb_friction"));
  for (const Scored& entry : list.entries) EXPECT_GE(entry.gain, 6.0);
}

// Stribeck and Dahl friction have Coulomb friction as a limit, and a parameter more.
TEST(Shortlist, HasWhatASimplerEffectGainsAsWellAsSecond) {
  const Job job = with_friction(3.0);
  const Shortlist list = shortlist(job, kValues, score_gains(job), false);
  const std::set<std::string> first = names_in(list, false);
  EXPECT_TRUE(first.contains("coulomb_friction"));
  EXPECT_TRUE(names_in(list).contains("dahl_friction"));
  EXPECT_FALSE(first.contains("dahl_friction"));
  EXPECT_FALSE(first.contains("stribeck_friction"));
}

// A richer law that gains more may be what a plain one is taken for.
TEST(Shortlist, HearsThePlainLawBesideARicherOne) {
  Model<double> truth = slide();
  auto& friction = add_effect<StribeckFriction>(truth);
  friction.F_st = 12.0;
  friction.v_st = 0.1;
  const Job job = two_recordings(truth, slide(), {"M", "B_a"});
  SearchOptions options;
  options.shortlist.first = 1;
  options.shortlist.worth = options.shortlist.nearly_best = 1.0;
  const std::vector<double> gains{score_gains(job).back()};
  const Shortlist list = shortlist(job, kValues, gains, false, {.options = options});
  EXPECT_EQ(list.entries.front().hypothesis->name, "stribeck_friction");
  EXPECT_EQ(names_in(list), (std::set<std::string>{"stribeck_friction", "coulomb_friction"}));
  options.shortlist.worth_plain = 1.0;
  EXPECT_EQ(names_in(shortlist(job, kValues, gains, false, {.options = options})),
            std::set<std::string>{"stribeck_friction"});
}

// In a simulation that tracks, an effect that enters linearly gains what its score promises.
TEST(Shortlist, PromisesWhatTheAcceptanceTestFinds) {
  Job job = with_friction(3.0);
  job.options.criterion = Tracking{30.0};
  const FitResult fit = estimate(job);
  ASSERT_TRUE(fit.is_usable());
  const Shortlist list = shortlist(job, values_of(fit), score_gains(job), false);
  const auto entry = std::ranges::find_if(
      list.entries, [](const Scored& e) { return e.hypothesis->name == "coulomb_friction"; });
  ASSERT_NE(entry, list.entries.end());
  const Tried refitted = try_hypothesis(job, *entry);
  const double found = improvement(residual_series(job, fit), refitted.residuals).fit_gain;
  EXPECT_NEAR(entry->promise, found, 0.1 * found);
}

// Beyond the first three, and but for delays.
TEST(Shortlist, LeavesOutWhatGainsLessThanHalfOfTheBest) {
  const Job job = with_friction(3.0);
  SearchOptions options;
  options.shortlist.length = 1000;
  const Shortlist list =
      shortlist(job, kValues, {score_gains(job).front()}, false, {.options = options});
  const double best = list.entries.front().scaled_gain;
  for (std::size_t i = 3; i < list.entries.size(); ++i)
    EXPECT_TRUE(list.entries[i].scaled_gain >= 0.5 * best ||
                list.entries[i].hypothesis->kind == HypothesisKind::clock)
        << list.entries[i].hypothesis->name;
}

// At the gain that shows it best: a high one may hide most of what a low one tells.
TEST(Shortlist, KeepsTheGreaterOfTwoThatAreNearlyTheSame) {
  const auto friction = std::make_shared<Hypothesis>();
  friction->strengths = {quantity_index("coulomb_friction.F_c")};
  const auto of = [&](double strength, double gain) {
    Scored entry;
    entry.hypothesis = friction;
    entry.own.strengths = {strength};
    entry.scaled_gain = gain;
    Shortlist list;
    list.entries = {entry};
    return list;
  };
  for (const auto& [first, second] : {std::pair(5.0, 50.0), std::pair(50.0, 5.0)}) {
    Shortlist list = of(4.0, first);
    list.add(of(4.5, second), {});
    ASSERT_EQ(list.entries.size(), 1u);
    EXPECT_EQ(list.entries.front().scaled_gain, 50.0);
    EXPECT_EQ(list.entries.front().own.strengths.front(), first > second ? 4.0 : 4.5);
  }
  Shortlist list = of(4.0, 5.0);
  list.add(of(9.0, 50.0), {});
  EXPECT_EQ(list.entries.size(), 2u);
}

/// The entry of an effect; fails where there is none.
Scored entry_of(const Shortlist& list, std::string_view name) {
  const auto found = std::ranges::find_if(
      list.entries, [&](const Scored& e) { return e.hypothesis->name == name; });
  EXPECT_NE(found, list.entries.end()) << name;
  return found == list.entries.end() ? Scored{} : *found;
}

TEST(FitEntries, TellWhatAnEffectGainsAndWhereItStarts) {
  const Job job = with_friction(12.0);
  const double gain = search_gain(job);
  Shortlist list = shortlist(job, kValues, {score_gains(job).front()}, false);
  fit_entries(list, job, kValues, gain);
  const Scored fitted = entry_of(list, "coulomb_friction");
  EXPECT_TRUE(fitted.is_fitted);
  EXPECT_NEAR(fitted.own.strengths.front(), 12.0, 0.2);
  EXPECT_NEAR(fitted.others.front(), 20.0, 0.2);
  EXPECT_TRUE(list.has_most);
  EXPECT_FALSE(fitted.is_second);
  // As another law of as many numbers or more does no better, it comes first.
  for (const Scored& entry : list.entries) {
    if (entry.hypothesis->parameters() > 1 && entry.is_fitted) {
      EXPECT_TRUE(entry.is_second) << entry.hypothesis->name;
    }
  }
  // Once is enough.
  Shortlist again = list;
  fit_entries(again, job, {1.0, 1.0}, gain);
  EXPECT_EQ(entry_of(again, "coulomb_friction").scaled_gain, fitted.scaled_gain);
}

TEST(FitEntries, LeaveThoseOfInstrumentsAsTheyAre) {
  Model<double> truth = slide();
  truth.instruments[index_of(Signal::acceleration)].gain = 1.2;
  const Job job = two_recordings(truth, slide(), {"M", "B_a"});
  Shortlist list = shortlist(job, kValues, {score_gains(job).front()}, false);
  fit_entries(list, job, kValues, search_gain(job));
  EXPECT_FALSE(entry_of(list, "acceleration.gain").is_fitted);
}

}  // namespace
}  // namespace axisfit
