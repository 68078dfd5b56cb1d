#include "base/linear_algebra.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>

namespace axisfit {

struct LeastSquaresSolver::Decomposition {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> qr;
};

LeastSquaresSolver::LeastSquaresSolver(const Eigen::MatrixXd& a)
    : decomposition_(new Decomposition{decltype(Decomposition::qr)(a)}) {}

LeastSquaresSolver::LeastSquaresSolver(const Eigen::MatrixXd& a, double threshold) {
  auto decomposition = std::make_unique<Decomposition>();
  decomposition->qr.setThreshold(threshold);
  decomposition->qr.compute(a);
  decomposition_ = std::move(decomposition);
}

LeastSquaresSolver::~LeastSquaresSolver() = default;

Eigen::Index LeastSquaresSolver::rank() const { return decomposition_->qr.rank(); }

Eigen::MatrixXd LeastSquaresSolver::basis() const {
  const auto& qr = decomposition_->qr;
  return qr.householderQ() * Eigen::MatrixXd::Identity(qr.rows(), qr.rank());
}

Eigen::MatrixXd LeastSquaresSolver::solve(const Eigen::MatrixXd& b) const {
  return decomposition_->qr.solve(b);
}

SingularValues singular_values(const Eigen::MatrixXd& a) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(a, Eigen::ComputeThinV);
  return {svd.singularValues(), svd.matrixV()};
}

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& a) { return a.eigenvalues(); }

}  // namespace axisfit
