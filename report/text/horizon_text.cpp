#include <fmt/format.h>

#include <cmath>

#include "base/text_table.h"
#include "report/text/report_text.h"

namespace axisfit {

std::string horizon_name(const Criterion& criterion) {
  if (tracks(criterion))
    return fmt::format("one step ahead, observer gain {:.3g} 1/s", given_gain(criterion));
  if (const double length = window_length(criterion); length > 0.0)
    return fmt::format("windows of {:.3g} s", length);
  return "whole recordings";
}

std::string horizon_text(const RunResult& run_result) {
  if (!run_result.horizon) return {};
  const HorizonChoice& choice = *run_result.horizon;
  std::vector<std::vector<std::string>> rows{{"", "error", ""}};
  for (std::size_t t = 0; t < choice.trials.size(); ++t) {
    const HorizonTrial& trial = choice.trials[t];
    rows.push_back({horizon_name(trial.criterion),
                    std::isfinite(trial.error) ? fmt::format("{:.3g} %", 100.0 * trial.error)
                                               : "not simulated",
                    t == choice.chosen ? "chosen" : ""});
  }
  return fmt::format("Horizon of the fit, chosen on {} stretches of up to {:.3g} s\n{}",
                     choice.stretches, choice.longest,
                     format_table(rows, {Alignment::left, Alignment::right, Alignment::left})) +
         paragraph(
             "Free-running error on stretches of the fitted recordings that were left out in turn, "
             "in standard deviations of the signals.",
             2) +
         "\n";
}

}  // namespace axisfit
