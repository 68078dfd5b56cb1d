#include <gtest/gtest.h>

#include <initializer_list>
#include <string>
#include <utility>

#include "report/text/report_text.h"
#include "tests/report/found.h"

namespace axisfit {
namespace {

/// A job with these free parameters, and nothing else.
Job with_free(std::initializer_list<const char*> names) {
  Job job;
  for (const char* name : names) job.free.emplace_back().quantity = quantity_index(name);
  return job;
}

TEST(UncertaintyTextTest, StrongCorrelationsOfEitherSignAreNamed) {
  const Job job = with_free({"M", "B_a", "K_f"});
  FitResult fit;
  fit.reduced_chi_square = 1.0;
  fit.correlation = Eigen::Matrix3d{{1.0, 0.96, -0.98}, {0.96, 1.0, 0.94}, {-0.98, 0.94, 1.0}};
  EXPECT_NE(on_one_line(uncertainty_text(job, fit))
                .find("Strongly correlated: M and K_f (-0.98), M and B_a (0.96)."),
            std::string::npos)
      << uncertainty_text(job, fit);
}

TEST(UncertaintyTextTest, SaysWhatNoiseIsAssumed) {
  const Job job = rubbing_file().job;
  FitResult fit;
  const auto told = [&] { return on_one_line(uncertainty_text(job, fit)); };
  fit.reduced_chi_square = 1.0;
  EXPECT_EQ(told(),
            "Standard errors and intervals assume noise as stated below, uncorrelated in time.");
  fit.reduced_chi_square = 6.25;
  fit.autocorrelation_time = 12.34;
  EXPECT_EQ(told(),
            "Standard errors and intervals assume residuals as observed, 2.5 times the noise, with "
            "an autocorrelation time of up to 12.3 samples.");
  fit.input_part = 0.1;
  EXPECT_EQ(told().find("of their squares"), std::string::npos) << "5 % of an error";
  fit.input_part = 0.25;
  EXPECT_NE(told().find(", which makes up to 25 % of their squares."), std::string::npos) << told();
}

TEST(UncertaintyTextTest, RemarksOnAnEstimateFarFromItsInitialValue) {
  Job job = with_free({"M"});
  job.free[0].initial = 6.0;
  job.free[0].scale = Scale::from_zero;
  FitResult fit;
  fit.reduced_chi_square = 1.0;
  fit.parameters.push_back({job.free[0].id(), 0.012, {.determined = true}});
  const auto told = [&] { return on_one_line(uncertainty_text(job, fit)); };
  EXPECT_NE(told().find("M: 0.002 times the initial value; if that was about right, a unit"),
            std::string::npos)
      << told();
  fit.parameters[0].value = 0.6;
  EXPECT_EQ(told().find("times the initial value"), std::string::npos) << "a poor guess";
  fit.parameters[0].value = 0.012;
  fit.parameters[0].uncertainty.determined = false;
  EXPECT_EQ(told().find("times the initial value"), std::string::npos);
}

TEST(UncertaintyTextTest, RemarksOnAnEstimateThatTheOtherHoldMoves) {
  Job job = with_free({"M"});
  job.recordings.emplace_back().command.hold = Hold::linear;
  FitResult fit;
  fit.reduced_chi_square = 1.0;
  fit.parameters.push_back({job.free[0].id(), 12.0, {.determined = true}});
  fit.parameters[0].other_hold = HoldShift{11.5, false};
  const auto told = [&] { return on_one_line(uncertainty_text(job, fit)); };
  EXPECT_NE(told().find("M: 11.5 kg if each value of the input held until the next ('hold: "
                        "zero_order'), which these recordings do not exclude."),
            std::string::npos)
      << told();
  job.recordings[0].command.hold = Hold::zero_order;
  fit.parameters[0].other_hold->is_better = true;
  EXPECT_NE(told().find("if the input went straight from one sample to the next ('hold: linear'), "
                        "which explains these recordings better."),
            std::string::npos)
      << told();
}

TEST(UncertaintyTextTest, NamesThreeCorrelationsAndCountsTheOthers) {
  const Job job = with_free({"M", "B_a", "K_f", "F_s"});
  FitResult fit;
  fit.reduced_chi_square = 1.0;
  fit.correlation = Eigen::MatrixXd::Constant(4, 4, 0.99);
  fit.correlation.diagonal().setOnes();
  EXPECT_NE(on_one_line(uncertainty_text(job, fit)).find(" (0.99), and 3 more pairs."),
            std::string::npos)
      << uncertainty_text(job, fit);
}

TEST(UncertaintyTextTest, NamesWhatIsKnownOfParametersTogether) {
  const Job job = with_free({"K_f", "k_g", "M"});
  Identifiability known;
  EXPECT_EQ(identifiability_text(job, known), "");
  known.weak = {{0.1, {{0, 1.0, 0.1, true}}, {}}};
  known.combinations = {{1, 2, -1.0, 34246.0, 120.0}};
  EXPECT_EQ(identifiability_text(job, known),
            "  K_f hardly affects these recordings.\n  k_g / M = 34246 +- 1.2e+02\n");
}

/// A fit of the rubbing mass, by hand.
RunResult fitted() {
  RunResult run_result;
  run_result.baseline = rubbing_file().job;
  run_result.first.parameters = {estimated("M", 4.0, 0.1), estimated("B_a", 8.0, 0.0)};
  run_result.grade.grade = Grade::explained;
  return run_result;
}

TEST(UncertaintyTextTest, MeaningsSayWhatIsNotDetermined) {
  const RunResult run_result = fitted();
  const auto told = [&](ParameterUncertainty second) {
    return on_one_line(
        meanings_text(run_result.baseline, {{.determined = true}, std::move(second)}));
  };
  EXPECT_EQ(told({.determined = true}), "M arm mass B_a arm viscous friction");
  EXPECT_EQ(told({}), "M arm mass B_a arm viscous friction: not determined");
  EXPECT_EQ(told({.determined = true, .weak = true}),
            "M arm mass B_a arm viscous friction: weakly determined");
  EXPECT_EQ(told({.at_bound = true}), "M arm mass B_a arm viscous friction: at bound");
}

TEST(UncertaintyTextTest, ProfilesStandBesideStandardErrors) {
  RunResult run_result = fitted();
  EXPECT_EQ(profiles_text(run_result), "");
  Profile profile;
  profile.lower.value = 3.75;
  profile.upper.open = true;
  run_result.profiles = {profile};
  EXPECT_EQ(on_one_line(profiles_text(run_result)),
            "95 % intervals value from profile from standard error unit M 4.00 3.75 .. open 3.80 "
            ".. 4.20 kg");
  run_result.profiles[0].parameter = 1;
  EXPECT_NE(on_one_line(profiles_text(run_result)).find(" open - N s/m"), std::string::npos)
      << profiles_text(run_result);
}

TEST(UncertaintyTextTest, ASecondOpinionStandsInForAFitThatIsNotUsable) {
  RunResult run_result = fitted();
  EXPECT_EQ(second_opinion_text(run_result), "");
  SecondOpinion& opinion = run_result.second_opinion.emplace();
  InverseEstimate mass;
  static_cast<ParameterResult&>(mass) = estimated("M", 5.0, 0.25);
  opinion.estimate.parameters = {mass};
  opinion.estimate.residual = 3.0;
  opinion.estimate.drive_rms = 24.0;
  EXPECT_EQ(second_opinion_text(run_result), "") << "it agrees";
  run_result.grade.grade = Grade::model_wrong;
  EXPECT_EQ(on_one_line(second_opinion_text(run_result)),
            "Inverse dynamics, without a simulation: M = 5.00 +- 0.25 kg. 12 % of the drive "
            "force remain unexplained.");
  run_result.grade.grade = Grade::usable;
  opinion.contradictions = {0};
  EXPECT_EQ(on_one_line(second_opinion_text(run_result)),
            "Second opinion: inverse dynamics, without a simulation, says M = 5.00 +- 0.25 kg "
            "(fit: 4.00 +- 0.1 kg). They differ by far more than their errors: what the model "
            "lacks acts on the two in different ways.");
}

TEST(UncertaintyTextTest, AForecastNeedsASimulation) {
  EXPECT_EQ(on_one_line(forecast_text(rubbing_file().job, {})),
            "Identifiability could not be checked: with the initial values the simulation does not "
            "finish.");
}

}  // namespace
}  // namespace axisfit
