// The words for what a run finds: its data and judgements (fit/) as names and sentences.
// With `colour`, verdicts are green, yellow or red, for a terminal. The job is the one whose fit is
// told of.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "fit/run.h"

namespace axisfit {

/// "explained", "usable", "model_wrong", "nothing_determined", "not_converged"
const char* grade_name(Grade grade);

/// How far a fit can be relied on, and why, one sentence or a few.
std::string grade_text(const Job& job, const FitGrade& grade, const FitResult& fit,
                       bool colour = false);

/// What a search for effects comes to, a sentence or a few.
std::string verdict_text(const EffectSelection& selection);
/// By which samples the effects were judged, where that needs a word.
std::string judges_text(const RunResult& run_result);

/// How far the final model can be relied on, and what a search for effects comes to.
std::string overall_verdict(const RunResult& run_result, bool colour = false);

/// What the decision on an effect rests on; no sentence, to follow its estimate.
std::string reason_text(const Job& job, const Outcome& trial);

/// What the recordings leave open in that direction, one sentence.
std::string weak_direction_text(const Job& job, const WeakDirection& weak);

/// A command with the unit of the drive: "2 A", "40 %".
std::string command_text(double value, Vocabulary vocabulary);

/// "a step of 10 V"
std::string motion_text(const Motion& motion, Vocabulary vocabulary);

/// "known only as a ratio to K_f, which is a guess"
std::string guesses_text(const Job& job, const std::vector<GuessInfluence>& guesses);

/// How a fit simulates that `tracks`, as a result has it, or does not: "tracking simulation",
/// "simulation in windows of 2 s" or "free-running simulation".
std::string simulation_name(const FitOptions& options, bool tracks);

/// What another observer gain and another effect make of an estimate, where its budget has them:
/// "157 N s/m at an observer gain of 100 1/s, which its error allows for",
/// "17.6 N s/m with added_mass in place of velocity.gain, which leaves it open".
std::vector<std::string> moves_text(const ParameterResult& p, std::string_view unit);
/// "17.6 N s/m if each value of the input held until the next, which the recordings do not
/// exclude".
std::string hold_shift_text(const Job& job, const HoldShift& shift, std::string_view unit);
/// What to do where another observer gain predicts better; empty where none does.
std::string better_gain_text(const FitResult& fit);
/// What to do where noise of the inputs adds up in the free run; empty where it does not.
std::string quiet_gain_text(const Job& job, const FitResult& fit);

/// "(8.10 +- 0.20) N exp(-|v| / 0.02 m/s)".
std::string closed_form_text(const ClosedForm& closed_form);
/// In which motion and signal two undecided effects differ, one sentence.
std::string discrimination_text(const Discrimination& discrimination, Vocabulary vocabulary);

/// Whether the input of a recording is a force, and no command.
bool drives_by_force(const Recording& recording, const Model<double>& model);

/// "noise of 0.02 V in the command, estimated from its samples": the largest of the recordings.
std::string input_noise_text(const Job& job);

/// What the errors of a stopped run lack, a sentence or two; empty where they lack nothing.
std::string stopped_errors_text(const RunResult& run_result);

/// " by the time limit of 60 s", or nothing: to follow "stopped".
std::string stop_reason(const RunResult& run_result);

/// "determined", "weakly determined", "not determined", "at bound", "error not known", "of a wrong
/// model"
std::string_view verdict_name(ParameterVerdict verdict);

/// "accepted", "undecided", "rejected"
const char* decision_name(Decision decision);

/// "fit", "validate" or, where a recording was fitted in part, "held_out".
const char* role_name(const Recording& recording, bool fitted);

/// Of one signal of a recording: "fit", "validate", or "compare" where it is only compared.
const char* role_name(const Recording& recording, const SignalError& signal);

}  // namespace axisfit
