// An independent simulator of the paper's axis, to judge the one under test by.
//
// It shares no code with sim/: equations (1) to (6) as printed, F_s = 0, and the classical
// Runge-Kutta method with a fixed tiny step. No event is located: a step whose ends lie on
// different branches of (2), (3) or (5) is merely taken again in many smaller ones. Where the gear
// force jumps, by b_g times the closing speed, the error is of the order of such a small step times
// the jump, and a comparison has to show that it falls with their number.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "sim/axis.h"
#include "sim/command.h"

namespace axisfit::reference {

using Vector = std::array<double, 7>;

struct Voltages {
  double V_c, V_m;
};

inline Voltages voltages(const Axis<double>& p, const Vector& y) {
  const double V_c = std::clamp(y[4] + p.T_z * y[5], -p.V_L, p.V_L);           // (2)
  const double V_m = std::clamp(p.K_v * (V_c - y[6] / p.K_i), -p.V_s, p.V_s);  // (3)
  return {V_c, V_m};
}

inline Vector rate(const Axis<double>& p, const Vector& y, double U) {
  const double x = p.r_g * y[2] - y[0];  // (4)
  double f_g = 0.0;                      // (5)
  if (x > p.H)
    f_g = (x - p.H) * p.k_g + (p.r_g * y[3] - y[1]) * p.b_g;
  else if (x < -p.H)
    f_g = (x + p.H) * p.k_g + (p.r_g * y[3] - y[1]) * p.b_g;
  return {y[1],  // (1)
          (f_g - p.B_a * y[1]) / p.M,
          y[3],
          (p.K_m * y[6] - p.B_m * y[3] - p.r_g * f_g) / p.J_m,
          y[5],
          (p.K_1 * U - p.K_2 * p.K_t * y[3] - y[4] - (p.T_p + p.T_r) * y[5]) / (p.T_p * p.T_r),
          (voltages(p, y).V_m - p.R * y[6] - p.K_e * y[3]) / p.L};
}

/// Which branches of (2), (3) and (5) a state is on.
inline std::array<int, 3> branches(const Axis<double>& p, const Vector& y) {
  const double x = p.r_g * y[2] - y[0];
  const auto [V_c, V_m] = voltages(p, y);
  const auto side = [](double v, double limit) { return (v >= limit) - (v <= -limit); };
  return {(x > p.H) - (x < -p.H), side(V_c, p.V_L), side(V_m, p.V_s)};
}

inline Vector along(const Vector& y, double h, const Vector& k) {
  Vector z;
  for (std::size_t i = 0; i < 7; ++i) z[i] = y[i] + h * k[i];
  return z;
}

inline Vector runge_kutta(const Axis<double>& p, Vector y, double U, double h) {
  const Vector k1 = rate(p, y, U);
  const Vector k2 = rate(p, along(y, 0.5 * h, k1), U);
  const Vector k3 = rate(p, along(y, 0.5 * h, k2), U);
  const Vector k4 = rate(p, along(y, h, k3), U);
  for (std::size_t i = 0; i < 7; ++i) y[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
  return y;
}

/// States at times[i], from rest at times[0]. Instants and switches of the command must be
/// multiples of the step.
inline std::vector<State<double>> simulate(const Axis<double>& p, const Schedule& command,
                                           std::span<const double> times, double step, int parts) {
  const auto ticks = [&](double t) { return std::llround((t - times[0]) / step); };
  std::vector<State<double>> states;
  Vector y{};
  double U = 0.0;
  std::size_t next = 0;
  long long tick = 0;
  auto branch = branches(p, y);
  for (const double t : times) {
    for (const long long end = ticks(t); tick < end; ++tick) {
      while (next < command.times.size() && ticks(command.times[next]) <= tick)
        U = command.values[next++];
      Vector z = runge_kutta(p, y, U, step);
      auto reached = branches(p, z);
      if (reached != branch) {
        z = y;
        for (int i = 0; i < parts; ++i) z = runge_kutta(p, z, U, step / parts);
        reached = branches(p, z);
      }
      branch = reached;
      y = z;
    }
    State<double> state{};  // those beyond the paper's stay at zero
    std::ranges::copy(y, state.begin());
    states.push_back(state);
  }
  return states;
}

}  // namespace axisfit::reference
