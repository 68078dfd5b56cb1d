// What the simulation needs of a scalar type.
//
// The model is written once as templates of a scalar T. With T = double it gives values; with a
// dual number (a value that carries derivatives) it gives values and exact derivatives. Decisions,
// such as which side of a limit a state is on, are taken on plain values.
#pragma once

namespace axisfit {

/// Access to the parts of a scalar. Specialise it for a dual number type; a mere overload of a
/// function would not be found by argument-dependent lookup from the templates below.
template <class T>
struct ScalarTraits;

template <>
struct ScalarTraits<double> {
  static double value(double x) { return x; }
  static bool has_derivative(double) { return false; }
};

/// The value of x without its derivatives.
template <class T>
double value_of(const T& x) {
  return ScalarTraits<T>::value(x);
}

/// The derivatives of x with the value zero.
template <class T>
T derivative_part(const T& x) {
  return x - ScalarTraits<T>::value(x);
}

/// Whether x can differ from zero: by its value, or because it is being differentiated.
template <class T>
bool is_active(const T& x) {
  return value_of(x) != 0.0 || ScalarTraits<T>::has_derivative(x);
}

}  // namespace axisfit
