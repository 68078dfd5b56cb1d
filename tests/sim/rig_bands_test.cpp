#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "tests/sim/rigs.h"

namespace axisfit {
namespace {

/// Its mass is known to 2 %.
Rig rig() {
  Rig rig = rig_of_mass();
  AxisUncertainty& known = rig.uncertainty.emplace();
  known.quantities = {{quantity_index("M"), true, 0.02, 0.0, 1.0}};
  known.correlation = {1.0};
  return rig;
}

RecordingOptions options() { return one_second(50.0, {Signal::velocity}); }

TEST(Bands, FollowEverySignalInItsUnit) {
  const std::vector<Column> columns = record_with_bands(rig(), StepMotion{20.0, 0.0}, options());
  ASSERT_EQ(columns.size(), 5u);
  EXPECT_EQ(columns[2].name, "velocity_mps");
  EXPECT_EQ(columns[3].name, "velocity_mps_half_width");
  EXPECT_EQ(columns[4].name, "velocity_mps_half_width_of_whole");
  // v = F t / M errs as M does: 1.96 x 2 %. The ensemble is finite; 2 m/s after a second.
  EXPECT_NEAR(columns[2].values.back(), 2.0, 1e-9);
  EXPECT_NEAR(columns[3].values.back(), 1.96 * 0.02 * 2.0, 0.2 * 1.96 * 0.02 * 2.0);
  EXPECT_NEAR(columns[3].values[25] / columns[3].values.back(), 0.5, 1e-3);
  for (std::size_t i = 1; i < columns[3].values.size(); ++i)
    EXPECT_GE(columns[4].values[i], columns[3].values[i]);
}

TEST(Bands, HoldTheNoiseOfReadings) {
  Rig noisy = rig();
  noisy.noise[index_of(Signal::velocity)] = 0.1;
  const double without =
      record_with_bands(rig(), StepMotion{20.0, 0.0}, options())[3].values.back();
  const auto columns = record_with_bands(noisy, StepMotion{20.0, 0.0}, options());
  EXPECT_NEAR(columns[2].values.back(), 2.0, 1e-9);
  EXPECT_NEAR(columns[3].values.back(), std::hypot(without, 1.96 * 0.1), 0.2 * 0.2);
}

TEST(Bands, NeedAnUncertainty) {
  Rig known = rig();
  known.uncertainty.reset();
  EXPECT_THROW(record_with_bands(known, StepMotion{20.0, 0.0}, options()), std::runtime_error);
}

}  // namespace
}  // namespace axisfit
