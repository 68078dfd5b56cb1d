#include "fit/data/job.h"

#include <algorithm>
#include <stdexcept>

namespace axisfit {

void exclude_uninformative(Measurement& measurement) {
  const std::size_t n = measurement.values.size();
  const Filter& filter = measurement.filter;
  const std::vector<bool> fresh = fresh_samples(measurement.values, measurement.hold);
  measurement.values = between_fresh(measurement.values, fresh);
  const std::size_t reach = reach_of(filter);
  measurement.uninformative.assign(n, false);
  for (std::size_t i = 0; i < n; ++i)
    measurement.uninformative[i] =
        !fresh[i] || i < reach || (filter.zero_phase && n - 1 - i < reach);
}

double noise_correlation_time(const Measurement& measurement) {
  return std::max(1.0,
                  autocorrelation_time(measurement.filter) / static_cast<double>(measurement.hold));
}

ChannelCourse Recording::course_at(double time) const {
  ChannelCourse course{time, {}, {}};
  const auto after = std::ranges::upper_bound(times, time);
  const auto end = static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(after - times.begin(), 1, std::ssize(times) - 1));
  const double since = times[end - 1], length = times[end] - since;
  for (std::size_t j = 0; j < channels.size(); ++j) {
    course.slope[j] = (channels[j][end] - channels[j][end - 1]) / length;
    course.value[j] = channels[j][end - 1] + course.slope[j] * (time - since);
  }
  return course;
}

bool share_samples(const Recording& a, const Recording& b) {
  constexpr std::size_t kFewest = 9;
  std::size_t shared = 0;
  bool varies = false;
  std::vector<std::pair<const Measurement*, const Measurement*>> both;
  for (const Measurement& m : a.measurements)
    if (const Measurement* other = b.find(m.signal)) both.emplace_back(&m, other);
  for (std::size_t i = 0, k = 0; i < a.times.size() && k < b.times.size();) {
    if (a.times[i] != b.times[k]) {
      a.times[i] < b.times[k] ? ++i : ++k;
      continue;
    }
    for (const auto& [one, other] : both) {
      if (one->values[i] != other->values[k]) return false;
      varies = varies || one->values[i] != one->values[0];
    }
    ++shared, ++i, ++k;
  }
  return varies && shared >= kFewest;
}

FreeParameter free_parameter(std::string_view name, double initial) {
  return free_parameter(quantity_list()[quantity_index(name)], initial);
}

FreeParameter free_parameter(const QuantityEntry& entry, double initial) {
  const Quantity& q = entry.quantity;
  FreeParameter p;
  p.quantity = entry.index;
  p.initial = initial;
  p.scale = scale_of(entry, initial);
  p.lower = q.lower;
  p.upper = q.upper;
  return p;
}

Scale scale_of(const QuantityEntry& entry, double initial) {
  const Quantity& q = entry.quantity;
  if (!entry.group.empty() || q.default_value == 0.0 || q.lower < 0.0 || !(initial > 0.0))
    return Scale::linear;
  return q.lower > 0.0 ? Scale::logarithmic : Scale::from_zero;
}

bool is_ignored(const QuantityEntry& entry, const Criterion& criterion) {
  return tracks(criterion) &&
         (entry.signal == Signal::position || entry.signal == Signal::velocity) &&
         (entry.quantity.symbol == "lag" || entry.quantity.symbol == "delay" ||
          entry.quantity.symbol == "drift");
}

std::optional<Job> with_exchanged_roles(Job job) {
  const auto is_own = [](const FreeParameter& p) { return p.recording.has_value(); };
  bool any = false;
  for (Recording& r : job.recordings) {
    r.role = r.role == Role::fit ? Role::validate : Role::fit;
    r.held_out.clear();
    if (r.role != Role::fit) continue;
    any = true;
    for (const auto& [quantity, value] : r.overrides)
      if (std::ranges::find(job.free, quantity, &FreeParameter::quantity) != job.free.end())
        return std::nullopt;
  }
  if (!any || std::ranges::any_of(job.free, is_own)) return std::nullopt;
  return job;
}

}  // namespace axisfit
