// Exact propagation of an affine system y' = f(y) + s t by matrix functions, for step lengths
// h, h/2, h/4, ... and, by a series, for anything shorter than the last of them.
//
// With A = df/dy, Psi(h) = h phi_1(hA) and Xi(h) = h^2 phi_2(hA),
//
//   y(t + h) = y + Psi(h) f(y) + Xi(h) s        (exact)
//
// however stiff A is. Psi and Xi come from their Taylor series at the shortest length and from
// doubling: with E = exp(hA) - I, E(2h) = 2E + E E, Psi(2h) = 2 Psi + E Psi and Xi(2h) = 2 Xi + E
// Xi
// + h Psi. (E = A Psi, but that product cancels badly when A is stiff.) All lengths of the doubling
// are kept: they are what the location of events needs, see integrator.h.
// Literature: N. J. Higham, Functions of Matrices, SIAM 2008, chapter 10.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/axis.h"
#include "sim/scalar.h"

namespace axisfit {

template <class T>
using Matrix = std::array<State<T>, kStates>;  // rows

/// Product of the leading n by n blocks; the rest is zero.
template <class T>
Matrix<T> product(const Matrix<T>& a, const Matrix<T>& b, std::size_t n = kStates) {
  Matrix<T> c{};
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < n; ++k) {
      if (!is_in_play(a[i][k])) continue;
      for (std::size_t j = 0; j < n; ++j) c[i][j] += a[i][k] * b[k][j];
    }
  return c;
}

inline double norm(const Matrix<double>& a) {
  double largest = 0.0;
  for (const auto& row : a) {
    double sum = 0.0;
    for (const double x : row) sum += std::abs(x);
    largest = std::max(largest, sum);
  }
  return largest;
}

/// The largest angular frequency among the eigenvalues of a matrix, rad/s.
double fastest_oscillation(const Matrix<double>& a);

/// A matrix without its zeros. The structure of the axis leaves many.
template <class T>
class SparseMatrix {
 public:
  explicit SparseMatrix(const Matrix<T>& dense) {
    for (std::size_t i = 0; i < kStates; ++i)
      for (std::size_t j = 0; j < kStates; ++j)
        if (is_in_play(dense[i][j])) entries_.push_back({i, j, dense[i][j]});
  }
  /// y += A x
  void add_product(const State<T>& x, State<T>& y) const {
    for (const Entry& entry : entries_) y[entry.row] += entry.value * x[entry.column];
  }

 private:
  struct Entry {
    std::size_t row, column;
    T value;
  };
  std::vector<Entry> entries_;
};

/// The same matrix without derivatives.
template <class T>
Matrix<double> value_of(const Matrix<T>& a) {
  Matrix<double> b;
  for (std::size_t i = 0; i < kStates; ++i)
    for (std::size_t j = 0; j < kStates; ++j) b[i][j] = value_of(a[i][j]);
  return b;
}

/// The dyadic lengths into which a step h is divided for one matrix A.
struct Ladder {
  double step;   ///< h, s
  int last;      ///< the shortest length is h / 2^last
  int resolved;  ///< at h / 2^resolved the fastest motion is resolved; at most `last`
  double length(int level) const { return std::ldexp(step, -level); }
};

/// Enough halvings of `step` for the series to be exact to rounding, and at least `least`.
template <class T>
Ladder ladder_for(const Matrix<T>& a, double step, int least) {
  // ||A^8||^(1/8) is close to the spectral radius where ||A|| alone, with entries of many different
  // units, overestimates it by orders of magnitude.
  Matrix<double> power = value_of(a);
  double log_scale = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double size = norm(power);
    if (!(size > 0.0)) return {step, least, 0};
    for (auto& row : power)
      for (double& x : row) x /= size;
    power = product(power, power);
    log_scale = 2.0 * (log_scale + std::log2(size));
  }
  const double size = norm(power);
  if (!(size > 0.0)) return {step, least, 0};
  const double log_rate = (log_scale + std::log2(size)) / 8.0;
  constexpr double kLogTheta = -2.0;  // ||A|| h / 2^last <= 1/4
  const double halvings = std::ceil(log_rate + std::log2(step) - kLogTheta);
  const int resolved =
      std::isfinite(halvings) ? static_cast<int>(std::clamp(halvings, 0.0, 60.0)) : 60;
  return {step, std::max(resolved, least), resolved};
}

/// Terms of the series: (1/4)^13 / 13! is far below rounding.
inline constexpr int kSeriesTerms = 12;

template <class T>
class Propagator {
 public:
  /// `a` = df/dy, of which the first n states are in use. With `with_slope`, Xi is prepared too.
  Propagator(const Matrix<T>& a, const Ladder& ladder, bool with_slope, std::size_t n = kStates)
      : states_(n), a_(a), ladder_(ladder) {
    const double h = ladder.length(ladder.last);
    // Psi = h (I + hA/2 + (hA)^2/6 + ...), Xi = h^2 (I/2 + hA/6 + ...)
    Matrix<T> psi = scaled_identity(h), xi = scaled_identity(0.5 * h * h), term = psi;
    for (int k = 2; k <= kSeriesTerms; ++k) {
      term = product(a, term, n);
      for (State<T>& row : term)
        for (T& x : row) x *= h / k;
      add(psi, 1.0, term);
      add(xi, h / (k + 1), term);
    }
    Matrix<T> e = product(a, psi, n);
    for (int level = ladder.last;; --level) {
      psi_.emplace_back(psi);
      if (with_slope) xi_.emplace_back(xi);
      if (level == 0) break;
      if (with_slope) {
        grow(xi, e);
        add(xi, ladder.length(level), psi);
      }
      grow(psi, e);
      grow(e, e);
    }
    std::ranges::reverse(psi_);
    std::ranges::reverse(xi_);
  }

  const Ladder& ladder() const { return ladder_; }

  /// y(t + h / 2^level), from f = f(y(t)) and, unless null, the slope s of f in time.
  State<T> advance(const State<T>& y, const State<T>& f, const State<T>* slope, int level) const {
    State<T> next = y;
    psi_[static_cast<std::size_t>(level)].add_product(f, next);
    if (slope != nullptr) xi_[static_cast<std::size_t>(level)].add_product(*slope, next);
    return next;
  }

  /// y(t + length) by the series, 0 <= length <= h / 2^last.
  State<T> advance_by(const State<T>& y, const State<T>& f, const State<T>* slope,
                      double length) const {
    State<T> next = y, derivative = f;
    double factor = length;  // length^n / n!
    for (int n = 1; n <= kSeriesTerms; ++n) {
      for (std::size_t i = 0; i < kStates; ++i) next[i] += factor * derivative[i];
      State<T> higher{};
      if (n == 1 && slope != nullptr) higher = *slope;
      a_.add_product(derivative, higher);
      derivative = higher;
      factor *= length / (n + 1);
    }
    return next;
  }

  /// exp(A h / 2^level) v
  State<T> exponential(const State<T>& v, int level) const {
    State<T> image{};
    a_.add_product(v, image);
    State<T> next = v;
    psi_[static_cast<std::size_t>(level)].add_product(image, next);
    return next;
  }

 private:
  /// m += factor * other
  void add(Matrix<T>& m, double factor, const Matrix<T>& other) const {
    for (std::size_t i = 0; i < states_; ++i)
      for (std::size_t j = 0; j < states_; ++j) m[i][j] += factor * other[i][j];
  }
  /// m := 2 m + e m
  void grow(Matrix<T>& m, const Matrix<T>& e) const {
    const Matrix<T> image = product(e, m, states_);
    add(m, 1.0, m);
    add(m, 1.0, image);
  }
  Matrix<T> scaled_identity(double scale) const {
    Matrix<T> m{};
    for (std::size_t i = 0; i < states_; ++i) m[i][i] = T(scale);
    return m;
  }

  std::size_t states_;
  SparseMatrix<T> a_;
  Ladder ladder_;
  std::vector<SparseMatrix<T>> psi_, xi_;  // by level
};

}  // namespace axisfit
