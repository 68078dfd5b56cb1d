#pragma once

#include "sim/effects/slots.h"

namespace axisfit {

/// A supply whose voltage drops under load. A power stage at its limit connects the motor to the
/// supply throughout, so that its resistance R_v is in series with the motor's:
///
///   V_m = +-V_s - R_v y6  at the limit of (3)
///
/// and the drop is a rise while the motor feeds back. Below the limit the power stage makes up for
/// it.
template <class T>
struct SupplyResistance {
  static constexpr std::string_view name = "supply_resistance";
  static constexpr std::string_view meaning = "supply whose voltage drops under load";
  static constexpr ActsOn acts_on = ActsOn::drive;
  static constexpr std::string_view excitation = "currents of several sizes at the voltage limit";

  T R_v;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(
        Quantity{"R_v", "ohm", "resistance of the supply", 0, 1e3, kRequired, UsedBy::velocity_loop}
            .typically(2.0),
        self.R_v);
  }

  static std::vector<SearchEntry> search(const SearchScales&) {
    return {{.strengths = {"R_v"}, .used_by = UsedBy::velocity_loop}};
  }

  void add_to(Slots<T>& slots) const { slots.supply_resistance += R_v; }
};

}  // namespace axisfit
