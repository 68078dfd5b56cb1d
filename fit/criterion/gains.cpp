#include "fit/criterion/gains.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/sampling.h"

namespace axisfit {

Observer observer_for(const Recording& recording, double gain) {
  if (!(gain > 0.0)) return {};
  const bool position = recording.find(Signal::position) != nullptr;
  if (recording.find(Signal::velocity) != nullptr) return Observer::of_velocity(gain, position);
  if (position) return Observer::of_position(gain);
  return {};
}

bool can_track(const Job& job) {
  return std::ranges::any_of(job.recordings, [](const Recording& r) {
    return r.role == Role::fit && observer_for(r, 1.0).active();
  });
}

double highest_gain(const Job& job) {
  const FitOptions& options = job.options;
  const double given =
      options.is_continued() ? options.continuation->start_gain : given_gain(options.criterion);
  if (given > 0.0) return given;
  double gain = std::numeric_limits<double>::infinity();
  for (const Recording& r : job.recordings) {
    if (r.role != Role::fit || !observer_for(r, 1.0).active()) continue;
    gain =
        std::min(gain, (r.find(Signal::velocity) != nullptr ? 1.0 : 0.3) / mean_interval(r.times));
  }
  return gain;
}

double final_gain(const Job& job) {
  return tracks(job.options.criterion) ? highest_gain(job) : 0.0;
}

bool has_choice_of_gains(const Job& job) {
  const bool is_given = tracks(job.options.criterion) && !job.choose_criterion;
  return !is_given && std::isfinite(highest_gain(job));
}

std::vector<double> score_gains(const Job& job) {
  const double highest = highest_gain(job);
  if (!has_choice_of_gains(job)) return {highest};
  return {highest / 10.0, highest / 30.0, highest / 100.0};
}

double search_gain(const Job& job) {
  const double highest = highest_gain(job);
  return has_choice_of_gains(job) ? highest / 30.0 : highest;
}

}  // namespace axisfit
