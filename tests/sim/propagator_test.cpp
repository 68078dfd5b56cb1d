#include "sim/propagator.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>
#include <unsupported/Eigen/MatrixFunctions>

#include "fit/solve/jet.h"

namespace axisfit {
namespace {

using Long = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

struct Exact {
  Long exponential, psi, xi;
};

/// The upper row of exp(h [A I 0; 0 0 I; 0 0 0]) holds exp(hA), Psi and Xi. In long double, by
/// Eigen's scaling and squaring.
Exact exact(const Matrix<double>& a, double h) {
  constexpr int n = kStates;
  Long block = Long::Zero(3 * n, 3 * n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j)
      block(i, j) = a[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    block(i, n + i) = 1.0L;
    block(n + i, 2 * n + i) = 1.0L;
  }
  block *= static_cast<long double>(h);
  const Long e = block.exp();
  return {e.topLeftCorner(n, n), e.block(0, n, n, n), e.block(0, 2 * n, n, n)};
}

template <class T>
State<T> unit(std::size_t j) {
  State<T> e{};
  e[j] = T(1.0);
  return e;
}

/// A propagator of which the first ramp leads to state j.
template <class T>
Propagator<T> with_ramp(const Matrix<T>& a, const StepLevels& step_levels, std::size_t j) {
  return Propagator<T>(a, step_levels, {{0, unit<T>(j)}, {2, State<T>{}}});
}

constexpr Slopes kFlat{}, kRising{1.0, 0.0, 0.0};

/// Largest errors of the columns of exp, Psi and Xi at a level, by the largest entry of each
/// matrix.
void expect_exact(const Matrix<double>& a, double step, int least, double tolerance) {
  const StepLevels step_levels = step_levels_for(a, step, least);
  std::vector<Propagator<double>> propagators;
  for (std::size_t j = 0; j < kStates; ++j) propagators.push_back(with_ramp(a, step_levels, j));
  const State<double> zero{};
  const auto close = [&](const char* what, int level, std::size_t j, const State<double>& column,
                         const Long& truth) {
    const auto scale = truth.cwiseAbs().maxCoeff();
    for (std::size_t i = 0; i < kStates; ++i) {
      const auto expected = truth(static_cast<int>(i), static_cast<int>(j));
      EXPECT_LE(std::abs(static_cast<long double>(column[i]) - expected), tolerance * scale)
          << what << " level " << level << " (" << i << ", " << j << ")";
    }
  };
  for (int level = 0; level <= step_levels.last; level += std::max(1, step_levels.last / 3)) {
    const Exact truth = exact(a, step_levels.length(level));
    for (std::size_t j = 0; j < kStates; ++j) {
      const State<double> e = unit<double>(j);
      Propagator<double>& propagator = propagators[j];
      close("Psi", level, j, propagator.advance(zero, e, kFlat, level), truth.psi);
      close("Xi", level, j, propagator.advance(zero, zero, kRising, level), truth.xi);
      close("exp", level, j, propagator.exponential(e, level), truth.exponential);
    }
  }
  for (const double share : {1.0, 0.37, 1e-3}) {
    const double length = share * step_levels.length(step_levels.resolved);
    const Exact truth = exact(a, length);
    for (std::size_t j = 0; j < kStates; ++j) {
      const auto series = [&](const State<double>& f, const Slopes& slopes) {
        return propagators[j].series(zero, f, slopes, length).at(length);
      };
      close("Psi, series", -1, j, series(unit<double>(j), kFlat), truth.psi);
      close("Xi, series", -1, j, series(zero, kRising), truth.xi);
    }
  }
}

TEST(Propagator, OfADecayHasItsClosedForm) {
  for (const double rate : {1e-3, 1.0, 1e3, 1e6, 1e8}) {
    Matrix<double> a{};
    a[2][2] = -rate;
    constexpr double h = 0.5e-3;
    Propagator<double> propagator = with_ramp(a, step_levels_for(a, h, 0), 2);
    const State<double> zero{}, e = unit<double>(2);
    const double z = -rate * h;
    // phi_2 by its series where the closed form cancels.
    const double phi2 = rate * h < 1e-2 ? 0.5 + z / 6.0 + z * z / 24.0 + z * z * z / 120.0
                                        : (std::expm1(z) - z) / (z * z);
    EXPECT_NEAR(propagator.advance(zero, e, kFlat, 0)[2] / (-std::expm1(z) / rate), 1.0, 1e-13);
    EXPECT_NEAR(propagator.advance(zero, zero, kRising, 0)[2] / (h * h * phi2), 1.0, 1e-11);
  }
}

TEST(Propagator, OfAnOscillatorHasItsClosedForm) {
  for (const double w : {1.0, 477.0, 1e4}) {
    Matrix<double> a{};
    a[0][1] = 1.0;
    a[1][0] = -w * w;
    constexpr double h = 0.5e-3;
    Propagator<double> propagator = with_ramp(a, step_levels_for(a, h, 0), 1);
    const State<double> zero{}, e = unit<double>(1);
    const State<double> psi = propagator.advance(zero, e, kFlat, 0);
    EXPECT_NEAR(psi[0], (1.0 - std::cos(w * h)) / (w * w), 1e-12 * h / w);
    EXPECT_NEAR(psi[1], std::sin(w * h) / w, 1e-12 / w);
    const State<double> xi = propagator.advance(zero, zero, kRising, 0);
    EXPECT_NEAR(xi[1], (1.0 - std::cos(w * h)) / (w * w), 1e-12 * h / w);
  }
}

TEST(Propagator, OfANilpotentMatrixIsAPolynomial) {
  Matrix<double> a{};
  for (std::size_t i = 0; i + 1 < kStates; ++i) a[i][i + 1] = 3.0;
  constexpr double h = 0.5;
  for (const int least : {0, 5}) {
    Propagator<double> propagator = with_ramp(a, step_levels_for(a, h, least), kStates - 1);
    const State<double> zero{}, e = unit<double>(kStates - 1);
    const State<double> psi = propagator.advance(zero, e, kFlat, 0);
    const State<double> xi = propagator.advance(zero, zero, kRising, 0);
    double term = h;  // h^(n+1) 3^n / (n+1)!
    for (std::size_t n = 0; n < kStates; ++n) {
      EXPECT_NEAR(psi[kStates - 1 - n] / term, 1.0, 1e-14) << n;
      EXPECT_NEAR(xi[kStates - 1 - n] / (term * h / (static_cast<double>(n) + 2.0)), 1.0, 1e-14);
      term *= 3.0 * h / (static_cast<double>(n) + 2.0);
    }
  }
}

TEST(StepLevels, FindsNoRateInAChainOfIntegrators) {
  // As far as the eighth power sees it, which is further than any chain of the axis goes. A longer
  // one is taken to be fast; that costs steps, not accuracy, see OfANilpotentMatrixIsAPolynomial.
  static_assert(kPaperStates < 8);
  for (std::size_t length = 1; length <= 8; ++length) {
    Matrix<double> a{};
    for (std::size_t i = 0; i + 1 < length; ++i) a[i][i + 1] = 3e3;
    EXPECT_EQ(step_levels_for(a, 0.5, 0).resolved, 0) << length;
  }
}

TEST(Propagator, OfZeroIsTheIdentity) {
  const Matrix<double> a{};
  expect_exact(a, 0.01, 0, 1e-15);
  expect_exact(a, 0.01, 12, 1e-15);
}

TEST(Propagator, OfRandomMatricesIsExact) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int n = 0; n < 5; ++n) {
    Matrix<double> a{};
    for (State<double>& row : a)
      for (double& x : row) x = 200.0 * normal(random);
    for (std::size_t i = 0; i < kStates; ++i) a[i][i] -= 600.0;
    expect_exact(a, 1e-3, n, 1e-13);
  }
}

/// A matrix like that of the axis: slow, oscillating and stiff parts coupled across very different
/// units, with a fast eigenvalue near -rate.
Matrix<double> stiff_matrix(double rate) {
  Matrix<double> a{};
  a[0][1] = 1.0;
  a[1] = {-3e4, -10.0, 200.0, 0.06, 0.0, 0.0, 0.0};
  a[2][3] = 1.0;
  a[3] = {3e7, 1e4, -2e5, -60.0, 0.0, 0.0, 340.0};
  a[4][5] = 1.0;
  a[5] = {0.0, 0.0, 0.0, -9e6, -1.6e5, -6.3e3, 0.0};
  a[6] = {0.0, 0.0, 0.0, -123.0, 3.0 * rate, 0.02 * rate, -rate};
  return a;
}

TEST(Propagator, OfStiffMatricesIsExact) {
  for (const double rate : {1e3, 1e5, 1e8}) {
    SCOPED_TRACE(rate);
    expect_exact(stiff_matrix(rate), 0.5e-3, 0, 1e-11);
  }
}

TEST(Propagator, StepsCompose) {
  // Two steps of half the length are one, with a slope in time as well.
  const Matrix<double> a = stiff_matrix(1e5);
  const State<double> y{0.1, 0.2, 15.0, 30.0, 2.0, -50.0, 3.0};
  Propagator<double> propagator(a, step_levels_for(a, 0.5e-3, 3),
                                {{0, State<double>{0.0, 1.0, 2.0, 3.0, 0.0, 0.0, 7.0}},
                                 {2, State<double>{0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0}}});
  constexpr Slopes slope{1.0, 100.0, 5.0};  // of the second there is no ramp
  const auto rate = [&](const State<double>& at, double t) {
    State<double> f = propagator.a_times(at);
    propagator.add_ramps(f, slope, t);
    return f;
  };
  const double half = propagator.step_levels().length(1);
  const State<double> once = propagator.advance(y, rate(y, 0.0), slope, 0);
  const State<double> middle = propagator.advance(y, rate(y, 0.0), slope, 1);
  const State<double> twice = propagator.advance(middle, rate(middle, half), slope, 1);
  for (std::size_t i = 0; i < kStates; ++i)
    EXPECT_NEAR(twice[i], once[i], 1e-11 * (std::abs(once[i]) + std::abs(y[i]))) << i;
}

TEST(Propagator, CarriesDerivatives) {
  using J = ceres::Jet<double, 1>;
  const State<double> y{0.1, 0.2, 15.0, 30.0, 2.0, -50.0, 3.0};
  // By an entry of the stiff row, of the oscillator, and by one that is zero.
  for (const auto& [row, column, size] :
       {std::tuple<std::size_t, std::size_t, double>{6, 6, 1e5}, {1, 0, 3e4}, {2, 6, 1.0}}) {
    SCOPED_TRACE(testing::Message() << row << " " << column);
    const auto step = [&](auto a) {
      using T = std::decay_t<decltype(a[0][0])>;
      State<T> start;
      for (std::size_t i = 0; i < kStates; ++i) start[i] = T(y[i]);
      Propagator<T> propagator = with_ramp(a, step_levels_for(a, 0.5e-3, 0), 5);
      return propagator.advance(start, propagator.a_times(start), {5.0, 0.0}, 0);
    };
    const auto at = [&, row = row, column = column](double change) {
      Matrix<double> a = stiff_matrix(1e5);
      a[row][column] += change;
      return step(a);
    };
    Matrix<J> differentiated;
    const Matrix<double> plain = stiff_matrix(1e5);
    for (std::size_t i = 0; i < kStates; ++i)
      for (std::size_t j = 0; j < kStates; ++j) differentiated[i][j] = J(plain[i][j]);
    differentiated[row][column].v[0] = 1.0;
    const State<J> result = step(differentiated);
    // Fourth-order central difference.
    const double d = 1e-3 * size;
    const State<double> p1 = at(d), m1 = at(-d), p2 = at(2.0 * d), m2 = at(-2.0 * d);
    for (std::size_t i = 0; i < kStates; ++i) {
      const double expected = (8.0 * (p1[i] - m1[i]) - (p2[i] - m2[i])) / (12.0 * d);
      const double rounding = 1e-11 * (std::abs(p1[i]) + std::abs(y[i])) / d;
      EXPECT_NEAR(result[i].v[0], expected, 1e-8 * std::abs(expected) + rounding) << i;
    }
  }
}

TEST(StepLevels, ReachesDownToTheFastestMotion) {
  for (const double rate : {1e2, 1e5, 1e8}) {
    const Matrix<double> a = stiff_matrix(rate);
    const StepLevels step_levels = step_levels_for(a, 0.5e-3, 0);
    const double fastest = std::max(rate, 6e3);
    EXPECT_LE(step_levels.length(step_levels.resolved) * fastest, 2.0) << rate;
    EXPECT_GE(step_levels.length(step_levels.resolved) * fastest, 0.05) << rate;
    EXPECT_EQ(step_levels.last, step_levels.resolved);
    EXPECT_EQ(step_levels_for(a, 0.5e-3, 40).last, 40);
  }
}

}  // namespace
}  // namespace axisfit
