// Forecast of the standard errors, before recordings are fitted or even made.
#pragma once

#include <Eigen/Core>

#include "fit/errors/identifiability.h"
#include "fit/errors/uncertainty.h"

namespace axisfit {

/// The errors to expect if the axis is as `values` say, and the noise white and of the stated size.
struct Forecast {
  bool finite = false;              ///< false: the simulation does not finish
  Uncertainty uncertainty;          ///< that the fit will have
  Identifiability identifiability;  ///< of the parameters
  /// How much of each parameter the series show: rms change of the simulated signal, in units of
  /// its noise, for an e-fold of a logarithmic parameter or the magnitude of a linear one.
  /// Parameters by series.
  Eigen::MatrixXd sensitivity;
  std::vector<SeriesRows> series;  ///< the columns
};

/// The forecast of a fit to the job's recordings, free running or at a fixed observer gain.
Forecast forecast(const Job& job, const std::vector<double>& values);

/// The motion that a parameter needs to be seen, in words that follow "needs"; empty where nothing
/// general can be said.
std::string_view excitation_needed(const QuantityEntry& quantity, Vocabulary vocabulary);

}  // namespace axisfit
