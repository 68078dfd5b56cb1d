#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "base/text_table.h"
#include "io/recording/csv.h"
#include "report/text/report_text.h"

namespace axisfit {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Until when a half width stays below a hundredth of the range of the prediction.
std::string horizon_text(const SignalPrediction& p, const Recording& recording) {
  constexpr double kPart = 0.01;
  const auto [low, high] = std::ranges::minmax(p.values);
  const std::size_t reached = p.band.reach(kPart * (high - low));
  return reached == p.values.size()
             ? "the end"
             : fmt::format("{:.3g} s", recording.times[reached] - recording.times.front());
}

/// What the bands allow for.
std::string allowance_text(const RunResult& run_result) {
  const AxisUncertainty& known = *run_result.uncertainty;
  std::string text = "The bands allow for the errors of the parameters";
  const auto scatters = [](const UncertainQuantity& q) { return q.scatter > 0.0; };
  if (std::ranges::any_of(known.quantities, scatters))
    text += ", for their scatter from recording to recording";
  const bool turns = run_result.job().model.structure.joint == Joint::revolute;
  if (known.missing_force)
    text += fmt::format(", for a missing {} of {:.2g} {} rms", turns ? "torque" : "force",
                        known.missing_force->deviation, turns ? "N m" : "N");
  return text + " and for the noise of the readings.";
}

}  // namespace

std::string prediction_text(const RunResult& run_result) {
  if (!run_result.options.predict || !run_result.uncertainty) return {};
  const Job& job = run_result.job();
  if (!run_result.no_prediction.empty())
    return paragraph("No prediction: " + run_result.no_prediction + ".") + "\n";
  if (run_result.predictions.empty())
    return paragraph("Nothing to predict: give a recording the role 'validate'.") + "\n";
  std::vector<std::vector<std::string>> rows{
      {"", "rmse", "band", "at most", "inside", "whole", "1 % until", "unit"}};
  std::string unfinished;
  for (const RecordingPrediction& prediction : run_result.predictions) {
    const Recording& recording = job.recordings[prediction.recording];
    if (prediction.signals.empty())
      unfinished += paragraph(
          fmt::format("{}: no band, for only {} of {} draws could be simulated to the end.",
                      recording.name, prediction.draws, AxisEnsemble::kDraws),
          2);
    for (const SignalPrediction& p : prediction.signals) {
      const Measurement& measured = recording.measurements[p.measurement];
      const SignalInfo signal = info(measured.signal, job.vocabulary());
      rows.push_back({fmt::format("{}: {}", recording.name, signal.name),
                      fmt::format("{:.4g}", p.rmse), fmt::format("+-{:.3g}", p.band.median()),
                      fmt::format("+-{:.3g}", p.band.largest()),
                      fmt::format("{:.1f} %", p.inside_percent),
                      fmt::format("{} {:.2g}x", p.is_whole_inside ? "in" : "not in", p.band.whole),
                      horizon_text(p, recording), std::string(signal.unit)});
    }
  }
  using enum Alignment;
  return "Prediction, free running, with 95 % bands\n" +
         format_table(rows, {left, right, right, right, right, right, right, left}) + unfinished +
         paragraph(
             "Of the band at any one time the median and largest half width, and how much of "
             "what was measured it holds; whether all of that is in the band for whole curves, "
             "so many times as wide; and until when the band is below 1 % of the range.",
             2) +
         paragraph(allowance_text(run_result), 2) + "\n";
}

std::string prediction_csv(const RunResult& run_result) {
  const Job& job = run_result.job();
  std::vector<Column> columns{{"recording", {}}, {"time_s", {}}};
  const auto column = [&](const std::string& name) -> std::vector<double>& {
    const auto found = std::ranges::find(columns, name, &Column::name);
    return found != columns.end() ? found->values : columns.emplace_back(Column{name, {}}).values;
  };
  std::size_t before = 0;
  for (const RecordingPrediction& prediction : run_result.predictions) {
    const Recording& recording = job.recordings[prediction.recording];
    const std::size_t n = recording.times.size();
    columns[0].values.insert(columns[0].values.end(), n,
                             static_cast<double>(prediction.recording + 1));
    columns[1].values.insert(columns[1].values.end(), recording.times.begin(),
                             recording.times.end());
    for (const SignalPrediction& p : prediction.signals) {
      const Measurement& measured = recording.measurements[p.measurement];
      const std::string name(info(measured.signal, job.vocabulary()).name);
      const auto fill = [&](const char* what, auto&& value) {
        std::vector<double>& values = column(name + what);
        values.resize(before, kNone);
        for (std::size_t i = 0; i < n; ++i) values.push_back(value(i));
      };
      fill("_measured", [&](std::size_t i) { return measured.values[i]; });
      fill("_predicted", [&](std::size_t i) { return p.values[i]; });
      fill("_half_width", [&](std::size_t i) { return p.band.half_width[i]; });
      fill("_half_width_of_whole",
           [&](std::size_t i) { return p.band.whole * p.band.half_width[i]; });
    }
    before += n;
  }
  for (Column& c : columns) c.values.resize(before, kNone);
  std::ostringstream out;
  write_csv(out, columns, 9);
  return out.str();
}

}  // namespace axisfit
