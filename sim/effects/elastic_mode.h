#pragma once

#include <numbers>

#include "sim/effects/slots.h"

namespace axisfit {

/// An elastic mode of the arm: the part m_e of its mass is carried by a spring, and vibrates with
/// the frequency f_e and the damping ratio zeta_e while the rest of the arm is held.
///
///   m_e (y1' + q'') = -m_e (w^2 q + 2 zeta_e w q'),  w = 2 pi f_e,  q its displacement
///
/// The arm with its accelerometer is what the gear drives. M remains the whole mass.
template <class T>
struct ElasticMode {
  static constexpr std::string_view name = "elastic_mode";
  static constexpr std::string_view meaning = "elastic mode of the arm";
  static constexpr ActsOn acts_on = ActsOn::inertia;
  static constexpr std::string_view excitation =
      "the arm to ring: an abrupt command, recorded by an accelerometer or fast velocity sensor";

  T m_e, f_e, zeta_e;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"m_e", "kg", "vibrating mass", 0, 1e5}.typically(12.0), self.m_e);
    visit(Quantity{"f_e", "Hz", "frequency with the arm fixed", 0.1, 1e4, kRequired,
                   UsedBy::every_axis, true}
              .typically(25.0),
          self.f_e);
    visit(Quantity{"zeta_e", "1", "damping ratio", 1e-4, 10, 0.02, UsedBy::every_axis, true}
              .typically(0.03),
          self.zeta_e);
  }

  static std::vector<SearchEntry> search(const SearchScales& scales) {
    // From a few cycles in the recording up to a third of the sampling rate; and where the residual
    // rings, which between these would be missed where there is little damping.
    auto modes =
        geometric(std::max(1.0, 4.0 / (scales.end - scales.start)), 0.33 / scales.interval, 20);
    for (auto& mode : modes) mode.push_back(0.03);
    for (const double frequency : scales.resonances) modes.push_back({frequency, 0.01});
    return {{{"m_e"}, {"f_e", "zeta_e"}, modes}};
  }

  void add_to(Slots<T>& slots) const {
    slots.elastic_mass += m_e;
    slots.elastic_frequency += 2.0 * std::numbers::pi * f_e;
    slots.elastic_damping += zeta_e;
  }
};

}  // namespace axisfit
