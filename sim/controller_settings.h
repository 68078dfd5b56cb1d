// The settings of the slave control unit (controller.h) and the reference that it follows.
#pragma once

#include <functional>

#include "sim/quantity.h"

namespace axisfit {

struct ControllerSettings {
  double period = 5e-3;                 ///< s, of sampling
  double track_period = 80e-3;          ///< s, between track points
  double k_ff = 1.0;                    ///< speed feed-forward
  double k_p = 6.0;                     ///< 1/s
  double k_i = 2.0;                     ///< 1/s^2
  double gain = 10.0;                   ///< V/(m/s), set-velocity voltage per speed
  double limit = 10.0;                  ///< V, of U either way
  double counts_per_revolution = 4000;  ///< of the encoder on the motor shaft; zero: not quantised
};

/// Calls visit(quantity, member) for every setting; the standard values are those above.
template <class SettingsT, class Visitor>
void visit_settings(SettingsT& c, Visitor&& visit) {
  using Q = Quantity;
  constexpr ControllerSettings defaults;
  visit(Q{"period", "s", "sampling period", 1e-5, 1, defaults.period}, c.period);
  visit(Q{"track_period", "s", "time between track points", 1e-5, 10, defaults.track_period},
        c.track_period);
  visit(Q{"k_ff", "1", "velocity feedforward", 0, 100, defaults.k_ff}, c.k_ff);
  visit(Q{"k_p", "1/s", "position gain", 0, 1e5, defaults.k_p}, c.k_p);
  visit(Q{"k_i", "1/s^2", "integral gain", 0, 1e6, defaults.k_i}, c.k_i);
  visit(Q{"gain", "U s/m", "set-velocity voltage per speed", 1e-3, 1e6, defaults.gain}, c.gain);
  visit(Q{"limit", "U", "largest magnitude of the command", 1e-3, 1e4, defaults.limit}, c.limit);
  visit(Q{"counts_per_revolution", "1", "encoder counts per motor revolution; 0: no quantisation",
          0, 1e9, defaults.counts_per_revolution},
        c.counts_per_revolution);
}

/// Where the axis should be, m, at a time since the start of the motion, s.
using Reference = std::function<double(double time)>;

}  // namespace axisfit
