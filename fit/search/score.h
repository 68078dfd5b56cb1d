// The score test of every hypothesis at strength zero: which effect would explain the residual.
//
// The simulation tracks the data at a moderate observer gain, so that it stays on the measured path
// although the model lacks something, and the free parameters are fitted there. With r the whitened
// residuals, J their Jacobian, D the derivatives with respect to a hypothesis's strengths and P the
// projection off the columns of J, the hypothesis would lower the sum of squares by
//
//   gain = | projection of P r on the columns of P D |^2
//
// which is chi-square distributed with as many degrees of freedom as strengths when it is absent
// and the noise is white: C. R. Rao's score or Lagrange multiplier test (1948).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "fit/search/options.h"
#include "fit/search/scored.h"
#include "fit/solve/solve.h"

namespace axisfit {

struct ScoreTest {
  bool usable = false;  ///< false: the tracking simulation has no finite residuals
  double sum_of_squares = 0.0;
  double mean_square = 0.0;   ///< of the tracking simulation's residuals, which noise drives, too
  Eigen::VectorXd residuals;  ///< without what the free parameters can still do
  std::vector<SeriesRows> series;  ///< theirs
  std::vector<Scored> scores;      ///< of every hypothesis and setting, the largest gain first
};

/// Scores all named hypotheses of the catalogue, or all curves, from a fit with the given values of
/// the free parameters. `observer_gain` as in observer_for().
ScoreTest score_test(const Job& job, const std::vector<double>& values, double observer_gain,
                     bool curves = false, const SearchContext& context = {});

/// A further rung of the ladder of gains (fit/criterion/gains.h) for what is large: the highest of
/// three at which the residual still is many times the noise. What is missing shows there where it
/// acts. At a lower gain the simulation drifts away from the
/// data, and what depends on the place or the speed is read off the wrong one. None where nothing
/// is that large.
std::optional<double> close_gain(const Job& job, const std::vector<double>& values,
                                 const SearchContext& context = {});

}  // namespace axisfit
