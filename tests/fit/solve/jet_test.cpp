#include "fit/solve/jet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "tests/sim/axes.h"

namespace axisfit {
namespace {

std::vector<std::size_t> columns_up_to(std::size_t n) {
  std::vector<std::size_t> columns(n);
  std::iota(columns.begin(), columns.end(), 10);  // not their own places
  return columns;
}

TEST(EvaluateColumns, CoversEachOnceAndBeginsOnce) {
  for (std::size_t n = 0; n <= 25; ++n) {
    const std::vector<std::size_t> all = columns_up_to(n);
    std::vector<std::size_t> covered;
    std::size_t passes = 0, first = 0;
    EXPECT_TRUE(
        evaluate_columns(all, [&]<class Jet>(std::span<const std::size_t> columns, bool is_first) {
          covered.insert(covered.end(), columns.begin(), columns.end());
          ++passes;
          first += is_first ? 1 : 0;
          constexpr std::size_t kWidth = Jet::DIMENSION;
          EXPECT_LE(columns.size(), kWidth) << n;
          EXPECT_TRUE(columns.size() + 2 > kWidth || kWidth == 2) << n;  // the narrowest
          return true;
        }));
    EXPECT_EQ(covered, all);  // without a thread pool they come in order
    EXPECT_EQ(passes, n == 0 ? 1 : (n + 7) / 8) << n;
    EXPECT_EQ(first, 1u) << n;
  }
}

TEST(EvaluateColumns, FailsWithAnyOfItsPasses) {
  const std::vector<std::size_t> all = columns_up_to(17);
  for (const std::size_t bad : all)
    EXPECT_FALSE(evaluate_columns(all, [&]<class Jet>(std::span<const std::size_t> columns, bool) {
      return std::ranges::find(columns, bad) == columns.end();
    })) << bad;
}

TEST(WithDerivatives, SeedsTheSlopesInTheOrderOfTheColumns) {
  const std::vector<FreeParameter> free{free_parameter("M", 20.0), free_parameter("K_f", 3.0),
                                        free_parameter("B_a", 5.0)};
  const ParameterSpace space(free);
  const Eigen::VectorXd u = space.internal({{20.0, 3.0, 5.0}});
  using Jet = ceres::Jet<double, 2>;
  const Model<double> model = driven_mass(20.0);
  const Model<Jet> seeded =
      with_derivatives<Jet>(model, space, u.data(), std::vector<std::size_t>{2, 0});
  EXPECT_EQ(seeded.axis.B_a.v, Eigen::Vector2d(space.slope(2, u[2]), 0.0));
  EXPECT_EQ(seeded.axis.M.v, Eigen::Vector2d(0.0, space.slope(0, u[0])));
  EXPECT_FALSE(ScalarTraits<Jet>::has_derivative(seeded.axis.K_f));
  EXPECT_TRUE(ScalarTraits<Jet>::has_derivative(seeded.axis.M));
  EXPECT_EQ(ScalarTraits<Jet>::value(seeded.axis.M), model.axis.M);
}

}  // namespace
}  // namespace axisfit
