#include "fleet/plan.h"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>
#include <fstream>

#include "base/parallel.h"
#include "fleet/alarms.h"
#include "fleet/factory.h"
#include "fleet/slurm.h"
#include "io/config/diagnostics.h"
#include "tests/apps/files.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;

/// What a call throws; empty if nothing.
template <class Call>
std::string message_of(Call&& call) {
  try {
    call();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

/// A factory of three axes and five nights.
class PlanTest : public ::testing::Test {
 protected:
  PlanTest() {
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
  fs::path recording(const std::string& axis, int night) const {
    return fs::path(factory()) / "recordings" / axis /
           ("2026-09-0" + std::to_string(night) + ".csv");
  }

  TempFolder folder_;
};

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

TEST_F(PlanTest, ItemsComeFromAManifestToo) {
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

TEST_F(PlanTest, MistakesInFleetFilesAreTold) {
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

TEST_F(PlanTest, HistoriesAreOnlyReplacedByHistories) {
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

TEST(Slurm, ScriptsWorkOnAShardAndMerge) {
  SlurmOptions options;
  options.tasks = 50;
  options.program = "/opt/it's/axisfit-fleet";
  options.partition = "night";
  const std::string array = array_script("/data/plan", options);
  EXPECT_NE(array.find("#SBATCH --array=0-49\n"), std::string::npos);
  EXPECT_NE(array.find("#SBATCH --requeue\n"), std::string::npos);
  EXPECT_NE(array.find("#SBATCH --partition=night\n"), std::string::npos);
  EXPECT_NE(array.find("exec '/opt/it'\\''s/axisfit-fleet' work '/data/plan' --shard "
                       "\"$SLURM_ARRAY_TASK_ID/50\"\n"),
            std::string::npos)
      << array;
  EXPECT_NE(merge_script("/data/plan", options).find(" merge '/data/plan'\n"), std::string::npos);
}

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

}  // namespace
}  // namespace axisfit
