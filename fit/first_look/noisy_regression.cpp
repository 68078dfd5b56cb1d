#include "fit/first_look/noisy_regression.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace axisfit {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kMostNoise = 0.5;  // of a regressor's sum of squares
constexpr double kLeastOwn = 1e-6;  // of a regressor's, that others do not make
constexpr double kLeastLeft = 1e-3;

}  // namespace

NoisyRegression::NoisyRegression(const MatrixXd& terms, const MatrixXd& noise)
    : terms_(terms), noise_(noise) {
  const MatrixXd& a = terms;
  const VectorXd scale = a.colwise().norm();
  if (a.rows() < 4 * a.cols()) return;
  std::vector<Index> kept;
  for (Index i = 0; i < a.cols(); ++i)
    if (scale[i] > 0.0 && noise(i, i) < kMostNoise * scale[i] * scale[i]) kept.push_back(i);
  while (!kept.empty() && !invert(kept, scale)) std::erase(kept, most_dependent(kept, scale));
  is_possible_ = !kept.empty();
}

MatrixXd NoisyRegression::covariance(const VectorXd& remaining, const VectorXd& inputs,
                                     const std::vector<Balance::Rows>& parts) const {
  const MatrixXd& a = terms_;
  // No recording is that of one mass to more digits than these.
  MatrixXd middle = std::pow(kLeastLeft, 2) * inputs.squaredNorm() /
                    static_cast<double>(inputs.size()) * (a.transpose() * a);
  for (const Balance::Rows& part : parts) {
    const auto n = static_cast<Index>(part.first.size());
    MatrixXd weighted = a.middleRows(part.row, n);
    weighted.array().colwise() *= remaining.segment(part.row, n).array();
    for (Index lag = 0; lag <= std::min(part.lags, n - 1); ++lag) {
      const double weight = 1.0 - static_cast<double>(lag) / static_cast<double>(part.lags + 1);
      const MatrixXd product = weighted.bottomRows(n - lag).transpose() * weighted.topRows(n - lag);
      middle += (lag == 0 ? 0.5 : 1.0) * weight * (product + product.transpose());
    }
  }
  return inverse_ * middle * inverse_;
}

MatrixXd NoisyRegression::normal(const std::vector<Index>& kept, const VectorXd& scale) const {
  const VectorXd inverse = scale(kept).cwiseInverse();
  const MatrixXd a = terms_(Eigen::all, kept) * inverse.asDiagonal();
  return a.transpose() * a -
         MatrixXd(inverse.asDiagonal() * noise_(kept, kept) * inverse.asDiagonal());
}

bool NoisyRegression::invert(const std::vector<Index>& kept, const VectorXd& scale) {
  const auto n = static_cast<Index>(kept.size());
  const Eigen::LDLT<MatrixXd> solver(normal(kept, scale));
  if (solver.info() != Eigen::Success || !solver.isPositive() ||
      solver.vectorD().minCoeff() < kLeastOwn)
    return false;
  const VectorXd inverse = scale(kept).cwiseInverse();
  inverse_ = MatrixXd::Zero(scale.size(), scale.size());
  inverse_(kept, kept) =
      inverse.asDiagonal() * solver.solve(MatrixXd::Identity(n, n)) * inverse.asDiagonal();
  return true;
}

Index NoisyRegression::most_dependent(const std::vector<Index>& kept, const VectorXd& scale) const {
  const MatrixXd squares = normal(kept, scale);
  Index worst = kept.front();
  double least = INFINITY;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    std::vector<Index> others;
    for (std::size_t k = 0; k < kept.size(); ++k)
      if (k != i) others.push_back(static_cast<Index>(k));
    const auto at = static_cast<Index>(i);
    const VectorXd with = squares(others, at);
    const double own = others.empty()
                           ? squares(at, at)
                           : squares(at, at) - with.dot(squares(others, others).ldlt().solve(with));
    if (own < least) {
      least = own;
      worst = kept[i];
    }
  }
  return worst;
}

}  // namespace axisfit
