// Ceres's dual numbers as scalars of the simulation.
#pragma once

#include <ceres/jet.h>

#include <algorithm>
#include <cstddef>
#include <span>

#include "fit/estimation/parameters.h"
#include "sim/scalar.h"

namespace axisfit {

template <int N>
struct ScalarTraits<ceres::Jet<double, N>> {
  static double value(const ceres::Jet<double, N>& x) { return x.a; }
  static bool has_derivative(const ceres::Jet<double, N>& x) { return !x.v.isZero(0.0); }
};

/// The most dual parts that a number has here.
inline constexpr int kWidestJet = 24;

/// The model with the derivatives with respect to the u of the parameters `columns`, in this order.
template <class Jet>
Model<Jet> with_derivatives(const Model<double>& model, const ParameterSpace& space,
                            const double* u, std::span<const std::size_t> columns) {
  Model<Jet> differentiated = convert<Jet>(model);
  const std::vector<Jet*> member = members(differentiated);
  for (std::size_t k = 0; k < columns.size(); ++k)
    member[space[columns[k]].quantity]->v[static_cast<Eigen::Index>(k)] =
        space.slope(columns[k], u[columns[k]]);
  return differentiated;
}

/// Calls evaluate.operator()<Jet>(columns) for all columns: in one pass, with the narrowest dual
/// number that holds them, and in several where the widest does not. Whether all passes returned
/// true; none follows one that did not. With no columns at all there is one pass.
template <class Evaluate>
bool evaluate_columns(std::span<const std::size_t> all, Evaluate&& evaluate) {
  do {
    const auto columns = all.first(std::min<std::size_t>(all.size(), kWidestJet));
    all = all.subspan(columns.size());
    const std::size_t n = columns.size();
    const bool finished =
        n <= 2    ? evaluate.template operator()<ceres::Jet<double, 2>>(columns)
        : n <= 4  ? evaluate.template operator()<ceres::Jet<double, 4>>(columns)
        : n <= 6  ? evaluate.template operator()<ceres::Jet<double, 6>>(columns)
        : n <= 8  ? evaluate.template operator()<ceres::Jet<double, 8>>(columns)
        : n <= 12 ? evaluate.template operator()<ceres::Jet<double, 12>>(columns)
                  : evaluate.template operator()<ceres::Jet<double, kWidestJet>>(columns);
    if (!finished) return false;
  } while (!all.empty());
  return true;
}

}  // namespace axisfit
