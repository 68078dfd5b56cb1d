#include "fit/search/pulses.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "fit/search/force_response.h"
#include "fit/search/options.h"

namespace axisfit {
namespace {

constexpr SearchOptions::Pulses kOptions;

}  // namespace

std::vector<Pulse> pulses_in(const Recording& recording, const Observer& observer,
                             const Eigen::VectorXd& residuals, const Eigen::MatrixXd& basis,
                             std::size_t most) {
  const std::size_t n = recording.times.size();
  const auto without_known = [&](const Eigen::VectorXd& rows) {
    return Eigen::VectorXd(rows - basis * (basis.transpose() * rows));
  };
  const Eigen::VectorXd residual = without_known(residuals);
  // The product of the residual with the response to a pulse is the sum of this while it lasts.
  const std::vector<double> adjoint = adjoint_response(recording, residual, observer);
  std::vector<double> sums(n + 1, 0.0);
  std::partial_sum(adjoint.begin(), adjoint.end(), sums.begin() + 1);
  std::vector<Pulse> found;
  for (std::size_t length = kOptions.fewest_samples; kOptions.fewest_in_recording * length <= n;
       length = static_cast<std::size_t>(kOptions.next * static_cast<double>(length))) {
    // Responses to pulses of one length are about as large, wherever they are: the largest products
    // are the best of that length.
    std::vector<std::size_t> firsts;
    while (firsts.size() < most) {
      std::optional<std::size_t> best;
      double largest = 0.0;
      for (std::size_t first = 0; first + length < n; ++first) {
        const double product = std::abs(sums[first + length] - sums[first]);
        if (product > largest && std::ranges::none_of(firsts, [&](std::size_t other) {
              return first < other + length && other < first + length;
            }))
          largest = product, best = first;
      }
      if (!best) break;
      firsts.push_back(*best);
    }
    for (const std::size_t first : firsts) {
      std::vector<double> force(n, 0.0);
      std::fill_n(force.begin() + static_cast<std::ptrdiff_t>(first), length, 1.0);
      const Eigen::VectorXd column = without_known(response_to(recording, force, observer));
      const double size = column.squaredNorm(), product = column.dot(residual);
      if (size > 0.0)
        found.push_back(
            {recording.times[first], recording.times[first + length], product * product / size});
    }
  }
  std::ranges::stable_sort(found, std::greater{}, &Pulse::gain);
  std::vector<Pulse> pulses;
  for (const Pulse& pulse : found)
    if (pulses.size() < most && std::ranges::none_of(pulses, [&](const Pulse& better) {
          return pulse.start < better.end && better.start < pulse.end;
        }))
      pulses.push_back(pulse);
  return pulses;
}

}  // namespace axisfit
