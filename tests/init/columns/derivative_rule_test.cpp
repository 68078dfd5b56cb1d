#include "init/columns/derivative_rule.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace axisfit {
namespace {

constexpr double kPi = 3.14159265358979;

UnscaledColumn column(Kind kind, const std::string& unit, std::vector<double> raw) {
  UnscaledColumn made;
  made.column.kind = kind;
  made.column.column = unit.empty() ? "it" : unit;
  made.raw = std::move(raw);
  made.named = unit;
  if (const auto known = stored_unit(kind, unit)) made.set_unit(*known);
  return made;
}

/// A swing of 0.2 rad or m, its velocity and acceleration, each times a factor.
struct Swing {
  UnscaledColumn time;
  ColumnSet columns;

  Swing(const std::string& position_unit, double position, const std::string& velocity_unit,
        double velocity, const std::string& time_unit = "s", double per_second = 1.0) {
    std::vector<double> t, x, v, a;
    for (int i = 0; i < 400; ++i) {
      const double at = 0.005 * i;
      t.push_back(at * per_second);
      x.push_back(position * 0.2 * std::sin(3.0 * at));
      v.push_back(velocity * 0.6 * std::cos(3.0 * at));
      a.push_back(-1.8 * std::sin(3.0 * at));
    }
    time = column(Kind::time, time_unit, t);
    columns[{Kind::position, false}] = column(Kind::position, position_unit, x);
    columns[{Kind::velocity, false}] = column(Kind::velocity, velocity_unit, v);
    columns[{Kind::acceleration, false}] = column(Kind::acceleration, "", a);
  }
  UnscaledColumn& position() { return *columns.find(Kind::position); }
  UnscaledColumn& velocity() { return *columns.find(Kind::velocity); }
  UnscaledColumn& acceleration() { return *columns.find(Kind::acceleration); }
};

TEST(DerivativeRule, OneOfTwoTellsTheOtherOnItsOwnJoint) {
  Swing turns("deg", 180.0 / kPi, "", 30.0 / kPi);
  size_motion_by_derivative(turns.time, turns.columns);
  EXPECT_EQ(turns.velocity().column.unit, "rpm");
  EXPECT_FALSE(turns.velocity().column.guessed);
  Swing slides("", 1e3, "m/s", 1.0);
  size_motion_by_derivative(slides.time, slides.columns);
  EXPECT_EQ(slides.position().column.unit, "mm");
  // A radian is no metre.
  Swing whole("", 1.0, "rad/s", 1.0);
  size_motion_by_derivative(whole.time, whole.columns);
  EXPECT_EQ(whole.position().column.unit, "rad");
}

TEST(DerivativeRule, AWrongHeaderIsCorrectedButNoAnswer) {
  Swing wrong("mm", 1e3, "m/s", 1e3);
  size_motion_by_derivative(wrong.time, wrong.columns);
  EXPECT_EQ(wrong.velocity().column.unit, "mm/s");
  EXPECT_TRUE(wrong.velocity().column.guessed);
  Swing answered("mm", 1e3, "m/s", 1e3);
  answered.velocity().answered = true;
  size_motion_by_derivative(answered.time, answered.columns);
  EXPECT_EQ(answered.velocity().column.unit, "m/s");
}

TEST(DerivativeRule, AFactorThatNoUnitExplainsIsAContradiction) {
  Swing scaled("m", 1.0, "m/s", 0.8);
  size_motion_by_derivative(scaled.time, scaled.columns);
  EXPECT_EQ(scaled.velocity().column.unit, "m/s");
  EXPECT_EQ(scaled.velocity().column.factor, 1.0);
  EXPECT_TRUE(scaled.velocity().column.contradicts);
  EXPECT_TRUE(scaled.velocity().column.guessed);
  EXPECT_FALSE(scaled.position().column.contradicts);
}

TEST(DerivativeRule, ASignIsTurnedAndSaid) {
  Swing swing("m", 1.0, "", -1.0);
  size_motion_by_derivative(swing.time, swing.columns);
  EXPECT_TRUE(swing.velocity().column.negative);
  EXPECT_TRUE(swing.velocity().column.guessed);
  size_acceleration_by_derivative(swing.time, swing.columns);
  EXPECT_FALSE(swing.acceleration().column.negative);
  EXPECT_EQ(swing.acceleration().column.unit, "m/s^2");
}

TEST(DerivativeRule, AVelocityTellsWhatACountIs) {
  Swing known("counts", 4096.0 / (2.0 * kPi), "rad/s", 1.0);
  size_motion_by_derivative(known.time, known.columns);
  EXPECT_NEAR(known.position().size, 2.0 * kPi / 4096.0, 1e-6);
  EXPECT_EQ(known.position().joint, Joint::revolute);
  EXPECT_EQ(known.velocity().column.unit, "rad/s");
  // Beside counts of unknown size there are counts per second.
  Swing open("counts", 4096.0, "", 4096.0);
  size_motion_by_derivative(open.time, open.columns);
  EXPECT_EQ(open.velocity().column.stored, "counts/s");
}

TEST(DerivativeRule, ALengthAndAnAngleAreNotCompared) {
  Swing screw("mm", 5.0, "rpm", 700.0);
  size_motion_by_derivative(screw.time, screw.columns);
  EXPECT_EQ(screw.velocity().column.unit, "rpm");
  EXPECT_EQ(screw.position().column.unit, "mm");
}

TEST(DerivativeRule, AVelocityOfAnotherAxisIsAskedAbout) {
  Swing swing("m", 1.0, "m/s", 1.0);
  std::vector<double>& raw = swing.velocity().raw;
  for (std::size_t i = 0; i < raw.size(); ++i) raw[i] = std::sin(0.9 * std::sqrt(double(i)));
  size_motion_by_derivative(swing.time, swing.columns);
  ASSERT_EQ(swing.velocity().column.reasons.size(), 1u);
  EXPECT_NE(swing.velocity().column.reasons[0].find("is it from the same axis?"),
            std::string::npos);
}

TEST(DerivativeRule, MotionTellsTheUnitOfTheTime) {
  Swing swing("mm", 1e3, "m/s", 1.0, "", 1e6);
  EXPECT_TRUE(size_time_by_motion(swing.time, swing.columns));
  EXPECT_EQ(swing.time.column.unit, "us");
  Swing open("", 1e3, "m/s", 1.0, "", 1e6);
  EXPECT_FALSE(size_time_by_motion(open.time, open.columns));
}

TEST(DerivativeRule, APositionAloneTellsTheAcceleration) {
  Swing swing("mm", 1e3, "", 1.0);
  swing.columns.erase({Kind::velocity, false});
  size_acceleration_by_derivative(swing.time, swing.columns);
  EXPECT_EQ(swing.acceleration().column.unit, "m/s^2");
}

TEST(DerivativeAt, IsThatOfALineInside) {
  EXPECT_EQ(derivative_at({0, 1, 3, 4}, {0, 2, 6, 8}), (std::vector<double>{2, 2, 2, 2}));
}

}  // namespace
}  // namespace axisfit
