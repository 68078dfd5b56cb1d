// The equations and guards of one mode as what they are without smooth forces: affine,
//
//   y' = A y + B w,  guards = G y + H w
//
// in the state y and the inputs w. A, B, G and H are read off the one description that there is,
// equations.h.
#pragma once

#include <array>

#include "sim/equations.h"
#include "sim/propagator.h"

namespace axisfit {

/// The inputs: what is constant in a mode, U, and the coupling's target.
enum DrivenBy : std::size_t {
  kByConstants,
  kByCommand,
  kByTargetVelocity,
  kByTargetPosition,
  kInputs,
};
/// Per input, what it contributes per unit.
template <class X>
using Driven = std::array<X, kInputs>;

/// So much of one state or input that constants beside it take no digits; a power of two.
inline constexpr double kLarge = 0x1p40;

/// Of one input alone; of the constants nothing.
template <class T>
Input<T> large_input(std::size_t which) {
  const auto amount = [&](std::size_t input) { return T(input == which ? kLarge : 0.0); };
  return {amount(kByCommand), {amount(kByTargetVelocity), amount(kByTargetPosition)}, T(0.0), {}};
}

/// A
template <class T>
Matrix<T> matrix_of(const Equations<T>& equations, const Mode& mode) {
  const State<T> offset = equations.rate(mode, State<T>{}, {}, Terms::affine);
  Matrix<T> a;
  for (std::size_t j = 0; j < kStates; ++j) {
    State<T> large{};
    large[j] = T(kLarge);
    const State<T> column = equations.rate(mode, large, {}, Terms::affine);
    for (std::size_t i = 0; i < kStates; ++i) a[i][j] = (column[i] - offset[i]) / kLarge;
  }
  return a;
}

/// B, by columns
template <class T>
Driven<State<T>> driven_by(const Equations<T>& equations, const Mode& mode) {
  Driven<State<T>> b;
  for (std::size_t c = 0; c < kInputs; ++c)
    b[c] = equations.rate(mode, State<T>{}, large_input<T>(c), Terms::affine);
  for (std::size_t c = kByConstants + 1; c < kInputs; ++c)
    for (std::size_t i = 0; i < kStates; ++i) b[c][i] = (b[c][i] - b[kByConstants][i]) / kLarge;
  return b;
}

/// Values, rates and tolerances of all guards of a mode at one instant.
struct Look {
  struct Node {
    double value, rate, tolerance;
  };
  std::array<Node, kGuards> nodes;
  std::size_t count = 0;
};

/// All guards of a mode without smooth forces, and their rates.
class LinearGuards {
 public:
  /// `a`, `b`: A and B of the mode.
  LinearGuards(const Equations<double>& equations, const Mode& mode, const Matrix<double>& a,
               const Driven<State<double>>& b)
      : states_used_(equations.states()), coupled_(equations.coupling().active()) {
    const auto read = [&](const State<double>& y, const Input<double>& input, Form& form) {
      count_ = 0;
      equations.visit_guards(mode, y, input, [&](Guard, double g, double) { form[count_++] = g; });
    };
    for (std::size_t c = 0; c < kInputs; ++c)
      read(State<double>{}, large_input<double>(c), inputs_[c]);
    for (std::size_t j = 0; j < kStates; ++j) {
      State<double> large{};
      large[j] = kLarge;
      read(large, {}, states_[j]);
    }
    for (std::size_t i = 0; i < count_; ++i) {
      const double constant = inputs_[kByConstants][i];
      for (std::size_t c = kByConstants + 1; c < kInputs; ++c)
        inputs_[c][i] = (inputs_[c][i] - constant) / kLarge;
      for (Form& form : states_) form[i] = (form[i] - constant) / kLarge;
      // Rates behind the values: G A and G B.
      for (std::size_t k = 0; k < kStates; ++k) {
        for (std::size_t j = 0; j < kStates; ++j)
          states_[j][kGuards + i] += states_[k][i] * a[k][j];
        for (std::size_t c = 0; c < kInputs; ++c)
          inputs_[c][kGuards + i] += states_[k][i] * b[c][k];
      }
    }
  }

  /// Without tolerances. `slope`: of the target, per second.
  Look look(const State<double>& y, const Input<double>& input, const Target& slope) const {
    Form sum = inputs_[kByConstants];
    add(sum, input.command, inputs_[kByCommand]);
    for (std::size_t j = 0; j < states_used_; ++j) add(sum, y[j], states_[j]);
    if (coupled_) {
      const Form &velocity = inputs_[kByTargetVelocity], &position = inputs_[kByTargetPosition];
      add(sum, input.target.velocity, velocity);
      add(sum, input.target.position, position);
      for (std::size_t i = 0; i < kGuards; ++i)
        sum[kGuards + i] += slope.velocity * velocity[i] + slope.position * position[i];
    }
    Look seen;
    seen.count = count_;
    for (std::size_t i = 0; i < count_; ++i) seen.nodes[i] = {sum[i], sum[kGuards + i], 0.0};
    return seen;
  }

 private:
  using Form = std::array<double, 2 * kGuards>;  // values, then rates
  static void add(Form& sum, double factor, const Form& form) {
    for (std::size_t i = 0; i < 2 * kGuards; ++i) sum[i] += factor * form[i];
  }

  std::size_t states_used_;
  bool coupled_;
  std::size_t count_ = 0;
  std::array<Form, kStates> states_{};
  Driven<Form> inputs_{};
};

}  // namespace axisfit
