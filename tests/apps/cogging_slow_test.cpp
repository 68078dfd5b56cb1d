// The cogging of a motor that others measured, from its recording to the loop closed, without an
// edit.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "tests/apps/files.h"
#include "tests/apps/shell.h"
#include "tests/foreign_recordings.h"

namespace axisfit {
namespace {

// By the source's own table and by least squares: 72 and 18 periods a turn, the former the larger.
// The position, in radians without a unit, is taken for millimetres.
TEST(CoggingSlowTest, TheLoopNamesBothOrdersOfAMotor) {
  const ForeignRecordings data = foreign_recordings("laas", {"speed_test1.txt"});
  if (!data.missing.empty()) GTEST_SKIP() << data.missing;
  const TempFolder folder;
  const std::string recording = (data.folder / "speed_test1.txt").string();
  ASSERT_EQ(shell(folder, "fit-params --init '" + recording + "'").exit_code, 0);
  const Answer closed = shell(folder, "fit-params job.yaml --close-loop --json");
  const YAML::Node result = YAML::Load(closed.out);
  std::map<std::string, double> value;
  for (const auto& p : result["parameters"])
    value[p["name"].as<std::string>()] = p["value"].as<double>();
  ASSERT_TRUE(value.contains("second_periodic_force.period")) << closed.err;
  const double turn = 2.0 * std::numbers::pi * 1e-3;
  EXPECT_NEAR(turn / value["periodic_force.period"], 72.0, 0.05);
  EXPECT_NEAR(turn / value["second_periodic_force.period"], 18.0, 0.05);
  EXPECT_GT(
      std::hypot(value["periodic_force.F_s1"], value["periodic_force.F_c1"]),
      2.0 * std::hypot(value["second_periodic_force.F_s1"], value["second_periodic_force.F_c1"]));
  EXPECT_FALSE(value.contains("pendulum_gravity.G_s"));
  EXPECT_FALSE(value.contains("elastic_mode.m_e"));
}

}  // namespace
}  // namespace axisfit
