// A least-squares problem at one point: its residuals and their Jacobian.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace axisfit {

/// Where the residuals of one series stand: one measurement of one recording.
struct SeriesRows {
  std::size_t recording = 0, measurement = 0;
  Eigen::Index first = 0, count = 0;
};

/// Residuals at u, those of the priors last, and their Jacobian with respect to u.
struct Linearization {
  bool finite = false;
  std::vector<SeriesRows> series;  ///< all rows but those of the priors
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;
};

}  // namespace axisfit
