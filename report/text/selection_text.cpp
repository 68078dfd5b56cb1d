#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <span>

#include "base/terminal.h"
#include "base/text_table.h"
#include "base/units.h"
#include "report/text/names.h"
#include "report/text/report_text.h"
#include "report/text/words.h"

namespace axisfit {
namespace {

/// "F_c = 24.95 +- 0.12 N"; of a curve the range of its coefficients.
std::string estimates_text(const Job& job, const std::vector<ParameterResult>& parameters,
                           bool is_curve) {
  if (parameters.empty()) return "";
  if (is_curve) {
    const auto [low, high] = std::ranges::minmax(parameters, {}, &ParameterResult::value);
    return fmt::format(
        "{} coefficients from {:.3g} to {}", parameters.size(), low.value,
        with_unit(fmt::format("{:.3g}", high.value), quantity_of(job, high.id).unit));
  }
  std::vector<std::string> parts;
  for (const ParameterResult& p : parameters) {
    const ParameterUncertainty& u = p.uncertainty;
    const std::string number =
        u.determined ? fmt::format("{} +- {:.2g}", with_digits_of(p.value, u.standard_error),
                                   u.standard_error)
                     : fmt::format("{:.3g}", p.value);
    const Quantity& quantity = quantity_of(job, p.id);
    parts.push_back(fmt::format("{} = {}", quantity.symbol, with_unit(number, quantity.unit)));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

/// ", n = 2 (held)": what an effect in the model has besides its estimates.
std::string held_text(const Job& job, const Outcome& t) {
  if (t.decision() != Decision::accepted || t.hypothesis.kind != HypothesisKind::effect) return "";
  Model<double> model = job.model;
  std::string text;
  for (const std::size_t q :
       std::span(t.hypothesis.shapes).subspan(t.hypothesis.estimated_shapes().size())) {
    if (std::ranges::find(job.free, q, &FreeParameter::quantity) != job.free.end()) continue;
    const Quantity& quantity = job.entry(q).quantity;
    text += fmt::format(", {} = {} (held)", quantity.symbol,
                        with_unit(fmt::format("{:.3g}", *members(model)[q]), quantity.unit));
  }
  return text;
}

Tone tone_of(Decision decision) {
  return decision == Decision::accepted    ? Tone::good
         : decision == Decision::undecided ? Tone::caution
                                           : Tone::neutral;
}

/// What other recordings say of an accepted effect.
std::string elsewhere_text(const Job& job, const Outcome& t) {
  if (!t.replication || t.hypothesis.kind == HypothesisKind::curve) return "";
  const Replication& found = *t.replication;
  return fmt::format("; the recordings to validate, fitted by themselves, {}: {}",
                     found.is_alike  ? "tell alike"
                     : found.is_near ? "agree, but do not prove it"
                                     : "tell otherwise",
                     estimates_text(job, t.replication->parameters, false));
}

std::string effects_text(const EffectSelection& selection, bool colour) {
  if (selection.effects.empty()) return "";
  const Job& job = selection.result.job;
  std::vector<std::vector<std::string>> rows;
  for (const Decision decision : {Decision::accepted, Decision::undecided, Decision::rejected})
    for (const Outcome& t : selection.effects) {
      if (t.decision() != decision) continue;
      const std::string estimate =
          estimates_text(job, t.parameters, t.hypothesis.kind == HypothesisKind::curve) +
          held_text(job, t);
      rows.push_back({toned(decision_name(decision), tone_of(decision), colour), t.hypothesis.name,
                      estimate + (estimate.empty() ? "" : ": ") + reason_text(job, t) +
                          elsewhere_text(job, t)});
    }
  return "Effects tried\n" +
         format_table(rows, {Alignment::left, Alignment::left, Alignment::wrapped}) + "\n";
}

std::string model_name(const FittedModel& model) {
  return model.added.empty() ? "  baseline" : "  + " + model.added;
}

std::string errors_text(const RunResult& run_result) {
  const EffectSelection& selection = *run_result.selection;
  const Vocabulary vocabulary = run_result.job().vocabulary();
  const bool tracking =
      std::ranges::any_of(run_result.scores.front().signals,
                          [](const SignalScore& s) { return s.tracking.has_value(); });
  std::vector<std::vector<std::string>> rows{{"", "rmse", "of range", "red. chi2", ""}};
  if (tracking) rows.front().back() = "free-running rmse";
  for (const SignalScore& head : run_result.scores.front().signals) {
    const Recording& recording = run_result.job().recordings[head.recording];
    const Measurement& m = recording.measurements[head.measurement];
    const std::string_view unit = info(m.signal, vocabulary).unit;
    rows.push_back(
        {series_name(recording, role_name(recording, head.fitted), m.signal, vocabulary)});
    for (std::size_t i = 0; i < selection.models.size(); ++i) {
      const SignalScore* score = find_series(run_result.scores[i].signals, head);
      std::vector<std::string> row{model_name(selection.models[i]), "-", "-", "-", ""};
      if (score != nullptr && score->as_fitted()) {
        const SignalErrors& e = *score->as_fitted();
        row[1] = fmt::format("{:.4g} {}", e.rmse, unit);
        row[2] = fmt::format("{:.3g} %", e.nrmse_percent);
        row[3] = fmt::format("{:.4g}", e.reduced_chi_square);
        if (tracking && score->free_running)
          row[4] = fmt::format("{:.4g} {}", score->free_running->rmse, unit);
      }
      rows.push_back(std::move(row));
    }
  }
  return fmt::format("Errors of the {}, before and after\n",
                     simulation_name(run_result.job().options, tracking)) +
         format_table(rows, {Alignment::left, Alignment::right, Alignment::right, Alignment::right,
                             Alignment::right});
}

std::string forces_text(const RunResult& run_result) {
  const EffectSelection& selection = *run_result.selection;
  const Vocabulary vocabulary = run_result.job().vocabulary();
  std::vector<std::vector<std::string>> rows;
  for (std::size_t r = 0; r < run_result.job().recordings.size(); ++r) {
    rows.push_back({run_result.job().recordings[r].name});
    for (std::size_t i = 0; i < selection.models.size(); ++i)
      rows.push_back(
          force_cells(model_name(selection.models[i]), run_result.scores[i].forces[r], vocabulary));
  }
  return forces_table("Missing force on the arm, before and after", std::move(rows), vocabulary);
}

}  // namespace

std::string selection_text(const RunResult& run_result, bool colour) {
  std::string text = effects_text(*run_result.selection, colour) + errors_text(run_result) + "\n";
  if (const std::string judges = judges_text(run_result); !judges.empty())
    text += paragraph(judges, 2) + "\n";
  return text + forces_text(run_result);
}

}  // namespace axisfit
