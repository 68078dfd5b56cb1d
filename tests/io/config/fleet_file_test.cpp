#include "io/config/fleet_file.h"

#include <gtest/gtest.h>

#include <string>

#include "io/config/config.h"
#include "tests/apps/files.h"

namespace axisfit {
namespace {

class FleetFileTest : public ::testing::Test {
 protected:
  FleetFileTest() { folder_.write("night.yaml", "axis: {axis}.yaml\n"); }
  FleetFile read(const std::string& text) {
    return read_fleet_file(folder_.write("fleet.yaml", text));
  }
  std::string error(const std::string& text) {
    try {
      read(text);
    } catch (const ConfigError& caught) {
      return folder_.without_path(caught.what());
    }
    return "no error";
  }

  TempFolder folder_;
};

TEST_F(FleetFileTest, HasDefaults) {
  const FleetFile file = read("job: night.yaml\nitems: 'recordings/{axis}/{night}.csv'\n");
  EXPECT_EQ(file.folder, folder_.path());
  EXPECT_EQ(file.job_name, "night.yaml");
  EXPECT_EQ(file.job_text, "axis: {axis}.yaml\n");
  EXPECT_EQ(file.items, folder_.path("recordings/{axis}/{night}.csv"));
  EXPECT_EQ(file.manifest, "");
  EXPECT_EQ(file.history, folder_.path("history.sqlite"));
  EXPECT_EQ(file.close_loop, CloseLoop::never);
  EXPECT_EQ(file.one_in, 1000);
  EXPECT_TRUE(file.limits.empty());
}

TEST_F(FleetFileTest, ReadsEveryKey) {
  const FleetFile file = read(
      "job: night.yaml\nmanifest: ../list.csv\nhistory: /data/h.sqlite\nclose_loop: unexplained\n"
      "one_in: 50\nlimits: {B_a: 300 N s/m, backlash.H: 0.2 mm, load_friction.mu: 0.1}\n");
  EXPECT_TRUE(file.manifest.ends_with("/list.csv"));
  EXPECT_EQ(file.manifest.find(".."), std::string::npos);
  EXPECT_EQ(file.history, "/data/h.sqlite");
  EXPECT_EQ(file.close_loop, CloseLoop::unexplained);
  EXPECT_EQ(file.one_in, 50);
  ASSERT_EQ(file.limits.size(), 3u);
  EXPECT_EQ(file.limits.at("B_a"), (std::pair<double, std::string>(300.0, "N s/m")));
  EXPECT_EQ(file.limits.at("backlash.H").second, "mm");
  EXPECT_EQ(file.limits.at("load_friction.mu").second, "1");
}

TEST_F(FleetFileTest, EveryMistakeIsNamedWithItsPlace) {
  EXPECT_EQ(error("items: '{axis}/{night}.csv'\n"),
            "fleet.yaml:1:1: key 'job' is missing in the file");
  EXPECT_EQ(error("job: night.yaml\n"),
            "fleet.yaml:1:1: the axes and nights are missing: give 'items' or 'manifest'");
  EXPECT_EQ(error("job: night.yaml\nitems: '{axis}/{night}.csv'\nmanifest: list.csv\n"),
            "fleet.yaml:3:11: give either 'items' or 'manifest'");
  EXPECT_EQ(error("job: night.yaml\nitems: '{night}.csv'\n"),
            "fleet.yaml:2:8: the pattern has no {axis}");
  EXPECT_EQ(error("job: night.yaml\nitems: '{axis}/{night}.csv'\nlimits: {B_a: much}\n"),
            "fleet.yaml:3:15: a limit is a number with its unit, such as 300 N s/m");
  EXPECT_EQ(error("job: none.yaml\nitems: '{axis}/{night}.csv'\n"),
            "fleet.yaml:1:6: 'none.yaml' cannot be read");
}

}  // namespace
}  // namespace axisfit
