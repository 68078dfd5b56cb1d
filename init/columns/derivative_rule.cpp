#include "init/columns/derivative_rule.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "base/rounding.h"
#include "fit/data/recording_check.h"

namespace axisfit {
namespace {

/// That of counts is no size to compare with.
bool is_sized(const UnscaledColumn& column) {
  return column.size > 0.0 && !is_raw(column.column.stored);
}

void take_ratio(UnscaledColumn& column, double size, const std::string& measured,
                std::optional<Joint> joint) {
  if (const auto unit = unit_of_size(column.column.kind, size, joint)) {
    column.set_unit(*unit);
    column.reason(fmt::format("{}: taken as {}", measured, unit->text));
    return;
  }
  column.set_size(round_to_digits(size, 4), joint);
  column.guess(fmt::format("{}: one unit is {:.4g} {}, which matches no known unit", measured, size,
                           si_unit(column.column.kind, joint.value_or(Joint::prismatic))));
}

/// The unit of the derivative of something of that size, which is `found.ratio` times the rate.
void size_rate(UnscaledColumn& rate, const UnscaledColumn& of, double size_of, double size_of_time,
               const RateRatio& found, const char* words) {
  const double size = size_of / (std::abs(found.ratio) * size_of_time);
  const std::string measured = fmt::format("{:.5g} times the derivative of {}", found.ratio, words);
  if (rate.answered && rate.size > 0.0) return;
  if (rate.size > 0.0 && std::abs(std::log(size / rate.size)) < kSameUnit) {
    rate.reason(fmt::format("{}, as expected for {}", measured, rate.named));
  } else if (const auto unit = unit_of_size(rate.column.kind, size, of.joint);
             rate.size > 0.0 && unit) {
    rate.guess(fmt::format("the header says {}, but it is {}: taken as {}", rate.named, measured,
                           unit->text));
    rate.set_unit(*unit);
  } else if (rate.size > 0.0) {
    rate.column.contradicts = true;
    rate.guess(fmt::format("it is {}, which no unit explains: one of the two has a wrong scale",
                           measured));
  } else {
    take_ratio(rate, size, measured, of.joint);
  }
  if (found.ratio > 0.0) return;
  rate.column.negative = true;
  rate.guess("its sign was inverted; if that is wrong, invert that of " + of.column.column);
}

/// A velocity beside counts is in counts per second, whatever a count is.
void size_counts(UnscaledColumn& rate, double size, double ratio) {
  const std::string measured = fmt::format("{:.5g} times the derivative of the position", ratio);
  const StoredUnit counts = *stored_unit(Kind::velocity, "counts/s");
  if (std::abs(std::log(size / counts.size)) < kSameUnit) {
    rate.set_unit(counts);
    rate.reason(fmt::format("{}: taken as {}", measured, counts.text));
  } else {
    rate.set_size(round_to_digits(size, 4), {});
    rate.guess(fmt::format("{}, which is in counts: its factor goes with that", measured));
  }
  if (ratio > 0.0) return;
  rate.column.negative = true;
  rate.guess("its sign was inverted");
}

}  // namespace

std::vector<double> derivative_at(const std::vector<double>& times,
                                  const std::vector<double>& values) {
  std::vector<double> rate(values.size(), 0.0);
  for (std::size_t i = 1; i + 1 < values.size(); ++i)
    rate[i] = (values[i + 1] - values[i - 1]) / (times[i + 1] - times[i - 1]);
  if (rate.size() > 2) {
    rate.front() = rate[1];
    rate.back() = rate[rate.size() - 2];
  }
  return rate;
}

bool size_time_by_motion(UnscaledColumn& time, ColumnSet& columns) {
  const UnscaledColumn *position = columns.find(Kind::position),
                       *velocity = columns.find(Kind::velocity);
  if (!position || !velocity || !is_sized(*position) || !is_sized(*velocity)) return false;
  if (position->joint && velocity->joint && position->joint != velocity->joint) return false;
  const auto found = rate_ratio(time.raw, position->raw, velocity->raw);
  if (!found || !found->related()) return false;
  const auto unit =
      unit_of_size(Kind::time, position->size / (std::abs(found->ratio) * velocity->size), {});
  if (!unit) return false;
  time.set_unit(*unit);
  time.reason(
      fmt::format("in {}, the derivative of the position agrees with the velocity", unit->text));
  return true;
}

void size_motion_by_derivative(const UnscaledColumn& time, ColumnSet& columns) {
  UnscaledColumn *position = columns.find(Kind::position), *velocity = columns.find(Kind::velocity);
  if (!position || !velocity) return;
  const auto found = rate_ratio(time.raw, position->raw, velocity->raw);
  if (!found) return;
  if (!found->related()) {
    velocity->guess(
        fmt::format("it does not follow the derivative of the position (correlation {:.2f}): "
                    "is it from the same axis?",
                    found->correlation));
    return;
  }
  // Counts and metres per second, say: a screw, or a motor and its load, lies between them.
  const bool are_alike = !position->joint || !velocity->joint || position->joint == velocity->joint;
  if (!is_sized(*position) && is_sized(*velocity) && !position->answered)
    take_ratio(*position, velocity->size * std::abs(found->ratio) * time.size,
               fmt::format("{} is {:.5g} times its derivative", velocity->column.column,
                           std::abs(found->ratio)),
               velocity->joint);
  if (is_raw(position->column.stored) && !is_sized(*velocity))
    size_counts(*velocity, position->size / (std::abs(found->ratio) * time.size), found->ratio);
  else if (position->size > 0.0 && are_alike)
    size_rate(*velocity, *position, position->size, time.size, *found, "the position");
}

void size_acceleration_by_derivative(const UnscaledColumn& time, ColumnSet& columns) {
  UnscaledColumn* acceleration = columns.find(Kind::acceleration);
  const UnscaledColumn *velocity = columns.find(Kind::velocity),
                       *position = columns.find(Kind::position);
  if (acceleration == nullptr) return;
  const UnscaledColumn* of = velocity ? velocity : position;
  if (of == nullptr || !(of->size > 0.0)) return;
  auto found =
      rate_ratio(time.raw, velocity ? velocity->raw : derivative_at(time.raw, position->raw),
                 acceleration->raw);
  if (!found || !found->related()) return;
  // A velocity whose sign is turned turns what is compared with it.
  if (velocity && velocity->column.negative) found->ratio = -found->ratio;
  if (acceleration->joint && of->joint && acceleration->joint != of->joint) return;
  size_rate(*acceleration, *of, velocity ? of->size : of->size / time.size, time.size, *found,
            velocity ? "the velocity" : "the derivative of the position");
}

}  // namespace axisfit
