// Bands around predictions.
#include "fit/predict/prediction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "fit/run.h"
#include "tests/fit/predicted.h"
#include "tests/fit/scattering.h"

namespace axisfit {
namespace {

TEST(Prediction, UncertaintyIsThatOfTheTableAndItsScatter) {
  const RunResult result = predicted(0.05, 3);
  ASSERT_TRUE(result.uncertainty);
  const AxisUncertainty& known = *result.uncertainty;
  ASSERT_EQ(known.quantities.size(), 2u);
  const ParameterScatter& scatter = result.scatter->parameters[1];
  ASSERT_GT(scatter.deviation, 0.0);
  const ParameterResult& damping = result.fit().parameters[1];
  const UncertainQuantity& q = known.quantities[1];
  EXPECT_EQ(q.quantity, quantity_index("B_a"));
  EXPECT_TRUE(q.logarithmic);
  EXPECT_NEAR(q.error, scatter.within / damping.value, 1e-12);
  EXPECT_NEAR(std::hypot(q.error, q.scatter),
              std::hypot(damping.uncertainty.standard_error, scatter.deviation) / damping.value,
              1e-9);
  EXPECT_NEAR(q.freedom, 4.0, 0.2);
  EXPECT_EQ(known.correlation.size(), 4u);
  EXPECT_EQ(known.correlation[0], 1.0);
  EXPECT_NEAR(known.correlation[1], known.correlation[2], 1e-9);
  EXPECT_FALSE(known.missing_force);  // the model is complete
}

TEST(Prediction, BandsAreNarrowWhereNothingScatters) {
  const auto width = [](double scatter) {
    return predicted(scatter, 2).predictions.front().signals.front().band.median();
  };
  EXPECT_LT(2.0 * width(0.0), width(0.05));
}

TEST(Prediction, AForceThatTheModelLacksWidensThem) {
  Job job = scattering_machine(3, 0.0, 1, 4.0);
  job.recordings.back().role = Role::validate;
  for (Recording& r : job.recordings) {
    // To and fro by a force that no parameter makes.
    std::vector<double>& v = r.measurements.front().values.edit();
    for (std::size_t i = 0; i < v.size(); ++i) v[i] += 0.02 * std::sin(10.0 * r.times[i]);
  }
  const RunResult result = run(std::move(job), {.predict = true});
  ASSERT_TRUE(result.uncertainty && result.uncertainty->missing_force);
  // M times the amplitude of its acceleration, over the root of two.
  const double force = kScatteringMass * 0.02 * 10.0 / std::sqrt(2.0);
  EXPECT_NEAR(result.uncertainty->missing_force->deviation, force, 0.15 * force);
  const SignalPrediction& p = result.predictions.front().signals.front();
  EXPECT_GT(p.inside_percent, 80.0);
}

TEST(Prediction, OfAMotionIsForTheSignalsOfTheRecordings) {
  Job job = scattering_machine(3, 0.05, 1);
  RunOptions options{.predict = true};
  options.motion = MotionToPredict{"step.yaml", StepMotion{5.0, 0.0}, 0.5, {}};
  const RunResult result = run(std::move(job), options);
  ASSERT_TRUE(result.motion) << result.no_prediction;
  EXPECT_EQ(result.motion->signals, std::vector{Signal::velocity});
  ASSERT_EQ(result.motion->columns.size(), 5u);
  EXPECT_EQ(result.motion->columns[3].name, "velocity_mps_half_width");
  EXPECT_EQ(result.motion->columns[0].values.size(), 501u);
  // Force over damping, 5 V at the gain of the mass.
  const double gain = result.baseline.model.axis.K_f;
  EXPECT_NEAR(result.motion->columns[2].values.back(),
              5.0 * gain / kScatteringDamping *
                  (1.0 - std::exp(-0.5 * kScatteringDamping / kScatteringMass)),
              0.1 * 5.0 * gain / kScatteringDamping);
}

}  // namespace
}  // namespace axisfit
