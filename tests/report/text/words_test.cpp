#include "report/text/words.h"

#include <gtest/gtest.h>

namespace axisfit {
namespace {

TEST(WordsTest, OfTheVerdictOnAFit) {
  using enum FitVerdict::Kind;
  FitResult fit;
  EXPECT_EQ(verdict_text(fit),
            "No usable fit: the simulation does not finish at the initial values. Check them and "
            "the axis file for impossible values.");
  fit.verdict = {.kind = no_minimum, .iteration_limit = 50};
  EXPECT_EQ(verdict_text(fit),
            "No usable fit: no minimum was found within 50 iterations. Try --starts 20, or free "
            "fewer parameters.");
  fit.verdict = {.kind = signal_not_followed, .signal = Signal::acceleration, .recording = "step"};
  EXPECT_EQ(verdict_text(fit),
            "No usable fit: the model follows the acceleration of step no better than a constant "
            "would. Try other initial values, --starts 20, or check units and signs of the "
            "columns.");
  fit.verdict = {.kind = usable};
  fit.usable = true;
  fit.reduced_chi_square = 1.00251;
  EXPECT_EQ(verdict_text(fit), "Usable fit: reduced chi-square 1.003 on the fitted data.");
  fit.verdict.undetermined = {"V_L", "k_g"};
  EXPECT_EQ(verdict_text(fit),
            "Usable fit: reduced chi-square 1.003 on the fitted data. These recordings do not "
            "determine V_L, k_g.");
}

TEST(WordsTest, OfWhatASearchComesTo) {
  using enum SelectionVerdict::Kind;
  EffectSelection selection;
  EXPECT_EQ(verdict_text(selection),
            "No effect selection: without a usable fit the residual says nothing about effects.");
  selection.verdict.kind = nothing_missing;
  EXPECT_EQ(verdict_text(selection),
            "Nothing is missing: the baseline model explains every signal down to its noise.");
  selection.verdict.kind = stopped;
  EXPECT_EQ(verdict_text(selection),
            "The search for missing effects was stopped: no effect has been accepted so far.");
  selection.verdict.kind = none_passes;
  EXPECT_EQ(verdict_text(selection),
            "Something is missing, but no effect passes the tests: see the reasons.");
  selection.verdict = {effects_accepted, {"added_mass"}, {}, 12.345};
  EXPECT_EQ(verdict_text(selection),
            "The model lacked added_mass. With it, the validation error falls by 12.3 %, but not "
            "down to the noise.");
  selection.verdict = {
      effects_accepted, {"added_mass", "drive_lag"}, {"spring", "position.gain"}, 99.96};
  selection.explained = true;
  EXPECT_EQ(verdict_text(selection),
            "The model lacked added_mass, drive_lag. With them, the validation error falls by 100 "
            "%, and every signal is explained down to its noise. Undecided: spring, position.gain; "
            "none of them was added.");
  selection.verdict = {undecided, {}, {"spring", "position.gain"}, 0.0};
  EXPECT_EQ(verdict_text(selection), "Undecided: spring, position.gain; none of them was added.");
}

TEST(WordsTest, OfARunNameTheFitOnce) {
  RunResult run_result;
  run_result.first.usable = true;
  run_result.first.verdict.kind = FitVerdict::Kind::usable;
  run_result.first.reduced_chi_square = 2.5;
  EXPECT_EQ(overall_verdict(run_result), "Usable fit: reduced chi-square 2.5 on the fitted data.");
  run_result.selection.emplace();
  run_result.selection->result.fit = run_result.first;
  run_result.selection->verdict.kind = SelectionVerdict::Kind::none_passes;
  EXPECT_EQ(overall_verdict(run_result),
            "Usable fit. Something is missing, but no effect passes the tests: see the reasons.");
}

TEST(WordsTest, OfTheDecisionOnAnEffect) {
  using enum Rejection::Test;
  EffectTrial trial;
  const auto rejected = [&](const Rejection& rejection) {
    trial.rejection = rejection;
    return reason_text(trial);
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
  EXPECT_EQ(rejected({.test = bound, .parameter = "F_c"}), "F_c is at its bound");
  EXPECT_EQ(rejected({.test = shape, .parameter = "v_st"}), "the recordings do not determine v_st");
  EXPECT_EQ(rejected({.test = distinct}),
            "it cannot be distinguished from a change of the other parameters");
  EXPECT_EQ(rejected({.test = strength, .found = 3.0}),
            "its strength is not determined: 3 standard errors from zero");

  trial.other = "drive_lag";
  trial.improvement.validate_percent = 12.345;
  trial.improvement.z = 7.5;
  const auto decided = [&](Reason reason) {
    trial.reason = reason;
    return reason_text(trial);
  };
  EXPECT_EQ(decided(Reason::explains_best),
            "explains the residual best: 12.3 % lower validation error (7.5 standard deviations "
            "above chance)");
  EXPECT_EQ(decided(Reason::explains_less), "explains less than drive_lag");
  EXPECT_EQ(decided(Reason::replaced), "explains less than drive_lag, which replaced it");
  EXPECT_EQ(decided(Reason::explains_equally), "explains these recordings as well as drive_lag");
  EXPECT_EQ(decided(Reason::not_needed), "no longer needed with the effects accepted after it");
}

TEST(WordsTest, OfAWeakDirection) {
  WeakDirection weak;
  weak.parts = {{.name = "k_g"}};
  EXPECT_EQ(weak_direction_text(weak), "k_g hardly affects these recordings.");
  weak.parts = {{.name = "k_g", .tenth = 0.0733, .relative = true}, {.name = "y0", .tenth = -0.02}};
  EXPECT_EQ(weak_direction_text(weak),
            "These can change jointly with hardly any effect: k_g by +7.3 %, y0 by -0.02.");
  weak.combination = "k_g / M";
  weak.parts[1].name = "M";
  EXPECT_EQ(weak_direction_text(weak), "k_g and M are determined only as k_g / M.");
}

TEST(WordsTest, OfMotions) {
  EXPECT_EQ(motion_text(StepMotion{-10.0, 0.0}), "a step of -10 V");
  for (const double u : {2.0, -2.0}) {
    const std::string volts = u > 0.0 ? "2 V" : "-2 V";
    EXPECT_EQ(motion_text(LevelsMotion{{u, -u, 0.5 * u, -0.5 * u, 0.2 * u, -0.2 * u, 0.0}, 0.625}),
              "levels of " + volts +
                  ", -1, 0.5, -0.5, 0.2 and -0.2 times that, then zero, each held for 0.625 s");
    EXPECT_EQ(motion_text(LevelsMotion{{u, 0.0, -u, 0.0}, 2.5}),
              "levels of " + volts + ", zero, the opposite and zero, each held for 2.5 s");
  }
  EXPECT_EQ(motion_text(SineMotion{5.0, 0.5, 0.5}), "a sine of 5 V and 0.5 Hz");
  EXPECT_EQ(motion_text(SineMotion{5.0, 0.5, 60.0}), "a chirp of 5 V from 0.5 to 60 Hz");
  EXPECT_EQ(motion_text(PrbsMotion{-5.0, 0.025, 0.0, 1}),
            "a pseudo-random binary sequence of +-5 V with a bit period of 0.025 s");
  EXPECT_EQ(motion_text(MoveMotion{0.45, 0.18, 0.72}),
            "a move of 0.45 m at 0.18 m/s and 0.72 m/s^2");
}

TEST(WordsTest, OfWhatDiscriminates) {
  Discrimination d{.chosen = "spring", .rival = "position.gain"};
  EXPECT_EQ(discrimination_text(d),
            "spring and position.gain explain these recordings equally well; no motion tried "
            "discriminates between them.");
  d.signal = Signal::position;
  d.size = 4.04;
  d.recording = "levels";
  EXPECT_EQ(discrimination_text(d),
            "spring and position.gain explain these recordings equally well; they differ most in "
            "the position during the motion of levels: by 4 times its noise.");
  d.experiment = Experiment{StepMotion{10.0, 0.0}, 2.0};
  EXPECT_EQ(discrimination_text(d),
            "spring and position.gain explain these recordings equally well; they differ most in "
            "the position during a step of 10 V: by 4 times its noise.");
}

TEST(WordsTest, InColourAreTheSameWords) {
  FitResult fit;
  EXPECT_TRUE(verdict_text(fit, true).starts_with("\033[31mNo usable fit\033[0m: the simulation"));
  fit.usable = true;
  fit.verdict.kind = FitVerdict::Kind::usable;
  fit.reduced_chi_square = 1.0;
  EXPECT_EQ(verdict_text(fit, true),
            "\033[32mUsable fit\033[0m: reduced chi-square 1 on the fitted data.");
}

TEST(WordsTest, OfTheEndOfARun) {
  RunResult run_result;
  EXPECT_EQ(stop_reason(run_result), "");
  run_result.time_limit = 60.0;
  EXPECT_EQ(stop_reason(run_result), " by the time limit of 60 s");
}

}  // namespace
}  // namespace axisfit
