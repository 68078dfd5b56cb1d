// Dependence: variables that the residual of a signal depends on, though it should not.
//
// A complete model leaves only noise, which is independent of the axis. In a fit of the simulation
// error, colour alone is no evidence: a wrong friction leaves a slow residual, but so does process
// noise, which the model is right not to follow. Dependence on the input or the state of the axis
// is evidence.
#pragma once

#include <string>
#include <vector>

#include "fit/judge/drift.h"
#include "fit/judge/series.h"

namespace axisfit {

struct Dependence {
  std::string on;         ///< "command", "velocity", "direction", "position" ... or a channel
  double fraction = 0.0;  ///< of the residual's mean square, explained by its mean over each of 12
                          ///< equally frequented ranges of the variable
  double p_value = 1.0;   ///< of that share or more, were there no dependence
};

/// The verdict on one series.
struct SeriesTest {
  ResidualSeries series;
  double reduced_chi_square = 0.0;
  double autocorrelation_time = 1.0;    ///< samples
  double unexplained_percent = 0.0;     ///< of the root mean square residual, beyond the noise
  bool explained = false;               ///< shows no more than its noise
  std::vector<Dependence> dependences;  ///< significant ones (p < 0.001), strongest first
  std::vector<std::size_t> outliers;    ///< places in the series, beyond four sigma
  Drift drift;                          ///< of the residual over sigma
  double resolution = 0.0;              ///< step between recorded values; zero: none
};

/// Tests every series of a fit. The p-values count one independent sample for each autocorrelation
/// time (analysis of variance; chi-square distributed for that many samples).
std::vector<SeriesTest> test_residuals(const Job& job, const FitResult& result);

}  // namespace axisfit
