// Eigen's matrix decompositions behind a few functions: each takes seconds to compile, and is
// compiled once.
#pragma once

#include <Eigen/Core>
#include <memory>

namespace axisfit {

/// Solves A x = b in the least-squares sense, by QR with column pivoting. Where columns of A are
/// dependent, the solution of least norm is taken. A has at least one column, and its entries are
/// finite.
class LeastSquaresSolver {
 public:
  /// Pivots below `threshold` times the largest count as zero; by default those that are rounding.
  explicit LeastSquaresSolver(const Eigen::MatrixXd& a);
  LeastSquaresSolver(const Eigen::MatrixXd& a, double threshold);
  ~LeastSquaresSolver();

  Eigen::Index rank() const;
  /// Orthonormal columns that span those of A, as many as its rank.
  Eigen::MatrixXd basis() const;
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;

 private:
  struct Decomposition;
  std::unique_ptr<const Decomposition> decomposition_;
};

/// A = U diag(values) right'.
struct SingularValues {
  Eigen::VectorXd values;  ///< descending
  Eigen::MatrixXd right;   ///< the right singular vectors, one column each
};

SingularValues singular_values(const Eigen::MatrixXd& a);

/// Of a square matrix, in no order.
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& a);

}  // namespace axisfit
