#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/rounding.h"
#include "base/terminal.h"
#include "base/text_table.h"
#include "base/units.h"
#include "report/text/names.h"
#include "report/text/report_text.h"
#include "report/text/words.h"

namespace axisfit {
namespace {

std::string_view unit_of(const Job& job, std::size_t parameter) {
  return quantity_of(job, job.free[parameter].id()).unit;
}

/// "12.3 .. 14.2", or what stands for an interval that there is not.
std::string interval_text(const ParameterUncertainty& u) {
  if (!u.has_interval()) return "-";
  const double digits = u.determined ? u.standard_error : 0.0;
  return with_digits_of(u.lower, digits) + " .. " + with_digits_of(u.upper, digits);
}

/// Estimates that hang together: neither is known without the other.
std::string correlation_text(const Job& job, const FitResult& result) {
  constexpr std::size_t kNamed = 3;
  const std::vector<StrongCorrelation> pairs = strong_correlations(result.correlation);
  if (pairs.empty()) return "";
  const std::size_t named = std::min(kNamed, pairs.size());
  std::vector<std::string> names;
  for (std::size_t i = 0; i < named; ++i)
    names.push_back(fmt::format("{} and {} ({:.3g})", name_of(job, job.free[pairs[i].first]),
                                name_of(job, job.free[pairs[i].second]), pairs[i].value));
  const std::string more =
      pairs.size() > named ? fmt::format(", and {} more pairs", pairs.size() - named) : "";
  return paragraph(fmt::format("Strongly correlated: {}{}.", fmt::join(names, ", "), more), 2);
}

/// An estimate of another order of magnitude than the user expects; empty where it is none.
std::string far_text(const FreeParameter& free, const ParameterResult& found) {
  constexpr double kFar = 300.0;  // a thousand, as of mm and m, from an initial value that is poor
  if (free.scale == Scale::linear || !(free.initial > 0.0) || !found.uncertainty.determined)
    return {};
  const double ratio = found.value / free.initial;
  if (!(ratio > 0.0) || (ratio < kFar && ratio > 1.0 / kFar)) return {};
  return fmt::format(
      "{:.2g} times the initial value; if that was about right, a unit in the job or the axis file "
      "is not",
      ratio);
}

/// The estimates whose error bars leave out that a value beneath them is a guess or another hold of
/// the input makes them different, or allow for what another observer gain or another effect makes
/// of them.
std::string remarks_text(const Job& job, const FitResult& result) {
  std::string text;
  for (std::size_t i = 0; i < result.parameters.size(); ++i) {
    const ParameterResult& p = result.parameters[i];
    const std::string name = name_of(job, p.id);
    if (const std::string far = far_text(job.free[i], p); !far.empty())
      text += paragraph(fmt::format("{}: {}.", name, far), 2);
    if (!p.rests_on.empty())
      text += paragraph(fmt::format("{}: {}.", name, guesses_text(job, p.rests_on)), 2);
    for (const std::string& move : moves_text(p, unit_of(job, i)))
      text += paragraph(fmt::format("{}: {}.", name, move), 2);
    if (p.other_hold)
      text += paragraph(
          fmt::format("{}: {}.", name, hold_shift_text(job, *p.other_hold, unit_of(job, i))), 2);
  }
  if (const std::string better = better_gain_text(result); !better.empty())
    text += paragraph(better + ".", 2);
  if (const std::string quiet = quiet_gain_text(job, result); !quiet.empty())
    text += paragraph(quiet + ".", 2);
  return text;
}

}  // namespace

std::string meanings_text(const Job& job, const std::vector<ParameterUncertainty>& known,
                          bool colour) {
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < job.free.size(); ++i) {
    std::string description(quantity_of(job, job.free[i].id()).meaning);
    if (const ParameterVerdict verdict = known[i].verdict();
        verdict != ParameterVerdict::determined)
      description += ": " + toned(verdict_name(verdict),
                                  verdict == ParameterVerdict::not_determined ||
                                          verdict == ParameterVerdict::of_wrong_model
                                      ? Tone::bad
                                      : Tone::caution,
                                  colour);
    rows.push_back({name_of(job, job.free[i]), description});
  }
  return format_table(rows, {Alignment::left, Alignment::wrapped});
}

std::string uncertainty_text(const Job& job, const FitResult& result) {
  const double excess = std::sqrt(result.reduced_chi_square);
  std::string noise = excess > 1.0
                          ? fmt::format("residuals as observed, {:.3g} times the noise", excess)
                          : "noise as stated below";
  noise += is_coloured(result.autocorrelation_time)
               ? fmt::format(", with an autocorrelation time of up to {:.3g} samples",
                             result.autocorrelation_time)
               : ", uncorrelated in time";
  // Less than a tenth of a variance is 5 % of the error.
  if (constexpr double kPart = 0.1; result.input_part > kPart)
    noise += fmt::format(", and {}, which makes up to {} of their squares", input_noise_text(job),
                         percent(100.0 * result.input_part));
  return paragraph("Standard errors and intervals assume " + noise + ".", 2) +
         remarks_text(job, result) + correlation_text(job, result) +
         identifiability_text(job, result.identifiability);
}

std::string second_opinion_text(const RunResult& run_result) {
  const auto number = [](const ParameterResult& p, std::string_view unit) {
    const double error = p.uncertainty.standard_error;
    return with_unit(with_digits_of(p.value, error) + fmt::format(" +- {:.2g}", error), unit);
  };
  std::string text;
  if (run_result.inverse_start == InverseStart::better)
    text += paragraph(
        fmt::format("The fit began from an inverse-dynamics estimate, the balance of {} without a "
                    "simulation: from the initial values it ended worse, or nowhere.",
                    words_on(run_result.job().vocabulary(), "forces")),
        2);
  if (!run_result.second_opinion) return text;
  const auto& [estimate, contradictions] = *run_result.second_opinion;
  std::vector<std::string> values;
  if (!run_result.grade.is_usable())
    for (const InverseEstimate& e : estimate.parameters)
      values.push_back(fmt::format("{} = {}", name_of(run_result.job(), e.id),
                                   number(e, unit_of(run_result.job(), e.parameter))));
  if (!values.empty())
    text += paragraph(
        fmt::format("Inverse dynamics, without a simulation: {}. {} of the {} remain unexplained.",
                    fmt::join(values, ", "),
                    percent(100.0 * estimate.residual / estimate.drive_rms),
                    words_on(run_result.job().vocabulary(), "drive force")),
        2);
  if (contradictions.empty()) return text;
  std::vector<std::string> differ;
  for (const std::size_t i : contradictions) {
    const InverseEstimate& e = estimate.parameters[i];
    const std::string_view unit = unit_of(run_result.job(), e.parameter);
    differ.push_back(fmt::format("{} = {} (fit: {})", name_of(run_result.job(), e.id),
                                 number(e, unit),
                                 number(run_result.fit().parameters[e.parameter], unit)));
  }
  return text + paragraph(fmt::format("Second opinion: inverse dynamics, without a simulation, "
                                      "says {}. They differ by far more than their errors: what "
                                      "the model lacks acts on the two in different ways.",
                                      fmt::join(differ, ", ")),
                          2);
}

std::string identifiability_text(const Job& job, const Identifiability& known) {
  std::string text;
  for (const WeakDirection& weak : known.weak) text += paragraph(weak_direction_text(job, weak), 2);
  for (const Combination& c : known.combinations)
    text += paragraph(fmt::format("{} = {} +- {:.2g}", name_of(job, c),
                                  with_digits_of(c.value, c.standard_error), c.standard_error),
                      2);
  return text;
}

std::string profiles_text(const RunResult& run_result) {
  if (run_result.profiles.empty()) return "";
  const FitResult& fit = run_result.fit();
  std::vector<std::vector<std::string>> rows{
      {"", "value", "from profile", "from standard error", "unit"}};
  std::string better;
  for (const Profile& profile : run_result.profiles) {
    const ParameterResult& p = fit.parameters[profile.parameter];
    const std::string name = name_of(run_result.job(), p.id);
    const ParameterUncertainty& u = p.uncertainty;
    const double digits = u.determined ? u.standard_error : 0.0;
    const auto end = [&](const ProfileEnd& e) {
      return e.open ? std::string("open") : with_digits_of(e.value, digits);
    };
    rows.push_back({name, with_digits_of(p.value, digits),
                    end(profile.lower) + " .. " + end(profile.upper), interval_text(u),
                    std::string(unit_of(run_result.job(), profile.parameter))});
    if (profile.better)
      better +=
          paragraph(fmt::format("The profile of {} found a better fit, with reduced chi-square "
                                "{:.4g}: the result is not the best minimum. Try --starts 20.",
                                name, profile.better->reduced_cost),
                    2);
  }
  return "95 % intervals\n" +
         format_table(rows, {Alignment::left, Alignment::right, Alignment::right, Alignment::right,
                             Alignment::left}) +
         better;
}

std::string suggestion_text(const RunResult& run_result) {
  const Vocabulary vocabulary = run_result.job().vocabulary();
  const std::string_view metre = unit_on(vocabulary, "m"), speed = unit_on(vocabulary, "m/s");
  for (const Discrimination& discrimination : run_result.discriminations)
    if (discrimination.experiment)
      return "Next experiment\n" +
             paragraph(fmt::format("Record {}, for {:.3g} s, with the {}: it discriminates between "
                                   "the undecided effects.",
                                   motion_text(discrimination.experiment->motion, vocabulary),
                                   discrimination.experiment->duration,
                                   info(*discrimination.signal, vocabulary).name),
                       2);
  const std::string none = "Next experiment: none is suggested, for ";
  if (!run_result.grade.is_usable())
    return paragraph(none + "the simulation does not show what the machine would do.");
  if (const auto held = held_by_bound(run_result.job(), run_result.fit()))
    return paragraph(none + name_of(run_result.job(), run_result.job().free[*held]) +
                     " is at its bound, and with a value beyond it the machine could leave its "
                     "limits. Widen the bound, or look for what the model lacks.");
  if (!run_result.suggestion)
    return paragraph(none +
                     "no motion that was tried stays within the limits for every value that the "
                     "parameters may have: within its 95 % interval, or its bounds where it is not "
                     "determined. Set 'limits' in the job if the machine may do more, narrow the "
                     "bounds, or record a small motion of your own choice first.");
  const Suggestion& s = *run_result.suggestion;
  const FitResult& fit = run_result.fit();
  const std::string name = name_of(run_result.job(), run_result.job().free[s.parameter]);
  std::string text = fmt::format(
      "Record {}, for {:.3g} s: it does most for {}, the least determined parameter. Of {} motions "
      "tried, {} stay within {:.4g} .. {:.4g} {}, {:.3g} {} and {}.",
      motion_text(s.experiment.motion, vocabulary), s.experiment.duration, name, s.tried,
      s.feasible, *s.limits.lowest, *s.limits.highest, metre, *s.limits.speed, speed,
      command_text(*s.limits.command, vocabulary));
  text += fmt::format(
      " For all values within the 95 % intervals, or the bounds of what is not determined, the "
      "simulated {} stays within {:.4g} .. {:.4g} {} and {:.3g} {}, {:.2g} {} and {:.2g} {} from "
      "the limits.",
      words_on(vocabulary, "arm"), s.reach.lowest + 0.0, s.reach.highest, metre,  // no "-0"
      s.reach.speed, speed,
      std::max(0.0,
               std::min(s.reach.lowest - *s.limits.lowest, *s.limits.highest - s.reach.highest)),
      metre, std::max(0.0, *s.limits.speed - s.reach.speed), speed);
  const MachineLimits& given = run_result.baseline.limits;
  if (!given.lowest || !given.speed)
    text += " These limits are what the recordings covered; set 'limits' in the job to allow more.";
  if (!s.predicted.parameters[s.parameter].determined) {
    const std::size_t quantity = run_result.job().free[s.parameter].quantity;
    const std::string_view need = excitation_needed(quantity_list()[quantity], vocabulary);
    text += fmt::format(" Even then {} remains undetermined{}{}.", name,
                        need.empty() ? "" : ": it needs ", need);
  }
  text = "Next experiment\n" + paragraph(text, 2);
  std::vector<std::vector<std::string>> rows{{"", "95 % interval now", "predicted", "unit"}};
  for (std::size_t i = 0; i < fit.parameters.size(); ++i)
    rows.push_back({name_of(run_result.job(), fit.parameters[i].id),
                    interval_text(fit.parameters[i].uncertainty),
                    interval_text(s.predicted.parameters[i]),
                    std::string(unit_of(run_result.job(), i))});
  return text +
         format_table(rows, {Alignment::left, Alignment::right, Alignment::right, Alignment::left});
}

std::string forecast_text(const Job& job, const Forecast& forecast, bool colour) {
  if (!forecast.finite)
    return paragraph(
        "Identifiability could not be checked: with the initial values the simulation does not "
        "finish.");
  std::vector<std::vector<std::string>> rows{{"", "expected std. error", "best seen in"}};
  std::string needs;
  for (std::size_t i = 0; i < job.free.size(); ++i) {
    const std::string name = name_of(job, job.free[i]);
    const ParameterUncertainty& u = forecast.uncertainty.parameters[i];
    const std::string_view unit = unit_of(job, i);
    Eigen::Index best = 0;
    const double most = forecast.sensitivity.row(static_cast<Eigen::Index>(i)).maxCoeff(&best);
    const SeriesRows& series = forecast.series[static_cast<std::size_t>(best)];
    const Recording& recording = job.recordings[series.recording];
    rows.push_back(
        {name, u.determined ? with_unit(fmt::format("{:.2g}", u.standard_error), unit) : "-",
         most > 0.0
             ? fmt::format(
                   "{} of {}",
                   info(recording.measurements[series.measurement].signal, job.vocabulary()).name,
                   recording.name)
             : "no signal"});
    const std::string_view need =
        excitation_needed(quantity_list()[job.free[i].quantity], job.vocabulary());
    if ((!u.determined || u.weak) && !u.at_bound && !need.empty())
      needs += paragraph(fmt::format("{} needs {}.", name, need), 2);
  }
  return "What these recordings determine, if the initial values are about right\n" +
         format_table(rows, {Alignment::left, Alignment::right, Alignment::wrapped}) +
         identifiability_text(job, forecast.identifiability) + needs + "\n" +
         meanings_text(job, forecast.uncertainty.parameters, colour);
}

}  // namespace axisfit
