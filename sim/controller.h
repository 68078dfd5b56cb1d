// The slave control unit: the sampled position controller around the axis.
//
// Every 5 ms it reads the encoder on the motor shaft and writes the set-velocity voltage U, held
// until the next sample. Every 80 ms it receives a track point (position and speed) from the master
// unit. The paper gives the periods and says that the law combines position, velocity and
// integrated position; the form and the gains are assumed:
//
//   U = clip((k_ff v_ref + k_p e + k_i T_s sum e) 10 V/(m/s), -limit, limit),  e = reference -
//   encoder
//
// with the reference interpolated linearly between track points, and v_ref its slope.
#pragma once

#include <functional>
#include <span>

#include "sim/command.h"
#include "sim/integrator.h"
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
  visit(Q{"gain", "V s/m", "set-velocity voltage per speed", 1e-3, 1e6, defaults.gain}, c.gain);
  visit(Q{"limit", "V", "largest magnitude of the voltage", 1e-3, 1e4, defaults.limit}, c.limit);
  visit(Q{"counts_per_revolution", "1", "encoder counts per motor revolution; 0: no quantisation",
          0, 1e9, defaults.counts_per_revolution},
        c.counts_per_revolution);
}

/// Where the axis should be, m, at a time since the start of the motion, s.
using Reference = std::function<double(double time)>;

/// r_g y2 as the encoder reports it: in whole counts, rounded down, m.
double encoder_reading(double position, double pinion_radius, double counts_per_revolution);

/// The control law. Holds the integral and the track points of one motion.
class SlaveControlUnit {
 public:
  SlaveControlUnit(const ControllerSettings& settings, Reference reference)
      : settings_(settings), reference_(std::move(reference)) {}

  /// U in volts at the sample number n, for the encoder position read then, m. To be called for
  /// n = 0, 1, 2, ... in turn.
  double sample(long n, double encoder_position);

  const ControllerSettings& settings() const { return settings_; }

 private:
  ControllerSettings settings_;
  Reference reference_;
  double integral_ = 0.0;  // sum of e, m
};

/// Simulates the axis under its controller, from times[0] on, and calls read(i, axis) at every
/// instant; returns the commands that were written. Needs model.axis.T_d < period. The schedule
/// ends early if the simulation fails.
Schedule simulate_controlled(
    const Model<double>& model, SlaveControlUnit& unit, std::span<const double> times,
    const std::function<void(std::size_t, const Integrator<double>&)>& read,
    const IntegratorOptions& options = {});

/// The commands (V) that the control law writes for a recorded motion, as a column: the command in
/// force from each of the instants `times` (s) on, from the recorded reference and encoder position
/// (m). For recordings that lack the command itself.
std::vector<double> command_from_reference(const ControllerSettings& settings,
                                           std::span<const double> times,
                                           std::span<const double> reference,
                                           std::span<const double> position);

}  // namespace axisfit
