// axisfit-fleet plan | work | merge | submit | report | table | job: many axes, every night.

#include <fmt/format.h>

#include <charconv>
#include <filesystem>

#include "apps/command_line.h"
#include "apps/progress.h"
#include "base/parallel.h"
#include "fleet/alarms.h"
#include "fleet/page.h"
#include "fleet/plan.h"
#include "fleet/slurm.h"
#include "io/results/output_folder.h"

namespace {

using namespace axisfit;
namespace fs = std::filesystem;

constexpr const char* kShortHelp =
    R"(Usage: axisfit-fleet plan FLEET.yaml | work PLAN | merge PLAN | submit PLAN | report FLEET.yaml

Examples:
  axisfit-fleet plan fleet.yaml      what the history does not know yet: a plan
  axisfit-fleet work plan            do it, on this machine
  axisfit-fleet merge plan           add the results to the history
  axisfit-fleet report fleet.yaml    which axes have changed

All options: axisfit-fleet --help
)";

constexpr const char* kExamples = R"(Examples:
  axisfit-fleet plan fleet.yaml --plan tonight
  axisfit-fleet work tonight --threads 4
  axisfit-fleet submit tonight --tasks 50 --minutes 30
  axisfit-fleet merge tonight
  axisfit-fleet report fleet.yaml

Exit codes: 0 done, 1 items of the merged plan are missing, 2 bad input.)";

/// "2/7"
Shard shard_of(const std::string& text) {
  const std::size_t slash = text.find('/');
  const auto number = [&](std::string_view part) {
    std::size_t value = 0;
    const auto read = std::from_chars(part.data(), part.data() + part.size(), value);
    if (read.ec != std::errc() || read.ptr != part.data() + part.size())
      throw std::runtime_error(fmt::format("--shard {}: give it as 2/7, from 0/7 to 6/7", text));
    return value;
  };
  if (slash == std::string::npos)
    throw std::runtime_error(fmt::format("--shard {}: give it as 2/7, from 0/7 to 6/7", text));
  const Shard shard{number(std::string_view(text).substr(0, slash)),
                    number(std::string_view(text).substr(slash + 1))};
  if (shard.of == 0 || shard.shard >= shard.of)
    throw std::runtime_error(
        fmt::format("--shard {}: there are shards 0 to {} of {}", text, shard.of - 1, shard.of));
  return shard;
}

struct Arguments {
  std::string fleet, axis, night, plan = "plan", shard = "0/1", retry;
  int threads = 1;
  std::string page;
  bool json = false;
  SlurmOptions slurm;
};

int make_plan(const Arguments& a) {
  const PlanSummary made =
      write_plan(read_fleet_file(a.fleet), a.plan, a.retry.empty() ? Retry::none : Retry::failed);
  print(
      fmt::format("{} items planned in {}; the history knows {}", made.items, a.plan, made.known) +
      (made.failed > 0 && a.retry.empty()
           ? fmt::format(", {} of which failed (--retry failed does them again)", made.failed)
           : "") +
      ".\n");
  return 0;
}

int work(const Arguments& a) {
  const Plan plan = read_plan(a.plan);
  const Shard shard = shard_of(a.shard);
  const ThreadPool pool(a.threads);
  RunContext context;  // without a stop flag: who ends it loses the items that are under way
  WorkSummary done;
  {
    ProgressLine line(::isatty(STDERR_FILENO) != 0);
    context.progress = [&](const Progress& now) { line.update(now); };
    done = work_on(plan, shard, context);
  }
  print(fmt::format("{} items done, {} of them failed; {} were done before.\n", done.done,
                    done.failed, done.before));
  return 0;
}

int merge_plan(const Arguments& a) {
  const Plan plan = read_plan(a.plan);
  const MergeSummary merged = merge(plan);
  print(fmt::format("{} results merged into {}, {} of them failures.\n", merged.results,
                    plan.history, merged.failed));
  if (merged.missing == 0) return 0;
  print(fmt::format("{} items are not done yet: work on the plan, and merge again.\n",
                    merged.missing));
  return 1;
}

int report(const Arguments& a) {
  const FleetFile file = read_fleet_file(a.fleet);
  const History history(file.history);
  const std::vector<NightResult> results = history.results();
  const FleetReport found = look_at(results, {file.one_in, file.limits});
  if (!a.page.empty()) {
    refuse_to_overwrite(a.page, {a.fleet, file.history});
    write_file(a.page, fleet_page(results, found));
  }
  print(a.json ? to_json(found).dump(2) + "\n" : report_text(found));
  return 0;
}

/// The job of one axis on one night, for fit-params.
int job(const Arguments& a) {
  const FleetFile file = read_fleet_file(a.fleet);
  for (const FleetItem& item : find_items(file))
    if (item.axis == a.axis && item.night == a.night) {
      print(filled_in(file.job_text, item.values));
      return 0;
    }
  throw std::runtime_error(
      fmt::format("{} has no axis {} on night {}", a.fleet, in_quotes(a.axis), in_quotes(a.night)));
}

/// All parameters of all nights, a row for each.
int table(const Arguments& a) {
  const History history(read_fleet_file(a.fleet).history);
  std::string text = "axis,night,status,parameter,unit,value,standard_error\n";
  for (const NightResult& night : history.results())
    for (const auto& p : night.parameters)
      text += fmt::format("{},{},{},{},{},{},{}\n", night.axis, night.night, night.status, p.name,
                          p.unit, p.value, p.standard_error);
  print(text);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  CLI::App app{"Fits many axes every night, keeps their history and tells which have changed.",
               "axisfit-fleet"};
  app.footer(kExamples);
  app.require_subcommand(1);
  const auto command = [&](const char* name, const char* meaning) {
    CLI::App* made = app.add_subcommand(name, meaning);
    made->option_defaults()->group("Other");
    return made;
  };
  CLI::App* plan = command("plan", "find what the history does not know, and write a plan");
  CLI::App* do_work = command("work", "do a plan, or a shard of it");
  CLI::App* merge_it = command("merge", "add the results of a plan to the history");
  CLI::App* submit_it = command("submit", "let Slurm do a plan, and merge it");
  CLI::App* tell = command("report", "which axes have changed");
  CLI::App* list = command("table", "all parameters of all nights, as CSV");
  CLI::App* show = command("job", "the job of one axis on one night, for fit-params");
  tell->add_flag("--json", a.json, "as JSON");
  tell->add_option("--page", a.page, "a page for a browser as well, in one file")
      ->check(kNotEmpty)
      ->type_name("FILE.html");
  for (CLI::App* reads : {plan, tell, list, show})
    reads->add_option("FLEET.yaml", a.fleet, "fleet file (docs/fleet.md)")
        ->required()
        ->check(kNotEmpty);
  show->add_option("AXIS", a.axis, "name of the axis")->required();
  show->add_option("NIGHT", a.night, "name of the night")->required();
  for (CLI::App* reads : {do_work, merge_it, submit_it})
    reads->add_option("PLAN", a.plan, "folder of the plan")->required()->check(kNotEmpty);
  plan->add_option("--plan", a.plan, "folder of the plan")
      ->capture_default_str()
      ->check(kNotEmpty)
      ->type_name("FOLDER");
  plan->add_option("--retry", a.retry, "failed: plan what has failed before, too")
      ->check(CLI::IsMember({"failed"}))
      ->type_name("WHICH");
  do_work->add_option("--shard", a.shard, "I/N: every N-th item from I on")
      ->capture_default_str()
      ->type_name("I/N");
  do_work->add_option("--threads", a.threads, "items at a time; 0: as many as there are processors")
      ->capture_default_str()
      ->check(whole_number(0, 1024));
  submit_it->add_option("--tasks", a.slurm.tasks, "tasks of the array")
      ->capture_default_str()
      ->check(whole_number<std::size_t>(1, 100'000));
  submit_it->add_option("--minutes", a.slurm.minutes, "that a task may take")
      ->capture_default_str()
      ->check(whole_number(1, 100'000));
  submit_it->add_option("--memory", a.slurm.megabytes, "MB for a task")
      ->capture_default_str()
      ->check(whole_number(50, 10'000'000));
  submit_it->add_option("--partition", a.slurm.partition, "of the cluster")->check(kNotEmpty);
  return run_program(app, kShortHelp, argc, argv, [&] {
    if (*plan) return make_plan(a);
    if (*do_work) return work(a);
    if (*merge_it) return merge_plan(a);
    if (*tell) return report(a);
    if (*list) return table(a);
    if (*show) return job(a);
    read_plan(a.plan);
    a.slurm.program = fs::read_symlink("/proc/self/exe").string();
    print("Submitted: " + submit(a.plan, a.slurm) + "\n");
    return 0;
  });
}
