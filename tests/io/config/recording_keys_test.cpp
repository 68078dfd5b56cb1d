#include "io/config/recording_keys.h"

#include <gtest/gtest.h>

#include <string>

namespace axisfit {
namespace {

/// A sigma as it is read, and what is said of it.
std::pair<double, std::string> sigma_of(const std::string& text, const char* unit = "m/s") {
  Diagnostics diagnostics;
  ConfigMap map(*ConfigNode::parse("sigma: " + text, "job.yaml", diagnostics));
  const double sigma = read_sigma(*map.required("sigma"), unit);
  return {sigma, diagnostics.empty() ? "" : diagnostics.sorted().front().message};
}

TEST(RecordingKeys, ASigmaHasTheUnitOfItsSignal) {
  EXPECT_EQ(sigma_of("2 mm/s"), (std::pair<double, std::string>(2e-3, "")));
  EXPECT_EQ(sigma_of("0.5", "1"), (std::pair<double, std::string>(0.5, "")));
  EXPECT_NE(sigma_of("-1 m/s").second, "");
  EXPECT_EQ(sigma_of("2").first, 1.0) << "after a mistake";
}

TEST(RecordingKeys, AreThoseOfEverySignal) {
  const auto has = [](const Section& keys, const char* name) {
    for (const Key& key : keys)
      if (key.name == name) return true;
    return false;
  };
  EXPECT_TRUE(has(recording_keys(), "trim"));
  EXPECT_TRUE(has(measurement_keys("velocity"), "filter"));
  EXPECT_TRUE(has(measurement_keys("command"), "supply"));
  EXPECT_FALSE(has(measurement_keys("command"), "filter"));
  EXPECT_TRUE(has(measurement_keys("position_reference"), "loop"));
  EXPECT_TRUE(has(channel_column_keys(), "derivative"));
}

}  // namespace
}  // namespace axisfit
