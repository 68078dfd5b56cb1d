#include "init/columns/unnamed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <vector>

namespace axisfit {
namespace {

TEST(UnnamedColumns, AreToldByDerivativesAndByTheForceBalance) {
  std::vector<double> times, force, position, velocity;
  double x = 0.0, v = 0.0;
  constexpr double kStep = 1e-3, kMass = 3.0, kViscous = 4.0;
  for (int i = 0; i < 4000; ++i) {
    const double t = kStep * i, f = 9.0 * std::sin(5.0 * t) + 6.0 * std::cos(13.0 * t);
    times.push_back(t);
    force.push_back(f);
    position.push_back(x);
    velocity.push_back(v);
    v += kStep * (f - kViscous * v) / kMass;
    x += kStep * v;
  }
  ColumnSet none;
  const auto found = infer_unnamed(times, none, {{4, force}, {2, velocity}, {7, position}});
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].place, 7u);
  EXPECT_EQ(found[0].kind, Kind::position);
  EXPECT_EQ(found[1].place, 2u);
  EXPECT_EQ(found[1].kind, Kind::velocity);
  EXPECT_EQ(found[2].place, 4u);
  EXPECT_EQ(found[2].kind, Kind::command);
  // What is known already is not looked for.
  ColumnSet known;
  known[{Kind::position, false}].raw = position;
  known[{Kind::current, false}].raw = force;
  EXPECT_TRUE(infer_unnamed(times, known, {{2, velocity}}).empty());
}

TEST(UnnamedColumns, WithoutAMotionSayNothing) {
  std::vector<double> times, a, b;
  for (int i = 0; i < 500; ++i) {
    times.push_back(i);
    a.push_back(std::sin(double(i * i)));
    b.push_back(std::cos(double(3 * i * i)));
  }
  ColumnSet none;
  EXPECT_TRUE(infer_unnamed(times, none, {{0, a}, {1, b}}).empty());
}

}  // namespace
}  // namespace axisfit
