#include "sim/controller.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/rig.h"
#include "tests/sim/axes.h"

namespace axisfit {
namespace {

TEST(Controller, CommandIsFoundAgainFromReferenceAndEncoder) {
  Rig rig;
  rig.model = paper_axis();
  const MoveMotion move{1.0, 0.9, 2.0};
  RecordingOptions options;
  options.duration = 2.0;
  options.signals = {Signal::position};
  const std::vector<Column> columns = record(rig, move, options);
  const std::vector<double>& times = columns[0].values;
  std::vector<double> reference;
  for (const double t : times) reference.push_back(reference_of(move)(t));
  const std::vector<double> command =
      command_from_reference(rig.controller, times, reference, columns[2].values);
  ASSERT_EQ(command.size(), times.size());
  double error = 0.0;
  // The run ends before the sampling at its last instant.
  for (std::size_t i = 0; i + 1 < times.size(); ++i)
    error = std::max(error, std::abs(command[i] - columns[1].values[i]));
  // The recorded reference is interpolated at the track instants, the original is exact there.
  EXPECT_LT(error, 1e-6);
}

TEST(Controller, EncoderCountsWholeSteps) {
  const double count = 2.0 * 3.14159265358979 * 0.00573 / 4000.0;
  EXPECT_NEAR(encoder_reading(3.7 * count, 0.00573, 4000), 3.0 * count, 1e-15);
  EXPECT_NEAR(encoder_reading(-0.2 * count, 0.00573, 4000), -count, 1e-15);
  EXPECT_EQ(encoder_reading(0.1234, 0.00573, 0), 0.1234);
}

}  // namespace
}  // namespace axisfit
