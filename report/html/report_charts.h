// The charts of what was found.
#pragma once

#include <string>
#include <vector>

#include "fit/run.h"
#include "report/html/chart.h"

namespace axisfit {

/// Makes the figures of a page, and remembers what its script needs for them. The outcome must
/// outlive it.
class ReportCharts {
 public:
  explicit ReportCharts(const RunResult& run_result);

  /// The signal that the declared model explains least, as it was measured and as it is simulated,
  /// or, with a closed loop, what was left of it before and after.
  Html overview();
  /// Every signal of a recording over time, measured and simulated, and the residual below it; and
  /// the two ends of the transmission against each other.
  Html traces(std::size_t recording);
  /// The residual of one series over what it may depend on, its autocorrelation and its spectrum.
  Html views(const SeriesTest& test);
  /// The missing force of a recording over time, velocity, position and wave number, and what the
  /// accepted effects supply of it. Empty where none was found.
  Html missing_force(std::size_t recording);
  /// What was measured less what was predicted, with the bands of that, of every signal over time.
  Html prediction(const RecordingPrediction& prediction);
  /// Deviance over the value, with the parabola that the standard error takes it for.
  Html profile(const Profile& profile);
  /// Cost and observer over the iterations, and where the starts ended.
  Html convergence();

  /// For the script: see chart_data().
  nlohmann::ordered_json data() const { return chart_data(charts_, columns_); }

 private:
  struct RecordingCharts {
    ChartColumns::Index times = 0;
    std::vector<ChartRange> phases;
    std::vector<ChartEvents> events;
    std::vector<ChartColumns::Index> measured, simulated;  ///< of every measurement
  };

  Html add(Chart chart);
  /// The load's position less the motor's over the latter: width and slope are those of the
  /// transmission's gap and compliance. Empty where not both were recorded.
  Html hysteresis(std::size_t recording);
  Chart over_time(std::size_t recording, std::string id, std::string title, ChartAxis y) const;
  /// The mean of y over ranges of x with equally many values.
  ChartSeries mean_line(std::string label, std::string_view role, const std::vector<double>& x,
                        const std::vector<double>& y);

  const RunResult& run_result_;
  ChartColumns columns_;
  std::vector<Chart> charts_;
  std::vector<RecordingCharts> recordings_;
};

}  // namespace axisfit
