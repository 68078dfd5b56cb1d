#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/rounding.h"
#include "base/terminal.h"
#include "base/text_table.h"
#include "base/units.h"
#include "fit/search/suspects.h"
#include "report/text/report_text.h"
#include "report/text/words.h"

namespace axisfit {
namespace {

/// "velocity of levels"
std::string name_of(const Job& job, const ResidualSeries& series) {
  const Recording& r = job.recordings[series.recording];
  return fmt::format(
      "{} of {}", info(r.measurements[series.measurement].signal, job.vocabulary()).name, r.name);
}

/// "F_s1 -3.2 N, F_c1 10.2 N, period 0.036 m"
std::string estimate_of(const Job& job, const Scored& suspect) {
  std::vector<std::string> parts;
  const auto add = [&](const std::vector<std::size_t>& quantities,
                       const std::vector<double>& values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const Quantity& q = job.entry(quantities[i]).quantity;
      if (values[i] == q.default_value) continue;  // an exponent as it usually is
      parts.push_back(
          fmt::format("{} {}", q.symbol, with_unit(fmt::format("{:.3g}", values[i]), q.unit)));
    }
  };
  add(suspect.hypothesis->strengths, suspect.own.strengths);
  add(suspect.hypothesis->shapes, suspect.own.shapes);
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string forces_text(const Job& job, const Diagnosis& diagnosis) {
  std::vector<std::vector<std::string>> rows;
  for (std::size_t r = 0; r < job.recordings.size(); ++r)
    rows.push_back(force_cells(job.recordings[r].name, diagnosis.forces[r], job.vocabulary()));
  return forces_table("Missing force on the arm", std::move(rows), job.vocabulary());
}

}  // namespace

std::string forces_table(std::string_view title, std::vector<std::vector<std::string>> rows,
                         Vocabulary vocabulary) {
  rows.insert(rows.begin(), {"", "rms", "from noise",
                             std::string(words_on(vocabulary, "of drive force")), "cutoff"});
  return fmt::format("{}\n{}", words_on(vocabulary, title),
                     format_table(rows, {Alignment::left, Alignment::right, Alignment::right,
                                         Alignment::right, Alignment::right}));
}

std::vector<std::string> force_cells(const std::string& name, const MissingForce& force,
                                     Vocabulary vocabulary) {
  if (!force.found) return {name, "-", "-", "-", "-"};
  const std::string_view unit = unit_on(vocabulary, "N");
  return {name, fmt::format("{:.3g} {}", force.rms, unit),
          fmt::format("{:.2g} {}", force.noise, unit),
          force.drive_rms > 0.0 ? percent(100.0 * force.rms / force.drive_rms, 3) : "-",
          fmt::format("{:.3g} Hz", force.cutoff)};
}

std::string residual_text(const Job& job, const Diagnosis& diagnosis) {
  std::vector<std::vector<std::string>> rows{
      {"", "unexplained", "depends on (fraction explained)"}};
  for (const SeriesTest& test : diagnosis.tests) {
    const Recording& recording = job.recordings[test.series.recording];
    std::vector<std::string> on;
    constexpr std::size_t kNamed = 3;
    for (const Dependence& d : test.dependences)
      if (on.size() < kNamed) on.push_back(fmt::format("{} {}", d.on, percent(100.0 * d.fraction)));
    rows.push_back(
        {series_name(recording, role_name(recording, test.series.fitted),
                     recording.measurements[test.series.measurement].signal, job.vocabulary()),
         test.explained ? "noise only" : fmt::format("{:.3g} %", test.unexplained_percent),
         fmt::format("{}", fmt::join(on, ", "))});
  }
  return "Residual beyond the noise, in per cent of its rms\n" +
         format_table(rows, {Alignment::left, Alignment::right, Alignment::wrapped});
}

std::string instruments_text(const Job& job, const Diagnosis& diagnosis) {
  std::string text;
  for (const SeriesTest& test : diagnosis.tests) {
    const Recording& recording = job.recordings[test.series.recording];
    const Measurement& m = recording.measurements[test.series.measurement];
    const std::string_view unit = info(m.signal, job.vocabulary()).unit;
    const std::string name = name_of(job, test.series);
    const auto add_line = [&](const std::string& what) {
      text += paragraph(fmt::format("The {} {}.", name, what), 2);
    };
    const auto value = [&](double x) { return with_unit(fmt::format("{:.3g}", x), unit); };
    // Beside noise that hides it, rounding is none of the reader's concern.
    if (test.resolution > m.sigma)
      add_line(fmt::format("has a resolution of {}", value(test.resolution)));
    if (test.drift.is_notable())
      add_line(fmt::format("drifts: its residual changes by {} per second, {} in total",
                           value(test.drift.per_second * m.sigma),
                           value(test.drift.span * m.sigma)));
    if (!test.outliers.empty()) {
      const auto size = [&](std::size_t i) { return std::abs(test.series.values[i]); };
      const std::size_t worst = *std::ranges::max_element(test.outliers, {}, size);
      const std::size_t n = test.outliers.size();
      add_line(fmt::format(
          "has {} outlier{}, the largest {:.3g} times the noise at {:.6g} s: bad readings, or an "
          "event simulated one sample early or late",
          n, n == 1 ? "" : "s", size(worst), recording.times[test.series.samples[worst]]));
    }
  }
  return text;
}

std::string suspected_effects_text(const Job& job, const Diagnosis& diagnosis,
                                   const std::vector<Scored>& suspects) {
  const bool found = std::ranges::any_of(diagnosis.forces, &MissingForce::found);
  std::string text = found ? forces_text(job, diagnosis) : "";
  if (suspects.empty()) return text;
  if (found) text += "\n";
  std::vector<std::vector<std::string>> rows{{"", "acts on", "explains", "estimate"}};
  for (const Scored& s : suspects)
    rows.push_back({s.hypothesis->name, s.hypothesis->acts_on, percent(100.0 * s.fraction),
                    estimate_of(job, s)});
  return text + "Suspected effects, from the residual of the tracking simulation\n" +
         format_table(rows,
                      {Alignment::left, Alignment::left, Alignment::right, Alignment::wrapped});
}

std::string residual_verdict(const Job& job, const Diagnosis& diagnosis,
                             const std::vector<Scored>& suspects, bool loop_was_asked_for,
                             bool colour, const std::vector<std::string>& faulty) {
  const auto& tests = diagnosis.tests;
  if (tests.empty()) return "";
  if (!diagnosis.explained) {
    const auto worst = std::ranges::max_element(tests, {}, &SeriesTest::unexplained_percent);
    std::string text = fmt::format("{}: up to {:.3g} % of the residual, in the {}. ",
                                   toned("Unexplained", Tone::caution, colour),
                                   worst->unexplained_percent, name_of(job, worst->series));
    const bool by_input = std::ranges::all_of(tests, [](const SeriesTest& t) {
      return t.explained || t.reduced_chi_square < 1.0 + t.series.input_noise;
    });
    if (by_input)
      text += fmt::format(
          "As much is left by {}: if the axis never received this noise, give it as sigma. ",
          input_noise_text(job));
    if (!faulty.empty())
      text += fmt::format("See first what the warnings tell of {}: that may be the cause. ",
                          fmt::join(faulty, ", "));
    if (suspects.empty())
      text += "No effect that axisfit knows explains it. ";
    else if (const Scored* cause = likely_cause(suspects))
      text += fmt::format("Most likely cause: {}. ", cause->hypothesis->name);
    else
      text += fmt::format(
          "The cause is unknown: no effect that axisfit knows explains more than {} of it. ",
          percent(100.0 * suspects.front().fraction));
    if (loop_was_asked_for)
      text += "The declared model does not fit: nothing can be said about effects yet.";
    else if (!suspects.empty())
      text += "To test the suspected effects, use --close-loop.";
    return paragraph(text);
  }
  std::set<std::string> on;
  double fraction = 0.0;
  for (const SeriesTest& test : tests)
    for (const Dependence& d : test.dependences) {
      on.insert(d.on);
      fraction = std::max(fraction, d.fraction);
    }
  std::string text =
      std::ranges::any_of(tests, [](const SeriesTest& t) { return !t.series.fitted; })
          ? "Data that were not fitted are also explained down to the noise. "
          : "";
  text += on.empty()
              ? "The residual shows no dependence on motion, position, command or time."
              : fmt::format("A small dependence on {} remains: at most {} of the mean square.",
                            fmt::join(on, ", "), percent(100.0 * fraction));
  return paragraph(text);
}

std::string residual_verdict(const RunResult& run_result, bool colour) {
  // That any model explains the recordings says nothing of this one.
  if (run_result.grade.grade == Grade::nothing_determined) return "";
  Diagnosis usual = *run_result.diagnosis;
  for (const OtherDay& day : run_result.other_days)
    std::erase_if(usual.tests,
                  [&](const SeriesTest& t) { return t.series.recording == day.recording; });
  if (!run_result.other_days.empty())
    usual.explained = std::ranges::all_of(usual.tests, &SeriesTest::explained);
  const Job& job = run_result.job();
  std::vector<std::string> faulty;
  for (std::size_t r = 0; r < run_result.checks.size(); ++r)
    if (std::ranges::any_of(
            warnings_of(run_result.baseline, job.recordings[r], run_result.checks[r]), is_fault))
      faulty.push_back(job.recordings[r].name);
  return residual_verdict(job, usual, run_result.suspects, run_result.options.select_effects,
                          colour, faulty);
}

}  // namespace axisfit
