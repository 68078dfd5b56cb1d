#include "fit/judge/second_opinion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/fit/search/selection.h"

namespace axisfit {
namespace {

/// The slide, whose mass and friction are to be found.
Job job_of_slide() {
  Job job;
  job.options.threads = 1;
  job.model = slide();
  job.recordings = {recorded(slide(), fit_motion(), 1.2, 1)};
  job.free = {free_parameter("M", 15.0), free_parameter("B_a", 20.0)};
  return job;
}

const FitResult& fit_of_slide() {
  static const FitResult fit = estimate(job_of_slide());
  return fit;
}

TEST(SecondOpinion, AgreesWithAFitOfATrueModel) {
  const auto opinion = second_opinion(job_of_slide(), fit_of_slide());
  ASSERT_TRUE(opinion);
  EXPECT_TRUE(opinion->estimate.exact);
  EXPECT_EQ(opinion->estimate.parameters.size(), 2u);
  EXPECT_TRUE(opinion->contradictions.empty());
}

/// That of a fit whose mass is another by this factor.
std::vector<std::size_t> contradictions_at(double factor, FitResult fit = fit_of_slide()) {
  fit.parameters[0].value *= factor;
  return second_opinion(job_of_slide(), fit)->contradictions;
}

TEST(SecondOpinion, ContradictsWhereADifferenceIsFarBeyondTheErrorsAndLarge) {
  EXPECT_EQ(contradictions_at(1.3), std::vector<std::size_t>{0});
  EXPECT_EQ(contradictions_at(0.7), std::vector<std::size_t>{0});
  // Five errors of a well determined mass are less than that, and yet it hardly matters.
  ASSERT_LT(5.0 * fit_of_slide().parameters[0].uncertainty.standard_error, 1.0);
  EXPECT_TRUE(contradictions_at(1.07).empty());
}

TEST(SecondOpinion, ContradictsNothingThatIsNotKnown) {
  FitResult open = fit_of_slide();
  open.parameters[0].uncertainty.standard_error = 5.0;
  EXPECT_TRUE(contradictions_at(1.3, open).empty());
  open = fit_of_slide();
  open.parameters[0].uncertainty.determined = false;
  EXPECT_TRUE(contradictions_at(1.3, open).empty());
  open = fit_of_slide();
  open.verdict.kind = FitVerdict::Kind::no_minimum;
  EXPECT_TRUE(contradictions_at(1.3, open).empty());
}

TEST(SecondOpinion, IsNoneOfABalanceThatLeavesMuch) {
  HiddenEffect spring = hidden_effect_named("stroke_spring");
  FitResult other = fit_of_slide();
  other.parameters[0].value *= 3.0;
  const auto contradictions = [&](double stiffness) {
    spring.strengths[0].second = stiffness;
    Job job = job_of_slide();
    job.recordings = {recorded(spring.truth(), fit_motion(), 1.2, 1)};
    return second_opinion(job, other)->contradictions;
  };
  EXPECT_EQ(contradictions(1.0), std::vector<std::size_t>{0});
  EXPECT_TRUE(contradictions(1000.0).empty());
}

TEST(SecondOpinion, NeedsABalanceOfForces) {
  Job job = job_of_slide();
  job.free = {free_parameter("K_f", 40.0)};
  job.recordings[0].measurements.erase(job.recordings[0].measurements.begin(),
                                       job.recordings[0].measurements.end());
  EXPECT_FALSE(second_opinion(job, fit_of_slide()));
}

TEST(InverseStart, IsNotTriedWhereTheFitIsGood) {
  Job job = job_of_slide();
  FitResult fit = fit_of_slide();
  EXPECT_EQ(try_inverse_start(job, fit), InverseStart::not_tried);
  EXPECT_EQ(fit.parameters[0].value, fit_of_slide().parameters[0].value);
}

TEST(InverseStart, ReplacesAFitThatFoundNothing) {
  Job job = job_of_slide();
  job.options.starts = 3;
  FitResult fit = fit_of_slide();
  const std::size_t starts = fit.starts.size();
  fit.verdict.kind = FitVerdict::Kind::no_minimum;
  fit.parameters[0].value = 100.0;
  ASSERT_EQ(try_inverse_start(job, fit), InverseStart::better);
  EXPECT_TRUE(fit.is_usable());
  EXPECT_NEAR(fit.parameters[0].value, 20.0, 4.0 * fit.parameters[0].uncertainty.standard_error);
  EXPECT_GT(fit.starts.size(), starts) << "those before are told, too";
  EXPECT_EQ(job.options.starts, 3) << "as the user has them";
}

}  // namespace
}  // namespace axisfit
