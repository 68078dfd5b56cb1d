#include "fit/estimate/profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "fit/solve/solve.h"
#include "tests/fit/example.h"

namespace axisfit {
namespace {

std::vector<Profile> all_profiles(const Job& job, const FitResult& fit) {
  std::vector<std::size_t> all(job.free.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return profiles(job, fit, all);
}

/// A slide of which mass and friction are fitted: a model that is all but linear.
Job slide_job() {
  Job job = two_recordings(slide(), slide(), {"M", "B_a"});
  job.recordings.pop_back();
  return job;
}

/// Half the fall of the likelihood when the parameter is held at the value, all others fitted.
double deviance_at(Job job, const FitResult& fit, std::size_t parameter, double value) {
  const ParameterSpace space(job);
  SolveOptions options;
  options.function_tolerance = 1e-14;
  options.fixed = {parameter};
  Eigen::VectorXd u = space.internal(values_of(fit));
  u[static_cast<Eigen::Index>(parameter)] = space.internal(parameter, value);
  const double inflation = fit.parameters[parameter].uncertainty.inflation;
  return (2.0 * solve(job, space, u, 0.0, options).cost -
          fit.at_solution->residuals.squaredNorm()) /
         (inflation * inflation);
}

TEST(Profile, OfALinearModelAgreesWithItsStandardErrors) {
  const Job job = slide_job();
  const FitResult fit = estimate(job);
  ASSERT_TRUE(fit.is_usable()) << fit.message;
  for (const Profile& profile : all_profiles(job, fit)) {
    SCOPED_TRACE(name_of(fit.parameters[profile.parameter].id));
    const ParameterResult& p = fit.parameters[profile.parameter];
    const ParameterUncertainty& u = p.uncertainty;
    EXPECT_FALSE(profile.lower.open);
    EXPECT_FALSE(profile.upper.open);
    EXPECT_FALSE(profile.better);
    EXPECT_NEAR(profile.lower.value, u.lower, 0.01 * (p.value - u.lower));
    EXPECT_NEAR(profile.upper.value, u.upper, 0.01 * (u.upper - p.value));
    for (const double end : {profile.lower.value, profile.upper.value})
      EXPECT_NEAR(deviance_at(job, fit, profile.parameter, end), profile.threshold,
                  0.01 * profile.threshold);
    EXPECT_TRUE(std::ranges::is_sorted(profile.points, {}, &ProfilePoint::value));
    EXPECT_GE(profile.points.size(), 5u);
  }
}

// A limit that is never reached could be any higher one: only the likelihood knows that side.
TEST(Profile, IsOpenWhereTheDataAreFlat) {
  const Model<double> truth = motor_axis();
  Job job = two_recordings(truth, truth, {"V_L", "B_a"});
  job.recordings = {recorded(truth, SineMotion{0.2, 1.0, 1.0}, 1.0, 3)};
  const FitResult fit = estimate(job);
  ASSERT_TRUE(fit.is_usable()) << fit.message;
  ASSERT_FALSE(fit.parameters[0].uncertainty.determined);
  const Profile limit = all_profiles(job, fit)[0];
  EXPECT_TRUE(limit.upper.open);
  EXPECT_DOUBLE_EQ(limit.upper.value, job.free[0].upper);
  EXPECT_FALSE(limit.lower.open);
  EXPECT_LT(limit.lower.value, 0.9 * fit.parameters[0].value);
  EXPECT_GT(limit.lower.value, job.free[0].lower);
}

TEST(Profile, OfWhatStandsAtItsBoundHasOneSide) {
  Job job = slide_job();
  job.model.structure.effects.set(*effect_named("coulomb_friction"));
  FreeParameter friction = free_parameter("coulomb_friction.F_c", 1.0);
  friction.scale = Scale::linear;
  friction.lower = 0.0;
  job.free.push_back(friction);
  // Noise decides on which side of zero the friction would end: take one that ends below.
  FitResult fit;
  for (std::uint64_t seed = 1;
       seed < 10 && !(fit.is_usable() && fit.parameters[2].uncertainty.at_bound); ++seed) {
    job.recordings = {recorded(slide(), fit_motion(), 1.2, seed)};
    fit = estimate(job);
  }
  ASSERT_TRUE(fit.parameters[2].uncertainty.at_bound);
  const Profile profile = all_profiles(job, fit)[2];
  EXPECT_EQ(profile.lower.value, 0.0);
  EXPECT_TRUE(profile.lower.open);
  const double upper = fit.parameters[2].uncertainty.upper;
  EXPECT_NEAR(profile.upper.value, upper, 0.05 * upper);
}

TEST(Profile, IsTheSameForAnyNumberOfThreads) {
  Job job = slide_job();
  const FitResult fit = estimate(job);
  const std::vector<Profile> one = all_profiles(job, fit);
  job.options.threads = 3;
  const std::vector<Profile> three = all_profiles(job, fit);
  for (std::size_t k = 0; k < one.size(); ++k) {
    EXPECT_EQ(one[k].lower.value, three[k].lower.value);
    EXPECT_EQ(one[k].upper.value, three[k].upper.value);
  }
}

// A profile that starts beside the minimum finds the way down, and says so.
TEST(Profile, TellsOfABetterFit) {
  Job job = slide_job();
  const FitResult minimum = estimate(job);
  FitResult fit = minimum;
  const ParameterSpace space(job);
  std::vector<double> beside = values_of(fit);
  beside[0] *= 1.02;
  fit.parameters[0].value = beside[0];
  fit.at_solution =
      std::make_shared<const Linearization>(linearize(job, space, space.internal(beside), 0.0));
  const std::vector<Profile> found = all_profiles(job, fit);
  ASSERT_TRUE(found[1].better);
  const StartResult& better = *found[1].better;
  EXPECT_TRUE(better.usable);
  EXPECT_EQ(better.from, beside);
  const auto reduced_cost_at = [&](const std::vector<double>& values) {
    const Eigen::VectorXd r = linearize(job, space, space.internal(values), 0.0).residuals;
    return r.squaredNorm() / static_cast<double>(r.size());
  };
  EXPECT_NEAR(better.reduced_cost, reduced_cost_at(better.to), 1e-9);
  EXPECT_LT(better.reduced_cost, reduced_cost_at(beside) - 0.1);
  // Of the points about one standard error from the minimum, where the sum of squares is one more.
  const double samples = static_cast<double>(fit.at_solution->residuals.size());
  EXPECT_NEAR(better.reduced_cost, reduced_cost_at(values_of(minimum)), 1.2 / samples);
}

}  // namespace
}  // namespace axisfit
