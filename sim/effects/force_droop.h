#pragma once

#include "sim/effects/droop.h"
#include "sim/effects/slots.h"

namespace axisfit {

/// A force source that gives less than it is asked for at high force: a supply that drops, iron
/// that saturates. With f = K_f U the force is
///
///   f (1 / sqrt(1 + 2 c_q f^2) - c_f |f|)
///
/// see lost_part(). It is TorqueDroop for a drive whose current is not in the model.
template <class T>
struct ForceDroop {
  static constexpr std::string_view name = "force_droop";
  static constexpr std::string_view meaning = "force per signal that falls with the force";
  static constexpr ActsOn acts_on = ActsOn::motor_torque;
  static constexpr std::string_view excitation = "accelerations from gentle to the strongest";

  T c_f, c_q;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(
        Quantity{"c_f", "1/N", "relative loss of K_f per newton", -1, 1, 0.0, UsedBy::force_source}
            .typically(3e-4),
        self.c_f);
    visit(Quantity{"c_q", "1/N^2", "relative loss of K_f per square of the force", 0, 1, 0.0,
                   UsedBy::force_source}
              .typically(3e-6),
          self.c_q);
  }

  static std::vector<SearchEntry> search(const SearchScales&) {
    return {{.strengths = {"c_f"}, .used_by = UsedBy::force_source},
            {.strengths = {"c_q"}, .used_by = UsedBy::force_source}};
  }

  T motor_torque(const Instant<T>& at) const {
    return -(lost_part(c_f, c_q, at.drive_force) * at.drive_torque);
  }
};

}  // namespace axisfit
