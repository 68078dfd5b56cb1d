// The work that all methods of the comparison do: the paper's step of the x axis, 2.5 s sampled at
// 1 kHz, all seven states and their sensitivities dy/d(ln p) at every sample.
#pragma once

#include <array>
#include <vector>

#include "fit/solve/jet.h"
#include "sim/affine.h"
#include "sim/rig.h"

namespace axisfit::speed {

template <int N>
using Jet = ceres::Jet<double, N>;

/// The parameters, the first N of which are differentiated: the paper's five unknown ones, then
/// others by how well a step shows them.
inline constexpr std::array<const char*, 20> kParameters{
    "V_L", "B_a", "b_g", "k_g", "T_p", "M",   "K_1", "K_2", "K_t", "T_z",
    "R",   "L",   "K_e", "K_m", "J_m", "B_m", "r_g", "H",   "T_r", "K_i"};

struct Work {
  Rig rig;
  double command = 10.0;      ///< V, from the first instant on
  std::vector<double> times;  ///< s

  /// The model with the derivatives of its first N parameters with respect to their logarithms.
  template <int N>
  Model<Jet<N>> model() const {
    auto model = convert<Jet<N>>(rig.model);
    const auto member = members(model);
    for (int k = 0; k < N; ++k) {
      Jet<N>& p = *member[quantity_index(kParameters[static_cast<std::size_t>(k)])];
      p.v[k] = p.a;
    }
    return model;
  }
};

/// States and sensitivities at the samples.
struct Trajectory {
  std::size_t parameters = 0;
  std::vector<double> states;         ///< samples x 7
  std::vector<double> sensitivities;  ///< samples x 7 x parameters

  template <int N>
  void add(const State<Jet<N>>& y) {
    for (std::size_t i = 0; i < kPaperStates; ++i) {
      states.push_back(y[i].a);
      for (int k = 0; k < N; ++k) sensitivities.push_back(y[i].v[k]);
    }
  }
};

/// Root mean squares of the states and, state by state, of their sensitivities; 1 for zero.
struct Scales {
  std::vector<double> states, sensitivities;
};
Scales scales_of(const Trajectory& trajectory);

/// How far a trajectory is from the reference: the largest over the states, and over states and
/// parameters, of the root mean square error over the reference's root mean square.
struct Error {
  double states = 0.0, sensitivities = 0.0;
};
Error error_of(const Trajectory& trajectory, const Trajectory& reference);

/// Equations, mode and events for solvers that know nothing of them.
template <int N>
class Axis {
 public:
  explicit Axis(const Work& work)
      : plain_model_(work.rig.model),
        model_(work.model<N>()),
        plain_(plain_model_, {}),
        exact_(model_, {}, plain_.parts()) {
    for (std::size_t k = 0; k < parameters_.size(); ++k) {
      parameters_[k] = members(plain_model_)[quantity_index(kParameters[k])];
      values_[k] = *parameters_[k];
    }
    input_.command = work.command;
    exact_input_.command = Jet<N>(work.command);
    start_ = initial_state(model_);
    exact_.begin(start_, exact_input_);
    mode_ = exact_.mode_at(start_, exact_input_);
  }
  Axis(const Axis&) = delete;
  Axis& operator=(const Axis&) = delete;

  const State<Jet<N>>& start() const { return start_; }
  const std::array<double, N>& parameters() const { return values_; }
  std::array<double, N>& parameters() { return values_; }

  /// The right-hand side, with the values of parameters().
  State<double> rate(const State<double>& y) {
    for (std::size_t k = 0; k < N; ++k) *parameters_[k] = values_[k];
    return plain_.rate(mode_, y, input_);
  }
  State<Jet<N>> rate(const State<Jet<N>>& y) const { return exact_.rate(mode_, y, exact_input_); }

  /// d rate / d y
  Matrix<double> matrix() const { return system_matrix(plain_, mode_); }

  /// Calls visit(i, value) for the guards of the mode; returns their number. Values are moved by
  /// rounding, so that those behind an event begin inside.
  template <class Visitor>
  int visit_guards(const State<double>& y, Visitor&& visit) const {
    int i = 0;
    plain_.visit_guards(mode_, y, input_,
                        [&](Guard, double g, double scale) { visit(i++, g + 1e-12 * scale); });
    return i;
  }

  /// Passes the event of guard i at y: the state as it goes on, with the event time's derivatives.
  State<Jet<N>> pass(int i, State<Jet<N>> y) {
    const State<Jet<N>> before = rate(y);
    State<Jet<N>> ahead = y;
    for (std::size_t s = 0; s < kStates; ++s) ahead[s] += before[s];
    Guard guard{};
    Jet<N> g, g_ahead;
    int at = 0;
    exact_.visit_guards(mode_, y, exact_input_, [&](Guard met, const Jet<N>& value, double) {
      if (at++ == i) guard = met, g = value;
    });
    at = 0;
    exact_.visit_guards(mode_, ahead, exact_input_, [&](Guard, const Jet<N>& value, double) {
      if (at++ == i) g_ahead = value;
    });
    const Jet<N> delay = -derivative_part(g) / (g_ahead.a - g.a);
    for (std::size_t s = 0; s < kStates; ++s) y[s] += before[s] * delay;
    mode_ = exact_.cross(mode_, guard, y, exact_input_);
    const State<Jet<N>> after = rate(y);
    for (std::size_t s = 0; s < kStates; ++s) y[s] -= after[s] * delay;
    return y;
  }

 private:
  Model<double> plain_model_;
  Model<Jet<N>> model_;
  Equations<double> plain_;
  Equations<Jet<N>> exact_;
  std::array<double*, N> parameters_{};
  std::array<double, N> values_{};
  Input<double> input_;
  Input<Jet<N>> exact_input_;
  State<Jet<N>> start_{};
  Mode mode_;
};

}  // namespace axisfit::speed
