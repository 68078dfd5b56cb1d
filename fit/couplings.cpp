#include "fit/couplings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/units.h"

namespace axisfit {
namespace {

/// Minus the force on an axis per acceleration of another one.
std::optional<Estimated> inertia_seen(const RunResult& result, const std::string& other) {
  const Job& job = result.job();
  const Channels channels = job.model.structure.channels;
  if (channels == nullptr || !result.fit().is_usable()) return std::nullopt;
  for (std::size_t i = 0; i < job.free.size(); ++i) {
    const QuantityEntry& entry = quantity_list()[job.free[i].quantity];
    if (entry.group != ChannelForce<double>::name || job.free[i].recording) continue;
    const std::size_t place = *entry.quantity.channel;
    if (place >= channels->size() || (*channels)[place].name != other + "_acceleration") continue;
    const ParameterResult& found = result.fit().parameters[i];
    if (!found.uncertainty.determined) return std::nullopt;
    const std::string& unit = (*channels)[place].unit;
    double per_si = 1.0;
    for (const char* si : {"m/s^2", "rad/s^2"})
      if (const auto factor = unit_factor(unit, si); std::holds_alternative<double>(factor))
        per_si = std::get<double>(factor);
    return Estimated{-found.value / per_si, found.uncertainty.standard_error / per_si};
  }
  return std::nullopt;
}

}  // namespace

std::vector<SharedInertia> shared_inertias(const std::vector<AxisRun>& axes) {
  std::vector<SharedInertia> found;
  for (std::size_t b = 1; b < axes.size(); ++b)
    for (std::size_t a = 0; a < b; ++a) {
      const auto one = inertia_seen(axes[a].result, axes[b].name),
                 other = inertia_seen(axes[b].result, axes[a].name);
      if (!one || !other || !(one->error > 0.0) || !(other->error > 0.0)) continue;
      const double w = 1.0 / (one->error * one->error), v = 1.0 / (other->error * other->error);
      const auto turns = [](const AxisRun& axis) {
        return axis.result.job().model.structure.joint == Joint::revolute;
      };
      constexpr std::array kUnits{"kg", "kg m", "kg m^2"};
      SharedInertia shared{axes[a].name, axes[b].name, kUnits[turns(axes[a]) + turns(axes[b])],
                           *one,         *other,       {}};
      shared.apart = std::abs(one->value - other->value) / std::hypot(one->error, other->error);
      shared.both = {(w * one->value + v * other->value) / (w + v),
                     std::max(1.0, shared.apart) / std::sqrt(w + v)};
      found.push_back(shared);
    }
  return found;
}

}  // namespace axisfit
