#include "fit/errors/residual_colour.h"

#include <algorithm>
#include <limits>

#include "base/autocovariance.h"
#include "base/convolution.h"

namespace axisfit {

ResidualColour residual_colour(const Eigen::VectorXd& residuals, const Eigen::MatrixXd& j,
                               std::span<const SeriesRows> series, const Eigen::MatrixXd& inverse,
                               const ErrorOptions& options) {
  ResidualColour found;
  std::vector<Eigen::MatrixXd> middles;
  double squares = 0.0, taken = 0.0;
  for (const SeriesRows& rows : series) {
    const Eigen::MatrixXd block = j.middleRows(rows.first, rows.count);
    std::vector<double>& g = found.autocovariance.emplace_back(modelled_autocovariance(
        {residuals.data() + rows.first, static_cast<std::size_t>(rows.count)}));
    if (!(g[0] > 0.0)) g[0] = std::numeric_limits<double>::min();
    const Eigen::MatrixXd coloured = g.size() == 1 ? g[0] * block : toeplitz_product(g, block);
    middles.push_back(block.transpose() * coloured);
    squares += g[0] * static_cast<double>(rows.count);
    taken += (inverse * middles.back()).trace();
  }
  const double given_back = 1.0 / std::max(options.least_left, 1.0 - taken / squares);
  found.middle.setZero(j.cols(), j.cols());
  for (std::size_t s = 0; s < middles.size(); ++s) {
    std::vector<double>& g = found.autocovariance[s];
    // Less than the stated noise is chance, or a statement that errs to the safe side.
    const double scale = std::max(given_back, 1.0 / g[0]);
    for (double& x : g) x *= scale;
    found.middle += scale * middles[s];
  }
  return found;
}

}  // namespace axisfit
