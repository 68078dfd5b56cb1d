// The axis: its parameters under the paper's symbols, its variants, and its state.
//
// W. L. Nelson and J. D. Chang, "Simulation of a Cartesian robot arm", IEEE 1984, with the numbers
// of its equations. SI units throughout. Positive motor rotation drives the arm in its positive
// direction. "Arm side" means metres and newtons at the rack, "motor side" radians and newton
// metres at the pinion.
#pragma once

#include <array>
#include <cstddef>

#include "sim/quantity.h"

namespace axisfit {

enum class Drive {
  velocity_loop,   ///< the paper's controller: preamplifier, current loop, two limits
  current_source,  ///< ideal power stage y6 = K_i V_c (the paper's linear case when V_L is large)
  force_source,    ///< force K_f U on the arm side, as from a recorded drive signal
  motor_current,   ///< the same, U being a current: K_f is what the motor makes of an ampere
  rated_force,     ///< the same, U being a share of the rated force K_f
  motor_voltage,   ///< torque K_m (U - K_m y3) / R: a motor without inductance, U at its terminals
};
inline constexpr std::size_t kDrives = 6;

enum class Transmission {
  backlash,  ///< rack and pinion with backlash, stiffness and damping, (4) and (5)
  rigid,     ///< arm and motor are one mass: J = J_m + r_g^2 M
};

/// Number of state variables of the paper, and with those of effects.
inline constexpr std::size_t kPaperStates = 7;
inline constexpr std::size_t kStates = 10;

/// y0 arm position m | y1 arm velocity m/s | y2 motor angle rad | y3 motor velocity rad/s |
/// y4, y5 preamplifier V, V/s | y6 motor current A |
/// y7 what a lagging drive follows, V | y8, y9 displacement of an elastic mode m, m/s.
/// States that a variant lacks stay at their initial value.
template <class T>
using State = std::array<T, kStates>;

template <class T>
struct Axis {
  T R, L, K_e, K_m, J_m, B_m, K_t, r_g, H, M, T_z, T_p, T_r, K_1, K_2, K_i, V_s, V_L, B_a, b_g, k_g,
      F_s, w, K_v, K_f, T_d;
};

/// Calls visit(quantity, member) for every parameter, in the order of the paper's table.
template <class AxisOfT, class Visitor>
void visit_axis(AxisOfT& a, Visitor&& visit) {
  using enum UsedBy;
  using Q = Quantity;
  visit(Q{"R", "ohm", "armature resistance", 1e-3, 1e3, kRequired, armature}, a.R);
  visit(Q{"L", "H", "armature inductance", 1e-6, 1, kRequired, velocity_loop}, a.L);
  visit(Q{"K_e", "V s/rad", "motor EMF constant", 0, 100, kRequired, velocity_loop}, a.K_e);
  visit(Q{"K_m", "N m/A", "motor torque constant", 1e-4, 100, kRequired, motor_constant}, a.K_m);
  visit(Q{"J_m", "kg m^2", "armature inertia", 0, 100, 0.0, motor}, a.J_m);
  visit(Q{"B_m", "N m s/rad", "armature damping", 0, 100, 0.0, motor}, a.B_m);
  visit(Q{"K_t", "V s/rad", "tachometer gain", 0, 100, kRequired, electric_drive}, a.K_t);
  visit(Q{"r_g", "m", "pinion radius", 1e-5, 10, kRequired, motor}, a.r_g);
  visit(Q{"H", "m", "half the gear backlash", 0, 0.1, kRequired, backlash}, a.H);
  visit(Q{"M", "kg", "arm mass", 1e-3, 1e5}, a.M);
  visit(Q{"T_z", "s", "compensation zero", 0, 10, kRequired, electric_drive}, a.T_z);
  visit(Q{"T_p", "s", "compensation pole", 1e-5, 100, kRequired, electric_drive}, a.T_p);
  visit(Q{"T_r", "s", "preamplifier roll-off", 1e-6, 1, kRequired, electric_drive}, a.T_r);
  visit(Q{"K_1", "1", "set-velocity gain", 0, 1e6, kRequired, electric_drive}, a.K_1);
  visit(Q{"K_2", "1", "tachometer feedback gain", 0, 1e6, kRequired, electric_drive}, a.K_2);
  visit(Q{"K_i", "A/V", "transconductance", 1e-3, 1e4, kRequired, electric_drive}, a.K_i);
  visit(Q{"V_s", "V", "motor voltage limit", 1e-2, 1e5, kRequired, velocity_loop}, a.V_s);
  visit(Q{"V_L", "V", "preamplifier limit", 1e-3, 1e6, kRequired, electric_drive}, a.V_L);
  visit(Q{"B_a", "N s/m", "arm viscous friction", 0, 1e6}, a.B_a);
  visit(Q{"b_g", "N s/m", "gear friction", 0, 1e8, kRequired, backlash}, a.b_g);
  visit(Q{"k_g", "N/m", "gear stiffness", 1, 1e12, kRequired, backlash}, a.k_g);
  visit(Q{"F_s", "N", "static friction of the arm", 0, 1e5, 0.0}, a.F_s);
  visit(Q{"w", "m/s", "speed above which the static friction vanishes", 1e-6, 1, 0.002}, a.w);
  visit(Q{"K_v", "V/V", "power-unit forward gain", 10, 1e6, kRequired, velocity_loop}, a.K_v);
  visit(Q{"K_f", "N/U", "force per drive signal", 1e-6, 1e9, kRequired, force_source}, a.K_f);
  visit(Q{"T_d", "s", "dead time of the command", -1, 1, 0.0}, a.T_d);
}

}  // namespace axisfit
