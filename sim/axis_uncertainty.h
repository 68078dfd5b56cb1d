// What is not known of an axis whose parameters were estimated.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace axisfit {

/// A quantity that was estimated. Its errors are those of its logarithm where it is logarithmic, or
/// else in its unit.
struct UncertainQuantity {
  std::size_t quantity = 0;  ///< its place in quantity_list()
  bool logarithmic = false;
  double error = 0.0;    ///< standard error of the estimate by the recordings as they are
  double scatter = 0.0;  ///< standard deviation of a further recording's about the estimate, beyond
  double freedom = 1.0;  ///< degrees of freedom of the scatter
};

/// A force on the arm (torque on the joint) that no effect explains, as a stationary process: every
/// `interval`, straight between, the sum of its last values times the coefficients, and a normal
/// innovation.
struct MissingForceProcess {
  double interval = 0.0;             ///< s
  double deviation = 0.0;            ///< standard deviation of the force, N
  double innovation = 0.0;           ///< standard deviation, N
  std::vector<double> coefficients;  ///< of the last value, the one before, ...
};

struct AxisUncertainty {
  std::vector<UncertainQuantity> quantities;
  /// Of the estimates' errors, by rows: as many as there are quantities, squared.
  std::vector<double> correlation;
  std::optional<MissingForceProcess> missing_force;  ///< none: not known, or hardly any
};

}  // namespace axisfit
