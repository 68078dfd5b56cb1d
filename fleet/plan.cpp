#include "fleet/plan.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "base/parallel.h"
#include "base/plain_text.h"
#include "base/version.h"
#include "fleet/night_result.h"
#include "io/config/diagnostics.h"
#include "io/config/job_file.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kFormat = 1;

fs::path result_path(const std::string& folder, std::size_t item) {
  return fs::path(folder) / "results" / std::to_string(item / 1000) / fmt::format("{}.json", item);
}

/// Whole or not at all, even if two processes write it at once: either's is right.
void write_whole(const fs::path& path, const std::string& contents) {
  static std::atomic<int> count = 0;
  char host[256] = "";
  ::gethostname(host, sizeof host - 1);
  fs::create_directories(path.parent_path());
  const fs::path draft = fmt::format("{}.{}-{}-{}.tmp", path.string(), host, ::getpid(), count++);
  {
    std::ofstream out(draft, std::ios::binary);
    out << contents;
    if (!out.flush()) throw std::runtime_error(in_quotes(draft.string()) + " cannot be written");
  }
  fs::rename(draft, path);
}

/// The head of a plan of whatever version of the program.
Json head_of_plan(const std::string& folder) {
  const std::string path = (fs::path(folder) / "plan.json").string();
  std::ifstream in(path);
  if (!in) throw std::runtime_error(in_quotes(path) + " cannot be read: is that a plan?");
  const Json json = Json::parse(in, nullptr, false);
  if (!json.is_object() || !json.contains("format") || !json.contains("tool") ||
      !json.contains("items"))
    throw std::runtime_error(in_quotes(path) + " is no plan");
  return json;
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

NightResult failed(const std::exception& error) {
  NightResult night;
  night.status = "failed";
  night.reason = first_line(error.what());
  return night;
}

NightResult result_of(const Plan& plan, const FleetItem& item, const RunContext& context) {
  NightResult night;
  try {
    JobFile file =
        read_job_draft({{plan.job_name, filled_in(plan.job_text, item.values)}}, plan.job_folder);
    file.job.options.threads = 1;  // items are what is spread
    const auto run_with = [&](const RunOptions& options) {
      RunResult result = run(file.job, options, context.quiet());
      if (result.interrupted) throw Interrupted();
      return result;
    };
    const RunResult declared = run_with({});
    night = night_result(declared);
    if (plan.close_loop == CloseLoop::always ||
        (plan.close_loop == CloseLoop::unexplained && declared.grade.grade != Grade::explained))
      add_search(night, run_with({.select_effects = true}));
  } catch (const std::exception& error) {
    night = failed(error);
  }
  night.axis = item.axis;
  night.night = item.night;
  night.fingerprint = item.fingerprint;
  return night;
}

}  // namespace

PlanSummary write_plan(const FleetFile& file, const std::string& folder, Retry retry) {
  // The results of another version of the program are of no use.
  const bool is_there = fs::exists(fs::path(folder) / "plan.json");
  if (is_there && head_of_plan(folder).at("tool") == version()) {
    const Plan before = read_plan(folder);
    const auto known = History(before.history).entries();
    for (const FleetItem& item : before.items) {
      const auto entry = known.find({item.axis, item.night});
      if (entry == known.end() || entry->second.fingerprint != item.fingerprint)
        throw std::runtime_error(fmt::format(
            "{} is a plan that is not merged yet: do 'axisfit-fleet merge {}', or remove it",
            in_quotes(folder), folder));
    }
  }
  if (is_there) fs::remove_all(fs::path(folder) / "results");
  PlanSummary summary;
  std::string lines;
  const auto known = History(file.history).entries();
  for (const FleetItem& item : find_items(file)) {
    if (const auto entry = known.find({item.axis, item.night});
        entry != known.end() && entry->second.fingerprint == item.fingerprint &&
        entry->second.tool == version()) {
      const bool has_failed = entry->second.status == "failed";
      summary.failed += has_failed;
      if (!has_failed || retry == Retry::none) {
        ++summary.known;
        continue;
      }
    }
    lines += Json{{"axis", item.axis},
                  {"night", item.night},
                  {"fingerprint", item.fingerprint},
                  {"values", item.values}}
                 .dump() +
             "\n";
    ++summary.items;
  }
  write_whole(fs::path(folder) / "items.jsonl", lines);
  write_whole(fs::path(folder) / "plan.json",
              Json{{"format", kFormat},
                   {"tool", version()},
                   {"items", summary.items},
                   {"job_folder", file.folder},
                   {"job_name", file.job_name},
                   {"job", file.job_text},
                   {"history", file.history},
                   {"close_loop", static_cast<int>(file.close_loop)}}
                      .dump(1) +
                  "\n");
  return summary;
}

Plan read_plan(const std::string& folder) {
  Plan plan;
  plan.folder = folder;
  const std::string path = (fs::path(folder) / "plan.json").string();
  const Json json = head_of_plan(folder);
  try {
    if (json.at("format") != kFormat || json.at("tool") != version())
      throw std::runtime_error(
          fmt::format("{} was made by axisfit {}, this is {}: make the plan anew", in_quotes(path),
                      json.at("tool").get<std::string>(), version()));
    plan.job_folder = json.at("job_folder");
    plan.job_name = json.at("job_name");
    plan.job_text = json.at("job");
    plan.history = json.at("history");
    plan.close_loop = static_cast<CloseLoop>(json.at("close_loop").get<int>());
    std::ifstream lines(fs::path(folder) / "items.jsonl");
    for (std::string line; std::getline(lines, line);) {
      const Json item = Json::parse(line);
      plan.items.push_back({item.at("axis"), item.at("night"),
                            item.at("values").get<std::map<std::string, std::string>>(),
                            item.at("fingerprint")});
    }
    if (plan.items.size() != json.at("items").get<std::size_t>())
      throw std::runtime_error(in_quotes(path) + " does not fit its items");
  } catch (const Json::exception&) {
    throw std::runtime_error(in_quotes(path) + " is no plan");
  }
  return plan;
}

WorkSummary work_on(const Plan& plan, const Shard& shard, const RunContext& context) {
  std::vector<std::size_t> open;
  WorkSummary summary;
  for (std::size_t k = shard.shard; k < plan.items.size(); k += shard.of)
    if (fs::exists(result_path(plan.folder, k)))
      ++summary.before;
    else
      open.push_back(k);
  std::atomic<std::size_t> done = 0, failures = 0;
  parallel_for(open.size(), [&](std::size_t i) {
    context.check_stop();
    const fs::path path = result_path(plan.folder, open[i]);
    if (fs::exists(path)) return;  // by somebody else meanwhile
    const NightResult night = result_of(plan, plan.items[open[i]], context);
    write_whole(path, to_json(night).dump() + "\n");
    failures += night.status == "failed";
    const std::size_t so_far = ++done;
    context.report({.phase = fmt::format("{} of {} items", so_far, open.size())});
  });
  summary.done = done;
  summary.failed = failures;
  return summary;
}

MergeSummary merge(const Plan& plan) {
  MergeSummary summary;
  std::vector<NightResult> results;
  for (std::size_t k = 0; k < plan.items.size(); ++k) {
    const fs::path path = result_path(plan.folder, k);
    std::ifstream in(path);
    if (!in) {
      ++summary.missing;
      continue;
    }
    try {
      results.push_back(night_result_from(Json::parse(in)));
    } catch (const Json::exception&) {
      throw std::runtime_error(in_quotes(path.string()) +
                               " is no result: remove it, and its item is done again");
    }
    const NightResult& night = results.back();
    if (night.fingerprint != plan.items[k].fingerprint)
      throw std::runtime_error(in_quotes(path.string()) + " is the result of another plan");
    summary.failed += night.status == "failed";
  }
  summary.results = results.size();
  History(plan.history).add(results, version());
  return summary;
}

}  // namespace axisfit
