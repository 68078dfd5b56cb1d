#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/text_table.h"
#include "base/units.h"
#include "report/text/names.h"
#include "report/text/report_text.h"

namespace axisfit {
namespace {

std::string name_of(const Job& job, const Scatter& scatter, std::size_t group) {
  const Scatter::Group& g = scatter.groups[group];
  const std::string& recording = job.recordings[g.recording].name;
  return scatter.of_stretches && g.fitted
             ? fmt::format("{} from {:.3g} s to {:.3g} s", recording, g.from, g.to)
             : recording;
}

/// The largest step of a parameter from one group to the next, where that is far beyond its errors.
std::string step_text(const Job& job, const FitResult& fit, const Scatter& scatter,
                      const ParameterScatter& p) {
  constexpr double kFar = 4.0;  // standard errors
  double farthest = kFar;
  std::string text;
  for (std::size_t g = 1; g < p.groups.size(); ++g) {
    const EstimateOfGroup &before = p.groups[g - 1], &after = p.groups[g];
    if (!before.determined || !after.determined) continue;
    const double error = std::hypot(before.standard_error, after.standard_error),
                 steps = std::abs(after.value - before.value) / error;
    if (!(steps > farthest)) continue;
    farthest = steps;
    text = fmt::format("{} steps from {} ({}) to {} ({}): {:.2g} standard errors",
                       name_of(job, fit.parameters[p.parameter].id),
                       with_digits_of(before.value, error), name_of(job, scatter, g - 1),
                       with_unit(with_digits_of(after.value, error),
                                 quantity_of(job, fit.parameters[p.parameter].id).unit),
                       name_of(job, scatter, g), steps);
  }
  return text;
}

}  // namespace

std::string scatter_text(const RunResult& run_result) {
  if (!run_result.scatter) return {};
  const Scatter& scatter = *run_result.scatter;
  const Job& job = run_result.job();
  const FitResult& fit = run_result.fit();
  std::vector<std::vector<std::string>> rows{
      {"", "error within", "scatter", "95 % interval", "for the machine", "unit"}};
  std::vector<std::string> scattered;
  for (const ParameterScatter& p : scatter.parameters) {
    const ParameterResult& found = fit.parameters[p.parameter];
    const std::string name = name_of(job, found.id);
    const bool is_known = found.uncertainty.determined;
    if (p.deviation > 0.0 && is_known) scattered.push_back(name);
    rows.push_back({name, fmt::format("{:.2g}", p.within),
                    p.deviation > 0.0 ? fmt::format("{:.2g}", p.deviation) : "none seen",
                    fmt::format("{:.2g} .. {:.2g}", p.lower, p.upper),
                    is_known ? fmt::format("{:.2g}", found.uncertainty.standard_error) : "-",
                    std::string(quantity_of(job, found.id).unit)});
  }
  using enum Alignment;
  const std::size_t groups = scatter.fitted_groups();
  const auto fitted = std::ranges::find(scatter.groups, true, &Scatter::Group::fitted);
  const std::string of = scatter.of_stretches ? fmt::format("{} stretches of {}", groups,
                                                            job.recordings[fitted->recording].name)
                                              : fmt::format("{} recordings", groups);
  std::string text = fmt::format("Scatter between {}\n{}", of,
                                 format_table(rows, {left, right, right, right, right, left}));
  if (!scattered.empty())
    text += paragraph(fmt::format("Standard errors and intervals above are for the machine: those "
                                  "of {} include the scatter.",
                                  fmt::join(scattered, ", ")),
                      2);
  if (groups == 2)
    text += paragraph("Two say little of a scatter: its interval tells how little.", 2);
  for (const ParameterScatter& p : scatter.parameters)
    if (const std::string step = step_text(job, fit, scatter, p); !step.empty())
      text += paragraph(step + ".", 2);
  return text + "\n";
}

}  // namespace axisfit
