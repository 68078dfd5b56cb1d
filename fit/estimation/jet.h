// Ceres's dual numbers as scalars of the simulation.
#pragma once

#include <ceres/jet.h>

#include "sim/scalar.h"

namespace axisfit {

template <int N>
struct ScalarTraits<ceres::Jet<double, N>> {
  static double value(const ceres::Jet<double, N>& x) { return x.a; }
  static bool has_derivative(const ceres::Jet<double, N>& x) { return !x.v.isZero(0.0); }
};

}  // namespace axisfit
