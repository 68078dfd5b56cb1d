#pragma once

#include "sim/effects/slots.h"

namespace axisfit {

/// Friction that differs between the two directions: by dF_c in its dry part and by dB_a in its
/// viscous part, added in the positive direction and subtracted in the negative one.
///
/// dF_c alone acts like a constant force of -dF_c, sliding or sticking: no recording of the motion
/// separates the two, only a force measured at standstill, without friction. It is here for
/// machines that are known to have it. Source: as in A. Janot, M. Gautier and M. Brunot, EMPS
/// (2019), who give each direction a viscous and a Coulomb coefficient of its own.
template <class T>
struct DirectionalFriction {
  static constexpr std::string_view name = "directional_friction";
  static constexpr std::string_view meaning = "friction that differs between the directions";
  static constexpr ActsOn acts_on = ActsOn::friction;
  static constexpr std::string_view excitation = motions::kBothWays;

  T dB_a, dF_c;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"dB_a", "N s/m", "viscous friction in the positive direction minus the mean",
                   -1e6, 1e6, 0.0}
              .typically(30.0),
          self.dB_a);
    visit(Quantity{"dF_c", "N", "dry friction in the positive direction minus the mean", -1e5, 1e5,
                   0.0}
              .typically(5.0),
          self.dF_c);
  }

  static std::vector<SearchEntry> search(const SearchScales&) { return {{{"dB_a"}}}; }

  void add_to(Slots<T>& slots) const {
    slots.viscous_asymmetry += dB_a;
    slots.friction_asymmetry += dF_c;
  }
};

}  // namespace axisfit
