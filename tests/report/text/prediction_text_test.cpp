// What is said of predictions.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "fit/run.h"
#include "report/text/report_text.h"
#include "tests/fit/scattering.h"
#include "tests/report/found.h"

namespace axisfit {
namespace {

Job to_predict() {
  Job job = scattering_machine(6, 0.05, 4);
  job.recordings.back().role = Role::validate;
  return job;
}

TEST(PredictionText, TellsOfBandsAndTheirCurves) {
  const RunResult result = run(to_predict(), {.predict = true});
  const std::string text = report_text(result);
  EXPECT_NE(text.find("Prediction, free running, with 95 % bands"), std::string::npos) << text;
  EXPECT_NE(text.find("run-6: velocity"), std::string::npos);
  const std::string csv = prediction_csv(result);
  EXPECT_EQ(csv.find("recording,time_s,velocity_measured,velocity_predicted,velocity_half_width,"
                     "velocity_half_width_of_whole\n6,0,"),
            0u);
  EXPECT_EQ(std::ranges::count(csv, '\n'),
            1 + static_cast<int>(result.job().recordings.back().times.size()));
  RunResult without = result;
  without.no_prediction = "the reason";
  EXPECT_TRUE(prediction_text(without).ends_with("\nNo further prediction: the reason.\n\n"));
  without.predictions.clear();
  EXPECT_EQ(prediction_text(without), "No prediction: the reason.\n\n");
  Job job = scattering_machine(2, 0.0, 1);
  EXPECT_NE(report_text(run(std::move(job), {.predict = true})).find("Nothing to predict"),
            std::string::npos);
}

/// A prediction of a recording of eleven samples, by hand.
RunResult predicted() {
  RunResult run_result;
  run_result.options.predict = true;
  run_result.baseline = scattering_machine(1, 0.0, 1, 0.01);
  run_result.uncertainty.emplace();
  RecordingPrediction& prediction = run_result.predictions.emplace_back();
  prediction.draws = 300;
  SignalPrediction& p = prediction.signals.emplace_back();
  for (int i = 0; i <= 10; ++i) {
    p.values.push_back(0.1 * i);  // m/s, up to 1
    p.band.half_width.push_back(0.002 * i);
  }
  p.band.whole = 1.5;
  p.rmse = 0.0125;
  p.inside_percent = 90.9;
  return run_result;
}

TEST(PredictionText, TellsUntilWhenABandIsNarrow) {
  RunResult run_result = predicted();
  const auto row = [&] {
    const std::string text = on_one_line(prediction_text(run_result));
    const std::size_t from = text.find("run-1: velocity");
    return text.substr(from, text.find(" Of the band") - from);
  };
  // A hundredth of the range is 0.01 m/s, which the band passes at the sample 6.
  EXPECT_EQ(row(), "run-1: velocity 0.0125 +-0.01 +-0.02 90.9 % not in 1.5x 0.006 s m/s");
  run_result.options.tolerances = {{3.0, "mm"}, {5.0, "mm/s"}};
  run_result.predictions[0].signals[0].is_whole_inside = true;
  EXPECT_EQ(row(), "run-1: velocity 0.0125 +-0.01 +-0.02 90.9 % in 1.5x 0.003 s m/s");
  EXPECT_NE(on_one_line(prediction_text(run_result))
                .find("band is below 3 mm or 5 mm/s, elsewhere below 1 % of the range."),
            std::string::npos);
  run_result.options.tolerances = {{1.0, "m/s"}};
  EXPECT_NE(row().find(" the end m/s"), std::string::npos) << row();
}

TEST(PredictionText, SaysWhatTheBandsAllowFor) {
  RunResult run_result = predicted();
  const auto allowance = [&] {
    const std::string text = on_one_line(prediction_text(run_result));
    return text.substr(text.find("The bands allow"));
  };
  EXPECT_EQ(allowance(),
            "The bands allow for the errors of the parameters and for the noise of the readings.");
  run_result.uncertainty->quantities = {{0, false, 1.0, 0.5, 3.0}};
  run_result.uncertainty->missing_force = MissingForceProcess{0.01, 1.25, 0.5, {}};
  EXPECT_EQ(allowance(),
            "The bands allow for the errors of the parameters, for their scatter from recording to "
            "recording, for a missing force of 1.2 N rms and for the noise of the readings.");
}

TEST(PredictionText, WithoutEnoughDrawsThereIsNoBand) {
  RunResult run_result = predicted();
  run_result.predictions[0].signals.clear();
  run_result.predictions[0].draws = 12;
  EXPECT_NE(on_one_line(prediction_text(run_result))
                .find("run-1: no band, for only 12 of 300 draws could be simulated to the end."),
            std::string::npos);
  run_result.options.predict = false;
  EXPECT_EQ(prediction_text(run_result), "");
}

}  // namespace
}  // namespace axisfit
