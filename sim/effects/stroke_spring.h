#pragma once

#include "sim/effects/slots.h"

namespace axisfit {

/// A spring along the stroke that pulls the arm to position zero with k_s per metre: a cable chain,
/// a hose. A spring with another origin needs a constant force in addition.
template <class T>
struct StrokeSpring {
  static constexpr std::string_view name = "stroke_spring";
  static constexpr std::string_view meaning = "spring along the stroke";
  static constexpr ActsOn acts_on = ActsOn::arm_force;
  static constexpr std::string_view excitation = motions::kWholeStroke;

  T k_s;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"k_s", "N/m", "stiffness along the stroke", -1e7, 1e7}.typically(300.0),
          self.k_s);
  }

  static std::vector<SearchEntry> search(const SearchScales&) { return {{{"k_s"}}}; }

  void add_to(Slots<T>& slots) const { slots.stiffness += k_s; }
};

}  // namespace axisfit
