#include "io/config/recording_series.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "io/config/recording_keys.h"
#include "tests/apps/files.h"

namespace axisfit {
namespace {

TEST(Trim, KeepsBothEnds) {
  Series series{{0.0, 1.0, 2.0, 3.0}, {5.0, 6.0, 7.0, 8.0}, true, 2};
  keep({1.0, 2.0}, series);
  EXPECT_EQ(series.times, (std::vector<double>{1.0, 2.0}));
  EXPECT_EQ(series.values, (std::vector<double>{6.0, 7.0}));
  EXPECT_TRUE(series.own_clock);
  EXPECT_EQ(series.missing, 2u);
  keep({}, series);
  EXPECT_EQ(series.times.size(), 2u);
}

/// Reads columns of two files: twelve samples at 1 Hz, and as many at 2 Hz with one that is
/// missing.
class SeriesReaderTest : public ::testing::Test {
 protected:
  SeriesReaderTest() {
    Column time{"t", {}}, slow{"slow", {}}, fine{"t", {}}, fast{"fast", {}};
    for (int i = 0; i < 12; ++i) {
      time.values.push_back(i);
      slow.values.push_back(10.0 * i);
      fine.values.push_back(0.5 * i);
      fast.values.push_back(i == 3 ? NAN : 1.0 * i);
    }
    sources_.tables = {{"own.csv", {"own.csv", {time, slow}, {}}},
                       {"other.csv", {"other.csv", {fine, fast}, {}}}};
  }

  std::optional<Series> read(const std::string& yaml) {
    Diagnostics diagnostics;
    const auto node = ConfigNode::parse(
        "file: own.csv\ntime: {column: t, unit: s}\nvelocity: " + yaml, "job.yaml", diagnostics);
    ConfigMap map(*node);
    SeriesReader reader(sources_);
    EXPECT_TRUE(reader.open_own(*map.required("file"), "own.csv"));
    reader.read_own_times(*map.required("time"));
    const ConfigNode velocity = *map.required("velocity");
    ConfigMap of_velocity(velocity, measurement_keys("velocity"));
    auto series = reader.read(velocity, of_velocity, "m/s");
    said_.clear();
    for (const Diagnostic& d : diagnostics.sorted()) said_ += d.message;
    return series;
  }

  RecordingSources sources_;
  std::string said_;
};

TEST_F(SeriesReaderTest, AColumnHasTheTimesOfItsRecording) {
  const auto series = read("{column: slow, unit: m/s}");
  ASSERT_TRUE(series) << said_;
  EXPECT_EQ(series->times.back(), 11.0);
  EXPECT_EQ(series->values.back(), 110.0);
  EXPECT_FALSE(series->own_clock);
}

TEST_F(SeriesReaderTest, AnotherFileHasItsOwnTimes) {
  const auto series = read("{column: fast, unit: m/s, file: other.csv}");
  ASSERT_TRUE(series) << said_;
  EXPECT_TRUE(series->own_clock);
  EXPECT_EQ(series->times.size(), 11u) << "without what is missing";
  EXPECT_EQ(series->times[3], 2.0);
  EXPECT_EQ(series->missing, 0u) << "of its own clock nothing is";
}

TEST_F(SeriesReaderTest, AnOffsetShiftsItsTimes) {
  const auto series = read("{column: slow, unit: m/s, offset: 250 ms}");
  ASSERT_TRUE(series) << said_;
  EXPECT_EQ(series->times.front(), 0.25);
  EXPECT_TRUE(series->own_clock);
}

TEST_F(SeriesReaderTest, CountsWhatIsMissingAtTheTimesOfTheRecording) {
  sources_.tables["own.csv"].columns[1].values[4] = NAN;
  const auto series = read("{column: slow, unit: m/s}");
  ASSERT_TRUE(series) << said_;
  EXPECT_EQ(series->missing, 1u);
}

TEST_F(SeriesReaderTest, TenValuesAreNeeded) {
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(read("{column: slow, unit: m/s}").has_value(), i < 3) << said_;
    sources_.tables["own.csv"].columns[1].values[i] = NAN;
  }
  EXPECT_FALSE(read("{column: slow, unit: m/s}"));
  EXPECT_EQ(said_, "velocity has only 9 values with a time: at least 10 are needed");
}

TEST_F(SeriesReaderTest, LengthsMustAgree) {
  sources_.tables["own.csv"].columns[1].values.pop_back();
  EXPECT_FALSE(read("{column: slow, unit: m/s}"));
  EXPECT_EQ(said_, "velocity has 11 values but the time has 12");
}

TEST(Resolved, IsRelativeToTheFolderOfTheRecordings) {
  const TempFolder folder;
  Diagnostics diagnostics;
  const auto node = ConfigNode::load(folder.write("job.yaml", "a: 1\n"), diagnostics);
  EXPECT_EQ(resolved(*node, "x/../a.csv", ""), folder.path("a.csv"));
  EXPECT_EQ(resolved(*node, "a.csv", "/data"), "/data/a.csv");
  EXPECT_EQ(resolved(*node, "/b/a.csv", "/data"), "/b/a.csv");
}

}  // namespace
}  // namespace axisfit
