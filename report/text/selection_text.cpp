#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/text_table.h"
#include "base/units.h"
#include "report/text/report_text.h"

namespace axisfit {
namespace {

/// "F_c = 24.95 +- 0.12 N"; of a curve the range of its coefficients.
std::string estimate_of(const EffectTrial& trial) {
  const auto unit_of = [](const ParameterResult& p) {
    return find_quantity(p.name)->quantity.unit;
  };
  if (trial.parameters.empty()) return "";
  if (trial.candidate.unnamed) {
    const auto [low, high] = std::ranges::minmax(trial.parameters, {}, &ParameterResult::value);
    return fmt::format("{} coefficients of {:.3g} to {}", trial.parameters.size(), low.value,
                       with_unit(fmt::format("{:.3g}", high.value), unit_of(high)));
  }
  std::vector<std::string> parts;
  for (const ParameterResult& p : trial.parameters) {
    const ParameterUncertainty& u = p.uncertainty;
    const std::string number =
        u.determined ? fmt::format("{} +- {:.2g}", with_digits_of(p.value, u.standard_error),
                                   u.standard_error)
                     : fmt::format("{:.3g}", p.value);
    parts.push_back(fmt::format("{} = {}", find_quantity(p.name)->quantity.symbol,
                                with_unit(number, unit_of(p))));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string effects_text(const ClosedLoop& loop) {
  if (loop.effects.empty()) return "";
  std::vector<std::vector<std::string>> rows;
  for (const Decision decision : {Decision::accepted, Decision::undecided, Decision::refused})
    for (const EffectTrial& t : loop.effects) {
      if (t.decision != decision) continue;
      const std::string estimate = estimate_of(t);
      rows.push_back({decision_name(decision), t.candidate.name,
                      estimate + (estimate.empty() ? "" : ": ") + t.reason});
    }
  return "Effects that were tried\n" + aligned(rows, {Set::left, Set::left, Set::wrapped}) + "\n";
}

std::string model_name(const LoopModel& model) {
  return model.added.empty() ? "  declared" : "  + " + model.added;
}

std::string errors_text(const Outcome& outcome) {
  const ClosedLoop& loop = *outcome.loop;
  const bool held = std::ranges::any_of(outcome.scores.front().signals,
                                        [](const SignalScore& s) { return s.held.has_value(); });
  std::vector<std::vector<std::string>> rows{{"", "rmse", "of range", "red. chi2", ""}};
  if (held) rows.front().back() = "free-running rmse";
  for (const SignalScore& head : outcome.scores.front().signals) {
    const Recording& recording = outcome.job().recordings[head.recording];
    const Measurement& m = recording.measurements[head.measurement];
    const std::string_view unit = info(m.signal).unit;
    rows.push_back({series_name(recording, role_name(recording, head.fitted), m.signal)});
    for (std::size_t i = 0; i < loop.models.size(); ++i) {
      const SignalScore* score = find_series(outcome.scores[i].signals, head);
      std::vector<std::string> row{model_name(loop.models[i]), "-", "-", "-", ""};
      if (score != nullptr && score->judged()) {
        const SignalErrors& e = *score->judged();
        row[1] = fmt::format("{:.4g} {}", e.rmse, unit);
        row[2] = fmt::format("{:.3g} %", e.nrmse_percent);
        row[3] = fmt::format("{:.4g}", e.reduced_chi_square);
        if (held && score->free_running)
          row[4] = fmt::format("{:.4g} {}", score->free_running->rmse, unit);
      }
      rows.push_back(std::move(row));
    }
  }
  return fmt::format("Errors of the {}simulation, before and after\n",
                     held ? "held " : "free-running ") +
         aligned(rows, {Set::left, Set::right, Set::right, Set::right, Set::right});
}

std::string forces_text(const Outcome& outcome) {
  const ClosedLoop& loop = *outcome.loop;
  std::vector<std::vector<std::string>> rows{{"", "rms", "its noise", "of drive force", "below"}};
  for (std::size_t r = 0; r < outcome.job().recordings.size(); ++r) {
    rows.push_back({outcome.job().recordings[r].name});
    for (std::size_t i = 0; i < loop.models.size(); ++i)
      rows.push_back(force_cells(model_name(loop.models[i]), outcome.scores[i].forces[r]));
  }
  return "Missing force on the arm, before and after\n" +
         aligned(rows, {Set::left, Set::right, Set::right, Set::right, Set::right});
}

}  // namespace

std::string loop_text(const Outcome& outcome) {
  std::string text = effects_text(*outcome.loop) + errors_text(outcome) + "\n";
  if (outcome.loop->held_out_blocks)
    text += paragraph(
                "No recording has the role validate: every second tenth of each recording was not "
                "fitted but held out, to judge the effects by.",
                2) +
            "\n";
  return text + forces_text(outcome);
}

}  // namespace axisfit
