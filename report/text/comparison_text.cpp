#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text_table.h"
#include "report/text/names.h"
#include "report/text/report_text.h"

namespace axisfit {
namespace {

std::string number_text(double value, const char* format) {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "-";
}

std::string name_of(const ComparedModel& model, bool in_loop) {
  if (model.name.empty()) return "declared";
  return in_loop ? "+ " + model.name : model.name;
}

std::string span_text(double horizon) {
  return horizon > 0.0 ? fmt::format("{:.3g} s", horizon) : "whole";
}

/// Values and standard errors by model, where any two of them were fitted.
std::string parameters_table(const Job& job, const Comparison& comparison) {
  std::vector<ParameterId> ids;
  for (const ComparedModel& model : comparison.models)
    for (const ParameterResult& p : model.parameters)
      if (std::ranges::find(ids, p.id) == ids.end()) ids.push_back(p.id);
  std::vector<std::vector<std::string>> rows{{""}};
  std::vector<Alignment> alignment{Alignment::left};
  for (std::size_t m = 0; m < comparison.models.size(); ++m) {
    if (comparison.models[m].parameters.empty()) continue;
    rows.front().push_back(std::to_string(m + 1));
    alignment.push_back(Alignment::right);
  }
  for (const ParameterId& id : ids) {
    rows.push_back({name_of(job, id)});
    for (const ComparedModel& model : comparison.models) {
      if (model.parameters.empty()) continue;
      const auto p = std::ranges::find(model.parameters, id, &ParameterResult::id);
      rows.back().push_back(
          p == model.parameters.end() ? ""
          : p->uncertainty.determined
              ? fmt::format("{} +- {:.2g}", with_digits_of(p->value, p->uncertainty.standard_error),
                            p->uncertainty.standard_error)
              : fmt::format("{:.4g}", p->value));
    }
  }
  return ids.empty() ? "" : format_table(rows, alignment);
}

/// "declared errs 1.4 times as much (3.1 standard errors), in 20 of 24 windows"
std::string lost_text(const Comparison& comparison, const ComparedModel& model,
                      const std::string& name) {
  return fmt::format("{} errs {:.2f} times as much ({} standard errors), more in {} of {} windows",
                     name, std::exp(model.log_ratio),
                     number_text(model.log_ratio / model.log_ratio_error, "{:.2g}"),
                     model.windows_lost, comparison.windows);
}

}  // namespace

std::string comparison_text(const RunResult& run_result) {
  if (!run_result.options.compare) return {};
  if (!run_result.comparison)
    return paragraph(
               "Nothing to compare models on: give a recording the role 'validate' that they can "
               "be simulated through.") +
           "\n";
  const Comparison& comparison = *run_result.comparison;
  const std::size_t of_loop = comparison.models.size() -
                              std::min(comparison.models.size(), run_result.options.others.size());
  std::vector<std::vector<std::string>> rows{{"", "", "free", "force"}};
  using enum Alignment;
  std::vector<Alignment> alignment{right, left, right, right};
  for (const double horizon : comparison.horizons) {
    rows.front().push_back(span_text(horizon));
    alignment.push_back(right);
  }
  for (const char* head : {"band", "AIC", "BIC"}) {
    rows.front().emplace_back(head);
    alignment.push_back(right);
  }
  double aic = INFINITY, bic = INFINITY;
  for (const ComparedModel& model : comparison.models) {
    aic = std::fmin(aic, model.aic);
    bic = std::fmin(bic, model.bic);
  }
  std::vector<std::string> names;
  for (std::size_t m = 0; m < comparison.models.size(); ++m) {
    const ComparedModel& model = comparison.models[m];
    names.push_back(name_of(model, m < of_loop));
    std::vector<std::string> row{
        std::to_string(m + 1), names.back(),
        model.parameters.empty() ? "-" : std::to_string(model.parameters.size()),
        number_text(model.missing_force, "{:.3g}")};
    for (const double error : model.free_running)
      row.push_back(number_text(100.0 * error, "{:.3g}"));
    row.push_back(number_text(model.inside_percent, "{:.0f} %"));
    row.push_back(number_text(model.aic - aic, "{:.0f}"));
    row.push_back(number_text(model.bic - bic, "{:.0f}"));
    rows.push_back(std::move(row));
  }
  const bool turns = run_result.job().model.structure.joint == Joint::revolute;
  std::string text =
      "Models compared on the recordings to validate\n" + format_table(rows, alignment) +
      paragraph(
          fmt::format("Free parameters; missing {}, {} rms; free-running error over windows of so "
                      "many seconds and over all, in per cent of the standard deviation of the "
                      "signals; how much the 95 % band holds; and, of what was fitted, AIC and BIC "
                      "above the lowest.",
                      turns ? "torque" : "force", turns ? "N m" : "N"),
          2) +
      parameters_table(run_result.job(), comparison);
  std::vector<std::string> reasons;
  for (std::size_t m = 0; m < comparison.models.size(); ++m)
    if (m != comparison.preferred && comparison.models[m].log_ratio != 0.0)
      reasons.push_back(lost_text(comparison, comparison.models[m], names[m]));
  std::string reason = fmt::format("Preferred: {}.", names[comparison.preferred]);
  for (std::size_t i = 0; i < reasons.size(); ++i)
    reason += (i == 0 ? fmt::format(" Over {} ", span_text(comparison.judged)) : "; ") + reasons[i];
  if (!reasons.empty()) reason += ".";
  const ComparedModel& preferred = comparison.models[comparison.preferred];
  if (std::ranges::any_of(comparison.models,
                          [](const ComparedModel& m) { return m.log_ratio < 0.0; }))
    reason += fmt::format(
        " It is preferred for its {} parameters: no other errs less by more than "
        "two standard errors.",
        preferred.parameters.size());
  return text + paragraph(reason, 2) + "\n";
}

}  // namespace axisfit
