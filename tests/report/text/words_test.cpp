#include "report/text/words.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

namespace axisfit {
namespace {

TEST(WordsTest, OfARecordingOfAnotherDay) {
  RunResult result;
  result.baseline.recordings.emplace_back().name = "later";
  result.baseline.free = {free_parameter("constant_force.F_0", 5.0)};
  result.first.parameters.push_back({result.baseline.free[0].id(), 5.0, {.determined = true}});
  result.first.verdict.kind = FitVerdict::Kind::usable;
  result.grade = {.grade = Grade::explained, .reason = FitGrade::Reason::none};
  EXPECT_EQ(overall_verdict(result).find("another day"), std::string::npos);
  OtherDay& day = result.other_days.emplace_back();
  day.differing = {0};
  day.parameters.push_back(
      {result.baseline.free[0].id(), 40.0, {.determined = true, .standard_error = 0.1}});
  day.percent_before = 12.3;
  day.percent = 0.45;
  const std::string text = overall_verdict(result);
  EXPECT_NE(text.find("later differs from the fitted recordings: with constant_force.F_0 = "
                      "40.00 instead of 5.00 N, found in its first half, the model leaves 0.45 % "
                      "of the drive force "
                      "of the second half unexplained, and not 12 %. The grade counts it so."),
            std::string::npos)
      << text;
}

TEST(WordsTest, OfTheGradeOfAFit) {
  using enum FitVerdict::Kind;
  using Reason = FitGrade::Reason;
  Job job;
  for (const char* name : {"levels", "step"}) job.recordings.emplace_back().name = name;
  FitResult fit;
  EXPECT_EQ(grade_text(job, {}, fit),
            "Not converged: the simulation does not finish at the initial values. Check them and "
            "the axis file for impossible values.");
  fit.verdict = {.kind = no_minimum, .iteration_limit = 50};
  EXPECT_EQ(grade_text(job, {}, fit),
            "Not converged: no minimum was found within 50 iterations. Try --starts 20, or free "
            "fewer parameters.");
  fit.verdict = {.kind = usable};
  EXPECT_EQ(grade_text(job, {Grade::nothing_determined, Reason::parameters}, fit),
            "Nothing determined: these recordings determine none of the free parameters. Record a "
            "motion that shows them, or free fewer.");
  const FitGrade badly{Grade::model_wrong, Reason::simulation, 1, Signal::acceleration, 23.4};
  EXPECT_EQ(grade_text(job, badly, fit),
            "Model wrong: the free-running simulation follows the acceleration of step to only 23 "
            "%. Check the units and signs of the columns, and try other initial values or --starts "
            "20.");
  FitGrade worse = badly;
  worse.percent = -5.0;
  EXPECT_NE(grade_text(job, worse, fit).find("step no better than a constant. Check"),
            std::string::npos);
  worse.percent = NAN;
  EXPECT_NE(grade_text(job, worse, fit).find("simulation of step does not finish. Check"),
            std::string::npos);
  EXPECT_EQ(
      grade_text(job, {Grade::model_wrong, Reason::force, 1, Signal::velocity, 181.2}, fit),
      "Model wrong: the force that the model lacks in step is 181 % of the drive's. Check the "
      "units and signs of the columns and what the axis file declares.");
  FitGrade drifts = badly;
  drifts.grade = Grade::usable;
  drifts.reason = Reason::drift;
  drifts.uses = {.missing_force_percent = 3.21, .force_recording = 1};
  EXPECT_EQ(grade_text(job, drifts, fit),
            "Usable for forces: the model leaves 3.2 % of the drive force of step unexplained. The "
            "free-running simulation follows the acceleration of step to only 23 %: do not "
            "simulate with it for long.");
  fit.reduced_chi_square = 1.00251;
  EXPECT_EQ(grade_text(job, {Grade::usable, Reason::residual, 1}, fit),
            "Usable: reduced chi-square 1.003 on the fitted data.");
  const FitUses both{2.0, 1, 0.83};
  EXPECT_EQ(grade_text(job, {Grade::usable, Reason::residual, 1, {}, 0.0, both}, fit),
            "Usable: the model leaves 2 % of the drive force of step unexplained; a free run stays "
            "within 1 % of the range for 0.83 s. Reduced chi-square 1.003 on the fitted data.");
  fit.verdict.undetermined = {{quantity_index("V_L")}, {quantity_index("k_g"), 1}};
  EXPECT_EQ(grade_text(job, {Grade::explained, Reason::none}, fit),
            "Explained: reduced chi-square 1.003 on the fitted data, and no signal shows more than "
            "its noise. These recordings do not determine V_L, k_g@step.");
}

TEST(WordsTest, OfWhatASearchComesTo) {
  using enum SelectionVerdict::Kind;
  EffectSelection selection;
  EXPECT_EQ(verdict_text(selection),
            "No effects were looked for: a search had no fit to start from.");
  selection.verdict.kind = nothing_missing;
  EXPECT_EQ(verdict_text(selection),
            "Nothing is missing: the baseline model explains every signal down to its noise.");
  selection.verdict.kind = stopped;
  EXPECT_EQ(verdict_text(selection),
            "The search for missing effects was stopped: no effect has been accepted so far.");
  selection.verdict.kind = none_passes;
  EXPECT_EQ(verdict_text(selection),
            "Something is missing, but no effect that axisfit knows comes near it.");
  selection.effects.resize(1);
  EXPECT_EQ(verdict_text(selection),
            "Something is missing, but no effect passes the tests: see the reasons.");
  selection.verdict = {
      .kind = misfit, .at_bound = ParameterId{quantity_index("M")}, .force_percent = 0.0};
  EXPECT_EQ(verdict_text(selection),
            "The declared model does not fit: M is at its bound. Nothing can be said about effects "
            "yet.");
  selection.result.job.recordings.resize(2);
  selection.result.job.recordings[1].name = "train";
  selection.verdict = {.kind = misfit, .recording = 1, .force_percent = 91.23};
  EXPECT_EQ(verdict_text(selection),
            "The declared model does not fit: of train, 91.2 % of the drive force is missing. "
            "Nothing can be said about effects yet.");
  selection.verdict = {.kind = hardly_anything, .small = {"spring"}};
  EXPECT_EQ(verdict_text(selection),
            "Hardly anything is missing: spring is significant, but hardly lowers the validation "
            "error.");
  selection.verdict = {
      .kind = effects_accepted, .accepted = {"added_mass"}, .validate_percent = 12.345};
  EXPECT_EQ(verdict_text(selection),
            "The model lacked added_mass. With it, the validation error falls by 12.3 %, but not "
            "down to the noise.");
  selection.verdict = {.kind = effects_accepted,
                       .accepted = {"added_mass", "drive_lag"},
                       .undecided = {"spring", "position.gain"},
                       .validate_percent = 99.96};
  selection.explained = true;
  selection.substitutions = {{"spring", "position.gain", {}, {}}};
  for (const char* added : {"", "added_mass", "spring", "drive_lag"})
    selection.models.push_back({added, {}, {}});
  EXPECT_EQ(verdict_text(selection),
            "The model lacked added_mass, drive_lag. Undecided: spring or position.gain; these "
            "recordings do not tell which. With added_mass, spring, drive_lag, the validation "
            "error falls by 100 %, and every signal is explained down to its noise.");
  selection.substitutions.clear();
  selection.verdict = {.kind = effects_accepted,
                       .accepted = {"T_z", "spring"},
                       .corrections = {{{quantity_index("T_z")}, 7.05e-3, 7.9989e-3}},
                       .validate_percent = 71.4};
  EXPECT_EQ(verdict_text(selection),
            "T_z is 0.007999 s, not the 0.00705 s of the axis file. The model lacked spring. With "
            "them, the validation error falls by 71.4 %, and every signal is explained down to its "
            "noise.");
  selection.substitutions.push_back({"T_z", "velocity.delay", {}, {}});
  selection.verdict.corrections.clear();
  EXPECT_EQ(verdict_text(selection),
            "The model lacked T_z, spring. With them, the validation error falls by 71.4 %, and "
            "every signal is explained down to its noise. These recordings do not tell T_z from "
            "velocity.delay.");
  selection.substitutions.clear();
  Outcome curve;
  curve.hypothesis.name = "friction_over_velocity";
  curve.closed_form = ClosedForm{
      {{5.031, 0.18, "N", "exp(-|v| / 0.2 m/s)"}, {-8.2, 0.42, "N s^2/m^2", "|v|^2"}}, 7.0, 9.0};
  selection.effects.push_back(curve);
  EXPECT_EQ(verdict_text(selection),
            "The model lacked T_z, spring. With them, the validation error falls by 71.4 %, and "
            "every signal is explained down to its noise. friction_over_velocity is explained as "
            "well by (5.03 +- 0.18) N exp(-|v| / 0.2 m/s) + (-8.20 +- 0.42) N s^2/m^2 |v|^2.");
  selection.effects.clear();
  selection.verdict = {.kind = undecided,
                       .undecided = {"spring", "position.gain", "stroke_friction"},
                       .validate_percent = 50.0};
  selection.substitutions = {{"spring", "position.gain", {}, {}},
                             {"spring", "stroke_friction", {}, {}}};
  selection.models = {{"", {}, {}}, {"spring", {}, {}}};
  selection.explained = false;
  EXPECT_EQ(verdict_text(selection),
            "Undecided: spring or position.gain or stroke_friction; these recordings do not tell "
            "which. With spring, the validation error falls by 50 %, but not down to the noise.");
}

/// An axis on which a constant has another name or unit than in the sources.
struct OtherName {
  const char* quantity;  ///< as the sources call it
  Structure structure;
  const char *name, *unit;
};

TEST(WordsTest, OfAConstantAreThoseOfTheAxis) {
  for (const OtherName& other :
       {OtherName{
            "coulomb_friction.F_c", {.joint = Joint::revolute}, "coulomb_friction.T_c", "N m"},
        OtherName{"K_f", {.drive = Drive::motor_current}, "K_f", "N/A"},
        OtherName{"r_g", {.gearing = Gearing::turns}, "lead", "m"},
        OtherName{"channel_force.k_2",
                  {.channels = kept({{"pressure", "bar"}, {"temperature", "K"}})},
                  "channel_force.temperature",
                  "N/K"}}) {
    EffectSelection selection;
    selection.result.job.model.structure = other.structure;
    selection.verdict = {.kind = SelectionVerdict::Kind::effects_accepted,
                         .accepted = {other.name, "spring"},
                         .corrections = {{{quantity_index(other.quantity)}, 0.5, 0.75}},
                         .validate_percent = 50.0};
    EXPECT_EQ(verdict_text(selection),
              fmt::format("{0} is 0.75 {1}, not the 0.5 {1} of the axis file. The model lacked "
                          "spring. With them, the validation error falls by 50 %, but not down to "
                          "the noise.",
                          other.name, other.unit));
  }
}

TEST(WordsTest, OfARunNameTheFitOnce) {
  RunResult run_result;
  run_result.first.verdict.kind = FitVerdict::Kind::usable;
  run_result.first.reduced_chi_square = 2.5;
  run_result.grade = {Grade::usable, FitGrade::Reason::residual};
  EXPECT_EQ(overall_verdict(run_result), "Usable: reduced chi-square 2.5 on the fitted data.");
  run_result.selection.emplace();
  run_result.selection->result.fit = run_result.first;
  run_result.selection->verdict.kind = SelectionVerdict::Kind::none_passes;
  run_result.selection->effects.resize(1);
  EXPECT_EQ(overall_verdict(run_result),
            "Usable. Something is missing, but no effect passes the tests: see the reasons.");
}

TEST(WordsTest, OfTheDecisionOnAnEffect) {
  using enum Rejection::Test;
  const ParameterId shape_id{quantity_index("stribeck_friction.v_st")};
  Outcome trial;
  const auto rejected = [&](const Rejection& rejection) {
    trial.rejection = rejection;
    return reason_text(Job(), trial);
  };
  EXPECT_EQ(rejected({.test = fit}), "there is no usable fit with it");
  EXPECT_EQ(rejected({.test = simulation}),
            "with it the simulation does not finish for all recordings");
  EXPECT_EQ(rejected({.test = significance, .found = 8.0, .required = 16.8114, .tried = 100}),
            "no better than chance: the sum of squares falls by 8, where the best of 100 effects "
            "needs 16.8");
  EXPECT_EQ(rejected({.test = validation, .found = 0.0625}),
            "does not lower the validation error (p = 0.062)");
  EXPECT_EQ(rejected({.test = validation_size, .found = 0.3}),
            "hardly lowers the validation error, by 0.3 %");
  EXPECT_EQ(rejected({.test = bound, .parameter = shape_id}),
            "stribeck_friction.v_st is at its bound");
  EXPECT_EQ(rejected({.test = shape, .parameter = shape_id}),
            "the recordings do not determine stribeck_friction.v_st");
  EXPECT_EQ(rejected({.test = distinct}),
            "it cannot be distinguished from a change of the other parameters");
  EXPECT_EQ(rejected({.test = strength, .found = 3.0}),
            "its strength is not determined: 3 standard errors from zero");
  EXPECT_EQ(
      rejected({.test = share, .found = 7.56}),
      "lowers the validation error beyond the noise by no more than 7.6 %, where most remains "
      "unexplained: it may imitate what is missing");
  EXPECT_EQ(rejected({.test = power, .found = 0.2}),
            "cannot be judged: the recordings to validate hardly show it (p = 0.2)");

  trial.other = "drive_lag";
  trial.improvement.validate_percent = 12.345;
  trial.improvement.z = 7.5;
  const auto decided = [&](Reason reason) {
    trial.reason = reason;
    return reason_text(Job(), trial);
  };
  EXPECT_EQ(decided(Reason::explains_best),
            "explains the residual best: 12.3 % lower validation error (7.5 standard deviations "
            "above chance)");
  EXPECT_EQ(decided(Reason::explains_beside),
            "explains the residual together with drive_lag, without which it is hidden: 12.3 % "
            "lower validation error (7.5 standard deviations above chance)");
  EXPECT_EQ(decided(Reason::explains_less), "explains less than drive_lag");
  EXPECT_EQ(decided(Reason::replaced), "explains less than drive_lag, which replaced it");
  EXPECT_EQ(decided(Reason::explains_equally), "explains these recordings as well as drive_lag");
  EXPECT_EQ(decided(Reason::not_needed), "no longer needed with the effects accepted after it");
  EXPECT_EQ(decided(Reason::falls_with), "stood or fell with drive_lag, which was taken out again");
}

TEST(WordsTest, OfMovesSayWhetherTheErrorAllowsForThem) {
  ParameterResult friction;
  EXPECT_TRUE(moves_text(friction, "N s/m").empty());
  friction.budget.gain = {100.0, 157.25};
  friction.budget.rival = {"velocity.gain", "added_mass", 17.6};
  friction.uncertainty.determined = true;
  EXPECT_EQ(
      moves_text(friction, "N s/m"),
      (std::vector<std::string>{
          "157.2 N s/m at an observer gain of 100 1/s, which its error allows for",
          "17.6 N s/m with added_mass in place of velocity.gain, which its error allows for"}));
  friction.uncertainty.determined = false;
  EXPECT_EQ(moves_text(friction, "N s/m").front(),
            "157.2 N s/m at an observer gain of 100 1/s, which leaves it open");
}

TEST(WordsTest, OfAWeakDirection) {
  Job job;
  job.free = {free_parameter("initial.y0", 0.0), free_parameter("M", 20.0),
              free_parameter("k_g", 4e6)};
  WeakDirection weak;
  weak.parts = {{.parameter = 2}};
  EXPECT_EQ(weak_direction_text(job, weak), "k_g hardly affects these recordings.");
  weak.parts = {{.parameter = 2, .tenth = 0.0733, .relative = true},
                {.parameter = 0, .tenth = -0.02}};
  EXPECT_EQ(weak_direction_text(job, weak),
            "These can change jointly with hardly any effect: k_g by +7.3 %, initial.y0 by -0.02.");
  weak.parts[1].parameter = 1;
  for (const auto& [exponent, combination] :
       {std::pair{-1.02, "k_g / M"}, {0.97, "k_g M"}, {0.5, "k_g M^0.5"}}) {
    weak.combination = Combination{2, 1, exponent};
    EXPECT_EQ(weak_direction_text(job, weak),
              std::string("k_g and M are determined only as ") + combination + ".");
  }
}

TEST(WordsTest, OfMotions) {
  EXPECT_EQ(motion_text(StepMotion{-10.0, 0.0}, kSourceVocabulary), "a step of -10 V");
  for (const double u : {2.0, -2.0}) {
    const std::string volts = u > 0.0 ? "2 V" : "-2 V";
    EXPECT_EQ(motion_text(LevelsMotion{{u, -u, 0.5 * u, -0.5 * u, 0.2 * u, -0.2 * u, 0.0}, 0.625},
                          kSourceVocabulary),
              "levels of " + volts +
                  ", -1, 0.5, -0.5, 0.2 and -0.2 times that, then zero, each held for 0.625 s");
    EXPECT_EQ(motion_text(LevelsMotion{{u, 0.0, -u, 0.0}, 2.5}, kSourceVocabulary),
              "levels of " + volts + ", zero, the opposite and zero, each held for 2.5 s");
  }
  EXPECT_EQ(motion_text(SineMotion{5.0, 0.5, 0.5}, kSourceVocabulary), "a sine of 5 V and 0.5 Hz");
  EXPECT_EQ(motion_text(SineMotion{5.0, 0.5, 60.0}, kSourceVocabulary),
            "a chirp of 5 V from 0.5 to 60 Hz");
  EXPECT_EQ(motion_text(PrbsMotion{-5.0, 0.025, 0.0, 1}, kSourceVocabulary),
            "a pseudo-random binary sequence of +-5 V with a bit period of 0.025 s");
  EXPECT_EQ(motion_text(MoveMotion{0.45, 0.18, 0.72}, kSourceVocabulary),
            "a move of 0.45 m at 0.18 m/s and 0.72 m/s^2");
}

TEST(WordsTest, OfWhatDiscriminates) {
  Discrimination d{.chosen = "spring", .rival = "position.gain"};
  EXPECT_EQ(discrimination_text(d, kSourceVocabulary),
            "spring and position.gain explain these recordings equally well; no motion tried "
            "discriminates between them.");
  d.signal = Signal::position;
  d.size = 4.04;
  d.recording = "levels";
  EXPECT_EQ(discrimination_text(d, kSourceVocabulary),
            "spring and position.gain explain these recordings equally well; they differ most in "
            "the position during the motion of levels: by 4 times its noise.");
  d.experiment = Experiment{StepMotion{10.0, 0.0}, 2.0};
  EXPECT_EQ(discrimination_text(d, kSourceVocabulary),
            "spring and position.gain explain these recordings equally well; they differ most in "
            "the position during a step of 10 V: by 4 times its noise.");
}

TEST(WordsTest, InColourAreTheSameWords) {
  const Job job;
  FitResult fit;
  EXPECT_TRUE(
      grade_text(job, {}, fit, true).starts_with("\033[31mNot converged\033[0m: the simulation"));
  fit.reduced_chi_square = 1.0;
  EXPECT_EQ(grade_text(job, {Grade::usable, FitGrade::Reason::residual}, fit, true),
            "\033[33mUsable\033[0m: reduced chi-square 1 on the fitted data.");
  EXPECT_TRUE(grade_text(job, {Grade::explained, FitGrade::Reason::none}, fit, true)
                  .starts_with("\033[32mExplained\033[0m: "));
}

TEST(WordsTest, OfTheEndOfARun) {
  RunResult run_result;
  EXPECT_EQ(stop_reason(run_result), "");
  run_result.time_limit = 60.0;
  EXPECT_EQ(stop_reason(run_result), " by the time limit of 60 s");
}

}  // namespace
}  // namespace axisfit
