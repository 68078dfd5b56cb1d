#pragma once

#include "sim/effects/slots.h"

namespace axisfit {

/// A rigid transmission that is not quite, seen by an encoder on the motor: with the force f that
/// it carries the motor is ahead of the arm by
///
///   c_g f + H_g sign(f)
///
/// its compliance and half its play, without the time that either takes. That holds while the motor
/// and the arm move much more slowly than they would vibrate against each other; beyond, the axis
/// has the transmission `backlash` with k_g = 1 / c_g and H = H_g. f is the motor's force without
/// what moves the motor itself. It changes nothing but the reading of the position.
template <class T>
struct SoftTransmission {
  static constexpr std::string_view name = "soft_transmission";
  static constexpr std::string_view meaning = "play or compliance between encoder and arm";
  static constexpr ActsOn acts_on = ActsOn::transmission;
  static constexpr std::string_view excitation =
      "a recorded position, strong acceleration and braking, and another signal of the arm";

  T c_g, H_g;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"c_g", "m/N", "compliance of the transmission", 0, 1, 0.0, UsedBy::rigid}
              .typically(1e-6),
          self.c_g);
    visit(Quantity{"H_g", "m", "half the play of the transmission", 0, 0.1, 0.0, UsedBy::rigid}
              .typically(1e-4),
          self.H_g);
  }

  static std::vector<SearchEntry> search(const SearchScales&) {
    return {{.strengths = {"c_g"}, .used_by = UsedBy::rigid},
            {.strengths = {"H_g"}, .used_by = UsedBy::rigid}};
  }

  void add_to(Slots<T>& slots) const {
    slots.compliance += c_g;
    slots.play += H_g;
  }
};

}  // namespace axisfit
