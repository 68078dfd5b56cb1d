#pragma once

#include "sim/effects/slots.h"

namespace axisfit {

/// A power stage that follows its input (V_c, or the command of a force source) with the time
/// constant T_l. At zero it follows without delay.
template <class T>
struct DriveLag {
  static constexpr std::string_view name = "drive_lag";
  static constexpr std::string_view meaning = "lag of the drive";
  static constexpr ActsOn acts_on = ActsOn::drive;
  static constexpr std::string_view excitation = motions::kSwitches;

  T T_l;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"T_l", "s", "time constant of the drive", 0, 10}.typically(5e-4), self.T_l);
  }

  static std::vector<SearchEntry> search(const SearchScales& scales) {
    return {{.strengths = {"T_l"}, .probes = later(scales)}};
  }

  void add_to(Slots<T>& slots) const { slots.drive_lag += T_l; }
};

}  // namespace axisfit
