#include "report/text/words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace axisfit {
namespace {

std::string rejection_text(const Rejection& rejection) {
  using enum Rejection::Test;
  switch (rejection.test) {
    case fit:
      return "there is no usable fit with it";
    case simulation:
      return "with it the simulation does not finish for all recordings";
    case significance:
      return fmt::format(
          "no better than chance: the sum of squares falls by {:.3g}, where the best of {} effects "
          "needs {:.3g}",
          rejection.found, rejection.tried, rejection.required);
    case validation:
      return fmt::format("does not lower the validation error (p = {:.2g})", rejection.found);
    case validation_size:
      return fmt::format("hardly lowers the validation error, by {:.2g} %", rejection.found);
    case bound:
      return rejection.parameter + " is at its bound";
    case shape:
      return "the recordings do not determine " + rejection.parameter;
    case distinct:
      return "it cannot be distinguished from a change of the other parameters";
    case strength:
      return fmt::format("its strength is not determined: {:.2g} standard errors from zero",
                         rejection.found);
  }
  return "";
}

}  // namespace

std::string verdict_text(const FitResult& fit) {
  using enum FitVerdict::Kind;
  const FitVerdict& verdict = fit.verdict;
  switch (verdict.kind) {
    case not_simulated:
      return "No usable fit: the simulation does not finish at the initial values. Check them and "
             "the axis file for impossible values.";
    case no_minimum:
      return fmt::format(
          "No usable fit: no minimum was found within {} iterations. Try --starts 20, or free "
          "fewer parameters.",
          verdict.iteration_limit);
    case signal_not_followed:
      return fmt::format(
          "No usable fit: the model follows the {} of {} no better than a constant would. Try "
          "other initial values, --starts 20, or check units and signs of the columns.",
          info(verdict.signal).name, verdict.recording);
    case usable:
      break;
  }
  std::string text = fmt::format("Usable fit: reduced chi-square {:.4g} on the fitted data.",
                                 fit.reduced_chi_square);
  if (!verdict.undetermined.empty())
    text += fmt::format(" These recordings do not determine {}.",
                        fmt::join(verdict.undetermined, ", "));
  return text;
}

std::string verdict_text(const EffectSelection& selection) {
  using enum SelectionVerdict::Kind;
  const SelectionVerdict& verdict = selection.verdict;
  std::string text;
  switch (verdict.kind) {
    case no_usable_fit:
      return "No effect selection: without a usable fit the residual says nothing about effects.";
    case nothing_missing:
      return "Nothing is missing: the baseline model explains every signal down to its noise.";
    case stopped:
      return "The search for missing effects was stopped: no effect has been accepted so far.";
    case none_passes:
      return "Something is missing, but no effect passes the tests: see the reasons.";
    case effects_accepted:
      text = fmt::format("The model lacked {}. With {}, the validation error falls by {:.3g} %{}",
                         fmt::join(verdict.accepted, ", "),
                         verdict.accepted.size() > 1 ? "them" : "it", verdict.validate_percent,
                         selection.explained ? ", and every signal is explained down to its noise."
                                             : ", but not down to the noise.");
      break;
    case undecided:
      break;
  }
  if (!verdict.undecided.empty())
    text += fmt::format("{}Undecided: {}; none of them was added.", text.empty() ? "" : " ",
                        fmt::join(verdict.undecided, ", "));
  return text;
}

std::string overall_verdict(const RunResult& run_result) {
  const FitResult& fit = run_result.fit();
  if (!run_result.selection) return verdict_text(fit);
  // Both judge the same model by the same residual.
  return (fit.usable ? "Usable fit." : verdict_text(fit)) + " " +
         verdict_text(*run_result.selection);
}

std::string reason_text(const EffectTrial& trial) {
  switch (trial.reason) {
    case Reason::failed_test:
      return rejection_text(trial.rejection.value());
    case Reason::explains_best:
      return fmt::format(
          "explains the residual best: {:.3g} % lower validation error ({:.3g} standard deviations "
          "above chance)",
          trial.improvement.validate_percent, trial.improvement.z);
    case Reason::explains_less:
      return "explains less than " + trial.other;
    case Reason::replaced:
      return fmt::format("explains less than {}, which replaced it", trial.other);
    case Reason::explains_equally:
      return "explains these recordings as well as " + trial.other;
    case Reason::not_needed:
      return "no longer needed with the effects accepted after it";
  }
  return "";
}

std::string stop_reason(const RunResult& run_result) {
  return run_result.time_limit ? fmt::format(" by the time limit of {:g} s", *run_result.time_limit)
                               : "";
}

std::string_view verdict_name(ParameterVerdict verdict) {
  switch (verdict) {
    case ParameterVerdict::determined:
      return "determined";
    case ParameterVerdict::weakly_determined:
      return "weakly determined";
    case ParameterVerdict::not_determined:
      return "not determined";
    case ParameterVerdict::at_bound:
      return "at bound";
  }
  return "";
}

const char* decision_name(Decision decision) {
  switch (decision) {
    case Decision::accepted:
      return "accepted";
    case Decision::undecided:
      return "undecided";
    case Decision::rejected:
      return "rejected";
  }
  return "";
}

const char* role_name(const Recording& recording, bool fitted) {
  if (recording.role == Role::validate) return "validate";
  return fitted ? "fit" : "held_out";
}

const char* role_name(const Recording& recording, const SignalError& signal) {
  if (recording.role == Role::validate) return "validate";
  return signal.fitted ? "fit" : "compare";
}

}  // namespace axisfit
