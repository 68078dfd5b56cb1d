// Exact propagation of an affine system y' = f(y) + s t by matrix functions, for step lengths
// h, h/2, h/4, ... and, by a series, for anything shorter than the last of them.
//
// With A = df/dy, Psi(h) = h phi_1(hA) and Xi(h) = h^2 phi_2(hA),
//
//   y(t + h) = y + Psi(h) f(y) + Xi(h) s        (exact)
//
// however stiff A is, and without error where f is zero. Psi and Xi come from their Taylor series
// at the shortest length and from doubling: with E = exp(hA) - I, E(2h) = 2E + E E, Psi(2h) = 2 Psi
// + E Psi and Xi(2h) = 2 Xi + E Xi + h Psi. (E = A Psi, but that product cancels badly when A is
// stiff.) The slope s is a sum of given vectors r, ramps, or zero, so that Xi is only needed
// times these. The matrices of a length are computed when first needed, and all are kept for the
// location of events, see integrator.h. Literature: N. J. Higham, Functions of Matrices, SIAM 2008,
// chapter 10.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
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
      if (!is_active(a[i][k])) continue;
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

/// An oscillation of a linear system: a pair of complex eigenvalues, or a real one at frequency 0.
struct Oscillation {
  double frequency;  ///< rad/s
  double damping;    ///< 1/s, the rate of its decay; negative: it grows
};

/// Those of y' = A y, the fastest first; at least one.
std::vector<Oscillation> oscillations(const Matrix<double>& a);

/// A matrix without its zeros. The structure of the axis leaves many.
template <class T>
class SparseMatrix {
 public:
  explicit SparseMatrix(const Matrix<T>& dense) {
    std::size_t size = 0;
    for (const State<T>& row : dense)
      size += static_cast<std::size_t>(std::ranges::count_if(row, is_active<T>));
    columns_.reserve(size);
    values_.reserve(size);
    for (std::size_t i = 0; i < kStates; ++i) {
      for (std::size_t j = 0; j < kStates; ++j) {
        if (!is_active(dense[i][j])) continue;
        columns_.push_back(j);
        values_.push_back(dense[i][j]);
      }
      ends_[i] = values_.size();
    }
  }
  /// y += A x
  void add_product(const State<T>& x, State<T>& y) const {
    std::size_t k = 0;
    for (std::size_t i = 0; i < kStates; ++i) {
      if (k == ends_[i]) continue;
      T sum = y[i];
      for (; k < ends_[i]; ++k) sum += values_[k] * x[columns_[k]];
      y[i] = sum;
    }
  }

 private:
  std::array<std::size_t, kStates> ends_{};  // by row
  std::vector<std::size_t> columns_;
  std::vector<T> values_;
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
struct StepLevels {
  double step;   ///< h, s
  int last;      ///< the shortest length is h / 2^last
  int resolved;  ///< at h / 2^resolved the fastest motion is resolved; at most `last`
  double rate;   ///< 1/s, of the fastest motion, rounded up by less than 2
  /// Of a level below 1000; std::ldexp takes as long as a row of the step.
  double length(int level) const {
    return step * std::bit_cast<double>(static_cast<std::uint64_t>(1023 - level) << 52);
  }
};

/// Enough halvings of `step` for the series to be exact to rounding, and at least `least`.
template <class T>
StepLevels step_levels_for(const Matrix<T>& a, double step, int least) {
  // ||A^8||^(1/8) is close to the spectral radius where ||A|| alone, with entries of many different
  // units, overestimates it by orders of magnitude.
  Matrix<double> power = value_of(a);
  double log_scale = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double size = norm(power);
    if (!(size > 0.0)) return {step, least, 0, 0.0};
    for (auto& row : power)
      for (double& x : row) x /= size;
    power = product(power, power);
    log_scale = 2.0 * (log_scale + std::log2(size));
  }
  const double size = norm(power);
  if (!(size > 0.0)) return {step, least, 0, 0.0};
  const double log_rate = (log_scale + std::log2(size)) / 8.0;
  const double halvings = std::ceil(log_rate + std::log2(step));  // ||A|| h / 2^halvings <= 1
  constexpr double kMost = 60.0;
  const int finest =
      static_cast<int>(std::isfinite(halvings) ? std::clamp(halvings, -kMost, kMost) : kMost);
  const int resolved = std::max(finest, 0);
  return {step, std::max(resolved, least), resolved, std::ldexp(1.0 / step, finest)};
}

/// Terms of the series: 1 / 21! is far below rounding.
inline constexpr int kSeriesTerms = 20;

/// Factors of the ramps in s: of the command, and of the observer's target velocity and position.
inline constexpr std::size_t kRamps = 3;
using Slopes = std::array<double, kRamps>;
/// Which of the ramps there are, in order.
using RampList = std::vector<std::size_t>;

/// A vector r of s.
template <class T>
struct Ramp {
  std::size_t which = 0;  ///< its factor, in Slopes
  State<T> direction{};
};

/// y(t) for a short time, as a polynomial: the Taylor series.
template <class T>
struct Series {
  std::array<State<T>, kSeriesTerms + 1> terms;
  std::size_t last = 0;  ///< of the terms that count

  State<T> at(double t) const {
    State<T> y = terms[last];
    for (std::size_t n = last; n-- > 0;)
      for (std::size_t i = 0; i < kStates; ++i) y[i] = terms[n][i] + t * y[i];
    return y;
  }
};

/// Not to be used by two threads at once.
template <class T>
class Propagator {
 public:
  /// What one length takes.
  struct Length {
    double time;  ///< s
    SparseMatrix<T> psi;
    std::vector<State<T>> xi;  ///< times each ramp
  };

  /// `a` = df/dy, of which the first n states are in use.
  Propagator(const Matrix<T>& a, const StepLevels& step_levels, std::vector<Ramp<T>> ramps = {},
             std::size_t n = kStates)
      : states_(n), step_levels_(step_levels), dense_(a), a_(a), ramps_(std::move(ramps)) {
    psi_ = psi_by_series(step_levels.length(step_levels.last));
    e_ = product(a, psi_, n);
    lengths_.push_back(by_series(step_levels.length(step_levels.last), psi_));
  }

  const StepLevels& step_levels() const { return step_levels_; }

  /// A y
  State<T> a_times(const State<T>& y) const {
    State<T> image{};
    a_.add_product(y, image);
    return image;
  }

  /// f += t times each ramp times its slope
  void add_ramps(State<T>& f, const Slopes& slopes, double t) const {
    for (const Ramp<T>& ramp : ramps_) add(f, t * slopes[ramp.which], ramp.direction);
  }

  /// h / 2^level
  const Length& length(int level) {
    while (step_levels_.last - level >= static_cast<int>(lengths_.size())) double_length();
    return lengths_[static_cast<std::size_t>(step_levels_.last - level)];
  }

  /// Any other time (s) of at most h / 2^resolved, within rounding, if it was asked for before: the
  /// matrices take as long as many series. Else null. The next call may end its life.
  const Length* repeated(double time) {
    constexpr std::size_t kKept = 8;
    constexpr double kSame = 1e-8;
    ++asked_;
    auto known = std::ranges::find_if(
        repeated_, [&](const Repeated& r) { return std::abs(r.time - time) <= kSame * time; });
    if (known == repeated_.end()) {
      if (repeated_.size() < kKept)
        known = repeated_.insert(known, Repeated{});
      else
        known = std::ranges::min_element(repeated_, {}, &Repeated::asked);
      *known = {time, asked_, {}};
      return nullptr;
    }
    known->asked = asked_;
    if (!known->length) known->length = by_series(known->time, psi_by_series(known->time));
    return &*known->length;
  }

  /// y(t + length), from f = f(y(t)).
  State<T> advance(const State<T>& y, const State<T>& f, const Slopes& slopes,
                   const Length& length) const {
    State<T> next = y;
    length.psi.add_product(f, next);
    for (std::size_t r = 0; r < ramps_.size(); ++r)
      add(next, slopes[ramps_[r].which], length.xi[r]);
    return next;
  }
  State<T> advance(const State<T>& y, const State<T>& f, const Slopes& slopes, int level) {
    return advance(y, f, slopes, length(level));
  }

  /// exp(A length) v
  State<T> exponential(const State<T>& v, const Length& length) const {
    State<T> image = v;
    length.psi.add_product(a_times(v), image);
    return image;
  }
  State<T> exponential(const State<T>& v, int level) { return exponential(v, length(level)); }

  /// y(t + ...), exact to rounding up to `length`, which is at most h / 2^resolved.
  Series<T> series(const State<T>& y, const State<T>& f, const Slopes& slopes,
                   double length) const {
    Series<T> result;
    result.terms[0] = y;
    State<T> derivative = f;
    const double theta = length * step_levels_.rate;
    double factor = 1.0;     // 1 / n!
    double largest = theta;  // of the term, theta^n / n!
    for (std::size_t n = 1;; ++n) {
      State<T>& term = result.terms[n];
      for (std::size_t i = 0; i < kStates; ++i) term[i] = factor * derivative[i];
      factor /= static_cast<double>(n + 1);
      largest *= theta / static_cast<double>(n + 1);
      constexpr double kNegligible = 0x1p-62;
      // Rates do not tell of a chain of integrators, which ends after as many terms as it has
      // links.
      constexpr std::size_t kLongestChain = 8;
      result.last = n;
      if (n == kSeriesTerms || (n > kLongestChain && largest < kNegligible)) return result;
      derivative = a_times(derivative);
      if (n == 1) add_ramps(derivative, slopes, 1.0);
    }
  }

 private:
  struct Repeated {
    double time = 0.0;
    std::uint64_t asked = 0;       ///< when it was last asked for, see asked_
    std::optional<Length> length;  ///< from the second time on
  };

  /// Psi = h (I + hA/2 + (hA)^2/6 + ...)
  Matrix<T> psi_by_series(double h) const {
    Matrix<T> psi{}, term{};
    for (std::size_t i = 0; i < states_; ++i) psi[i][i] = term[i][i] = T(h);
    for (int k = 2; k <= kSeriesTerms; ++k) {
      term = product(dense_, term, states_);
      for (std::size_t i = 0; i < states_; ++i)
        for (std::size_t j = 0; j < states_; ++j) psi[i][j] += term[i][j] *= h / k;
    }
    return psi;
  }

  /// Xi r = h^2 (I/2 + hA/6 + ...) r
  Length by_series(double h, const Matrix<T>& psi) const {
    std::vector<State<T>> xi;
    for (const Ramp<T>& ramp : ramps_) {
      State<T> sum{}, next = ramp.direction;
      double factor = 0.5 * h * h;
      for (int k = 3; k <= kSeriesTerms + 2; ++k) {
        add(sum, factor, next);
        next = a_times(next);
        factor *= h / k;
      }
      xi.push_back(sum);
    }
    return {h, SparseMatrix<T>(psi), std::move(xi)};
  }

  void double_length() {
    const Length& half = lengths_.back();
    const double h = half.time;
    const SparseMatrix<T> e(e_);
    std::vector<State<T>> xi = half.xi;
    for (std::size_t r = 0; r < xi.size(); ++r) {
      add(xi[r], 1.0, half.xi[r]);
      e.add_product(half.xi[r], xi[r]);
      State<T> psi{};
      half.psi.add_product(ramps_[r].direction, psi);
      add(xi[r], h, psi);
    }
    psi_ = grown(psi_);
    e_ = grown(e_);
    lengths_.push_back({2.0 * h, SparseMatrix<T>(psi_), std::move(xi)});
  }

  /// 2 m + E m
  Matrix<T> grown(const Matrix<T>& m) const {
    Matrix<T> sum = product(e_, m, states_);
    for (std::size_t i = 0; i < states_; ++i)
      for (std::size_t j = 0; j < states_; ++j) sum[i][j] += 2.0 * m[i][j];
    return sum;
  }

  static void add(State<T>& y, double factor, const State<T>& x) {
    for (std::size_t i = 0; i < kStates; ++i) y[i] += factor * x[i];
  }

  std::size_t states_;
  StepLevels step_levels_;
  Matrix<T> dense_;
  SparseMatrix<T> a_;  // the same
  std::vector<Ramp<T>> ramps_;
  Matrix<T> e_, psi_;               // of the longest length so far
  std::vector<Length> lengths_;     // from the shortest up
  std::vector<Repeated> repeated_;  // those asked for last
  std::uint64_t asked_ = 0;         // calls of repeated()
};

}  // namespace axisfit
