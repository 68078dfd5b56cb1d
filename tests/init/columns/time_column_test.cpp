#include "init/columns/time_column.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace axisfit {
namespace {

struct Log {
  std::vector<double> stamps, position, current;

  explicit Log(double interval, double jitter = 0.0) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> late(-jitter, jitter);
    for (int i = 0; i < 200; ++i) {
      stamps.push_back(interval * (i + late(random)));
      position.push_back(std::sin(0.1 * i));
      current.push_back(std::cos(0.1 * i));
    }
  }
  Table table(const std::string& time, const std::string& place, const std::string& drive) const {
    Table made;
    made.columns = {{time, stamps}, {place, position}, {drive, current}};
    return made;
  }
};

TimeColumn time_of(const Table& table, std::optional<double> rate = {}) {
  const RecordingFile file(table);
  const std::vector<ColumnAnswer> none;
  return find_time(file, "log.csv", headings_of(file, "log.csv", none), rate);
}

std::string refusal(const Table& table) {
  try {
    time_of(table);
  } catch (const RecordingError& error) {
    return error.what();
  }
  return "none";
}

TEST(TimeColumn, StampsThatJitterAreStamps) {
  for (const double jitter : {0.0, 0.05, 0.1})
    for (const char* name : {"time", ""})
      EXPECT_EQ(time_of(Log(10.0, jitter).table(name, "", "")).place, 0u) << name << jitter;
}

TEST(TimeColumn, ACountIsOneWhereNothingElseIs) {
  Table table = Log(10.0, 0.1).table("", "", "");
  std::vector<double> count;
  for (int i = 0; i < 200; ++i) count.push_back(i);
  table.columns.insert(table.columns.begin(), {"", count});
  EXPECT_EQ(time_of(table).place, 1u) << "stamps before a count";
  table.columns.erase(table.columns.begin() + 1);
  EXPECT_EQ(time_of(table).place, 0u);
}

TEST(TimeColumn, IsNotNeededWithARate) {
  Log log(10.0);
  Table table;
  table.columns = {{"position", log.position}, {"current", log.current}};
  EXPECT_NE(refusal(table).find("how many samples a second there are by --rate \"1 kHz\""),
            std::string::npos);
  const TimeColumn time = time_of(table, 250.0);
  EXPECT_FALSE(time.place);
  EXPECT_EQ(time.rate, 250.0);
  EXPECT_EQ(time.column.raw.size(), 200u);
  EXPECT_DOUBLE_EQ(time.column.raw[100], 0.4);
}

TEST(TimeColumn, ARowThatIsRepeatedCountsOnce) {
  Log log(10.0);
  for (auto* values : {&log.stamps, &log.position, &log.current})
    values->insert(values->begin() + 50, (*values)[50]);
  const TimeColumn time = time_of(log.table("time_ms", "position", "current"));
  EXPECT_EQ(time.column.raw.size(), 200u);
  const std::vector<double> clock =
      times_of_clock(RecordingFile(log.table("time_ms", "position", "current")), 0);
  EXPECT_EQ(clock.size(), 201u);
  EXPECT_TRUE(std::isnan(clock[51]));
}

TEST(TimeColumn, RowsOfOneTimeThatDifferAreNamed) {
  Log log(10.0);
  log.stamps[51] = log.stamps[50];
  const std::string text = refusal(log.table("time_ms", "position", "current"));
  EXPECT_NE(text.find("time_ms does not increase in 1 row: "), std::string::npos) << text;
  EXPECT_NE(text.find("(500, after 500). Rows that agree would count once"), std::string::npos)
      << text;
  log.stamps[51] = log.stamps[40];
  EXPECT_NE(refusal(log.table("time_ms", "position", "current")).find("reorder these rows"),
            std::string::npos);
}

TEST(TimeColumn, OneThatIncreasesComesBeforeOneThatDoesNot) {
  Log log(10.0);
  Table table = log.table("t_ms", "position", "current");
  std::vector<double> seconds;
  for (const double t : log.stamps) seconds.push_back(std::floor(t / 1000.0));
  table.columns.insert(table.columns.begin(), {"timestamp", seconds});
  EXPECT_EQ(time_of(table).place, 1u);
}

}  // namespace
}  // namespace axisfit
