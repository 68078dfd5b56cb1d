// The settings of the position controller (controller.h) and the reference that it follows.
#pragma once

#include <functional>

#include "sim/quantity.h"

namespace axisfit {

/// The most whole periods of its commands by which a controller's commands are late.
inline constexpr std::size_t kMostPeriodsLate = 8;

/// When the controller acts, and how finely it sees.
struct ControllerTiming {
  double period = 5e-3;                 ///< s, of sampling
  double track_period = 80e-3;          ///< s, between track points of a move
  double counts_per_revolution = 4000;  ///< of the encoder on the motor shaft; zero: not quantised
  double velocity_samples = 1.0;        ///< of the velocity loop in a period; a whole number

  /// s, from one command to the next
  double command_period() const { return period / velocity_samples; }
};

/// The law of the controller; see control().
template <class T>
struct ControllerGains {
  T k_ff{1.0};
  T k_p{6.0};                ///< 1/s
  T k_i{2.0};                ///< 1/s^2
  T gain{10.0};              ///< command per m/s
  T k_v{0.0};                ///< 1 closes a velocity loop
  T k_n{0.0};                ///< 1/s
  T k_a{0.0};                ///< command per m/s^2
  T limit{10.0};             ///< of the command, either way
  T speed_limit{1e3};        ///< m/s, of the set velocity
  T u_0{0.0};                ///< command that the integral of the velocity loop begins with
  T T_v{0.0};                ///< s, lag of the measured velocity
  T T_u{0.0};                ///< s, lag of the command
  T notch_depth{1.0};        ///< gain of the notch filter at its frequency; 1: there is none
  T notch_frequency{100.0};  ///< Hz
  T notch_width{0.5};        ///< of its frequency
};

template <class T>
struct Controller {
  ControllerTiming timing;
  ControllerGains<T> gains;
};

/// Calls visit(quantity, member) for what is chosen; the standard values are those above.
template <class Timing, class Visitor>
void visit_timing(Timing& c, Visitor&& visit) {
  using Q = Quantity;
  constexpr ControllerTiming defaults;
  visit(Q{"period", "s", "sampling period", 1e-5, 1, defaults.period}, c.period);
  visit(Q{"track_period", "s", "time between track points of a move", 1e-5, 10,
          defaults.track_period},
        c.track_period);
  visit(Q{"counts_per_revolution", "1", "encoder counts per motor revolution; 0: no quantisation",
          0, 1e9, defaults.counts_per_revolution},
        c.counts_per_revolution);
  visit(Q{"velocity_samples", "1", "samples of the velocity loop in a period", 1, 1000,
          defaults.velocity_samples},
        c.velocity_samples);
}

/// The same for what can be fitted.
template <class Gains, class Visitor>
void visit_gains(Gains& c, Visitor&& visit) {
  using Q = Quantity;
  constexpr auto of_loop = UsedBy::controller;
  constexpr ControllerGains<double> defaults;
  visit(Q{"k_ff", "1", "velocity feedforward", 0, 100, defaults.k_ff, of_loop}, c.k_ff);
  visit(Q{"k_p", "1/s", "position gain", 0, 1e5, defaults.k_p, of_loop}, c.k_p);
  visit(Q{"k_i", "1/s^2", "integral gain", 0, 1e6, defaults.k_i, of_loop}, c.k_i);
  visit(Q{"gain", "U s/m", "command per set velocity, or per velocity error with k_v", 1e-3, 1e6,
          defaults.gain, of_loop},
        c.gain);
  visit(Q{"k_v", "1", "velocity feedback: 1 in a cascade, 0 for a law of the position alone", 0,
          100, defaults.k_v, of_loop},
        c.k_v);
  visit(Q{"k_n", "1/s", "integral gain of the velocity loop, one over its reset time", 0, 1e6,
          defaults.k_n, of_loop},
        c.k_n);
  visit(Q{"k_a", "U s^2/m", "acceleration feedforward", 0, 1e6, defaults.k_a, of_loop}, c.k_a);
  visit(Q{"limit", "U", "largest magnitude of the command", 1e-3, 1e4, defaults.limit, of_loop},
        c.limit);
  visit(Q{"speed_limit", "m/s", "largest magnitude of the set velocity", 1e-6, 1e3,
          defaults.speed_limit, of_loop},
        c.speed_limit);
  visit(Q{"u_0", "U", "command that the velocity loop's integral begins with", -1e4, 1e4,
          defaults.u_0, of_loop},
        c.u_0);
  visit(Q{"T_v", "s", "lag of the measured velocity", 0, 1, defaults.T_v, of_loop}, c.T_v);
  visit(Q{"T_u", "s", "lag of the command", 0, 1, defaults.T_u, of_loop}, c.T_u);
  visit(Q{"notch_depth", "1", "gain of a notch filter of the command at its frequency; 1: none", 0,
          10, defaults.notch_depth, of_loop},
        c.notch_depth);
  visit(Q{"notch_frequency", "Hz", "frequency of the notch filter", 1e-2, 1e5,
          defaults.notch_frequency, of_loop},
        c.notch_frequency);
  visit(Q{"notch_width", "1", "bandwidth of the notch filter over its frequency", 1e-3, 10,
          defaults.notch_width, of_loop},
        c.notch_width);
}

/// Both.
template <class ControllerT, class Visitor>
void visit_settings(ControllerT& controller, Visitor&& visit) {
  visit_timing(controller.timing, visit);
  visit_gains(controller.gains, visit);
}

/// Where the axis should be, m, at a time since the start of the motion, s.
using Reference = std::function<double(double time)>;

}  // namespace axisfit
