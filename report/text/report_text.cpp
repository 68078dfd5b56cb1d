#include "report/text/report_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "base/terminal.h"
#include "base/text_table.h"
#include "fit/data/standstill.h"
#include "io/recording/csv.h"
#include "report/text/names.h"
#include "report/text/words.h"
#include "sim/rig.h"

namespace axisfit {
namespace {

/// What an accelerometer shows at rest, where it has nothing to show and is left out.
std::string excluded_text(const Recording& recording, Vocabulary vocabulary) {
  std::string text;
  for (const Measurement& m : recording.measurements) {
    const auto excluded = excluded_samples(m);
    if (!excluded) continue;
    const SignalInfo signal = info(m.signal, vocabulary);
    text += paragraph(
        fmt::format(
            "{}: {} samples of the {} at standstill are excluded, with a mean of {:.3g} {}{}.",
            recording.name, excluded->samples, signal.name, excluded->mean, signal.unit,
            excluded->is_within_noise ? "" : ": a bias or an artefact of the instrument"),
        2);
  }
  return text;
}

std::string recordings_text(const RunResult& run_result) {
  const Job& job = run_result.job();
  std::vector<std::vector<std::string>> rows;
  for (const Recording& r : job.recordings) {
    std::string signals;
    for (const Measurement& m : r.measurements)
      signals += (signals.empty() ? "" : ", ") + std::string(info(m.signal, job.vocabulary()).name);
    rows.push_back({r.name, r.role == Role::fit ? "fit" : "validate",
                    fmt::format("{} samples", r.times.size()),
                    fmt::format("{:.4g} s to {:.4g} s", r.times.front(), r.times.back()), signals});
  }
  std::string text =
      "Recordings\n" + format_table(rows, {Alignment::left, Alignment::left, Alignment::right,
                                           Alignment::left, Alignment::wrapped});
  for (std::size_t r = 0; r < job.recordings.size(); ++r) {
    text += excluded_text(job.recordings[r], job.vocabulary());
    for (const std::string& warning :
         warnings_for(run_result.baseline, job.recordings[r], run_result.checks[r]))
      text += paragraph(fmt::format("! {}: {}", job.recordings[r].name, warning), 2);
  }
  return text;
}

/// What stands beside the numbers, which have no room for it.
std::string legend_text(const Job& job, const FitResult& result, bool colour) {
  std::vector<ParameterUncertainty> known;
  for (const ParameterResult& p : result.parameters) known.push_back(p.uncertainty);
  return meanings_text(job, known, colour);
}

/// With a closed loop, the declared model's estimates stand where the initial values would.
std::string parameters_text(const RunResult& run_result) {
  const Job& job = run_result.job();
  const FitResult& result = run_result.fit();
  std::vector<std::vector<std::string>> rows{{"", "value", "std. error", "95 % interval",
                                              run_result.selection ? "baseline" : "initial",
                                              "unit"}};
  for (std::size_t i = 0; i < job.free.size(); ++i) {
    const ParameterResult& p = result.parameters[i];
    const ParameterUncertainty& u = p.uncertainty;
    const Quantity& quantity = quantity_of(job, p.id);
    const double error = u.determined ? u.standard_error : 0.0;
    const bool undetermined = !u.determined && !u.at_bound;
    std::string other = fmt::format("{:.4g}", job.free[i].initial);
    if (run_result.selection) {
      const auto& declared = run_result.selection->models.front().fit.parameters;
      other = i < declared.size() ? fmt::format("{:.4g}", declared[i].value) : "-";
    }
    rows.push_back({name_of(job, p.id),
                    undetermined ? fmt::format("~{:.1g}", p.value) : with_digits_of(p.value, error),
                    u.determined ? fmt::format("{:.2g}", error) : "-",
                    u.has_interval() ? fmt::format("{} .. {}", with_digits_of(u.lower, error),
                                                   with_digits_of(u.upper, error))
                                     : "-",
                    other, std::string(quantity.unit)});
  }
  return "Parameters\n" + format_table(rows, {Alignment::left, Alignment::right, Alignment::right,
                                              Alignment::right, Alignment::right, Alignment::left});
}

/// How many of several starts ended in the same place, and where the others did. Of one that leaves
/// much in a model with many minima, that more may find a better one.
std::string starts_text(const RunResult& run_result) {
  const FitResult& first = run_result.first;
  const std::size_t starts = first.starts.size();
  if (starts < 2) {
    constexpr double kMuch = 4.0;
    const bool has_many = capabilities(run_result.job().model.structure).has_backlash;
    return has_many && run_result.fit().is_usable() && run_result.fit().reduced_chi_square > kMuch
               ? paragraph(
                     "A gear makes wrong minima: --starts 8 shows whether this is one of them.", 2)
               : "";
  }
  const std::vector<Minimum> minima = distinct_minima(first.starts);
  if (minima.empty()) return "";
  std::string text = fmt::format("{} of {} starts reach this minimum", minima[0].starts, starts);
  constexpr std::size_t kNamed = 4;
  std::size_t counted = static_cast<std::size_t>(minima[0].starts);
  for (std::size_t i = 1; i < std::min(minima.size(), kNamed); ++i) {
    text += fmt::format(", {} one with reduced chi-square {:.4g}", minima[i].starts,
                        minima[i].reduced_cost);
    counted += static_cast<std::size_t>(minima[i].starts);
  }
  if (counted < starts) text += fmt::format(", {} end elsewhere or fail", starts - counted);
  return paragraph(text + ".", 2);
}

const char* mark_of(NoiseSource noise) {
  switch (noise) {
    case NoiseSource::given:
      return "";
    case NoiseSource::differences:
      return "*";
    case NoiseSource::fit:
      return "**";
    case NoiseSource::standstill:
      return "***";
  }
  return "";
}

std::string errors_text(const Job& job, const FitResult& result) {
  const bool prediction = tracks(job.options.criterion);
  std::vector<std::vector<std::string>> rows{
      {"", "rmse", "of range", "noise", "red. chi2", "unit", ""}};
  if (prediction) rows.front().back() = "prediction rmse";
  for (std::size_t r = 0; r < job.recordings.size(); ++r) {
    const Recording& recording = job.recordings[r];
    for (const SignalError& e : result.recordings[r].signals) {
      const bool finished = result.recordings[r].free_running.finished;
      rows.push_back({series_name(recording, role_name(recording, e), e.signal, job.vocabulary()),
                      finished ? fmt::format("{:.4g}", e.rmse) : "-",
                      finished ? fmt::format("{:.3g} %", e.nrmse_percent) : "-",
                      fmt::format("{:.3g}{}", e.sigma, mark_of(e.noise)),
                      finished ? fmt::format("{:.4g}", e.reduced_chi_square) : "-",
                      std::string(info(e.signal, job.vocabulary()).unit),
                      e.prediction_rmse ? fmt::format("{:.4g}", *e.prediction_rmse) : ""});
    }
  }
  std::string text =
      "Errors of the free-running simulation\n" +
      format_table(rows, {Alignment::left, Alignment::right, Alignment::right, Alignment::right,
                          Alignment::right, Alignment::left, Alignment::right});
  if (has_noise_from(job, NoiseSource::differences))
    text += "  * estimated from differences of the samples\n";
  if (has_noise_from(job, NoiseSource::standstill))
    text += "  *** estimated from the scatter at standstill\n";
  if (has_noise_from(job, NoiseSource::fit))
    text += paragraph(
        "** estimated jointly with the parameters: the reduced chi-square is one by construction",
        2);
  return text;
}

}  // namespace

std::string series_name(const Recording& recording, const char* role, Signal signal,
                        Vocabulary vocabulary) {
  return fmt::format("{}, {}: {}", recording.name, role, info(signal, vocabulary).name);
}

std::string report_text(const RunResult& run_result, bool colour) {
  const Job& job = run_result.job();
  const FitResult& result = run_result.fit();
  std::string stopped_errors = stopped_errors_text(run_result);
  if (!stopped_errors.empty()) stopped_errors = paragraph(stopped_errors, 2);
  std::string text = fmt::format(
      "{}\n{}{}\n{}\n{}\n", recordings_text(run_result), parameters_text(run_result),
      uncertainty_text(job, result) + stopped_errors + second_opinion_text(run_result) +
          starts_text(run_result),
      legend_text(job, result, colour),
      run_result.selection ? selection_text(run_result, colour) : errors_text(job, result));
  text += horizon_text(run_result) + scatter_text(run_result) + prediction_text(run_result) +
          comparison_text(run_result);
  if (const std::string profiles = profiles_text(run_result); !profiles.empty())
    text += profiles + "\n";
  if (run_result.diagnosis && !run_result.diagnosis->explained) {
    text += residual_text(job, *run_result.diagnosis) + "\n";
    // A loop has told of the force, and has put the suspects to the test.
    const std::string suspected_effects =
        run_result.selection
            ? ""
            : suspected_effects_text(job, *run_result.diagnosis, run_result.suspects);
    if (!suspected_effects.empty()) text += suspected_effects + "\n";
  }
  if (run_result.diagnosis)
    if (const std::string faults = instruments_text(job, *run_result.diagnosis); !faults.empty())
      text += "Instruments\n" + faults + "\n";
  text += paragraph(overall_verdict(run_result, colour));
  for (const Discrimination& s : run_result.discriminations)
    text += paragraph(discrimination_text(s, job.vocabulary()));
  if (!run_result.selection && run_result.diagnosis) text += residual_verdict(run_result, colour);
  if (run_result.interrupted) {
    const int starts = std::max(1, job.options.starts);
    return text + "\n" +
           paragraph(fmt::format(
               "{}{}: this is the result of {}{}.", toned("Stopped early", Tone::caution, colour),
               stop_reason(run_result),
               starts > 1 ? fmt::format("{} of {} starts", run_result.first.starts.size(), starts)
                          : "the fit",
               run_result.selection ? ", with the effects accepted so far" : ""));
  }
  if (run_result.options.suggest_experiment) text += "\n" + suggestion_text(run_result);
  return text;
}

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// The missing force of all recordings, one after the other, and what it may depend on.
std::vector<Column> force_columns(const Job& job, const Diagnosis& diagnosis) {
  struct Course {
    const char *name, *unit;
    double Sample::*member;
  };
  constexpr Course kCourse[]{
      {"command", "U", &Sample::command},         {"arm_position", "m", &Sample::position},
      {"arm_velocity", "m/s", &Sample::velocity}, {"motor_angle", "rad", &Sample::motor_angle},
      {"motor_current", "A", &Sample::current},   {"drive_force", "N", &Sample::drive_force},
      {"gear_force", "N", &Sample::gear_force}};
  const auto called = [&](const char* name, const char* unit) {
    return column_name(words_on(job.vocabulary(), name), unit_on(job.vocabulary(), unit));
  };
  std::vector<Column> columns{{called("missing_force", "N"), {}}};
  for (const Course& course : kCourse) columns.push_back({called(course.name, course.unit), {}});
  for (std::size_t r = 0; r < job.recordings.size(); ++r) {
    const MissingForce& force = diagnosis.forces[r];
    for (std::size_t i = 0; i < job.recordings[r].times.size(); ++i) {
      columns.front().values.push_back(force.found ? force.force[i] : kNone);
      for (std::size_t c = 0; c < std::size(kCourse); ++c)
        columns[c + 1].values.push_back(force.found ? force.samples[i].*kCourse[c].member : kNone);
    }
  }
  return columns;
}

}  // namespace

std::string residuals_csv(const Job& job, const FitResult& result,
                          const std::optional<Diagnosis>& diagnosis) {
  std::vector<double> number, time;
  for (std::size_t r = 0; r < job.recordings.size(); ++r)
    for (const double t : job.recordings[r].times) {
      number.push_back(static_cast<double>(r + 1));
      time.push_back(t);
    }
  std::vector<Column> columns{{"recording", number}, {"time_s", time}};
  for (const SignalInfo& signal : kSignalTable) {
    const std::string name(info(signal.signal, job.vocabulary()).name);
    Column measured{name + "_measured", {}}, simulated{name + "_simulated", {}},
        residual{name + "_residual", {}};
    bool recorded = false;
    for (std::size_t r = 0; r < job.recordings.size(); ++r) {
      const Recording& recording = job.recordings[r];
      const auto m = std::ranges::find(recording.measurements, signal.signal, &Measurement::signal);
      const bool present = m != recording.measurements.end();
      recorded = recorded || present;
      const auto index = static_cast<std::size_t>(m - recording.measurements.begin());
      for (std::size_t i = 0; i < recording.times.size(); ++i) {
        const double y = present ? m->values[i] : kNone;
        const bool reached =
            present && i < result.recordings[r].free_running.simulated[index].size();
        const double s = reached ? result.recordings[r].free_running.simulated[index][i] : kNone;
        measured.values.push_back(y);
        simulated.values.push_back(s);
        residual.values.push_back(y - s);
      }
    }
    if (!recorded) continue;
    for (Column* c : {&measured, &simulated, &residual}) columns.push_back(std::move(*c));
  }
  if (diagnosis)
    for (Column& column : force_columns(job, *diagnosis)) columns.push_back(std::move(column));
  std::ostringstream out;
  write_csv(out, columns, 9);
  return out.str();
}

}  // namespace axisfit
