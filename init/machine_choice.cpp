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

/// As StopFlag counts: about a second, and ten. What explains a recording does so at once; a stiff
/// gear that does not would take minutes.
constexpr long kWorkOfATrial = 2'000'000, kWorkOfAnother = 50'000'000;

struct Trial {
  std::size_t place;  ///< in the order of trials: one mass first
  TriedAxis result;
  Job read;

  double error() const { return result.error.value_or(std::numeric_limits<double>::infinity()); }

  void fit(int attempts, const RunContext& context) {
    context.report({.phase = "trying " + result.name});
    Job tried = read;
    tried.options.attempts = attempts;
    const StopFlag spent(context.stop, attempts > 1 ? kWorkOfAnother : kWorkOfATrial);
    RunContext within = context.quiet();
    within.stop = &spent;
    try {
      result.error = error_of(tried, estimate(tried, within));
    } catch (const Interrupted&) {  // no fit within that work
      if (is_set(context.stop)) throw;
    }
  }
};

}  // namespace

MachineChoice choose_machine(const InitRequest& request, const RunContext& context, int threads) {
  constexpr std::size_t kMostSamples = 20000;  // that are read quickly for every machine
  constexpr double kExplained = 0.02;          // of the input
  MachineChoice choice;
  std::string refusal;
  try {
    choice.job = initial_job(request, context);
  } catch (const std::runtime_error& error) {
    // Columns that do not suit one mass may suit another axis.
    refusal = error.what();
  }
  // Where the sign of the input is open, no machine can be told from another.
  const bool is_told = refusal.empty() && choice.job.look &&
                       (choice.job.look->unexplained < kExplained ||
                        choice.job.look->direction == FirstLook::Direction::open);
  if (is_told) return choice;
  const std::vector<std::string> machines = machines_for(request);
  std::vector<Trial> trials;
  const auto try_axis = [&](const std::string& name, const InitialJob& made) {
    Trial trial{trials.size(), {name, {}, 0}, read_job_draft(made.files, request.folder).job};
    trial.read.options.threads = threads;
    trial.result.parameters = trial.read.free.size();
    try {
      trial.fit(1, context);
    } catch (const Interrupted&) {  // is said of the job that is chosen
    }
    choice.is_validated = trial.read.recordings.size() > 1;
    trials.push_back(std::move(trial));
  };
  const auto samples_of = [&](const InitialJob& made) {
    std::size_t samples = 0;
    for (const Recording& r : read_job_draft(made.files, request.folder).job.recordings)
      samples += r.times.size();
    return samples;
  };
  if (machines.empty() || (refusal.empty() && samples_of(choice.job) > kMostSamples)) {
    if (!refusal.empty()) throw std::runtime_error(refusal);
    return choice;
  }
  const auto job_of = [&](const std::string& name, bool is_on_trial) {
    InitRequest one = request;
    one.is_machine = name != kMass;
    if (one.is_machine) one.axis = name;
    one.is_on_trial = is_on_trial;
    return initial_job(one, context);
  };
  if (refusal.empty()) try_axis(kMass, job_of(kMass, true));
  for (const std::string& name : machines) {
    if (is_set(context.stop)) break;
    try {
      try_axis(name, job_of(name, true));
    } catch (const std::runtime_error& error) {
      if (refusal.empty()) refusal = error.what();
    }
  }
  if (trials.empty()) throw std::runtime_error(refusal);
  // What explains the recordings does so at once, but for axes whose valleys are narrow.
  constexpr double kExplains = 3.0;
  for (Trial& t : trials)
    if (t.read.options.starts > 1 && !is_set(context.stop) &&
        std::ranges::min_element(trials, {}, &Trial::error)->error() > kExplains)
      t.fit(t.read.options.attempts, context);
  constexpr double kAsGood = 1.05, kFits = 10.0;
  std::ranges::stable_sort(trials, {}, &Trial::error);
  choice.is_explained = trials.front().error() <= kFits;
  const auto mass = std::ranges::find(trials, kMass, [](const Trial& t) { return t.result.name; });
  const auto end = std::ranges::find_if_not(
      trials, [&](const Trial& t) { return t.error() <= kAsGood * trials.front().error(); });
  const auto chosen = !choice.is_explained && mass != trials.end()
                          ? mass
                          : std::ranges::min_element(trials.begin(), end, {}, [](const Trial& t) {
                              return std::pair(t.result.parameters, t.place);
                            });
  std::rotate(trials.begin(), chosen, chosen + 1);
  if (const std::string& name = trials.front().result.name; name != kMass) {
    choice.job = job_of(name, false);
    mark_examples(choice.job, read_job_draft(choice.job.files, request.folder));
  }
  if (is_set(context.stop))
    choice.job.guesses.emplace_back(
        "which kind of axis it is was not looked at, since the run was stopped");
  for (Trial& t : trials) choice.tried.push_back(std::move(t.result));
  return choice;
}

}  // namespace axisfit
