#include "fleet/control_chart.h"

#include <Eigen/LU>

#include "base/distributions.h"

namespace axisfit {

double mean_run_length(double threshold, double reference) {
  // The sum between 0 and h in equal cells, of which the first is half as wide: the state zero is
  // its middle.
  constexpr Eigen::Index kCells = 120;
  const double width = 2.0 * threshold / (2.0 * kCells - 1.0);
  Eigen::MatrixXd stays(kCells, kCells);
  for (Eigen::Index from = 0; from < kCells; ++from)
    for (Eigen::Index to = 0; to < kCells; ++to) {
      const double step = static_cast<double>(to - from) * width + reference;
      const double below = to == 0 ? 0.0 : normal_cdf(step - 0.5 * width);
      stays(from, to) = normal_cdf(step + 0.5 * width) - below;
    }
  const Eigen::MatrixXd system = Eigen::MatrixXd::Identity(kCells, kCells) - stays;
  const Eigen::VectorXd lengths = system.partialPivLu().solve(Eigen::VectorXd::Ones(kCells));
  return 0.5 * lengths[0];  // of two sides, either of which may give it
}

double threshold_for(double run_length, double reference) {
  double low = 0.0, high = 20.0;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (mean_run_length(middle, reference) < run_length ? low : high) = middle;
  }
  return high;
}

void Cusum::Side::add(double z) {
  sum += z - kChartReference;
  if (sum > 0.0) {
    ++nights;
  } else {
    sum = 0.0;
    nights = 0;
  }
}

bool Cusum::add(double z) {
  up_.add(z);
  down_.add(-z);
  return up_.sum >= threshold_ || down_.sum >= threshold_;
}

}  // namespace axisfit
