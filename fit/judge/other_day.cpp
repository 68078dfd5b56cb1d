#include "fit/judge/other_day.h"

#include <algorithm>
#include <cmath>

#include "fit/estimate/recipes.h"

namespace axisfit {
namespace {

/// Missing force from a sample on, in per cent of the drive's.
double percent_from(const MissingForce& force, std::size_t first) {
  if (!force.found || first >= force.force.size()) return INFINITY;
  double sum = 0.0;
  for (std::size_t i = first; i < force.force.size(); ++i) sum += force.force[i] * force.force[i];
  const double square = sum / static_cast<double>(force.force.size() - first);
  return 100.0 * std::sqrt(std::max(0.0, square - force.noise * force.noise)) / force.drive_rms;
}

/// What may differ from day to day, the likeliest alone first, then together: places in Job::free.
std::vector<std::vector<std::size_t>> candidates(const Job& job) {
  std::vector<std::size_t> found;
  for (const char* name : {"constant_force.F_0", "coulomb_friction.F_c", "F_s", "B_a", "M"}) {
    const auto at =
        std::ranges::find(job.free, ParameterId{quantity_index(name), {}}, &FreeParameter::id);
    if (at != job.free.end()) found.push_back(static_cast<std::size_t>(at - job.free.begin()));
  }
  std::vector<std::vector<std::size_t>> sets;
  for (const std::size_t one : found) sets.push_back({one});
  for (std::size_t i = 0; i < found.size(); ++i)
    for (std::size_t j = i + 1; j < found.size(); ++j) sets.push_back({found[i], found[j]});
  if (found.size() > 2) sets.push_back(found);
  return sets;
}

/// A job with that recording alone, whose first half is fitted, and nothing free.
Job job_of(const Job& job, const FitResult& fit, std::size_t recording) {
  Job alone = job;
  alone.model = fitted_model(job, fit);
  alone.recordings = {job.recordings[recording]};
  alone.free.clear();
  alone.options = recipe::once(job.options);
  Recording& own = alone.recordings.front();
  own.role = Role::fit;
  own.held_out.assign(own.times.size(), false);
  std::fill(own.held_out.begin() + static_cast<std::ptrdiff_t>(own.times.size() / 2),
            own.held_out.end(), true);
  return alone;
}

std::optional<OtherDay> other_day(const Job& job, const FitResult& fit, std::size_t recording,
                                  const MissingForce& missing, double usual,
                                  const RunContext& context) {
  const std::size_t half = job.recordings[recording].times.size() / 2;
  OtherDay best{.recording = recording, .percent_before = percent_from(missing, half)};
  best.percent = best.percent_before;
  const Job nothing_free = job_of(job, fit, recording);
  std::size_t fewest = 0;
  for (const std::vector<std::size_t>& differing : candidates(job)) {
    // As few as do: more are not tried where some do.
    if (best.percent < usual && differing.size() > fewest) break;
    context.check_stop();
    Job alone = nothing_free;
    for (const std::size_t i : differing) {
      FreeParameter& free = alone.free.emplace_back(job.free[i]);
      free.initial = fit.parameters[i].value;
    }
    FitResult found = estimate(alone, context.quiet());
    if (!found.verdict.has_minimum()) continue;
    MissingForce force = missing_force(alone, found, 0);
    const double percent = percent_from(force, half);
    if (!(percent < best.percent)) continue;
    fewest = differing.size();
    best.differing = differing;
    best.parameters = std::move(found.parameters);
    best.percent = percent;
    best.result = std::move(found.recordings.front());
    best.force = std::move(force);
  }
  // What the first half alone lacks is no other value of a parameter.
  if (best.differing.empty() || !(best.percent < usual)) return std::nullopt;
  return best;
}

}  // namespace

std::vector<OtherDay> other_days(const Job& job, const FitResult& fit, const Diagnosis& diagnosis,
                                 const GradeOptions& options, const RunContext& context) {
  std::vector<OtherDay> days;
  if (!fit.verdict.has_minimum()) return days;
  double usual = options.noticed_force;
  for (std::size_t r = 0; r < diagnosis.forces.size(); ++r)
    if (job.recordings[r].role == Role::fit)
      usual = std::max(usual, percent_of_drive(diagnosis.forces[r]));
  usual *= options.other_day_factor;
  for (std::size_t r = 0; r < diagnosis.forces.size(); ++r)
    if (job.recordings[r].role == Role::validate && percent_of_drive(diagnosis.forces[r]) > usual)
      if (auto day = other_day(job, fit, r, diagnosis.forces[r], usual, context))
        days.push_back(std::move(*day));
  return days;
}

}  // namespace axisfit
