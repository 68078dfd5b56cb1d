// The slave control unit: the sampled position controller around the axis.
//
// Every 5 ms it reads the encoder on the motor shaft and writes the set-velocity voltage U, held
// until the next sample. Every 80 ms it receives a track point (position and speed) from the master
// unit. The paper gives the periods and states that the law combines position, velocity and
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
#include "sim/controller_settings.h"
#include "sim/integrator.h"

namespace axisfit {

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
