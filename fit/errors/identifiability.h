// Identifiability: what the recordings determine about the parameters jointly.
#pragma once

#include <optional>
#include <vector>

#include "fit/errors/error_options.h"
#include "fit/solve/linearization.h"
#include "fit/solve/parameters.h"

namespace axisfit {

/// A combination that is determined, of two parameters that are not: first second^exponent.
struct Combination {
  std::size_t first = 0, second = 0;  ///< places in the space
  double exponent = 0.0;
  double value = 0.0, standard_error = 0.0;
};

/// A direction in the space of the parameters along which the recordings hardly change.
struct WeakDirection {
  double singular_value = 0.0;
  /// Change of u, of unit length, by parameter; components that are small beside
  /// the largest are omitted.
  struct Part {
    std::size_t parameter = 0;  ///< its place in the space
    double change = 0.0;
    /// Change of the value over a tenth of that length: in the quantity's unit or, of a
    /// logarithmic parameter, relative to the value.
    double tenth = 0.0;
    bool relative = false;
  };
  std::vector<Part> parts;                   ///< largest first
  std::optional<Combination> combination{};  ///< of two parts, where one is determined
};

struct Identifiability {
  /// Singular values of the whitened Jacobian, largest first: the inverse of one is the standard
  /// error, under white noise, along its direction; e-folds of a logarithmic parameter, magnitudes
  /// of a linear one.
  std::vector<double> singular_values;
  std::vector<std::size_t> without_influence;  ///< parameters that no recorded signal shows
  std::vector<WeakDirection> weak;             ///< weakest first
  std::vector<Combination> combinations;
};

/// `scale` is the size of the residual in units of the noise, colour allowed for. A direction is
/// weak when the standard error along it is more than a factor of e, or the parameter's magnitude.
Identifiability identifiability(const ParameterSpace& space, const Eigen::VectorXd& u,
                                const Linearization& at, double scale,
                                const ErrorOptions& options = {});

}  // namespace axisfit
