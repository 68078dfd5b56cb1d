// A hypothesis as the score test sees it, and where its refit should start.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "fit/search/hypothesis.h"

namespace axisfit {

struct Scored {
  std::shared_ptr<const Hypothesis> hypothesis{};
  /// At the setting of its shapes that was tried, and where one step of least squares would put it.
  HypothesisValues own{};
  std::vector<double> others{};  ///< of the job's free parameters, that go along with that step
  double gain = 0.0;             ///< fall of the sum of squares that this step promises
  double fraction = 0.0;         ///< the same, of the sum of squares of the simulation that tracks
  /// Of ScoreTest::residuals by that step; empty in a shortlist.
  Eigen::VectorXd change{};

  // By the shortlist.
  double scaled_gain = 0.0;  ///< in units of the residuals' mean square, at least one
  double promise = 0.0;      ///< in units of the acceptance test, see Improvement::fit_gain
  /// A simpler one gains as much, so that this is worth a refit only where that one fails.
  bool is_second = false;
  bool is_fitted = false;  ///< what it gains and where it starts are of a fit, not of a step
};

/// Whether they are the same hypothesis with the same shapes held where they are, so that fits from
/// both may meet.
inline bool is_same_law(const Scored& a, const Scored& b) {
  const auto held = static_cast<std::ptrdiff_t>(a.hypothesis->estimated_shapes().size());
  return is_same_form(*a.hypothesis, *b.hypothesis) &&
         std::equal(a.own.shapes.begin() + held, a.own.shapes.end(), b.own.shapes.begin() + held,
                    b.own.shapes.end());
}

}  // namespace axisfit
