#include "fleet/plan.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "base/parallel.h"
#include "io/config/diagnostics.h"
#include "tests/fleet/small_fleet.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;

using PlanTest = SmallFleet;

TEST_F(PlanTest, IsTheSameInAnyShardsAndAfterAnyLoss) {
  work_on(planned(), {}, {});
  EXPECT_EQ(merge(read_plan(plan_folder())).results, 15u);
  const std::string whole = history();
  fs::remove(fleet().history);
  const Plan plan = planned("other");
  for (std::size_t shard = 0; shard < 7; ++shard) work_on(plan, {shard, 7}, {});
  // As if tasks had been killed: some results are not there, and drafts of others are.
  int lost = 0;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(plan.folder) / "results"))
    if (entry.is_regular_file() && ++lost % 3 == 0) {
      std::ofstream(entry.path().string() + ".host-1-1.tmp") << "{\"axis\":";
      fs::remove(entry.path());
    }
  MergeSummary merged = merge(plan);
  EXPECT_EQ(merged.results, 10u);
  EXPECT_EQ(merged.missing, 5u);
  const WorkSummary again = work_on(plan, {}, {});
  EXPECT_EQ(again.done, 5u);
  EXPECT_EQ(again.before, 10u);
  merged = merge(plan);
  EXPECT_EQ(merged.missing, 0u);
  EXPECT_EQ(history(), whole);
  merge(plan);
  EXPECT_EQ(history(), whole);
  EXPECT_NE(whole.find("\"B_a\""), std::string::npos);
  EXPECT_NE(whole.find("\"temperature\""), std::string::npos);
}

TEST_F(PlanTest, HasWhatTheHistoryDoesNotKnow) {
  Plan plan = planned();
  EXPECT_EQ(plan.items.size(), 15u);
  EXPECT_NE(message_of([&] { planned(); }).find("is a plan that is not merged yet"),
            std::string::npos);
  {
    const ThreadPool pool(2);
    work_on(plan, {}, {});
  }
  merge(plan);
  EXPECT_EQ(planned().items.size(), 0u);
  // A file that changed, a new one, and one that is damaged.
  fs::last_write_time(recording("axis-0001", 2), fs::file_time_type::clock::now());
  fs::copy(recording("axis-0002", 1), recording("axis-0002", 9));
  fs::resize_file(recording("axis-0003", 3), 100);
  plan = planned();
  ASSERT_EQ(plan.items.size(), 3u);
  EXPECT_EQ(plan.items[1].night, "2026-09-09");
  const WorkSummary done = work_on(plan, {}, {});
  EXPECT_EQ(done.done, 3u);
  EXPECT_EQ(done.failed, 1u);
  EXPECT_EQ(merge(plan).failed, 1u);
  const PlanSummary none = write_plan(fleet(), plan_folder(), Retry::none);
  EXPECT_EQ(none.items, 0u);
  EXPECT_EQ(none.failed, 1u);
  EXPECT_EQ(write_plan(fleet(), plan_folder("retry"), Retry::failed).items, 1u);
  for (const NightResult& night : History(fleet().history).results())
    if (night.status == "failed") {
      EXPECT_EQ(night.axis, "axis-0003");
      EXPECT_NE(night.reason.find("night.yaml:6:11: "), std::string::npos) << night.reason;
    }
}

// What a search finds is added; parameters and residuals stay those of the declared model, so that
// nights with and without a search can be compared.
TEST_F(PlanTest, KeepsTheDeclaredModelWhereASearchFindsMore) {
  const auto leave_out = [&](const std::string& name, const std::string& line) {
    std::string text = folder_.read("factory/" + name);
    const std::size_t at = text.find(line);
    ASSERT_NE(at, std::string::npos) << line;
    folder_.write("factory/" + name, text.erase(at, line.size()));
  };
  leave_out("axis.yaml", "  coulomb_friction: {F_c: 12 N}\n");
  leave_out("night.yaml", "  coulomb_friction.F_c: {}\n");
  const auto result_with = [&](CloseLoop close_loop) {
    FleetFile file = fleet();
    file.close_loop = close_loop;
    const std::string folder = plan_folder(std::to_string(static_cast<int>(close_loop)));
    write_plan(file, folder, Retry::none);
    Plan plan = read_plan(folder);
    plan.items.resize(1);
    work_on(plan, {}, {});
    merge(plan);
    return History(file.history).results().at(0);
  };
  const NightResult declared = result_with(CloseLoop::never);
  EXPECT_TRUE(declared.effects.empty());
  EXPECT_NE(declared.status, "explained");
  ASSERT_FALSE(declared.parameters.empty());
  for (const CloseLoop close_loop : {CloseLoop::unexplained, CloseLoop::always}) {
    NightResult searched = result_with(close_loop);
    EXPECT_EQ(searched.effects, std::vector<std::string>{"coulomb_friction"});
    EXPECT_EQ(searched.status, "explained");
    searched.effects.clear();
    searched.status = declared.status;
    searched.fingerprint = declared.fingerprint;
    searched.seconds = declared.seconds;
    EXPECT_EQ(to_json(searched), to_json(declared));
  }
}

TEST_F(PlanTest, PlansOfAnotherVersionAreMadeAnew) {
  const Plan plan = planned();
  const std::string head = folder_.read("plan/plan.json");
  const std::size_t tool = head.find("\"tool\": \"") + 9;
  folder_.write("plan/plan.json",
                head.substr(0, tool) + "0.0.1" + head.substr(head.find('"', tool)));
  EXPECT_NE(message_of([&] { read_plan(plan.folder); }).find("was made by axisfit 0.0.1"),
            std::string::npos);
  EXPECT_EQ(planned().items.size(), 15u);
  folder_.write("plan/plan.json", "{\"mine\": 1}");
  EXPECT_NE(message_of([&] { planned(); }).find("is no plan"), std::string::npos);
}

TEST_F(PlanTest, ResultsThatAreNoneAreToldByName) {
  const Plan plan = planned();
  work_on(plan, {}, {});
  std::ofstream(plan.folder + "/results/0/4.json") << "{\"axis\":";
  EXPECT_NE(message_of([&] { merge(plan); }).find("4.json' is no result"), std::string::npos);
  std::ofstream(plan.folder + "/items.jsonl") << "[";
  EXPECT_NE(message_of([&] { read_plan(plan.folder); }).find("is no plan"), std::string::npos);
  EXPECT_NE(message_of([&] { read_plan(factory()); }).find("is that a plan?"), std::string::npos);
}

}  // namespace
}  // namespace axisfit
