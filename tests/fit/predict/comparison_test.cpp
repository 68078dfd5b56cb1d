#include "fit/predict/comparison.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "fit/data/noise.h"
#include "fit/run.h"
#include "tests/fit/scattering.h"

namespace axisfit {
namespace {

/// A model with a parameter of each name, fitted to the first of the recordings.
ModelEntry entry(const std::string& name, Job job, const std::vector<const char*>& free) {
  std::erase_if(job.free, [&](const FreeParameter& p) {
    return std::ranges::none_of(
        free, [&](const std::string& n) { return n == job.entry(p.quantity).name; });
  });
  FitResult fit = estimate(job);
  std::vector<MissingForce> forces;
  for (std::size_t r = 0; r < job.recordings.size(); ++r)
    forces.push_back(missing_force(job, fit, r));
  return {name, std::move(job), std::move(fit), {}, std::move(forces)};
}

TEST(Comparison, PrefersWhatPredictsAndElseWhatIsSimple) {
  Job job = scattering_machine(3, 0.0, 4, 3.0);
  for (std::size_t r = 1; r < 3; ++r) job.recordings[r].role = Role::validate;
  add_effect<QuadraticDrag>(job.model);
  FreeParameter drag = free_parameter("quadratic_drag.c", 1.0);
  drag.scale = Scale::linear;
  drag.lower = -100.0;
  drag.initial = 0.0;
  job.free.push_back(drag);
  // The starting values of the others are wrong: B_a is 30 instead of 40 N s/m.
  job.model.axis.B_a = 30.0;
  const std::vector<ModelEntry> models{entry("mass", job, {"M"}), entry("both", job, {"M", "B_a"}),
                                       entry("all", job, {"M", "B_a", "quadratic_drag.c"})};
  const auto found = compare_models(models);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->models.size(), 3u);
  EXPECT_EQ(found->models[found->preferred].name, "both");
  EXPECT_GT(found->models[0].log_ratio, 4.0 * found->models[0].log_ratio_error);
  EXPECT_LT(std::abs(found->models[2].log_ratio), 0.05);
  EXPECT_EQ(found->models[0].windows_lost, found->windows);
  EXPECT_EQ(found->horizons.back(), 0.0);
  EXPECT_EQ(found->models[1].free_running.size(), found->horizons.size());
  // The noise, and no more.
  const double sigma = usual_noise(Signal::velocity),
               scale = standard_deviation(job.recordings[1].measurements[0].values);
  EXPECT_NEAR(found->models[1].free_running.back(), sigma / scale, 0.05 * sigma / scale);
  EXPECT_GT(found->models[0].bic, found->models[1].bic + 100.0);
  EXPECT_LT(found->models[1].bic, found->models[2].bic);
  EXPECT_GT(found->models[0].missing_force, 3.0 * found->models[1].missing_force);
}

TEST(Comparison, KnowsOfTheFinalModelWhatItsBandsKnow) {
  Job job = scattering_machine(6, 0.05, 3);
  job.recordings.back().role = Role::validate;
  RunOptions options{.predict = true};
  options.compare = true;
  const RunResult result = run(std::move(job), options);
  ASSERT_TRUE(result.comparison);
  const double inside = result.predictions.front().signals.front().inside_percent;
  ASSERT_LT(inside, 100.0);  // or there is nothing to compare
  EXPECT_DOUBLE_EQ(result.comparison->models.front().inside_percent, inside);
}

TEST(Comparison, NeedsARecordingToValidate) {
  const Job job = scattering_machine(2, 0.0, 4);
  EXPECT_FALSE(compare_models({entry("both", job, {"M", "B_a"})}));
  EXPECT_FALSE(compare_models({}));
}

/// A model that is taken as it is.
ModelEntry as_it_is(const Job& job, const Model<double>& model) {
  ModelEntry entry{"", with_model(job, model), {}};
  entry.fit = evaluated(entry.job);
  entry.forces.resize(job.recordings.size());
  return entry;
}

/// Two recordings of three seconds to validate.
Job two_to_validate() {
  Job job = scattering_machine(2, 0.0, 4, 3.0);
  for (Recording& r : job.recordings) r.role = Role::validate;
  return job;
}

TEST(Comparison, GoesByTheLongestHorizonThatLeavesEightWindows) {
  const Job job = two_to_validate();
  Model<double> wrong = job.model;
  wrong.axis.B_a = 30.0;
  const auto found = compare_models({as_it_is(job, wrong), as_it_is(job, job.model)});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->horizons, (std::vector{0.03, 0.1, 0.3, 0.0}));
  EXPECT_EQ(found->judged, 0.3);
  EXPECT_EQ(found->windows, 20);
  EXPECT_EQ(found->preferred, 1u);
  EXPECT_EQ(found->models[0].windows_lost, 20);
  EXPECT_EQ(found->models[1].windows_lost, 0);
  EXPECT_EQ(found->models[1].log_ratio, 0.0);
  // What is wrong adds up.
  EXPECT_TRUE(std::ranges::is_sorted(found->models[0].free_running));
  EXPECT_GT(found->models[0].free_running.back(), 5.0 * found->models[0].free_running.front());
  // Nothing was fitted, and no band is asked for.
  EXPECT_TRUE(std::isnan(found->models[1].bic));
  EXPECT_EQ(found->models[1].curves, 0);
}

TEST(Comparison, DoesNotPreferWhatCannotBeSimulated) {
  const Job job = two_to_validate();
  Model<double> broken = job.model;
  broken.axis.M = std::nan("");
  const auto found = compare_models({as_it_is(job, broken), as_it_is(job, job.model)});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->preferred, 1u);
  EXPECT_TRUE(std::isnan(found->models[0].free_running.back()));
  EXPECT_FALSE(compare_models({as_it_is(job, broken)}));
}

TEST(WithModel, KeepsWhatTheRecordingsHave) {
  Job job = two_to_validate();
  job.model.structure.closed_loop = true;
  job.model.structure.channels = kept({{"temperature", "degC", 20.0}});
  const Job other = with_model(job, paper_axis());
  EXPECT_TRUE(other.free.empty());
  EXPECT_EQ(other.model.axis.M, paper_axis().axis.M);
  EXPECT_EQ(other.model.structure.transmission, paper_axis().structure.transmission);
  EXPECT_TRUE(other.model.structure.closed_loop);
  EXPECT_EQ(other.model.structure.channels, job.model.structure.channels);
}

}  // namespace
}  // namespace axisfit
