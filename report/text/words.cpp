#include "report/text/words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <variant>

#include "base/rounding.h"
#include "base/terminal.h"
#include "base/text_table.h"
#include "base/units.h"
#include "fit/estimate/kalman_gain.h"
#include "report/text/names.h"

namespace axisfit {
namespace {

std::string rejection_text(const Job& job, const Rejection& rejection) {
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
    case power:
      return fmt::format("cannot be judged: the recordings to validate hardly show it (p = {:.2g})",
                         rejection.found);
    case validation_size:
      return fmt::format("hardly lowers the validation error, by {:.2g} %", rejection.found);
    case bound:
      return name_of(job, rejection.parameter.value()) + " is at its bound";
    case span:
      return fmt::format(
          "{} = {:.3g} is beyond what the recordings span: there it is a simpler effect",
          name_of(job, rejection.parameter.value()), rejection.found);
    case shape:
      return "the recordings do not determine " + name_of(job, rejection.parameter.value());
    case distinct:
      return "it cannot be distinguished from a change of the other parameters";
    case strength:
      return fmt::format("its strength is not determined: {:.2g} standard errors from zero",
                         rejection.found);
    case misfit:
      return "the declared model does not fit, with it or without";
    case force:
      return fmt::format(
          "raises the missing {} of a recording to validate from {} to {} of the drive's",
          words_on(job.vocabulary(), "force"), percent(rejection.required),
          percent(rejection.found));
    case period:
      return fmt::format(
          "the recordings to validate, fitted by themselves, show another period, {:.3g}: a slow "
          "disturbance looks so",
          rejection.found);
    case share:
      return fmt::format(
          "lowers the validation error beyond the noise by no more than {}, where most "
          "remains unexplained: it may imitate what is missing",
          percent(rejection.found));
  }
  return "";
}

/// What to record where an effect cannot be judged.
std::string advice_text(const Outcome& trial, Vocabulary vocabulary) {
  if (trial.rejection->test != Rejection::Test::power || trial.hypothesis.strengths.empty())
    return "";
  const auto effect = quantity_list()[trial.hypothesis.strengths.front()].effect;
  if (!effect) return "";
  return fmt::format("; record {}", words_on(vocabulary, kEffectTable[*effect].excitation));
}

std::string text_of(const StepMotion& motion, Vocabulary vocabulary) {
  return fmt::format("a step of {}", command_text(motion.level, vocabulary));
}

/// A level as it relates to the first.
std::string level_text(double ratio) {
  return ratio == 0.0    ? "zero"
         : ratio == -1.0 ? "the opposite"
                         : fmt::format("{:g} times that", ratio);
}

std::string text_of(const LevelsMotion& motion, Vocabulary vocabulary) {
  const std::vector<double>& levels = motion.levels;
  const double first = levels.front();
  std::string text = fmt::format("levels of {}", command_text(first, vocabulary));
  std::vector<double> ratios;
  for (const double level : levels) ratios.push_back(level / first);
  if (levels.size() > 4 && levels.back() == 0.0) {
    const auto last = std::prev(ratios.end(), 2);
    text += fmt::format(", {:g} and {:g} times that, then zero",
                        fmt::join(std::next(ratios.begin()), last, ", "), *last);
  } else {
    for (std::size_t i = 1; i < levels.size(); ++i)
      text += (i + 1 < levels.size() ? ", " : " and ") + level_text(ratios[i]);
  }
  return text + fmt::format(", each held for {:.3g} s", motion.hold);
}

std::string text_of(const SineMotion& motion, Vocabulary vocabulary) {
  const std::string amplitude = command_text(motion.amplitude, vocabulary);
  return motion.from == motion.to
             ? fmt::format("a sine of {} and {:g} Hz", amplitude, motion.from)
             : fmt::format("a chirp of {} from {:g} to {:g} Hz", amplitude, motion.from, motion.to);
}

std::string text_of(const PrbsMotion& motion, Vocabulary vocabulary) {
  return fmt::format("a pseudo-random binary sequence of +-{} with a bit period of {:g} s",
                     command_text(std::abs(motion.amplitude), vocabulary), motion.bit);
}

std::string text_of(const MoveMotion& motion, Vocabulary vocabulary) {
  return fmt::format("a move of {:.3g} {} at {:.3g} {} and {:.3g} {}", motion.distance,
                     unit_on(vocabulary, "m"), motion.speed, unit_on(vocabulary, "m/s"),
                     motion.acceleration, unit_on(vocabulary, "m/s^2"));
}

std::string text_of(const RecordedMotion&, Vocabulary) { return "a recorded motion"; }

std::string grade_heading(const FitGrade& grade, bool colour) {
  switch (grade.grade) {
    case Grade::explained:
      return toned("Explained", Tone::good, colour);
    case Grade::usable:
      return toned("Usable", Tone::caution, colour);
    case Grade::model_wrong:
      return toned("Model wrong", Tone::bad, colour);
    case Grade::nothing_determined:
      return toned("Nothing determined", Tone::bad, colour);
    case Grade::not_converged:
      return toned("Not converged", Tone::bad, colour);
  }
  return "";
}

/// What was wrong with the model as declared, whole sentences.
std::string lacked_text(const Job& job, const SelectionVerdict& verdict) {
  std::vector<std::string> effects = verdict.accepted;
  std::string text;
  for (const auto& [id, declared, value] : verdict.corrections) {
    const std::string name = name_of(job, id);
    std::erase(effects, name);
    const std::string_view unit = quantity_of(job, id).unit;
    text += fmt::format("{} is {}, not the {} of the axis file. ", name,
                        with_unit(fmt::format("{:.4g}", value), unit),
                        with_unit(fmt::format("{:.4g}", declared), unit));
  }
  if (!effects.empty()) text += fmt::format("The model lacked {}. ", fmt::join(effects, ", "));
  return text;
}

bool is_accepted(const SelectionVerdict& verdict, const std::string& effect) {
  return std::ranges::find(verdict.accepted, effect) != verdict.accepted.end();
}

/// Every undecided effect that is in the model, with its rivals: "spring or bump".
std::vector<std::string> undecided_list(const EffectSelection& selection) {
  std::vector<std::string> list;
  std::string chosen;
  for (const Substitution& pair : selection.substitutions) {
    if (is_accepted(selection.verdict, pair.chosen)) continue;
    if (list.empty() || chosen != pair.chosen) list.push_back(chosen = pair.chosen);
    list.back() += " or " + pair.rival;
  }
  return list;
}

/// What was added, and what it does: "it" or "them" where all was named as accepted.
std::string gain_text(const EffectSelection& selection) {
  const SelectionVerdict& verdict = selection.verdict;
  std::vector<std::string> added;
  for (const FittedModel& model : selection.models)
    if (!model.added.empty()) added.push_back(model.added);
  const std::string with = !verdict.undecided.empty()    ? fmt::format("{}", fmt::join(added, ", "))
                           : verdict.accepted.size() > 1 ? "them"
                                                         : "it";
  return fmt::format("With {}, the validation error falls by {:.3g} %{}", with,
                     verdict.validate_percent,
                     selection.explained ? ", and every signal is explained down to its noise."
                                         : ", but not down to the noise.");
}

/// What a simulation does with a signal, to follow it as the subject.
std::string followed_text(double percent, const std::string& signal) {
  return percent > 0.0 ? fmt::format("follows {} to only {:.2g} %", signal, percent)
                       : fmt::format("follows {} no better than a constant", signal);
}

}  // namespace

const char* grade_name(Grade grade) {
  switch (grade) {
    case Grade::explained:
      return "explained";
    case Grade::usable:
      return "usable";
    case Grade::model_wrong:
      return "model_wrong";
    case Grade::nothing_determined:
      return "nothing_determined";
    case Grade::not_converged:
      return "not_converged";
  }
  return "";
}

/// What a model is good for, the forces first; empty where nothing tells.
std::string uses_text(const Job& job, const FitUses& uses) {
  std::vector<std::string> parts;
  if (uses.missing_force_percent)
    parts.push_back(fmt::format(
        "the model leaves {} of the {} of {} unexplained", percent(*uses.missing_force_percent),
        words_on(job.vocabulary(), "drive force"), job.recordings[uses.force_recording].name));
  if (uses.followed_for)
    parts.push_back(fmt::format("a free run stays within 1 % of the range {}{:.2g} s",
                                uses.is_followed_to_the_end ? "to the end, " : "for ",
                                *uses.followed_for));
  return parts.empty() ? "" : fmt::format("{}.", fmt::join(parts, "; "));
}

std::string grade_text(const Job& job, const FitGrade& grade, const FitResult& fit, bool colour) {
  const Vocabulary vocabulary = job.vocabulary();
  const std::string heading = grade_heading(grade, colour);
  const auto recording = [&] { return job.recordings[grade.recording].name; };
  const auto signal = [&] {
    return fmt::format("the {} of {}", info(grade.signal, vocabulary).name, recording());
  };
  using enum FitGrade::Reason;
  switch (grade.reason) {
    case solver:
      if (fit.verdict.kind == FitVerdict::Kind::not_simulated)
        return heading +
               ": the simulation does not finish at the initial values. Check them and the axis "
               "file for impossible values.";
      return fmt::format(
          "{}: no minimum was found within {} iterations. Try --starts 20, or free fewer "
          "parameters.",
          heading, fit.verdict.iteration_limit);
    case parameters:
      return heading +
             ": these recordings determine none of the free parameters. Record a motion that shows "
             "them, or free fewer.";
    case standstill:
      return heading +
             ": no fitted signal changes by more than its noise, and a constant explains it as "
             "well as the model. Are these the right columns?";
    case simulation:
      if (grade.uses.missing_force_percent < GradeOptions().largest_force &&
          grade.uses.missing_force_percent && !std::isnan(grade.percent))
        return fmt::format(
            "{}: {} The free-running simulation {}. Units and signs are right, for most of the {} "
            "is explained: something is missing.",
            heading, uses_text(job, grade.uses), followed_text(grade.percent, signal()),
            words_on(vocabulary, "force"));
      return fmt::format(
          "{}: {}. Check the units and signs of the columns, and try other initial values or "
          "--starts 20.",
          heading,
          std::isnan(grade.percent)
              ? "the free-running simulation of " + recording() + " does not finish"
              : fmt::format("the free-running simulation {}",
                            followed_text(grade.percent, signal())));
    case force:
      return fmt::format(
          "{}: the {} that the model lacks in {} is {} of the drive's. Check the units and "
          "signs of the columns and what the axis file declares.",
          heading, words_on(vocabulary, "force"), recording(), percent(grade.percent, 3));
    case drift:
      return fmt::format(
          "{} for {}: {} The free-running simulation {}: do not simulate with it for long.",
          heading, words_on(vocabulary, "forces"), uses_text(job, grade.uses),
          followed_text(grade.percent, signal()));
    case contradiction:
      return fmt::format(
          "{}: {} is not the derivative of what else is recorded of the motion, by its scale or "
          "its sign. One of them is wrong, and the estimates with it: see the warnings.",
          heading, signal());
    case residual:
    case stopped:
    case none:
      break;
  }
  const std::string uses = uses_text(job, grade.uses);
  std::string text =
      fmt::format("{}: {}{} chi-square {:.4g} on the fitted data{}", heading, uses,
                  uses.empty() ? "reduced" : " Reduced", fit.reduced_chi_square,
                  grade.reason == none      ? ", and no signal shows more than its noise."
                  : grade.reason == stopped ? ", and no signal shows more than its noise, but the "
                                              "run was stopped before all errors were known."
                                            : ".");
  std::vector<std::string> undetermined;
  for (const ParameterId& id : fit.verdict.undetermined) undetermined.push_back(name_of(job, id));
  if (!undetermined.empty())
    text += fmt::format(" These recordings do not determine {}.", fmt::join(undetermined, ", "));
  return text;
}

std::string closed_form_text(const ClosedForm& closed_form) {
  std::vector<std::string> terms;
  for (const ClosedForm::Term& term : closed_form.terms)
    terms.push_back(fmt::format("({} +- {:.2g}) {} {}",
                                with_digits_of(term.factor, term.standard_error),
                                term.standard_error, term.unit, term.form));
  return fmt::format("{}", fmt::join(terms, " + "));
}

std::string verdict_text(const EffectSelection& selection) {
  using enum SelectionVerdict::Kind;
  const SelectionVerdict& verdict = selection.verdict;
  const Job& job = selection.result.job;
  std::string text;
  switch (verdict.kind) {
    case no_usable_fit:
      return "No effects were looked for: a search had no fit to start from.";
    case nothing_missing:
      return "Nothing is missing: the baseline model explains every signal down to its noise.";
    case stopped:
      return "The search for missing effects was stopped: no effect has been accepted so far.";
    case none_passes:
      return selection.effects.empty()
                 ? "Something is missing, but no effect that axisfit knows comes near it."
                 : "Something is missing, but no effect passes the tests: see the reasons.";
    case hardly_anything:
      return fmt::format(
          "Hardly anything is missing: {} {} significant, but hardly lowers the validation error.",
          fmt::join(verdict.small, ", "), verdict.small.size() > 1 ? "are" : "is");
    case effects_accepted:
    case undecided:
      text = lacked_text(job, verdict);
      if (const auto equals = undecided_list(selection); !equals.empty())
        text += fmt::format("Undecided: {}; these recordings do not tell which. ",
                            fmt::join(equals, ", "));
      text += gain_text(selection);
      for (const Outcome& t : selection.effects)
        if (t.closed_form)
          text += fmt::format(" {} is explained as well by {}.", t.hypothesis.name,
                              closed_form_text(*t.closed_form));
      for (const Substitution& pair : selection.substitutions)
        if (is_accepted(verdict, pair.chosen))
          text += fmt::format(" These recordings do not tell {} from {}.", pair.chosen, pair.rival);
      break;
    case misfit:
      return verdict.at_bound
                 ? fmt::format(
                       "The declared model does not fit: {} is at its bound. Nothing can be said "
                       "about effects yet.",
                       name_of(job, *verdict.at_bound))
                 : fmt::format(
                       "The declared model does not fit: of {}, {} of the {} is missing. "
                       "Nothing can be said about effects yet.",
                       job.recordings[verdict.recording.value()].name,
                       percent(verdict.force_percent, 3),
                       words_on(job.vocabulary(), "drive force"));
  }
  return text;
}

std::string judges_text(const RunResult& run_result) {
  std::vector<std::string> sentences;
  const Job& used = run_result.job();
  if (had_to_track(run_result.baseline, used))
    sentences.push_back(fmt::format(
        "The {} moves a free run by far more than the readings are in doubt. All models therefore "
        "track the recordings, as with 'observer: {{fixed: {:.3g} 1/s}}'.",
        input_noise_text(used), given_gain(used.options.criterion)));
  if (run_result.selection->held_out_blocks)
    sentences.push_back(
        "No recording has the role validate: every second tenth of each recording was held out "
        "to validate the effects.");
  else if (run_result.roles_exchanged)
    sentences.push_back(
        "With the roles that the job gives to the recordings, no effect passes. Here they are "
        "exchanged: those to validate are fitted, and those to fit validate.");
  return fmt::format("{}", fmt::join(sentences, " "));
}

/// What differs in a recording of another day, and what that explains.
std::string other_day_text(const Job& job, const FitResult& fit, const OtherDay& day) {
  std::vector<std::string> own;
  for (std::size_t k = 0; k < day.differing.size(); ++k) {
    const ParameterResult& usual = fit.parameters[day.differing[k]];
    const double error = day.parameters[k].uncertainty.standard_error;
    own.push_back(fmt::format(
        "{} = {} instead of {}", name_of(job, usual.id),
        with_digits_of(day.parameters[k].value, error),
        with_unit(with_digits_of(usual.value, error), quantity_of(job, usual.id).unit)));
  }
  return fmt::format(
      " {} differs from the fitted recordings: with {}, found in its first half, the model leaves "
      "{} of the {} of the second half unexplained, and not {}. The grade counts it so.",
      job.recordings[day.recording].name, fmt::join(own, " and "), percent(day.percent),
      words_on(job.vocabulary(), "drive force"), percent(day.percent_before));
}

std::string overall_verdict(const RunResult& run_result, bool colour) {
  const FitGrade& grade = run_result.grade;
  const std::string of_grade = grade_text(run_result.job(), grade, run_result.fit(), colour);
  std::string of_days;
  for (const OtherDay& day : run_result.other_days)
    of_days += other_day_text(run_result.job(), run_result.fit(), day);
  if (!run_result.selection) return of_grade + of_days;
  // Both judge the same model by the same residual: what it is good for is left to tell.
  const bool by_residual =
      grade.reason == FitGrade::Reason::residual || grade.reason == FitGrade::Reason::none;
  const std::string uses =
      grade.grade == Grade::usable ? uses_text(run_result.job(), grade.uses) : "";
  const std::string in_short = grade_heading(grade, colour) + (uses.empty() ? "." : ": " + uses);
  return (by_residual ? in_short : of_grade) + " " + verdict_text(*run_result.selection) +
         (run_result.roles_exchanged ? " Found with the roles of the recordings exchanged." : "") +
         of_days;
}

std::string reason_text(const Job& job, const Outcome& trial) {
  switch (trial.reason) {
    case Reason::failed_test:
      return rejection_text(job, trial.rejection.value()) + advice_text(trial, job.vocabulary());
    case Reason::explains_best:
      return fmt::format(
          "explains the residual best: {:.3g} % lower validation error ({:.3g} standard deviations "
          "above chance)",
          trial.improvement.validate_percent, trial.improvement.z);
    case Reason::replicates:
      return "explains the residual best of what the recordings to validate, fitted by themselves, "
             "tell alike";
    case Reason::shown_by_blocks:
      return fmt::format(
          "explains the residual best: {:.3g} % lower error on held-out blocks of the fitted "
          "recordings, since those to validate could not have shown it",
          trial.improvement.validate_percent);
    case Reason::explains_beside:
      return fmt::format(
          "explains the residual together with {}, without which it is hidden: {:.3g} % lower "
          "validation error ({:.3g} standard deviations above chance)",
          trial.other, trial.improvement.validate_percent, trial.improvement.z);
    case Reason::explains_less:
      return "explains less than " + trial.other;
    case Reason::replaced:
      return fmt::format("explains less than {}, which replaced it", trial.other);
    case Reason::explains_equally:
    case Reason::is_equal_delay:
      return fmt::format("explains these recordings as well as {}{}", trial.other,
                         trial.in_model ? "; this one stays in the model" : "");
    case Reason::not_needed:
      return "no longer needed with the effects accepted after it";
    case Reason::falls_with:
      return fmt::format("stood or fell with {}, which was taken out again", trial.other);
  }
  return "";
}

std::string weak_direction_text(const Job& job, const WeakDirection& weak) {
  const std::vector<WeakDirection::Part>& parts = weak.parts;
  const auto name = [&](const WeakDirection::Part& p) {
    return name_of(job, job.free[p.parameter]);
  };
  if (parts.size() == 1) return name(parts[0]) + " hardly affects these recordings.";
  if (weak.combination)
    return fmt::format("{} and {} are determined only as {}.", name(parts[0]), name(parts[1]),
                       name_of(job, *weak.combination));
  std::vector<std::string> changes;
  for (const WeakDirection::Part& p : parts)
    changes.push_back(p.relative ? fmt::format("{} by {:+.2g} %", name(p), 100.0 * p.tenth)
                                 : fmt::format("{} by {:+.2g}", name(p), p.tenth));
  return fmt::format("These can change jointly with hardly any effect: {}.",
                     fmt::join(changes, ", "));
}

std::string command_text(double value, Vocabulary vocabulary) {
  return vocabulary.command == Command::share_of_rated
             ? fmt::format("{:.3g} %", 100.0 * value)
             : fmt::format("{:.3g} {}", value, unit_on(vocabulary, kCommandUnit));
}

std::string motion_text(const Motion& motion, Vocabulary vocabulary) {
  return std::visit([vocabulary](const auto& m) { return text_of(m, vocabulary); }, motion);
}

std::string simulation_name(const FitOptions& options, bool tracks) {
  if (!tracks) return "free-running simulation";
  if (const double length = window_length(options.criterion); length > 0.0)
    return fmt::format("simulation in windows of {:.3g} s", length);
  return "tracking simulation";
}

std::vector<std::string> moves_text(const ParameterResult& p, std::string_view unit) {
  const auto text = [&](double value, const std::string& where) {
    return fmt::format("{} {}, which {}", with_unit(fmt::format("{:.4g}", value), unit), where,
                       p.uncertainty.determined ? "its error allows for" : "leaves it open");
  };
  std::vector<std::string> moves;
  if (const auto& gain = p.budget.gain)
    moves.push_back(
        text(gain->value, fmt::format("at an observer gain of {:.3g} 1/s", gain->observer_gain)));
  if (const auto& rival = p.budget.rival)
    moves.push_back(
        text(rival->value, fmt::format("with {} in place of {}", rival->rival, rival->chosen)));
  return moves;
}

std::string hold_shift_text(const Job& job, const HoldShift& shift, std::string_view unit) {
  const auto held = std::ranges::any_of(job.recordings, [](const Recording& r) {
    return r.command.meaning != Meaning::reference && r.command.hold == Hold::zero_order;
  });
  return fmt::format(
      "{} if {}, which {}", with_unit(fmt::format("{:.4g}", shift.value), unit),
      held ? "the input went straight from one sample to the next ('hold: linear')"
           : "each value of the input held until the next ('hold: zero_order')",
      shift.is_better ? "explains these recordings better" : "these recordings do not exclude");
}

std::string better_gain_text(const FitResult& fit) {
  if (!fit.better_gain) return "";
  return fmt::format(
      "Fitted at an observer gain of {0:.3g} 1/s, the model predicts the recordings to validate "
      "better in the free run: set 'observer: {{fixed: {0:.3g} 1/s}}'",
      *fit.better_gain);
}

std::string quiet_gain_text(const Job& job, const FitResult& fit) {
  if (!fit.quiet_gain) return "";
  return fmt::format(
      "The {} adds up in the free run, to far more than the noise of the readings, and the "
      "estimates err more than they need to: set 'observer: {{fixed: {:.3g} 1/s}}', so that the "
      "simulation tracks the recordings",
      input_noise_text(job), *fit.quiet_gain);
}

std::string guesses_text(const Job& job, const std::vector<GuessInfluence>& guesses) {
  constexpr double kWhole = 0.005;  // of an elasticity of one
  std::vector<std::string> whole, part;
  for (const auto& [id, elasticity] : guesses) {
    const std::string name = name_of(job, id);
    if (std::abs(elasticity - 1.0) < kWhole)
      whole.push_back("as a ratio to " + name);
    else if (std::abs(elasticity + 1.0) < kWhole)
      whole.push_back("as a product with " + name);
    else
      part.push_back(part.empty()
                         ? fmt::format("1 % more of {} makes {:+.2g} % here", name, elasticity)
                         : fmt::format("of {} {:+.2g} %", name, elasticity));
  }
  std::vector<std::string> said;
  if (!whole.empty())
    said.push_back(fmt::format("known only {}, which {}", fmt::join(whole, " and "),
                               whole.size() == 1 ? "is a guess" : "are guesses"));
  if (!part.empty())
    said.push_back(fmt::format("rests on {}: {}", part.size() == 1 ? "a guess" : "guesses",
                               fmt::join(part, ", ")));
  return fmt::format("{}", fmt::join(said, "; "));
}

std::string discrimination_text(const Discrimination& discrimination, Vocabulary vocabulary) {
  std::string text = fmt::format("{} and {} explain these recordings equally well; ",
                                 discrimination.chosen, discrimination.rival);
  if (!discrimination.signal) return text + "no motion tried discriminates between them.";
  return text + fmt::format("they differ most in the {} during {}: by {:.2g} times its noise.",
                            info(*discrimination.signal, vocabulary).name,
                            discrimination.experiment
                                ? motion_text(discrimination.experiment->motion, vocabulary)
                                : "the motion of " + discrimination.recording,
                            discrimination.size);
}

bool drives_by_force(const Recording& recording, const Model<double>& model) {
  static const std::size_t kGain = quantity_index("K_f");
  return capabilities(model.structure).is_force_driven &&
         std::ranges::any_of(recording.overrides, [](const auto& o) { return o.first == kGain; });
}

std::string input_noise_text(const Job& job) {
  const Recording& noisiest =
      *std::ranges::max_element(job.recordings, {}, &Recording::command_sigma);
  const bool force = drives_by_force(noisiest, job.model);
  return fmt::format(
      "noise of {} in the {}{}",
      with_unit(fmt::format("{:.3g}", noisiest.command_sigma),
                unit_on(job.vocabulary(), force ? "N" : kCommandUnit)),
      force ? words_on(job.vocabulary(), "drive force") : "command",
      noisiest.command_noise == NoiseSource::given ? "" : ", estimated from its samples");
}

std::string stop_reason(const RunResult& run_result) {
  return run_result.time_limit ? fmt::format(" by the time limit of {:g} s", *run_result.time_limit)
                               : "";
}

std::string stopped_errors_text(const RunResult& run_result) {
  if (run_result.errors_known == ErrorsKnown::fully) return "";
  if (run_result.errors_known == ErrorsKnown::no)
    return "The run was stopped before the standard errors were known: at another observer gain "
           "the estimates may be others.";
  std::vector<std::string> lacks;
  if (tracks(run_result.job().options.criterion))
    lacks.push_back("allow for other observer gains by one step of least squares instead of fits");
  if (run_result.options.select_effects)
    lacks.push_back("do not allow for other effects that may explain as much");
  if (lacks.empty()) return "";
  return fmt::format("The run was stopped: standard errors {}.", fmt::join(lacks, ", and "));
}

std::string_view verdict_name(ParameterVerdict verdict) {
  switch (verdict) {
    case ParameterVerdict::determined:
      return "determined";
    case ParameterVerdict::weakly_determined:
      return "weakly determined";
    case ParameterVerdict::not_determined:
      return "not determined";
    case ParameterVerdict::at_zero:
      return "not distinguishable from zero";
    case ParameterVerdict::at_bound:
      return "at bound";
    case ParameterVerdict::error_not_known:
      return "error not known";
    case ParameterVerdict::of_wrong_model:
      return "of a wrong model";
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
