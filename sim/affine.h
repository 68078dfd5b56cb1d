// The equations of one mode, which are affine without smooth forces,
//
//   y' = A y + B w
//
// in the state y and the inputs w. A and B are evaluated from the only implementation, equations.h,
// as are the guards in guards.h.
#pragma once

#include <array>

#include "sim/equations.h"
#include "sim/propagator.h"

namespace axisfit {

/// The inputs: what is constant in a mode, U, and the observer's target.
enum InputIndex : std::size_t {
  kConstantInput,
  kCommandInput,
  kTargetVelocityInput,
  kTargetPositionInput,
  kInputs,
};
/// Per input, what it contributes per unit.
template <class X>
using PerInput = std::array<X, kInputs>;

/// So much of one state or input that constants beside it take no digits; a power of two.
inline constexpr double kLarge = 0x1p40;

/// Of one input alone; of the constants nothing.
template <class T>
Input<T> large_input(std::size_t which) {
  const auto amount = [&](std::size_t input) { return T(input == which ? kLarge : 0.0); };
  return {amount(kCommandInput),
          {amount(kTargetVelocityInput), amount(kTargetPositionInput)},
          T(0.0),
          {}};
}

/// A
template <class T>
Matrix<T> system_matrix(const Equations<T>& equations, const Mode& mode) {
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
PerInput<State<T>> input_matrix(const Equations<T>& equations, const Mode& mode) {
  PerInput<State<T>> b;
  for (std::size_t c = 0; c < kInputs; ++c)
    b[c] = equations.rate(mode, State<T>{}, large_input<T>(c), Terms::affine);
  for (std::size_t c = kConstantInput + 1; c < kInputs; ++c)
    for (std::size_t i = 0; i < kStates; ++i) b[c][i] = (b[c][i] - b[kConstantInput][i]) / kLarge;
  return b;
}

}  // namespace axisfit
