#pragma once

#include "sim/effects/slots.h"

namespace axisfit {

/// Dry friction proportional to the force that the gear transmits, mu per newton of tooth pressure;
/// for a rigid transmission, per newton of drive force.
///
/// Source: load-dependent friction of gears and screws, e.g. P. Hamon, M. Gautier and P. Garrec,
/// IROS 2010.
template <class T>
struct LoadFriction {
  static constexpr std::string_view name = "load_friction";
  static constexpr std::string_view meaning = "friction proportional to the transmitted force";
  static constexpr ActsOn acts_on = ActsOn::friction;
  static constexpr std::string_view excitation = motions::kAcceleration;

  T mu;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"mu", "1", "dry friction per transmitted force", 0, 1}.typically(0.05), self.mu);
  }

  static std::vector<SearchEntry> search(const SearchScales&) { return {{{"mu"}}}; }

  void add_to(Slots<T>& slots) const { slots.load_friction += mu; }
};

}  // namespace axisfit
