// What the tests of the simulator share: the paper's x axis, commands, and recorded runs.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "sim/model.h"
#include "sim/simulate.h"

namespace axisfit {

/// The x axis of the paper with T_p = 0.04 s, by the values of its table. What the paper does not
/// state (F_s, w, K_v) is assumed.
inline Model<double> paper_axis() {
  Model<double> model;
  Axis<double>& a = model.axis;
  a.R = 0.56;
  a.L = 0.00235;
  a.K_e = 0.289;
  a.K_m = 0.289;
  a.J_m = 0.000847;
  a.B_m = 0.000733;
  a.K_t = 0.0668;
  a.r_g = 0.00573;
  a.H = 0.00001;
  a.M = 146.0;
  a.T_z = 0.00705;
  a.T_p = 0.04;
  a.T_r = 0.000159;
  a.K_1 = 1014.2;
  a.K_2 = 870.0;
  a.K_i = 3.0;
  a.V_s = 95.0;
  a.V_L = 2.7;
  a.B_a = 200.0;
  a.b_g = 1500.0;
  a.k_g = 5e6;
  a.F_s = 0.0;
  a.w = 0.002;
  a.K_v = 1000.0;
  a.K_f = 1.0;
  a.T_d = 0.0;
  return model;
}

/// Puts an effect into play and returns it: add_effect<QuadraticDrag>(model).c = 10.
template <template <class> class Effect, class T>
Effect<T>& add_effect(Model<T>& model) {
  std::size_t place = 0;
  visit_effects(model.effects, [&](std::size_t index, const auto& effect) {
    if (effect.name == Effect<T>::name) place = index;
  });
  model.structure.effects.set(place);
  return std::get<Effect<T>>(model.effects);
}

/// A free mass that a force K_f U = U drives: everything about it has a closed form.
inline Model<double> driven_mass(double mass) {
  Model<double> model = paper_axis();
  model.structure.drive = Drive::force_source;
  model.structure.transmission = Transmission::rigid;
  model.axis.M = mass;
  model.axis.J_m = model.axis.B_m = model.axis.B_a = 0.0;
  return model;
}

/// Motor and arm of the paper with nothing between them but the teeth: no drive, no losses.
inline Model<double> free_gear() {
  Model<double> model = paper_axis();
  model.structure.drive = Drive::force_source;
  model.axis.B_m = model.axis.B_a = model.axis.b_g = 0.0;
  return model;
}

/// Mass of the motor as felt at the rack, kg.
inline double motor_mass(const Axis<double>& a) { return a.J_m / (a.r_g * a.r_g); }

/// n + 1 instants 0, dt, 2 dt, ... n dt.
inline std::vector<double> instants(std::size_t n, double dt) {
  std::vector<double> times(n + 1);
  for (std::size_t i = 0; i <= n; ++i) times[i] = static_cast<double>(i) * dt;
  return times;
}

/// All drives that an axis can have.
inline std::vector<Drive> every_drive() {
  std::vector<Drive> drives;
  for (std::size_t drive = 0; drive < kDrives; ++drive) drives.push_back(static_cast<Drive>(drive));
  return drives;
}

/// A command in which every kind of motion occurs.
inline Schedule step_command() { return {{0.0}, {10.0}}; }
inline Schedule level_command() {
  return {{0.0, 0.2, 0.45, 0.7, 0.9}, {10.0, 4.0, -3.0, 0.0, 6.0}};
}
/// As the slave control unit writes it: a new value every 5 ms, here up, down, and to rest.
inline Schedule staircase_command() {
  Schedule schedule;
  for (int k = 0; k < 200; ++k) {
    const double t = 0.005 * k;
    schedule.append(t, t < 0.3 ? 20.0 * t : t < 0.9 ? 6.0 - 15.0 * (t - 0.3) : 0.0);
  }
  return schedule;
}

/// States at all instants of a run.
template <class T>
struct Run {
  bool finished = false;
  std::vector<State<T>> states;
  std::vector<Mode> modes;
  std::vector<int> events;      ///< number of events before each instant
  std::vector<double> current;  ///< A; values only
  std::vector<double> acceleration;
  std::vector<double> encoder;  ///< m
};

template <class T>
Run<T> run(const Model<T>& model, const Schedule& command, std::span<const double> times,
           const IntegratorOptions& options = {}, const Observer& observer = {},
           const MeasuredSeries& measured = {}) {
  Run<T> result;
  const SimulationResult simulation_result = simulate(
      model, command, times,
      [&](std::size_t, const Integrator<T>& axis) {
        result.states.push_back(axis.state());
        result.modes.push_back(axis.mode());
        result.events.push_back(axis.events());
        result.current.push_back(
            value_of(axis.equations().current(axis.mode(), axis.state(), axis.input())));
        result.encoder.push_back(
            value_of(axis.equations().encoder_position(axis.mode(), axis.state(), axis.input())));
        result.acceleration.push_back(
            value_of(axis.equations().acceleration(axis.mode(), axis.state(), axis.input())));
      },
      observer, measured, options);
  result.finished = simulation_result.finished;
  return result;
}

/// Largest magnitude of every state over a run: what errors are measured by.
inline State<double> ranges(const std::vector<State<double>>& states) {
  State<double> largest{};
  for (const State<double>& y : states)
    for (std::size_t i = 0; i < kStates; ++i) largest[i] = std::max(largest[i], std::abs(y[i]));
  return largest;
}

/// Largest difference of two runs over all states and instants, each state by its range in `b`.
inline double largest_difference(const std::vector<State<double>>& a,
                                 const std::vector<State<double>>& b) {
  if (a.size() != b.size()) return INFINITY;
  const State<double> range = ranges(b);
  double worst = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k)
    for (std::size_t i = 0; i < kStates; ++i) {
      const double d = std::abs(a[k][i] - b[k][i]);
      if (d != 0.0) worst = std::max(worst, d / range[i]);
    }
  return worst;
}

}  // namespace axisfit
