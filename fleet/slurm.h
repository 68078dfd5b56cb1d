// A plan on a cluster: an array of tasks of Slurm, and a last job that merges.
#pragma once

#include <cstddef>
#include <string>

namespace axisfit {

struct SlurmOptions {
  std::size_t tasks = 1;    ///< shards
  int minutes = 60;         ///< that a task may take
  int megabytes = 1000;     ///< of memory for a task
  std::string partition{};  ///< empty: the usual one
  std::string program{};    ///< axisfit-fleet, as it is called on the nodes
};

/// The script of the array, whose tasks work on a shard each, and that of the merge. A task may be
/// requeued and run twice at once: what is done is told by files that appear whole.
std::string array_script(const std::string& plan, const SlurmOptions& options);
std::string merge_script(const std::string& plan, const SlurmOptions& options);

/// Writes both into the plan's folder and submits them, the merge after the array. Returns the
/// numbers of the jobs as text. Throws std::runtime_error with what sbatch says.
std::string submit(const std::string& plan, const SlurmOptions& options);

}  // namespace axisfit
