// Ceres's dual numbers as scalars of the simulation.
#pragma once

#include <ceres/jet.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "fit/solve/parameters.h"
#include "sim/scalar.h"

namespace axisfit {

template <int N>
struct ScalarTraits<ceres::Jet<double, N>> {
  static double value(const ceres::Jet<double, N>& x) { return x.a; }
  static bool has_derivative(const ceres::Jet<double, N>& x) { return !x.v.isZero(0.0); }
};

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

/// Calls evaluate.operator()<Jet>(columns, is_first) for all columns: up to eight in one pass, with
/// the narrowest dual number that holds them, more in several passes, side by side. (Two passes of
/// eight take no longer than one of sixteen, one after the other.) Returns whether all passes
/// returned true. Without columns there is one pass.
template <class Evaluate>
bool evaluate_columns(std::span<const std::size_t> all, Evaluate&& evaluate) {
  constexpr std::size_t kMost = 8;
  const std::size_t passes = std::max<std::size_t>(1, (all.size() + kMost - 1) / kMost);
  std::vector<char> finished(passes, 0);
  parallel_for(passes, [&](std::size_t pass) {
    const std::size_t first = pass * all.size() / passes, end = (pass + 1) * all.size() / passes;
    const auto columns = all.subspan(first, end - first);
    const std::size_t n = columns.size();
    const bool is_first = pass == 0;
    finished[pass] =
        n <= 2   ? evaluate.template operator()<ceres::Jet<double, 2>>(columns, is_first)
        : n <= 4 ? evaluate.template operator()<ceres::Jet<double, 4>>(columns, is_first)
        : n <= 6 ? evaluate.template operator()<ceres::Jet<double, 6>>(columns, is_first)
                 : evaluate.template operator()<ceres::Jet<double, kMost>>(columns, is_first);
  });
  return std::ranges::find(finished, 0) == finished.end();
}

}  // namespace axisfit
