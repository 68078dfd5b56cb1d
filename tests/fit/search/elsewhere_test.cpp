#include "fit/search/elsewhere.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "fit/estimate/estimate.h"
#include "fit/search/catalogue.h"
#include "tests/fit/search/selection.h"

namespace axisfit {
namespace {

Model<double> with_friction(double F_c) {
  Model<double> truth = slide();
  if (F_c != 0.0) add_effect<CoulombFriction>(truth).F_c = F_c;
  return truth;
}

/// A recording to fit, and one to validate, of machines with so much Coulomb friction.
FittedModel declared_model(double to_fit, double to_validate) {
  Job job = two_recordings(with_friction(to_fit), slide(), {"M", "B_a"});
  job.recordings[1] =
      two_recordings(with_friction(to_validate), slide(), {"M", "B_a"}).recordings[1];
  FitResult fit = estimate(job);
  return {"", std::move(job), std::move(fit)};
}

/// Coulomb friction, refitted, as a test of validation left it.
Tried refit_of(const FittedModel& model, Rejection::Test test) {
  const SearchScales scales{-0.05, 0.2, 1.0, -1.0, 1.0, 0.0, 1.2, 1e-3};
  const std::vector<Hypothesis> all = catalogue(model.job, scales);
  Scored start;
  start.hypothesis = std::make_shared<const Hypothesis>(
      *std::ranges::find(all, "coulomb_friction", &Hypothesis::name));
  start.own = {{3.0}, {}};
  start.others = values_of(model.fit);
  Tried refit = try_hypothesis(model.job, start);
  judge(refit, residual_series(model.job, model.fit), {});
  refit.rejection = Rejection{.test = test};
  return refit;
}

/// Asked of the recording to validate, and what was computed for that.
struct Asked {
  Tried refit;
  ElsewhereMemory memory{};
};
Asked asked(const FittedModel& model, Rejection::Test test) {
  std::vector<Tried> refits{refit_of(model, test)};
  ElsewhereMemory memory;
  ask_elsewhere(model, refits, {}, memory, {});
  return {std::move(refits.front()), std::move(memory)};
}

TEST(AskElsewhere, AcceptsWhatTheRecordingsToValidateTellByThemselves) {
  const auto [refit, memory] = asked(declared_model(5.0, 5.0), Rejection::Test::validation);
  EXPECT_FALSE(refit.rejection);
  ASSERT_TRUE(refit.replication);
  EXPECT_NEAR(refit.replication->parameters[0].value, 5.0, 0.2);
  EXPECT_EQ(memory.fits.size(), 1u);
}

TEST(AskElsewhere, AcceptsNothingThatTheseTellOtherwise) {
  const Tried refit = asked(declared_model(5.0, 0.0), Rejection::Test::validation).refit;
  ASSERT_TRUE(refit.rejection);
  EXPECT_EQ(refit.rejection->test, Rejection::Test::validation);
  EXPECT_FALSE(refit.on_blocks);
}

TEST(AskElsewhere, AsksHeldOutBlocksOfWhatTheseCannotShow) {
  const auto [refit, memory] = asked(declared_model(5.0, 0.0), Rejection::Test::power);
  EXPECT_FALSE(refit.rejection);
  EXPECT_TRUE(refit.on_blocks);
  ASSERT_TRUE(memory.on_blocks);
  for (const ResidualSeries& series : *memory.on_blocks) EXPECT_EQ(series.recording, 0u);
}

TEST(AskElsewhere, AsksOnlyForTheFirstFewWhereTheFittedRecordingsHoldNothing) {
  for (const double to_fit : {0.0, 5.0}) {
    const FittedModel model = declared_model(to_fit, 0.0);
    std::vector<Tried> refits(5, refit_of(model, Rejection::Test::validation));
    ElsewhereMemory memory;
    int groups = 0;
    const SearchContext context{{}, {nullptr, nullptr, [&](const Progress&) { ++groups; }}};
    ask_elsewhere(model, refits, {}, memory, context);
    EXPECT_EQ(groups, to_fit == 0.0 ? 1 : 3);
  }
}

}  // namespace
}  // namespace axisfit
