// What is said of predictions.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "fit/run.h"
#include "report/text/report_text.h"
#include "tests/fit/scattering.h"

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

}  // namespace
}  // namespace axisfit
