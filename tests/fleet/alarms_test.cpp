#include "fleet/alarms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "tests/fleet/small_fleet.h"

namespace axisfit {
namespace {

/// An axis with B_a of 60 to 66 N s/m on 30 nights.
std::vector<NightResult> worn_axis() {
  std::vector<NightResult> nights;
  for (int i = 0; i < 30; ++i) {
    NightResult night;
    night.axis = "x";
    night.night = "2026-09-" + std::string(i < 9 ? "0" : "") + std::to_string(i + 1);
    night.status = "explained";
    const double wiggle = 0.1 * ((i * 7) % 5 - 2);
    night.parameters = {{"B_a", "N s/m", 60.0 + wiggle + (i >= 20 ? 0.6 * (i - 19) : 0.0), 0.2}};
    if (i >= 12) night.effects = {"periodic_force, period 0.012 m"};
    nights.push_back(night);
  }
  return nights;
}

TEST(Alarms, SayWhatChangedSinceWhenAndWhereItLeads) {
  const FleetReport report = look_at(worn_axis(), {1000, {{"B_a", {0.07, "N s/mm"}}}});
  ASSERT_GE(report.alarms.size(), 2u);
  const Alarm& effect = report.alarms.front();
  EXPECT_EQ(effect.kind, Alarm::Kind::effect);
  EXPECT_EQ(effect.night, "2026-09-14");  // the second night on which it was there
  EXPECT_EQ(effect.text, "periodic_force, period 0.012 m has appeared, since 2026-09-13.");
  const Alarm& last = report.alarms.back();
  EXPECT_EQ(last.what, "B_a");
  EXPECT_NE(last.text.find("B_a up "), std::string::npos) << last.text;
  EXPECT_NE(last.text.find("At this rate the limit of 0.07 N s/mm is met in "), std::string::npos)
      << last.text;
  EXPECT_EQ(report.alarms[1].night.substr(0, 8), "2026-09-");
  EXPECT_LE(report.alarms[1].night, "2026-09-23");
  EXPECT_NE(message_of([&] {
              look_at(worn_axis(), {1000, {{"B_a", {1.0, "kg"}}}});
            }).find("limit of B_a:"),
            std::string::npos);
}

TEST(Alarms, ALimitIsPassedOnlyFromItsOtherSide) {
  std::vector<NightResult> nights = worn_axis();
  for (NightResult& night : nights)
    night.parameters[0].value = 120.0 - night.parameters[0].value;  // falls from 60
  const auto last_text = [&](double limit) {
    return look_at(nights, {1000, {{"B_a", {limit, "N s/m"}}}}).alarms.back().text;
  };
  EXPECT_NE(last_text(58.0).find("The limit of 58 N s/m is passed."), std::string::npos)
      << last_text(58.0);
  EXPECT_EQ(last_text(70.0).find("limit"), std::string::npos) << last_text(70.0);
  EXPECT_NE(last_text(40.0).find("the limit of 40 N s/m is met in "), std::string::npos)
      << last_text(40.0);
}

TEST(Alarms, KnowDatesAndNumbers) {
  const auto days = days_of({"2026-02-27", "2026-03-01"});
  EXPECT_EQ(days.at("2026-03-01") - days.at("2026-02-27"), 2.0);
  EXPECT_EQ(days_of({"7", "12"}).at("12"), 12.0);
  EXPECT_EQ(days_of({"b", "a"}).at("b"), 1.0);
}

TEST(Alarms, AnEffectCountsWithItsSecondNight) {
  std::vector<NightResult> nights = worn_axis();
  for (NightResult& night : nights) night.parameters.clear();
  const auto alarms = [&](const std::vector<std::size_t>& with) {
    for (std::size_t i = 0; i < nights.size(); ++i) {
      nights[i].effects.clear();
      if (std::ranges::find(with, i) != with.end()) nights[i].effects = {"drag"};
    }
    std::string text;
    for (const Alarm& a : look_at(nights, {}).alarms) text += a.night + " " + a.text + "\n";
    return text;
  };
  EXPECT_EQ(alarms({5}), "") << "one night proves nothing";
  EXPECT_EQ(alarms({5, 8}), "") << "nor do two that are far apart";
  EXPECT_EQ(alarms({5, 7}), "2026-09-08 drag has appeared, since 2026-09-06.\n");
  EXPECT_EQ(alarms({0, 1, 2}), "") << "the axis came with it";
}

TEST(Alarms, AnAxisUnlikeTheOthersIsFound) {
  std::vector<NightResult> nights, few = worn_axis();
  few.resize(5);
  for (int axis = 0; axis < 9; ++axis)
    for (NightResult night : few) {
      night.axis = "axis-" + std::to_string(axis);
      night.effects.clear();
      night.parameters[0].value = axis == 4 ? 90.0 : 60.0 + 0.2 * axis;
      nights.push_back(night);
    }
  const FleetReport report = look_at(nights, {});
  ASSERT_EQ(report.alarms.size(), 1u);
  EXPECT_EQ(report.alarms[0].kind, Alarm::Kind::outlier);
  EXPECT_EQ(report.alarms[0].axis, "axis-4");
  EXPECT_TRUE(report.alarms[0].text.starts_with("B_a is 90 N s/m, where the fleet has 61 N s/m"))
      << report.alarms[0].text;
  std::erase_if(nights, [](const NightResult& n) { return n.axis > "axis-6"; });
  EXPECT_TRUE(look_at(nights, {}).alarms.empty()) << "seven say too little of a spread";
}

TEST(Alarms, ALastNightThatFailedIsTold) {
  std::vector<NightResult> nights = worn_axis();
  nights.resize(5);
  nights[2].status = "failed";
  EXPECT_TRUE(look_at(nights, {}).alarms.empty());
  nights[4].status = "failed";
  nights[4].reason = "a.csv: the file is empty";
  nights[4].parameters.clear();
  const FleetReport report = look_at(nights, {});
  ASSERT_EQ(report.alarms.size(), 1u);
  EXPECT_EQ(report.alarms[0].kind, Alarm::Kind::failures);
  EXPECT_EQ(report.alarms[0].text, "The last night failed: a.csv: the file is empty");
  EXPECT_EQ(report.failed, 2u);
  EXPECT_STREQ(kind_name(report.alarms[0].kind), "failures");
  EXPECT_EQ(to_json(report).at("alarms")[0].at("kind"), "failures");
}

TEST(Alarms, AReportCountsBeforeItTells) {
  std::vector<NightResult> nights = worn_axis();
  nights.resize(4);
  nights[3].parameters.clear();
  const std::string text = report_text(look_at(nights, {}));
  EXPECT_TRUE(
      text.starts_with("1 axes, 4 nights, 4 results: 0 failed, 1 without a usable fit.\n"
                       "1 courses of parameters are watched; a chart alarms at "))
      << text;
  EXPECT_TRUE(text.ends_with("\n\nNo axis has changed.\n")) << text;
}

TEST(Alarms, AResidualIsCalledByItsSignal) {
  EXPECT_EQ(residual_name({"night", "velocity", "m/s", "fit", 0.0, 0.0}),
            "residual of velocity in night");
}

}  // namespace
}  // namespace axisfit
