#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <sstream>
#include <variant>

#include "base/text_table.h"
#include "base/units.h"
#include "io/recording/csv.h"
#include "report/text/report_text.h"

namespace axisfit {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// The allowed error of a signal, in its unit; none where the user names none.
std::optional<double> tolerance_for(const RunOptions& options, std::string_view unit) {
  for (const Tolerance& tolerance : options.tolerances)
    if (const auto factor = unit_factor(tolerance.unit, unit);
        std::holds_alternative<double>(factor))
      return tolerance.value * std::get<double>(factor);
  return std::nullopt;
}

/// Until when a half width stays below the tolerance, or else a hundredth of the range of the
/// prediction.
std::string reach_text(const Band& band, std::span<const double> values,
                       std::span<const double> times, std::optional<double> tolerance) {
  constexpr double kPart = 0.01;
  const auto [low, high] = std::ranges::minmax(values);
  const std::size_t reached = band.reach(tolerance.value_or(kPart * (high - low)));
  return reached == values.size() ? "the end"
                                  : fmt::format("{:.3g} s", times[reached] - times.front());
}

std::string tolerances_text(const RunOptions& options) {
  std::vector<std::string> parts;
  for (const Tolerance& t : options.tolerances)
    parts.push_back(fmt::format("{:g} {}", t.value, t.unit));
  return fmt::format(
      "{}1 % of the range",
      parts.empty() ? "" : fmt::format("{}, elsewhere below ", fmt::join(parts, " or ")));
}

/// The motion that nobody recorded, where one was asked for.
std::string motion_text(const RunResult& run_result) {
  if (!run_result.motion)
    return run_result.no_prediction.empty()
               ? ""
               : paragraph("No further prediction: " + run_result.no_prediction + ".") + "\n";
  const MotionPrediction& motion = *run_result.motion;
  const Vocabulary vocabulary = run_result.job().vocabulary();
  std::vector<std::vector<std::string>> rows{
      {"", "lowest", "highest", "band", "at most", "until", "unit"}};
  for (std::size_t s = 0; s < motion.signals.size(); ++s) {
    // Each signal is followed by its two half widths.
    const std::vector<Column>& columns = motion.columns;
    const std::size_t at = columns.size() - 3 * (motion.signals.size() - s);
    const Band band{columns[at + 1].values};
    const SignalInfo signal = info(motion.signals[s], vocabulary);
    const auto [low, high] = std::ranges::minmax(columns[at].values);
    rows.push_back({std::string(signal.name), fmt::format("{:.4g}", low),
                    fmt::format("{:.4g}", high), fmt::format("+-{:.3g}", band.median()),
                    fmt::format("+-{:.3g}", band.largest()),
                    reach_text(band, columns[at].values, columns.front().values,
                               tolerance_for(run_result.options, signal.unit)),
                    std::string(signal.unit)});
  }
  using enum Alignment;
  return fmt::format("Prediction of {}, with 95 % bands\n", motion.name) +
         format_table(rows, {left, right, right, right, right, right, left}) +
         paragraph(fmt::format("The band at any one time, its median and largest half width, and "
                               "until when it is below {}.",
                               tolerances_text(run_result.options)),
                   2) +
         "\n";
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
  if (!run_result.no_prediction.empty() && run_result.predictions.empty())
    return paragraph("No prediction: " + run_result.no_prediction + ".") + "\n";
  if (run_result.predictions.empty() && run_result.motion) return motion_text(run_result);
  if (run_result.predictions.empty())
    return paragraph("Nothing to predict: give a recording the role 'validate'.") + "\n";
  std::vector<std::vector<std::string>> rows{
      {"", "rmse", "band", "at most", "inside", "whole",
       run_result.options.tolerances.empty() ? "1 % until" : "until", "unit"}};
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
                      reach_text(p.band, p.values, recording.times,
                                 tolerance_for(run_result.options, signal.unit)),
                      std::string(signal.unit)});
    }
  }
  using enum Alignment;
  return "Prediction, free running, with 95 % bands\n" +
         format_table(rows, {left, right, right, right, right, right, right, left}) + unfinished +
         paragraph(
             fmt::format("Of the band at any one time the median and largest half width, and how "
                         "much of what was measured it holds; whether all of that is in the band "
                         "for whole curves, so many times as wide; and until when the band is "
                         "below {}.",
                         tolerances_text(run_result.options)),
             2) +
         paragraph(allowance_text(run_result), 2) + "\n" + motion_text(run_result);
}

std::string motion_csv(const RunResult& run_result) {
  std::ostringstream out;
  write_csv(out, run_result.motion->columns, 9);
  return out.str();
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
