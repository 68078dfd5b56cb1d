// A least-squares problem at one point: its residuals and their Jacobian.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

namespace axisfit {

/// Where the residuals of one series stand: one measurement of one recording.
struct SeriesRows {
  std::size_t recording = 0, measurement = 0;
  Eigen::Index first = 0, count = 0;
};

/// The effect of noise of the recorded inputs on the residuals: they change by d when a draw of the
/// noise is added to the inputs.
struct InputNoise {
  Eigen::MatrixXd gradients;     ///< J'd, a column for each draw
  Eigen::MatrixXd mean_squares;  ///< of the part of d that no u makes, per series (rows) and draw
};

/// Residuals at u, those of the priors last, and their Jacobian with respect to u.
struct Linearization {
  bool finite = false;
  std::vector<SeriesRows> series;  ///< all rows but those of the priors
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;
  std::optional<InputNoise> input_noise;  ///< none where every input is exact, or not asked for
};

}  // namespace axisfit
