#include "init/machine_choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "fit/judge/series.h"
#include "init/starter_axis.h"
#include "io/config/job_file.h"

namespace axisfit {
namespace {

constexpr const char* kMass = "mass";

/// The error of the last recording if that validates, or else of all.
std::optional<double> error_of(const Job& job, const FitResult& fit) {
  if (!fit.verdict.has_minimum()) return std::nullopt;
  const bool validates = job.recordings.size() > 1;
  double sum = 0.0, samples = 0.0;
  for (const ResidualSeries& series : residual_series(job, fit)) {
    if (series.fitted == validates) continue;
    for (const double r : series.values) sum += r * r;
    samples += double(series.values.size());
  }
  return samples > 0.0 ? std::optional(std::sqrt(sum / samples)) : std::nullopt;
}

/// Says in the axis file which of its values are those of an example: what the job neither frees
/// nor leaves at zero or its standard value.
void mark_examples(InitialJob& created, const JobFile& read) {
  const Structure& structure = read.job.model.structure;
  Model<double> model = read.job.model;
  const std::vector<double*> values = members(model);
  std::vector<std::string> names;
  for (const QuantityEntry& entry : quantity_list(read.job.vocabulary())) {
    const double value = *values[entry.index];
    if (is_used(entry, structure) && value != 0.0 && value != entry.quantity.default_value &&
        std::ranges::count(read.job.free, entry.index, &FreeParameter::quantity) == 0)
      names.push_back(entry.name);
  }
  if (names.empty()) return;
  created.files.front().second +=
      fmt::format("guessed: [{}]   # put your own values\n", fmt::join(names, ", "));
  created.guesses.push_back(
      fmt::format("in axis.yaml, that of a machine of this kind, {}: their "
                  "values are those of an example; put your own",
                  fmt::join(names, ", ")));
}

struct Trial {
  std::size_t place;  ///< in the order of trials: one mass first
  TriedAxis result;
  InitialJob job;
  Job read;

  double error() const { return result.error.value_or(std::numeric_limits<double>::infinity()); }

  void fit(int attempts, const RunContext& context) {
    context.report({.phase = "trying " + result.name});
    Job tried = read;
    tried.options.attempts = attempts;
    result.error = error_of(tried, estimate(tried, context.quiet()));
  }
};

}  // namespace

MachineChoice choose_machine(const std::vector<std::string>& recordings, const std::string& folder,
                             const std::vector<ColumnAnswer>& answers, const RunContext& context) {
  const std::vector<std::string> machines = machines_for(recordings, answers);
  if (machines.empty()) return {initial_job(recordings, {}, folder, {}, answers), {}};
  std::vector<Trial> trials;
  std::string refusal;
  std::vector<std::string> names{kMass};
  names.insert(names.end(), machines.begin(), machines.end());
  MachineChoice choice;
  for (const std::string& name : names) {
    try {
      const bool is_machine = name != kMass;
      Trial trial{trials.size(),
                  {name, {}, 0},
                  initial_job(recordings, is_machine ? name : "", folder, {}, answers, is_machine),
                  {}};
      const JobFile read = read_job_draft(trial.job.files, folder);
      if (is_machine) mark_examples(trial.job, read);
      trial.read = read.job;
      trial.result.parameters = read.job.free.size();
      trial.fit(1, context);
      choice.is_validated = read.job.recordings.size() > 1;
      trials.push_back(std::move(trial));
    } catch (const std::runtime_error& error) {
      // Columns that do not suit one axis may suit another.
      if (refusal.empty()) refusal = error.what();
    }
  }
  if (trials.empty()) throw std::runtime_error(refusal);
  const auto best = [&] { return std::ranges::min_element(trials, {}, &Trial::error)->error(); };
  // What explains the recordings does so at once, but for axes whose valleys are narrow.
  constexpr double kExplains = 3.0;
  for (Trial& t : trials)
    if (t.read.options.starts > 1 && best() > kExplains) t.fit(t.read.options.attempts, context);
  constexpr double kAsGood = 1.05;
  std::ranges::stable_sort(trials, {}, &Trial::error);
  const auto as_good = [&](const Trial& t) {
    return t.error() <= kAsGood * trials.front().error();
  };
  const auto end = std::ranges::find_if_not(trials, as_good);
  const auto chosen = std::ranges::min_element(trials.begin(), end, {}, [](const Trial& t) {
    return std::pair(t.result.parameters, t.place);
  });
  std::rotate(trials.begin(), chosen, chosen + 1);
  choice.job = std::move(trials.front().job);
  for (Trial& t : trials) choice.tried.push_back(std::move(t.result));
  return choice;
}

}  // namespace axisfit
