// What an effect says of itself to the search for missing effects, beyond its name and quantities.
//
//   static constexpr ActsOn acts_on;               where it acts
//   static constexpr std::string_view excitation;  what a motion must do to show it
//   static std::vector<SearchEntry> search(const SearchScales&);  what is tried of it
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>
#include <vector>

#include "sim/quantity.h"

namespace axisfit {

/// Where an effect acts. The search lists candidates in this order.
enum class ActsOn { friction, arm_force, inertia, transmission, motor_torque, drive };

inline constexpr ActsOn kPlacesToAct[]{ActsOn::friction,     ActsOn::arm_force,    ActsOn::inertia,
                                       ActsOn::transmission, ActsOn::motor_torque, ActsOn::drive};

constexpr std::string_view name_of(ActsOn place) {
  switch (place) {
    case ActsOn::friction:
      return "friction";
    case ActsOn::arm_force:
      return "arm force";
    case ActsOn::inertia:
      return "inertia";
    case ActsOn::transmission:
      return "transmission";
    case ActsOn::motor_torque:
      return "motor torque";
    case ActsOn::drive:
      return "drive";
  }
  return {};
}

/// What a motion must do for a parameter to be seen, in words that follow "needs".
namespace motions {
inline constexpr std::string_view kBothWays = "motion in both directions at several speeds";
inline constexpr std::string_view kWholeStroke =
    "motion in both directions over the whole stroke, at several speeds";
inline constexpr std::string_view kAcceleration = "strong acceleration and braking";
inline constexpr std::string_view kManyTurns = "slow motion over many turns of the motor";
inline constexpr std::string_view kSwitches = "abrupt changes of the command";
}  // namespace motions

/// What the recordings span: the scales on which the shapes of effects are sought.
struct SearchScales {
  double position_low = 0.0, position_high = 0.0;  ///< m, of the arm
  double speed = 0.0;                              ///< m/s, largest magnitude
  double velocity_low = 0.0, velocity_high = 0.0;  ///< m/s
  double start = 0.0, end = 0.0;                   ///< s
  double interval = 0.0;                           ///< s, between samples, mean
  double mass = 0.0;                               ///< kg, that moves, motor included
  std::vector<double> periods = {};                ///< m, of forces along the stroke, best first
  std::vector<double> drive_periods = {};  ///< m, of such in proportion to the drive's force
  std::vector<std::array<double, 2>> pulses = {};  ///< s, start and end of a force over time
  std::vector<double> resonances = {};             ///< Hz, at which the residual rings
  double pinion_radius = 0.0;                      ///< m, r_g
  double short_travel = 1e-3;  ///< m, over which surfaces bend, as an order of magnitude
};

/// The values of an entry's shapes that are tried, one list of them per trial.
using ShapeSettings = std::vector<std::vector<double>>;

/// A candidate that an effect offers: some of its strengths, which are estimated together. An
/// effect whose strengths mean different things offers several.
struct SearchEntry {
  std::vector<std::string_view> strengths;  ///< symbols of quantities
  std::vector<std::string_view> shapes = {};
  ShapeSettings settings = ShapeSettings(1);  ///< at first one, of no shapes; none: not offered
  /// Further shapes, last in each setting, that are not estimated: the recordings choose between
  /// the settings alone.
  std::vector<std::string_view> held = {};
  /// Of each shape, beyond which the recordings cannot tell the effect from others; empty: none.
  std::vector<double> largest = {};
  /// Strengths at which the score test looks instead of at zero; see Candidate.
  std::vector<double> probes = {};
  UsedBy used_by = UsedBy::every_axis;  ///< the axes for which it is offered
  std::string_view extends = {};  ///< the effect beside which alone it is offered; none: always
  /// Whether it is a change of the dry friction that the axis has, and offered beside such alone.
  bool changes_dry_friction = false;
  bool is_curve = false;  ///< a curve, whose ends are not estimated
  /// Whether the two strengths are sine and cosine of a phase, which homing may shift.
  bool has_phase = false;
};

/// One setting of one shape for each value.
inline ShapeSettings one_by_one(const std::vector<double>& values) {
  ShapeSettings settings;
  for (const double value : values) settings.push_back({value});
  return settings;
}

/// n values from a to b, each the same multiple of the one before.
inline ShapeSettings geometric(double a, double b, int n) {
  ShapeSettings settings;
  for (int i = 0; i < n; ++i) settings.push_back({a * std::pow(b / a, double(i) / double(n - 1))});
  return settings;
}

/// Periods per turn of the motor: the likely ones, and those of these periods along the stroke (m).
inline ShapeSettings orders_per_turn(const std::vector<double>& periods, double pinion_radius) {
  ShapeSettings settings{{1.0}, {2.0}, {3.0}, {4.0}, {6.0}};
  for (const double period : periods)
    settings.push_back({2.0 * std::numbers::pi * pinion_radius / period});
  return settings;
}

/// Probes of a lag or a dead time, s: the derivative at zero holds while it is shorter than
/// anything else.
inline std::vector<double> later(const SearchScales& scales) {
  return {2.0 * scales.interval, 8.0 * scales.interval};
}

}  // namespace axisfit
