#include "init/columns/roles.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <stdexcept>
#include <utility>

#include "base/plain_text.h"
#include "fit/data/noise.h"
#include "init/columns/column_set.h"

namespace axisfit {
namespace {

using Values = std::vector<double>;

bool is_motion(Kind kind) {
  return kind == Kind::position || kind == Kind::velocity || kind == Kind::acceleration;
}

bool is_drive(Kind kind) {
  return kind == Kind::force || kind == Kind::current || kind == Kind::command ||
         kind == Kind::motor_voltage || kind == Kind::set_velocity;
}

std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, " "));
}

/// The words that tell an axis from others, all or the last number alone.
std::string label_of(const Candidate& candidate, bool number_alone) {
  if (!number_alone) return joined(candidate.name.axis);
  const auto& words = candidate.name.axis;
  const auto number = std::find_if(words.rbegin(), words.rend(), is_number);
  return number == words.rend() ? std::string() : *number;
}

double range_of(const Values& values) {
  const auto [least, most] = std::ranges::minmax(values);
  return most - least;
}

/// More than noise, and than the steps of an encoder.
bool shows_motion(const Values& values) {
  constexpr double kNoise = 10.0, kSteps = 4.0;
  const double range = range_of(values);
  return range > kNoise * noise_from_differences(values) && range > kSteps * resolution_of(values);
}

/// Labels under which there is both a motion and a drive.
std::map<std::string, std::vector<std::size_t>> complete_labels(
    const std::vector<Candidate>& candidates, bool number_alone) {
  std::map<std::string, std::vector<std::size_t>> of_label;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    of_label[label_of(candidates[i], number_alone)].push_back(i);
  std::erase_if(of_label, [&](const auto& entry) {
    const auto has = [&](auto&& suits) {
      return std::ranges::any_of(entry.second, [&](std::size_t i) {
        return !candidates[i].name.is_setpoint && suits(candidates[i].name.kind);
      });
    };
    const auto drives = [&] {
      return std::ranges::any_of(entry.second,
                                 [&](std::size_t i) { return is_drive(candidates[i].name.kind); });
    };
    return entry.first.empty() || !has(is_motion) || !drives();
  });
  return of_label;
}

/// Whether the motion of an axis is none beside those of the others: a thousandth of them.
void compare_motions(const std::vector<Candidate>& candidates, std::vector<AxisColumns>& axes) {
  constexpr double kIdle = 1e-3;
  for (AxisColumns& axis : axes) {
    axis.moves = std::ranges::any_of(axis.columns, [&](std::size_t i) {
      const Candidate& own = candidates[i];
      if (!is_motion(own.name.kind) || own.name.kind == Kind::acceleration) return false;
      double most = 0.0;
      for (const Candidate& other : candidates)
        if (other.name.kind == own.name.kind && other.name.unit == own.name.unit)
          most = std::max(most, range_of(other.values));
      return shows_motion(own.values) && range_of(own.values) > kIdle * most;
    });
  }
}

std::string columns_of(const std::vector<Candidate>& candidates, const AxisColumns& axis) {
  std::vector<std::string> names;
  for (const std::size_t i : axis.columns) names.push_back(shortened(candidates[i].shown));
  return fmt::format("{}", fmt::join(names, ", "));
}

[[noreturn]] void ask(const std::vector<Candidate>& candidates,
                      const std::vector<AxisColumns>& axes, const std::string& problem) {
  std::vector<std::string> each;
  for (const AxisColumns& axis : axes)
    each.push_back(fmt::format("{}{} ({})", sanitized(axis.name), axis.moves ? "" : ", which idles",
                               columns_of(candidates, axis)));
  throw std::runtime_error(fmt::format(
      "{}: {}. Say which by --motor, and make a job for each in a folder of its own: --motor "
      "\"{}\" "
      "--output \"{}\"",
      problem, fmt::join(each, "; "), sanitized(axes.front().name), sanitized(axes.front().name)));
}

/// Whether two columns are about the same quantity of the same axis.
bool are_alike(const Candidate& a, const Candidate& b) {
  return a.name.kind == b.name.kind && a.name.is_setpoint == b.name.is_setpoint;
}

double correlation_of(const Values& a, const Values& b) {
  const auto n = static_cast<double>(a.size());
  double mean_a = 0.0, mean_b = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    mean_a += a[i] / n;
    mean_b += b[i] / n;
  }
  double ab = 0.0, aa = 0.0, bb = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - mean_a) * (b[i] - mean_b);
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
  }
  return aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : 0.0;
}

/// Correlation of `late` with what `early` was so many samples before.
double correlation_at(const Values& early, const Values& late, std::ptrdiff_t lag) {
  const auto shift = static_cast<std::size_t>(std::abs(lag));
  const std::size_t n = early.size() - shift;
  const auto part = [&](const Values& values, std::size_t from) {
    return Values(values.begin() + static_cast<std::ptrdiff_t>(from),
                  values.begin() + static_cast<std::ptrdiff_t>(from + n));
  };
  return lag >= 0 ? correlation_of(part(early, 0), part(late, shift))
                  : correlation_of(part(early, shift), part(late, 0));
}

}  // namespace

std::vector<AxisColumns> axes_in(const std::vector<Candidate>& candidates) {
  for (const bool number_alone : {false, true}) {
    const auto of_label = complete_labels(candidates, number_alone);
    if (of_label.size() < 2) continue;
    std::vector<AxisColumns> axes;
    for (const auto& [label, columns] : of_label) axes.push_back({label, columns});
    compare_motions(candidates, axes);
    return axes;
  }
  return {};
}

std::string keep_one_axis(std::vector<Candidate>& candidates, const std::string& motor,
                          std::vector<std::string>& others) {
  std::vector<AxisColumns> axes = axes_in(candidates);
  if (axes.empty()) {
    const auto single = complete_labels(candidates, false);
    if (single.empty() && motor.empty()) return {};
    for (const auto& [label, columns] : single) axes.push_back({label, columns, true});
    if (axes.empty() || (!motor.empty() && axes.front().name != plain(motor)))
      throw std::runtime_error(fmt::format(
          "--motor {}: no columns are named after such an axis, with a motion and what drives it",
          sanitized(motor)));
    // A column without its label may be of it, too.
    constexpr int kOther = 3;
    const std::set<std::size_t> own(axes.front().columns.begin(), axes.front().columns.end());
    for (std::size_t i = 0; i < candidates.size(); ++i)
      if (own.count(i) == 0 && !candidates[i].is_answered) candidates[i].name.rank -= kOther;
    return {};
  }
  const bool is_answered =
      std::ranges::any_of(
          candidates, [](const Candidate& c) { return c.is_answered && is_motion(c.name.kind); }) &&
      std::ranges::any_of(
          candidates, [](const Candidate& c) { return c.is_answered && is_drive(c.name.kind); });
  auto chosen = axes.end();
  if (!motor.empty()) {
    const std::string wanted = joined(words_of(motor));
    chosen = std::ranges::find_if(axes, [&](const AxisColumns& axis) {
      return axis.name == wanted || axis.name == plain(motor);
    });
    if (chosen == axes.end())
      ask(candidates, axes, fmt::format("--motor {}: there are the axes", sanitized(motor)));
  } else if (std::ranges::count_if(axes, &AxisColumns::moves) == 1) {
    chosen = std::ranges::find_if(axes, &AxisColumns::moves);
  } else if (!is_answered) {
    ask(candidates, axes, "the columns are of several axes");
  }
  std::set<std::size_t> dropped;
  for (auto axis = axes.begin(); axis != axes.end(); ++axis)
    if (axis != chosen) dropped.insert(axis->columns.begin(), axis->columns.end());
  std::vector<Candidate> kept;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (dropped.count(i) == 0 || candidates[i].is_answered)
      kept.push_back(std::move(candidates[i]));
    else
      others.push_back(candidates[i].shown);
  candidates = std::move(kept);
  return chosen == axes.end() ? std::string() : chosen->name;
}

bool is_reference_of(const Values& reference, const Values& measured) {
  constexpr double kAlike = 0.9, kSilent = 0.2;
  constexpr std::size_t kMostLag = 50, kLeast = 4 * kMostLag;
  if (reference.size() < kLeast || never_changes(reference) || never_changes(measured))
    return false;
  if (!(noise_from_differences(reference) < kSilent * noise_from_differences(measured)))
    return false;
  std::ptrdiff_t lead = 0;
  double best = correlation_at(reference, measured, 0);
  for (std::ptrdiff_t lag = -std::ptrdiff_t(kMostLag); lag <= std::ptrdiff_t(kMostLag); ++lag)
    if (const double here = correlation_at(reference, measured, lag); here > best) {
      best = here;
      lead = lag;
    }
  return best > kAlike && lead > 0;
}

void tell_references(std::vector<Candidate>& candidates) {
  for (Candidate& a : candidates)
    for (const Candidate& b : candidates) {
      if (&a == &b || !are_alike(a, b) || a.name.is_setpoint || a.is_answered) continue;
      if (a.name.is_measured || a.name.side != b.name.side || a.name.unit != b.name.unit) continue;
      if (a.name.kind == Kind::command || a.name.kind == Kind::time) continue;
      if (!is_reference_of(a.values, b.values)) continue;
      a.name.is_setpoint = true;
      break;
    }
}

void tell_sides(std::vector<Candidate>& candidates) {
  const auto is_position = [](const Candidate& c, Side side) {
    return c.name.kind == Kind::position && !c.name.is_setpoint && !c.is_answered &&
           c.name.side == side;
  };
  const auto has = [&](Side side) {
    return std::ranges::any_of(candidates,
                               [&](const Candidate& c) { return is_position(c, side); });
  };
  if (!has(Side::load) || (!has(Side::motor) && !has(Side::unsaid))) return;
  const bool is_torque_of_joint = std::ranges::any_of(candidates, [](const Candidate& c) {
    return c.name.kind == Kind::force && c.name.side == Side::load;
  });
  constexpr int kOtherSide = 50;
  for (Candidate& c : candidates) {
    if (is_torque_of_joint) {
      if (c.name.side == Side::motor && is_motion(c.name.kind) && !c.is_answered)
        c.name.rank -= kOtherSide;
      if (is_position(c, Side::unsaid)) c.name.rank -= kOtherSide;
    } else if (is_position(c, Side::load)) {
      c.name.kind = Kind::load_position;
    }
  }
}

void rank_raw_last(std::vector<Candidate>& candidates) {
  constexpr int kRaw = 30;
  constexpr double kSame = 0.99;
  const auto are_whole = [](const Values& values) {
    return std::ranges::all_of(values, [](double x) { return x == std::round(x); });
  };
  for (Candidate& raw : candidates) {
    if (raw.is_answered || !raw.name.unit.empty() || !are_whole(raw.values)) continue;
    const bool is_told = std::ranges::any_of(candidates, [&](const Candidate& other) {
      return &other != &raw && are_alike(raw, other) && !are_whole(other.values) &&
             std::abs(correlation_of(raw.values, other.values)) > kSame;
    });
    if (is_told) raw.name.rank -= kRaw;
  }
}

}  // namespace axisfit
