#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/text_table.h"
#include "base/units.h"
#include "report/text/report_text.h"

namespace axisfit {
namespace {

/// "velocity of levels"
std::string name_of(const Job& job, const ResidualSeries& series) {
  const Recording& r = job.recordings[series.recording];
  return fmt::format("{} of {}", info(r.measurements[series.measurement].signal).name, r.name);
}

/// "F_s1 -3.2 N, F_c1 10.2 N, period 0.036 m"
std::string estimate_of(const Suspect& suspect) {
  std::vector<std::string> parts;
  const auto add = [&](const std::vector<std::size_t>& quantities,
                       const std::vector<double>& values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const Quantity& q = quantity_list()[quantities[i]].quantity;
      parts.push_back(
          fmt::format("{} {}", q.symbol, with_unit(fmt::format("{:.3g}", values[i]), q.unit)));
    }
  };
  add(suspect.candidate.strengths, suspect.strengths);
  add(suspect.candidate.shapes, suspect.shapes);
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string forces_text(const Job& job, const Diagnosis& diagnosis) {
  std::vector<std::vector<std::string>> rows{{"", "rms", "its noise", "of drive force", "below"}};
  for (std::size_t r = 0; r < job.recordings.size(); ++r)
    rows.push_back(force_cells(job.recordings[r].name, diagnosis.forces[r]));
  return "Missing force on the arm\n" +
         aligned(rows, {Set::left, Set::right, Set::right, Set::right, Set::right});
}

}  // namespace

std::vector<std::string> force_cells(const std::string& name, const MissingForce& force) {
  if (!force.found) return {name, "-", "-", "-", "-"};
  return {
      name, fmt::format("{:.3g} N", force.rms), fmt::format("{:.2g} N", force.noise),
      force.drive_rms > 0.0 ? fmt::format("{:.3g} %", 100.0 * force.rms / force.drive_rms) : "-",
      fmt::format("{:.3g} Hz", force.cutoff)};
}

std::string residual_text(const Job& job, const Diagnosis& diagnosis) {
  std::vector<std::vector<std::string>> rows{{"", "unexplained", "depends on (share)"}};
  for (const SeriesTest& test : diagnosis.tests) {
    const Recording& recording = job.recordings[test.series.recording];
    std::vector<std::string> on;
    constexpr std::size_t kNamed = 3;
    for (const Dependence& d : test.dependences)
      if (on.size() < kNamed) on.push_back(fmt::format("{} {:.2g} %", d.on, 100.0 * d.share));
    rows.push_back({series_name(recording, role_name(recording, test.series.fitted),
                                recording.measurements[test.series.measurement].signal),
                    test.explained ? "noise" : fmt::format("{:.3g} %", test.unexplained_percent),
                    fmt::format("{}", fmt::join(on, ", "))});
  }
  return "Residual beyond the noise, of the root mean square\n" +
         aligned(rows, {Set::left, Set::right, Set::wrapped});
}

std::string instruments_text(const Job& job, const Diagnosis& diagnosis) {
  std::string text;
  for (const SeriesTest& test : diagnosis.tests) {
    const Recording& recording = job.recordings[test.series.recording];
    const Measurement& m = recording.measurements[test.series.measurement];
    const std::string_view unit = info(m.signal).unit;
    const std::string name = name_of(job, test.series);
    const auto tell = [&](const std::string& what) {
      text += paragraph(fmt::format("The {} {}.", name, what), 2);
    };
    const auto value = [&](double x) { return with_unit(fmt::format("{:.3g}", x), unit); };
    // Beside noise that hides it, rounding is none of the reader's concern.
    if (test.grid > m.sigma) tell(fmt::format("is rounded to steps of {}", value(test.grid)));
    // Significant, and worth a word: from end to end a tenth of the noise or more.
    if (test.drift.p_value < 1e-3 && std::abs(test.drift.span) > 0.1)
      tell(fmt::format("drifts: its residual changes by {} per second, {} in all",
                       value(test.drift.per_second * m.sigma), value(test.drift.span * m.sigma)));
    if (!test.outliers.empty()) {
      const auto size = [&](std::size_t i) { return std::abs(test.series.values[i]); };
      const std::size_t worst = *std::ranges::max_element(test.outliers, {}, size);
      const std::size_t n = test.outliers.size();
      tell(fmt::format(
          "has {} outlier{}, the farthest {:.3g} times the noise off at {:.6g} s: "
          "bad readings, or an event that comes a sample early or late",
          n, n == 1 ? "" : "s", size(worst), recording.times[test.series.samples[worst]]));
    }
  }
  return text;
}

std::string suspects_text(const Job& job, const Diagnosis& diagnosis) {
  const bool found = std::ranges::any_of(diagnosis.forces, &MissingForce::found);
  std::string text = found ? forces_text(job, diagnosis) : "";
  if (diagnosis.suspects.empty()) return text;
  if (found) text += "\n";
  std::vector<std::vector<std::string>> rows{{"", "acts on", "explains", "estimate"}};
  for (const Suspect& s : diagnosis.suspects)
    rows.push_back({s.candidate.name, s.candidate.slot, fmt::format("{:.2g} %", 100.0 * s.share),
                    estimate_of(s)});
  return text + "Suspects, by the residual of the simulation held to the recordings\n" +
         aligned(rows, {Set::left, Set::left, Set::right, Set::wrapped});
}

std::string residual_verdict(const Job& job, const Diagnosis& diagnosis) {
  const auto& tests = diagnosis.tests;
  if (tests.empty()) return "";
  if (!diagnosis.explained) {
    const auto worst = std::ranges::max_element(tests, {}, &SeriesTest::unexplained_percent);
    std::string text = fmt::format("Unexplained: up to {:.3g} % of the residual, in the {}. ",
                                   worst->unexplained_percent, name_of(job, worst->series));
    if (diagnosis.suspects.empty())
      text += "No effect that axisfit knows is a suspect.";
    else
      text += fmt::format("Strongest suspect: {}. To put the suspects to the test: --close-loop.",
                          diagnosis.suspects.front().candidate.name);
    return paragraph(text);
  }
  std::set<std::string> on;
  double share = 0.0;
  for (const SeriesTest& test : tests)
    for (const Dependence& d : test.dependences) {
      on.insert(d.on);
      share = std::max(share, d.share);
    }
  std::string text =
      std::ranges::any_of(tests, [](const SeriesTest& t) { return !t.series.fitted; })
          ? "What was not fitted is explained down to the noise, too. "
          : "";
  text += on.empty()
              ? "The residual depends on nothing: not on the motion, the position, the command or "
                "the time."
              : fmt::format(
                    "A trace is left that depends on {}: at most {:.2g} % of the mean "
                    "square.",
                    fmt::join(on, ", "), 100.0 * share);
  return paragraph(text);
}

}  // namespace axisfit
