// A small fleet for the tests: three axes on five nights.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "fleet/factory.h"
#include "fleet/plan.h"
#include "tests/apps/files.h"
#include "tests/base/message_of.h"

namespace axisfit {

/// A factory of three axes and five nights.
class SmallFleet : public ::testing::Test {
 protected:
  SmallFleet() {
    FactoryOptions options;
    options.axes = 3;
    options.nights = 5;
    options.missing = options.wrong = options.worn = 0.0;
    write_factory(factory(), options);
  }
  std::string factory() const { return folder_.path() + "/factory"; }
  FleetFile fleet() const { return read_fleet_file(factory() + "/fleet.yaml"); }
  std::string plan_folder(const std::string& name = "plan") const {
    return folder_.path() + "/" + name;
  }
  Plan planned(const std::string& name = "plan") const {
    write_plan(fleet(), plan_folder(name), Retry::none);
    return read_plan(plan_folder(name));
  }
  /// The history's results as text, but for the time that they took.
  std::string history() const {
    std::string text;
    for (NightResult night : History(fleet().history).results()) {
      night.seconds = 0.0;
      text += to_json(night).dump() + "\n";
    }
    return text;
  }
  std::filesystem::path recording(const std::string& axis, int night) const {
    return std::filesystem::path(factory()) / "recordings" / axis /
           ("2026-09-0" + std::to_string(night) + ".csv");
  }

  TempFolder folder_;
};

}  // namespace axisfit
