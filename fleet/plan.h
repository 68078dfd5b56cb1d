// A plan: a folder with work items that depend on nothing but their inputs. Any number of processes
// on any number of machines can work on it, and be killed; what is done is told by its file, which
// appears whole or not at all.
//
//   plan.json           what to do, and the program's version
//   items.jsonl         one item per line
//   results/N/K.json    what item K says, N = K / 1000
//   logs/               of a cluster
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "fit/solve/run_context.h"
#include "fleet/history.h"
#include "fleet/items.h"

namespace axisfit {

struct Plan {
  std::string folder;                ///< of the plan
  std::string job_folder, job_name;  ///< of the job
  std::string job_text;
  std::string history;
  CloseLoop close_loop = CloseLoop::never;
  std::vector<FleetItem> items;
};

/// What making a plan found.
struct PlanSummary {
  std::size_t items = 0, known = 0, failed = 0;  ///< planned, left out as known, known as failed
};

/// Which of those that failed are done again.
enum class Retry { none, failed };

/// Writes a plan for what the history does not know yet, or knows from other inputs or another
/// version of the program. Throws std::runtime_error where the folder has a plan whose results are
/// not merged yet.
PlanSummary write_plan(const FleetFile& file, const std::string& folder, Retry retry);

/// Throws std::runtime_error for anything but a plan of this version of the program.
Plan read_plan(const std::string& folder);

/// The items of one of several shards: every `of`-th, from `shard` on.
struct Shard {
  std::size_t shard = 0, of = 1;
};

struct WorkSummary {
  std::size_t done = 0, failed = 0, before = 0;  ///< here, of those failed, and by others before
};

/// Does what is not done of a shard, on all threads of the pool. Items that fail are results, too.
/// Throws Interrupted, when what was begun is not kept, and std::runtime_error where results cannot
/// be written.
WorkSummary work_on(const Plan& plan, const Shard& shard, const RunContext& context);

struct MergeSummary {
  std::size_t results = 0, failed = 0, missing = 0;
};

/// Adds all results to the history, in one transaction; again, it changes nothing.
MergeSummary merge(const Plan& plan);

}  // namespace axisfit
