#include "fit/estimate/horizon.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include "base/parallel.h"
#include "fit/criterion/gains.h"
#include "fit/criterion/windows.h"
#include "fit/data/initial_state.h"
#include "fit/estimate/continuation.h"
#include "fit/estimate/estimate.h"
#include "fit/estimate/free_run.h"
#include "fit/estimate/recipes.h"
#include "sim/sampling.h"

namespace axisfit {
namespace {

/// A part of a recording that is left out of a fit.
struct Stretch {
  std::size_t recording = 0;
  std::size_t part = 0;
  std::size_t first = 0, end = 0;  ///< samples
  double duration = 0.0;           ///< s
};

double duration_of(const Recording& recording) {
  return recording.times.back() - recording.times.front();
}

/// At least four, and whole recordings where there are as many.
std::vector<Stretch> stretches_of(const Job& job) {
  constexpr std::size_t kFewest = 4;
  const auto recordings =
      static_cast<std::size_t>(std::ranges::count(job.recordings, Role::fit, &Recording::role));
  const std::size_t parts = (kFewest + recordings - 1) / std::max<std::size_t>(1, recordings);
  std::vector<Stretch> stretches;
  for (std::size_t r = 0; r < job.recordings.size(); ++r) {
    const Recording& recording = job.recordings[r];
    if (recording.role != Role::fit) continue;
    const double duration = duration_of(recording) / static_cast<double>(parts);
    const Partition windows = windows_of(recording, duration);
    for (std::size_t part = 0; part < windows.parts(); ++part)
      stretches.push_back({r, part, windows.first(part), windows.first(part + 1), duration});
  }
  return stretches;
}

template <class Vector>
void cut(Vector& values, std::size_t first, std::size_t end) {
  if (values.empty()) return;
  values = Vector(std::vector(values.begin() + static_cast<std::ptrdiff_t>(first),
                              values.begin() + static_cast<std::ptrdiff_t>(end)));
}

/// Some samples of a recording. Commands from before them go on acting.
Recording piece_of(Recording recording, std::size_t first, std::size_t end) {
  cut(recording.times, first, end);
  for (Samples& channel : recording.channels) cut(channel, first, end);
  for (Measurement& m : recording.measurements) {
    cut(m.values, first, end);
    cut(m.excluded, first, end);
    cut(m.uninformative, first, end);
  }
  if (first > 0) {
    std::erase_if(recording.overrides, [](const auto& value) {
      return quantity_list()[value.first].group == "initial";
    });
    recording.initial_state = InitialState::data;
    initial_state_from_data(recording);
  }
  return recording;
}

/// The job without a stretch: what is before and after it are recordings of their own, since the
/// state after it would tell a run what happened in it.
Job without(Job job, const Stretch& stretch) {
  constexpr std::size_t kFewest = 40;
  const Recording whole = job.recordings[stretch.recording];
  const std::size_t behind = whole.times.size() - stretch.end;
  Recording& before = job.recordings[stretch.recording];
  if (stretch.first >= kFewest) {
    before = piece_of(whole, 0, stretch.first);
    if (behind >= kFewest) {
      job.recordings.push_back(piece_of(whole, stretch.end, whole.times.size()));
      job.recordings.back().name += " (2)";
    }
  } else if (behind >= kFewest) {
    before = piece_of(whole, stretch.end, whole.times.size());
  } else {
    before.role = Role::validate;  // other recordings are fitted
  }
  return job;
}

/// A window that no piece fills: the free run of all of it, from a fitted state.
constexpr Criterion kWholePiece = Windows{std::numeric_limits<double>::max()};

/// A simulation that tracks a late signal is late itself.
bool tracks_in_time(const Job& job) {
  const std::vector<QuantityEntry>& list = quantity_list(job.vocabulary());
  Model<double> model = job.model;
  const std::vector<double*> values = members(model);
  for (const QuantityEntry& entry : list)
    if (is_ignored(entry, Tracking{}) && *values[entry.index] != 0.0) return false;
  return std::ranges::none_of(
      job.free, [&](const FreeParameter& p) { return is_ignored(list[p.quantity], Tracking{}); });
}

std::vector<HorizonTrial> criteria_for(const Job& job, const std::vector<Stretch>& stretches) {
  std::vector<HorizonTrial> trials;
  if (tracks_in_time(job)) trials.push_back({Tracking{highest_gain(job)}});
  double shortest = std::numeric_limits<double>::infinity(), interval = 0.0;
  for (const Stretch& stretch : stretches) {
    shortest = std::min(shortest, stretch.duration);
    interval = std::max(interval, mean_interval(job.recordings[stretch.recording].times));
  }
  constexpr double kSamples = 30.0;  // of a window, at least
  for (const double share : {0.01, 0.03, 0.1, 0.3, 1.0})
    if (share * shortest >= kSamples * interval) trials.push_back({Windows{share * shortest}});
  trials.push_back({FreeRun{}});
  return trials;
}

}  // namespace

HorizonChoice choose_horizon(const Job& job, const RunContext& context) {
  const ThreadPool pool(job.options.threads);
  const std::vector<Stretch> stretches = stretches_of(job);
  HorizonChoice choice;
  choice.stretches = static_cast<int>(stretches.size());
  for (const Stretch& s : stretches) choice.longest = std::max(choice.longest, s.duration);
  choice.trials = criteria_for(job, stretches);

  // From a poor start only a fit that tracks, at least at first, gets near; the others begin where
  // it ends.
  Job tracking = job;
  tracking.options = recipe::rough(job.options);
  tracking.options.criterion = choice.trials.front().criterion;
  const FitResult near = estimate(tracking, context.quiet());
  if (near.verdict.kind == FitVerdict::Kind::not_simulated)
    throw NoHorizon("horizon: auto: the model cannot be simulated at any start: " + near.message);
  const std::vector<double> from = values_of(near);

  const std::size_t fits = choice.trials.size() * stretches.size();
  std::vector<double> squares(fits);
  std::mutex mutex;
  Progress all{.phase = "choosing the horizon", .of = static_cast<int>(fits)};
  parallel_for(fits, [&](std::size_t i) {
    context.check_stop();
    const Criterion& criterion = choice.trials[i / stretches.size()].criterion;
    const Stretch& stretch = stretches[i % stretches.size()];
    Job rest = without(job, stretch);
    rest.options = recipe::polish(recipe::quick(job.options));
    rest.options.criterion = std::holds_alternative<FreeRun>(criterion) ? kWholePiece : criterion;
    rest.options.threads = 1;
    set_initial_values(rest, from);
    const ParameterSpace space(rest);
    const ContinuationResult fit =
        run_continuation(rest, space, space.internal(initial_values(rest)), {}, context.quiet());
    squares[i] = std::numeric_limits<double>::infinity();
    if (fit.last.usable)
      if (const std::vector<double> errors =
              free_run_errors(job, space.values(fit.last.u), stretch.recording, stretch.duration);
          !errors.empty())
        squares[i] = errors[stretch.part];
    const std::lock_guard lock(mutex);
    ++all.done;
    context.report(all);
  });
  for (std::size_t t = 0; t < choice.trials.size(); ++t) {
    double sum = 0.0;
    int count = 0;
    for (std::size_t s = 0; s < stretches.size(); ++s)
      if (const double square = squares[t * stretches.size() + s]; !std::isnan(square)) {
        sum += square;
        ++count;
      }
    choice.trials[t].error = std::sqrt(sum / count);
    if (choice.trials[t].error < choice.trials[choice.chosen].error) choice.chosen = t;
  }
  if (!std::isfinite(choice.trials[choice.chosen].error))
    throw NoHorizon(
        "horizon: auto: with every horizon the fit, or the simulation of a stretch that was left "
        "out, failed: give a horizon, such as 'horizon: 1 s'");
  return choice;
}

}  // namespace axisfit
