// Files as the tools of drives write them: some that are kept here, and some of others, which are
// not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "io/recording/csv.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;

Table kept(const std::string& name) {
  return read_csv(std::string(AXISFIT_TESTDATA) + "/drives/" + name);
}

TEST(DriveExports, MrConfiguratorHasTwoRowsOfNames) {
  const Table table = kept("mr-configurator-like.csv");
  ASSERT_EQ(table.columns.size(), 6u);
  EXPECT_EQ(table.rows(), 600u);
  EXPECT_EQ(table.columns[0].name, "Time");
  EXPECT_EQ(table.columns[0].unit, "ms");
  EXPECT_EQ(table.columns[1].name, "Servo motor speed");
  EXPECT_EQ(table.columns[2].name, "Torque");
  EXPECT_EQ(table.columns[2].values[1], 1.752804);
}

TEST(DriveExports, LabViewCountsSamples) {
  const Table table = kept("labview-like.csv");
  ASSERT_EQ(table.columns.size(), 4u);
  EXPECT_EQ(table.columns[1].name, "Force");
  EXPECT_EQ(table.columns[1].unit, "N");
  EXPECT_EQ(table.columns[1].clock, 0u);
  EXPECT_EQ(table.columns[3].name, "Linear scale");
  EXPECT_EQ(table.columns[3].clock, 2u);
  EXPECT_EQ(table.columns[2].unit, "s");
  EXPECT_DOUBLE_EQ(table.columns[2].values.back(), 0.599);
}

TEST(DriveExports, ARecordingMayHaveNoHeader) {
  const Table table = kept("headerless.txt");
  ASSERT_EQ(table.columns.size(), 4u);
  EXPECT_EQ(table.rows(), 600u);
  EXPECT_EQ(table.columns[1].values[1], 0.05393);
}

/// The exports of TwinCAT Scope, of another project: one second of known signals.
class TwinCat : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(AXISFIT_CONFIGS) / "../../shared/data/twincat";
    if (!fs::exists(folder_)) GTEST_SKIP() << "no exports of TwinCAT Scope in " << folder_;
  }

  std::vector<std::string> exports() const {
    std::vector<std::string> found;
    for (const auto& entry : fs::directory_iterator(folder_))
      if (entry.path().filename().string().starts_with("tc3_")) found.push_back(entry.path());
    return found;
  }

  fs::path folder_;
};

/// The values of a series, without the rows of longer ones.
std::vector<double> series(const Column& column) {
  std::vector<double> values;
  std::ranges::copy_if(column.values, std::back_inserter(values),
                       [](double x) { return !std::isnan(x); });
  return values;
}

TEST_F(TwinCat, EveryChannelOfEveryExportIsRead) {
  const std::vector<std::string> files = exports();
  EXPECT_EQ(files.size(), 13u);
  for (const std::string& file : files) {
    SCOPED_TRACE(file);
    const Table table = read_csv(file);
    // Where blanks separate, names with blanks cannot be told apart; the symbols stand for them.
    const bool symbols = file.find("Seperator_1") != std::string::npos;
    const Column* real = table.find(symbols ? "MAIN.var_LREAL" : "var_REAL64");
    ASSERT_NE(real, nullptr);
    ASSERT_TRUE(real->clock);
    const Column& time = table.columns[*real->clock];
    EXPECT_EQ(time.unit, "ms");
    const std::vector<double> times = series(time), values = series(*real);
    ASSERT_EQ(times.size(), 1000u);
    ASSERT_EQ(values.size(), 1000u);
    for (std::size_t i = 0; i < times.size(); ++i) {
      ASSERT_EQ(times[i], double(i));
      ASSERT_EQ(values[i], double(i));
    }
    const auto unit = [&](const char* wanted) {
      return std::ranges::count(table.columns, wanted, &Column::unit);
    };
    EXPECT_EQ(unit("V"), 1);
    EXPECT_EQ(unit("dV"), 1);
    for (const Column& column : table.columns) EXPECT_EQ(column.obstacle, "") << column.name;
  }
}

TEST_F(TwinCat, FasterChannelsHaveTimesOfTheirOwn) {
  const Table table = read_csv(folder_ / "tc3_scope_3_4_3145_3-DecimalMark_,.csv");
  const Column* fast = table.find("func_OS");
  ASSERT_NE(fast, nullptr);
  const std::vector<double> times = series(table.columns[fast->clock.value()]);
  ASSERT_EQ(times.size(), 4996u);
  EXPECT_DOUBLE_EQ(times[1], 0.2);
  EXPECT_EQ(series(*table.find("func_units_scaled"))[2], -10.0);
}

}  // namespace
}  // namespace axisfit
