#include "fleet/history.h"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/fleet/small_fleet.h"

namespace axisfit {
namespace {

using HistoryTest = SmallFleet;

TEST_F(HistoryTest, HistoriesAreOnlyReplacedByHistories) {
  const std::string path = folder_.path() + "/other.sqlite";
  sqlite3* other = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &other), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(other, "CREATE TABLE mine(a)", nullptr, nullptr, nullptr), SQLITE_OK);
  EXPECT_NE(message_of([&] { History h(path); }).find("no history of a fleet"), std::string::npos);
  sqlite3_close(other);
  const std::string own = folder_.path() + "/own.sqlite";
  { const History made(own); }
  ASSERT_EQ(sqlite3_open(own.c_str(), &other), SQLITE_OK);
  sqlite3_exec(other, "PRAGMA user_version = 99", nullptr, nullptr, nullptr);
  sqlite3_close(other);
  EXPECT_NE(message_of([&] { History h(own); }).find("is of version 99"), std::string::npos);
  EXPECT_NE(message_of([&] {
              History h(folder_.write("text",
                                      "no database at all, but text that "
                                      "is long enough to be read as one, "
                                      "which has a header of 100 bytes"));
            }).find("history '"),
            std::string::npos);
}

NightResult night(const char* axis, const char* name, double value) {
  NightResult night;
  night.axis = axis;
  night.night = name;
  night.status = "usable";
  night.fingerprint = "of " + night.axis;
  night.parameters = {{"B_a", "N s/m", value, 0.5}};
  night.effects = {"drag", "drag"};
  return night;
}

TEST(History, GivesBackNightsInTheirOrder) {
  const TempFolder folder;
  History history(folder.path("h.sqlite"));
  history.add({night("y", "1", 3.0), night("x", "2", 2.0), night("x", "1", 1.0)}, "tool");
  const std::vector<NightResult> all = history.results();
  ASSERT_EQ(all.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(all[i].parameters.at(0).value, static_cast<double>(i + 1));
  EXPECT_EQ(all[0].effects, std::vector<std::string>{"drag"}) << "each once";
  const auto entries = history.entries();
  ASSERT_EQ(entries.size(), 3u);
  EXPECT_EQ(entries.at({"y", "1"}).fingerprint, "of y");
  EXPECT_EQ(entries.at({"y", "1"}).tool, "tool");
  EXPECT_EQ(entries.at({"y", "1"}).status, "usable");
}

TEST(History, ANightReplacesWhatWasKnownOfIt) {
  const TempFolder folder;
  History(folder.path("h.sqlite")).add({night("x", "1", 1.0), night("x", "2", 2.0)}, "old");
  History history(folder.path("h.sqlite"));
  NightResult other = night("x", "1", 7.0);
  other.effects.clear();
  history.add({other}, "new");
  ASSERT_EQ(history.results().size(), 2u);
  EXPECT_EQ(history.results()[0].parameters.at(0).value, 7.0);
  EXPECT_TRUE(history.results()[0].effects.empty()) << "nothing of the old one is left";
  EXPECT_EQ(history.entries().at({"x", "1"}).tool, "new");
  EXPECT_EQ(history.entries().at({"x", "2"}).tool, "old");
}

TEST(History, TakesAllOrNothing) {
  const TempFolder folder;
  History history(folder.path("h.sqlite"));
  NightResult twice = night("x", "2", 2.0);
  twice.parameters.push_back(twice.parameters[0]);
  EXPECT_THROW(history.add({night("x", "1", 1.0), twice}, "tool"), std::runtime_error);
  EXPECT_TRUE(history.results().empty());
}

TEST(History, KeepsNumbersThatAreNotFiniteAsUnknown) {
  const TempFolder folder;
  History history(folder.path("h.sqlite"));
  history.add({night("x", "1", INFINITY)}, "tool");
  EXPECT_TRUE(std::isnan(history.results()[0].parameters[0].value));
}

}  // namespace
}  // namespace axisfit
