// Linear regression on regressors with known noise.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fit/first_look/force_balance.h"

namespace axisfit {

/// A regression with the noise of the regressors subtracted. A regressor that is mostly noise, or
/// that others make, is left out.
class NoisyRegression {
 public:
  /// `noise` is what noise adds to terms' terms, on average. Both must outlive it.
  NoisyRegression(const Eigen::MatrixXd& terms, const Eigen::MatrixXd& noise);

  bool is_possible() const { return is_possible_; }
  bool has(Eigen::Index place) const { return inverse_(place, place) > 0.0; }
  Eigen::VectorXd solve(const Eigen::VectorXd& inputs) const {
    return inverse_ * (terms_.transpose() * inputs);
  }
  Eigen::VectorXd remaining(const Eigen::VectorXd& inputs) const {
    return inputs - terms_ * solve(inputs);
  }

  /// The covariance of a solution, which allows for the autocorrelation of what remains: windows
  /// share samples (W. K. Newey and K. D. West, Econometrica 55, 1987).
  Eigen::MatrixXd covariance(const Eigen::VectorXd& remaining, const Eigen::VectorXd& inputs,
                             const std::vector<Balance::Rows>& parts) const;

 private:
  Eigen::MatrixXd normal(const std::vector<Eigen::Index>& kept, const Eigen::VectorXd& scale) const;
  /// False: these regressors depend on each other.
  bool invert(const std::vector<Eigen::Index>& kept, const Eigen::VectorXd& scale);
  /// The one of these of which the others leave the least.
  Eigen::Index most_dependent(const std::vector<Eigen::Index>& kept,
                              const Eigen::VectorXd& scale) const;

  const Eigen::MatrixXd& terms_;
  const Eigen::MatrixXd& noise_;
  Eigen::MatrixXd inverse_;
  bool is_possible_ = false;
};

}  // namespace axisfit
