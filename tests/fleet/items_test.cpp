#include "fleet/items.h"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>
#include <string>

#include "tests/fleet/small_fleet.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;

using ItemsTest = SmallFleet;

TEST_F(ItemsTest, ItemsComeFromAManifestToo) {
  folder_.write("factory/list.csv",
                "axis, night, file\nleft,1,recordings/axis-0001/2026-09-01.csv\n"
                "left,2,recordings/axis-0001/2026-09-02.csv\n");
  std::string job = folder_.read("factory/night.yaml");
  job.replace(job.find("recordings/{axis}/{night}.csv"), 29, "{file}");
  folder_.write("factory/night.yaml", job);
  folder_.write("factory/fleet.yaml", "job: night.yaml\nmanifest: list.csv\n");
  const Plan plan = planned();
  ASSERT_EQ(plan.items.size(), 2u);
  EXPECT_EQ(work_on(plan, {}, {}).failed, 0u);
  const std::string before = find_items(fleet())[1].fingerprint;
  fs::last_write_time(recording("axis-0001", 2), fs::file_time_type::clock::now());
  EXPECT_NE(find_items(fleet())[1].fingerprint, before);
  sqlite3* list = nullptr;
  ASSERT_EQ(sqlite3_open((factory() + "/list.db").c_str(), &list), SQLITE_OK);
  ASSERT_EQ(
      sqlite3_exec(list,
                   "CREATE TABLE items(axis, night, file); INSERT INTO items VALUES('left', 1, "
                   "'recordings/axis-0001/2026-09-01.csv')",
                   nullptr, nullptr, nullptr),
      SQLITE_OK);
  sqlite3_close(list);
  folder_.write("factory/fleet.yaml", "job: night.yaml\nmanifest: list.db\n");
  const std::vector<FleetItem> items = find_items(fleet());
  ASSERT_EQ(items.size(), 1u);
  EXPECT_EQ(items[0].values.at("file"), "recordings/axis-0001/2026-09-01.csv");
  folder_.write("factory/fleet.yaml", "job: night.yaml\nmanifest: none.db\n");
  EXPECT_NE(message_of([&] { find_items(fleet()); }).find("manifest '"), std::string::npos);
  folder_.write("factory/fleet.yaml", "job: night.yaml\nmanifest: list.csv\n");
  folder_.write("factory/list.csv", "axis,night\nleft,1\nleft,1\n");
  EXPECT_NE(message_of([&] { find_items(fleet()); }).find("axis left has night 1 twice"),
            std::string::npos);
  folder_.write("factory/list.csv", "axis,night\nleft\n");
  EXPECT_NE(message_of([&] { find_items(fleet()); }).find("line 2: 1 fields"), std::string::npos);
  folder_.write("factory/list.csv", "axis\nleft\n");
  EXPECT_NE(message_of([&] { find_items(fleet()); }).find("no column 'night'"), std::string::npos);
}

TEST_F(ItemsTest, MistakesInFleetFilesAreTold) {
  const auto says = [&](const std::string& text, const std::string& expected) {
    folder_.write("factory/fleet.yaml", text);
    const std::string found = message_of([&] { find_items(fleet()); });
    EXPECT_NE(found.find(expected), std::string::npos) << found;
  };
  says("items: a/{axis}/{night}.csv\n", "'job' is missing");
  says("job: night.yaml\n", "give 'items' or 'manifest'");
  says("job: night.yaml\nitems: '{axis}.csv'\n", "fleet.yaml:2:8: the pattern has no {night}");
  says("job: none.yaml\nitems: '{axis}/{night}.csv'\n", "none.yaml' cannot be read");
  says("job: night.yaml\nitems: '{axis}/{night}.csv'\nlimits: {B_a: much}\n",
       "a limit is a number with its unit");
  says("job: night.yaml\nitems: 'nowhere/{axis}/{night}.csv'\n", "there are no such axes");
}

TEST(FilledIn, PutsValuesInPlaceOfTheirNames) {
  EXPECT_EQ(filled_in("a/{axis}/{night}.csv: {axis} {other}", {{"axis", "x"}, {"night", "1"}}),
            "a/x/1.csv: x {other}");
  EXPECT_EQ(filled_in("{axis}", {{"axis", "{axis}"}}), "{axis}") << "once";
}

/// Names files, and tells which items a pattern finds among them.
class PatternTest : public ::testing::Test {
 protected:
  PatternTest() {
    folder_.write("night.yaml", "axis: a.yaml\n");
    for (const char* axis : {"left", "right"}) {
      fs::create_directories(folder_.path(axis));
      for (const char* night : {"2", "10"})
        folder_.write(std::string(axis) + "/run-" + night + "." + axis + ".csv", "");
    }
  }
  std::string found(const std::string& pattern) {
    folder_.write("fleet.yaml", "job: night.yaml\nitems: '" + pattern + "'\n");
    std::string text;
    for (const FleetItem& item : find_items(read_fleet_file(folder_.path("fleet.yaml"))))
      text += item.axis + " " + item.night + ", ";
    return text;
  }

  TempFolder folder_;
};

TEST_F(PatternTest, NamesAxesAndNights) {
  EXPECT_EQ(found("{axis}/run-{night}.csv"),
            "left 10.left, left 2.left, right 10.right, right 2.right, ");
  EXPECT_EQ(found("{axis}/run-{night}.left.csv"), "left 10, left 2, ");
}

TEST_F(PatternTest, ANameThatComesTwiceIsTheSame) {
  EXPECT_EQ(found("{axis}/run-{night}.{axis}.csv"), "left 10, left 2, right 10, right 2, ");
  fs::rename(folder_.path("left/run-2.left.csv"), folder_.path("left/run-2.right.csv"));
  EXPECT_EQ(found("{axis}/run-{night}.{axis}.csv"), "left 10, right 10, right 2, ");
}

TEST_F(PatternTest, OtherCharactersStandForThemselves) {
  EXPECT_EQ(message_of([&] { found("{axis}/run.{night}.left.csv"); }),
            folder_.path("{axis}/run.{night}.left.csv") + ": there are no such axes");
}

TEST_F(PatternTest, AFileThatChangesChangesTheFingerprint) {
  const auto fingerprint = [&] {
    folder_.write("fleet.yaml", "job: night.yaml\nitems: '{axis}/run-{night}.left.csv'\n");
    return find_items(read_fleet_file(folder_.path("fleet.yaml"))).at(0).fingerprint;
  };
  const std::string before = fingerprint();
  EXPECT_EQ(fingerprint(), before);
  folder_.write("night.yaml", "axis: a.yaml\n# another job\n");
  EXPECT_NE(fingerprint(), before);
}

}  // namespace
}  // namespace axisfit
