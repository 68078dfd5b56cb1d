#include "init/columns/unnamed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "fit/data/recording_check.h"
#include "fit/first_look/first_look.h"

namespace axisfit {
namespace {

using Values = std::vector<double>;
using Columns = std::map<std::size_t, Values>;

/// The place of a position and that of its velocity.
std::optional<std::pair<std::size_t, std::size_t>> find_motion(const Values& times,
                                                               const Columns& free) {
  constexpr double kRelated = 0.95;
  std::map<std::pair<std::size_t, std::size_t>, double>
      rates;  // how much the second is the first's
  for (const auto& [of, values] : free)
    for (const auto& [is, rate] : free)
      if (const auto found = rate_ratio(times, values, rate); found && of != is)
        rates[{of, is}] = std::abs(found->correlation);
  double best = kRelated;
  std::optional<std::pair<std::size_t, std::size_t>> motion;
  for (const auto& [pair, correlation] : rates) {
    const bool is_rate = std::ranges::any_of(rates, [&, p = pair.first](const auto& r) {
      return r.first.second == p && r.second > kRelated;
    });
    if (is_rate || correlation <= best) continue;
    best = correlation;
    motion = pair;
  }
  return motion;
}

std::optional<Inferred> find_driver(const Values& times, const Values& position,
                                    const Values& velocity, const Columns& free) {
  std::optional<Inferred> driver;
  double best = 0.0;
  for (const auto& [c, values] : free) {
    const DrivenMotion motion{times, position, velocity, values};
    const auto look = first_look(std::span(&motion, 1));
    if (!look || look->direction != FirstLook::Direction::along || look->explained() <= best)
      continue;
    best = look->explained();
    driver = Inferred{c, Kind::command,
                      fmt::format("no column has a name; this one goes with the motion "
                                  "(correlation {:.2f}), as what drives the axis does",
                                  best)};
  }
  return driver;
}

}  // namespace

std::vector<Inferred> infer_unnamed(const Values& times, ColumnSet& columns, Columns free) {
  std::vector<Inferred> found;
  const UnscaledColumn *position = columns.find(Kind::position),
                       *velocity = columns.find(Kind::velocity);
  Values place = position ? position->raw : Values(), rate = velocity ? velocity->raw : Values();
  if (!position && !velocity) {
    const auto motion = find_motion(times, free);
    if (!motion) return found;
    place = free.at(motion->first);
    rate = free.at(motion->second);
    found.push_back(
        {motion->first, Kind::position, "no column has a name; another one is its derivative"});
    found.push_back({motion->second, Kind::velocity,
                     "no column has a name; it is the derivative of another one"});
    free.erase(motion->first);
    free.erase(motion->second);
  }
  if (columns.find(Kind::force) || columns.find(Kind::current) || columns.find(Kind::command))
    return found;
  if (auto driver = find_driver(times, place, rate, free)) found.push_back(std::move(*driver));
  return found;
}

}  // namespace axisfit
