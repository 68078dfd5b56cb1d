#include "fit/errors/input_noise.h"

#include <Eigen/QR>
#include <algorithm>

#include "base/parallel.h"
#include "base/random.h"
#include "fit/solve/solve.h"

namespace axisfit {
namespace {

/// The job as it would have been recorded, with another draw of the inputs' noise.
Job with_input_noise(Job job, std::size_t draw) {
  std::mt19937_64 generator(draw + 1);
  for (Recording& r : job.recordings)
    if (r.role == Role::fit && r.command_sigma > 0.0)
      for (double& value : r.command.values.edit()) value += r.command_sigma * normal(generator);
  return job;
}

double mean_square(const Eigen::Ref<const Eigen::VectorXd>& rows) {
  return rows.squaredNorm() / static_cast<double>(rows.size());
}

/// The largest factor, at most one, at which every series has a draw that is no larger than its
/// residual.
double bearable_scale(const InputNoise& noise, const Linearization& at) {
  double square = 1.0;
  for (std::size_t s = 0; s < at.series.size(); ++s) {
    const double least = noise.mean_squares.row(static_cast<Eigen::Index>(s)).minCoeff();
    const SeriesRows& rows = at.series[s];
    if (least > 0.0)
      square = std::min(square, mean_square(at.residuals.segment(rows.first, rows.count)) / least);
  }
  return std::sqrt(square);
}

}  // namespace

std::optional<InputNoise> input_noise(const Job& job, const ParameterSpace& space,
                                      const Eigen::VectorXd& u, double observer_gain,
                                      const Linearization& at) {
  const auto is_noisy = [](const Recording& r) {
    return r.role == Role::fit && r.command_sigma > 0.0;
  };
  if (!at.finite || std::ranges::none_of(job.recordings, is_noisy)) return std::nullopt;
  const int draws = job.options.input_noise_draws;
  // The error of longer steps is in the residuals with noise and without, unless they go astray.
  Job coarse = job;
  coarse.options.step *= 2.0;
  Eigen::VectorXd without = residuals_at(coarse, space, u, observer_gain);
  if (without.size() != at.residuals.size()) {
    coarse.options.step = job.options.step;
    without = at.residuals;
  }
  InputNoise result;
  result.gradients.setZero(at.jacobian.cols(), draws);
  result.mean_squares.setZero(static_cast<Eigen::Index>(at.series.size()), draws);
  const Eigen::VectorXd length = at.jacobian.colwise().norm().cwiseMax(1e-300);
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(at.jacobian *
                                                       length.cwiseInverse().asDiagonal());
  parallel_for(static_cast<std::size_t>(draws), [&](std::size_t draw) {
    const Job noisy = with_input_noise(coarse, draw);
    const Eigen::VectorXd residuals = residuals_at(noisy, space, u, observer_gain);
    if (residuals.size() != without.size()) return;  // it does not finish
    const Eigen::VectorXd change = residuals - without;
    const auto column = static_cast<Eigen::Index>(draw);
    result.gradients.col(column) = at.jacobian.transpose() * change;
    const Eigen::VectorXd left =
        change - at.jacobian * length.cwiseInverse().asDiagonal() * qr.solve(change);
    for (std::size_t s = 0; s < at.series.size(); ++s)
      result.mean_squares(static_cast<Eigen::Index>(s), column) =
          mean_square(left.segment(at.series[s].first, at.series[s].count));
  });
  const auto estimated = [](const Recording& r) {
    return r.command_sigma > 0.0 && r.command_noise == NoiseSource::differences;
  };
  if (std::ranges::any_of(job.recordings, estimated)) {
    const double scale = bearable_scale(result, at);
    result.gradients *= scale;
    result.mean_squares *= scale * scale;
  }
  return result;
}

}  // namespace axisfit
