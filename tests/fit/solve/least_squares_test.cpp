#include "fit/solve/least_squares.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <thread>
#include <vector>

#include "base/parallel.h"
#include "fit/errors/uncertainty.h"

namespace axisfit {
namespace {

/// What was asked of a cost.
struct Asked {
  std::map<double, int> jacobians;  ///< by the first parameter
  std::set<std::thread::id> by;
};

/// exp(u) - target in every of two parameters, slowly.
class Exponential : public ceres::CostFunction {
 public:
  Exponential(double target, Asked& asked) : target_(target), asked_(asked) {
    set_num_residuals(2);
    mutable_parameter_block_sizes()->push_back(2);
  }
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    asked_.by.insert(std::this_thread::get_id());
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const bool with_jacobian = jacobians != nullptr && jacobians[0] != nullptr;
    if (with_jacobian) ++asked_.jacobians[parameters[0][0]];
    for (int i = 0; i < 2; ++i) {
      residuals[i] = std::exp(parameters[0][i]) - target_ * (i + 1);
      if (with_jacobian)
        for (int k = 0; k < 2; ++k)
          jacobians[0][2 * i + k] = i == k ? std::exp(parameters[0][i]) : 0.0;
    }
    return true;
  }

 private:
  double target_;
  Asked& asked_;
};

ParameterSpace two_parameters() {
  FreeParameter p;
  p.lower = -10.0;
  p.upper = 10.0;
  static const std::vector<FreeParameter> list{p, p};
  return ParameterSpace(list);
}

Costs costs_of(std::vector<Asked>& asked) {
  Costs costs;
  for (std::size_t i = 0; i < asked.size(); ++i)
    costs.push_back(std::make_unique<Exponential>(2.0 + 0.1 * static_cast<double>(i), asked[i]));
  return costs;
}

TEST(LeastSquares, AsksForAJacobianOncePerPoint) {
  std::vector<Asked> asked(2);
  const SolveResult result =
      minimize(two_parameters(), costs_of(asked), Eigen::Vector2d(3.0, 3.0), {});
  ASSERT_TRUE(result.converged);
  EXPECT_NEAR(result.u[0], std::log(2.05), 1e-6);
  EXPECT_NEAR(result.u[1], std::log(4.1), 1e-6);
  for (const Asked& a : asked) {
    EXPECT_GT(a.jacobians.size(), 4u);
    for (const auto& [u, times] : a.jacobians) EXPECT_EQ(times, 1) << u;
  }
}

/// The cubes of both parameters and one, which is left; a step takes away a third of a parameter.
class Cubes : public ceres::CostFunction {
 public:
  Cubes() {
    set_num_residuals(3);
    mutable_parameter_block_sizes()->push_back(2);
  }
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    residuals[2] = 1.0;
    for (int i = 0; i < 2; ++i) residuals[i] = std::pow(parameters[0][i], 3);
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    std::fill_n(jacobians[0], 6, 0.0);
    for (int i = 0; i < 2; ++i) jacobians[0][3 * i] = 3.0 * std::pow(parameters[0][i], 2);
    return true;
  }
};

TEST(LeastSquares, GivesUpWhatWouldNotComeBelowACost) {
  const auto solved = [](double give_up_above) {
    Costs costs;
    costs.push_back(std::make_unique<Cubes>());
    SolveOptions options;
    options.function_tolerance = 1e-15;
    options.give_up_above = give_up_above;
    return minimize(two_parameters(), std::move(costs), Eigen::Vector2d(3.0, 3.0), options);
  };
  const SolveResult whole = solved(1e9), given_up = solved(0.3);
  ASSERT_TRUE(whole.converged);
  EXPECT_NEAR(whole.reduced_cost, 1.0 / 3.0, 1e-6);
  EXPECT_EQ(solved(0.34).iterations, whole.iterations);
  EXPECT_TRUE(given_up.usable);
  EXPECT_FALSE(given_up.converged);
  EXPECT_LT(given_up.iterations, whole.iterations);
}

TEST(LeastSquares, GivesUpWhatPromisesTooLittle) {
  const auto solved = [](double start, double give_up_above) {
    Costs costs;
    costs.push_back(std::make_unique<Cubes>());
    SolveOptions options;
    options.function_tolerance = 1e-15;
    options.give_up_above = give_up_above;
    return minimize(two_parameters(), std::move(costs), Eigen::Vector2d(start, start), options);
  };
  // From x = 1.2 steps lead to 0.8, 0.53 and 0.36. There the cost is 0.5 + x^6, and the linearised
  // costs promise x^6: five times as much would lead to 0.5 - 4 x^6 = 0.49.
  EXPECT_FALSE(solved(1.2, 0.32).converged);
  EXPECT_LE(solved(1.2, 0.32).iterations, 4);  // the start is the first of them
  EXPECT_GT(solved(1.2, 0.34).iterations, 8);
}

/// A first parameter that 1 would suit best, in noise of the size 1; but from `jump` on another
/// residual is five of these.
class Jumping : public ceres::CostFunction {
 public:
  Jumping(double jump, int* evaluations) : jump_(jump), evaluations_(evaluations) {
    set_num_residuals(102);
    mutable_parameter_block_sizes()->push_back(2);
  }
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    ++*evaluations_;
    std::fill_n(residuals, 102, 1.0);
    residuals[0] = 10.0 * (parameters[0][0] - 1.0);
    residuals[1] = 10.0 * parameters[0][1];
    if (parameters[0][0] > jump_) residuals[2] = 5.0;
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    std::fill_n(jacobians[0], 204, 0.0);
    jacobians[0][0] = jacobians[0][3] = 10.0;
    return true;
  }

 private:
  double jump_;
  int* evaluations_;
};

struct Solved {
  SolveResult result;
  int evaluations = 0;
};

Solved solved_before(double jump, bool jumps) {
  Solved solved;
  Costs costs;
  costs.push_back(std::make_unique<Jumping>(jump, &solved.evaluations));
  SolveOptions options;
  options.function_tolerance = 1e-12;
  options.jumps = jumps;
  solved.result =
      minimize(two_parameters(), std::move(costs), Eigen::Vector2d(jump - 0.02, 0.001), options);
  return solved;
}

// A tenth of a standard error before the minimum, and one before it.
TEST(LeastSquares, EndsBeforeAJumpThatBarsLittle) {
  const Solved little = solved_before(0.99, true), more = solved_before(0.9, true);
  EXPECT_TRUE(little.result.usable && little.result.converged);
  EXPECT_LT(little.result.u[0], 0.99);
  EXPECT_LE(little.evaluations, 8);
  EXPECT_GE(solved_before(0.99, false).evaluations, 30);
  EXPECT_NEAR(more.result.u[0], 0.9, 1e-3);
  EXPECT_EQ(more.evaluations, solved_before(0.9, false).evaluations);
  EXPECT_NEAR(solved_before(10.0, true).result.u[0], 1.0, 1e-6);
}

TEST(LeastSquares, KnowsTheJacobianAtItsSolution) {
  std::vector<Asked> asked(2);
  const ParameterSpace space = two_parameters();
  const SolveResult solved = minimize(space, costs_of(asked), Eigen::Vector2d(3.0, 3.0), {});
  ASSERT_TRUE(solved.at_solution);
  const Linearization expected = linearize(space, costs_of(asked), solved.u);
  EXPECT_EQ(solved.at_solution->residuals, expected.residuals);
  EXPECT_EQ(solved.at_solution->jacobian, expected.jacobian);
  EXPECT_TRUE(solved.at_solution->finite);
}

// At the minimum exp(u) = 2.05 and 4.1 the residuals are +-0.05 and +-0.1.
TEST(LeastSquares, ReducedCostIsTheMeanSquareOfTheResiduals) {
  std::vector<Asked> asked(2);
  const SolveResult result =
      minimize(two_parameters(), costs_of(asked), Eigen::Vector2d(1.0, 1.0), {});
  ASSERT_TRUE(result.converged);
  EXPECT_NEAR(result.cost, 0.0125, 1e-9);
  EXPECT_NEAR(result.reduced_cost, 0.025 / 4.0, 1e-9);
}

// On a logarithmic scale, too: a parameter that nothing else shows is as uncertain as its prior.
TEST(LeastSquares, APriorIsAMeasurementOfTheValue) {
  FreeParameter p;
  p.lower = 0.01;
  p.upper = 10.0;
  p.prior = Prior{0.5, 0.02};
  const std::vector<FreeParameter> list{p};
  const ParameterSpace space(list);
  const Eigen::VectorXd start = Eigen::VectorXd::Constant(1, std::log(0.6));
  const Linearization away = linearize(space, {}, start);
  EXPECT_NEAR(away.residuals[0], 5.0, 1e-12);
  EXPECT_NEAR(away.jacobian(0, 0), 0.6 / 0.02, 1e-12);

  const SolveResult solved = minimize(space, {}, start, {});
  ASSERT_TRUE(solved.converged);
  EXPECT_NEAR(std::exp(solved.u[0]), 0.5, 1e-6);
  Linearization at = linearize(space, {}, solved.u);
  at.series.clear();
  EXPECT_NEAR(uncertainty(space, solved.u, at).parameters[0].standard_error, 0.02, 1e-6);
}

TEST(LeastSquares, IsTheSameSideBySide) {
  std::vector<SolveResult> solved;
  std::vector<Linearization> linear;
  for (const int threads : {1, 3}) {
    std::vector<Asked> asked(3);
    const ThreadPool pool(threads);
    const ParameterSpace space = two_parameters();
    solved.push_back(minimize(space, costs_of(asked), Eigen::Vector2d(3.0, 3.0), {}));
    linear.push_back(linearize(space, costs_of(asked), solved.back().u));
    std::set<std::thread::id> by;
    for (const Asked& a : asked) by.insert(a.by.begin(), a.by.end());
    EXPECT_EQ(by.size() > 1, threads > 1);
  }
  EXPECT_EQ(solved[0].u, solved[1].u);
  EXPECT_EQ(solved[0].cost, solved[1].cost);
  EXPECT_EQ(solved[0].iterations, solved[1].iterations);
  EXPECT_EQ(linear[0].residuals, linear[1].residuals);
  EXPECT_EQ(linear[0].jacobian, linear[1].jacobian);
  EXPECT_EQ(linear[0].residuals.size(), 6);
}

}  // namespace
}  // namespace axisfit
