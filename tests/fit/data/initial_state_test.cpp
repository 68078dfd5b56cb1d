#include "fit/data/initial_state.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/base/noise.h"

namespace axisfit {
namespace {

std::vector<double> every_millisecond(std::size_t n) {
  std::vector<double> times(n);
  for (std::size_t i = 0; i < n; ++i) times[i] = 1e-3 * static_cast<double>(i);
  return times;
}

double cubic(double t) { return 2.0 + 3.0 * t - 40.0 * t * t + 500.0 * t * t * t; }
double slope(double t) { return 3.0 - 80.0 * t + 1500.0 * t * t; }

std::vector<double> cubic_at(const std::vector<double>& times) {
  std::vector<double> values;
  for (const double t : times) values.push_back(cubic(t));
  return values;
}

TEST(LocalCourse, OfACubicIsTheCubic) {
  const std::vector<double> times = every_millisecond(40), values = cubic_at(times);
  for (const std::size_t sample : {10u, 15u, 29u}) {
    const LocalCourse course = local_course(times, values, 10, 20, sample);
    EXPECT_NEAR(course.value, values[sample], 1e-10) << sample;
    EXPECT_NEAR(course.slope, slope(times[sample]), 1e-7) << sample;
  }
}

TEST(LocalCourse, LooksAtItsSamplesAlone) {
  const std::vector<double> times = every_millisecond(40);
  std::vector<double> values = cubic_at(times);
  values[9] = values[30] = 1e3;
  EXPECT_NEAR(local_course(times, values, 10, 20, 10).value, cubic(times[10]), 1e-10);
  EXPECT_GT(std::abs(local_course(times, values, 10, 21, 10).value - cubic(times[10])), 1.0);
  EXPECT_NEAR(local_course(times, values, 31, 100, 35).value, cubic(times[35]), 1e-9)
      << "as far as there are any";
}

TEST(LocalCourse, ErrsAsItsErrorsSay) {
  const std::vector<double> times = every_millisecond(20);
  constexpr std::size_t kTrials = 400;
  double value = 0.0, rate = 0.0, value_error = 0.0, slope_error = 0.0;
  for (std::size_t trial = 0; trial < kTrials; ++trial) {
    std::vector<double> values = cubic_at(times);
    Normal normal(trial + 1);
    for (double& x : values) x += 0.01 * normal();
    const LocalCourse course = local_course(times, values, 0, 20, 0);
    value += std::pow(course.value - cubic(0.0), 2) / kTrials;
    rate += std::pow(course.slope - slope(0.0), 2) / kTrials;
    value_error += std::pow(course.value_error, 2) / kTrials;
    slope_error += std::pow(course.slope_error, 2) / kTrials;
  }
  // Four standard errors of a variance from 400 trials: 28 %.
  EXPECT_NEAR(value / value_error, 1.0, 0.28);
  EXPECT_NEAR(rate / slope_error, 1.0, 0.28);
}

TEST(LocalCourse, ErrsByTheStatedNoiseAtLeast) {
  const std::vector<double> times = every_millisecond(20), values = cubic_at(times);
  EXPECT_NEAR(local_course(times, values, 0, 20, 0).value_error, 0.0, 1e-10);
  const LocalCourse one = local_course(times, values, 0, 20, 0, 0.1),
                    two = local_course(times, values, 0, 20, 0, 0.2);
  EXPECT_GT(one.value_error, 0.05);
  EXPECT_NEAR(two.value_error, 2.0 * one.value_error, 1e-9);
  EXPECT_NEAR(two.slope_error, 2.0 * one.slope_error, 1e-7);
}

TEST(LocalCourse, OfFewerThanFourSamplesIsTheSample) {
  const std::vector<double> times = every_millisecond(3), values{5.0, 7.0, 6.0};
  const LocalCourse course = local_course(times, values, 0, 20, 1, 0.1);
  EXPECT_EQ(course.value, 7.0);
  EXPECT_EQ(course.slope, 0.0);
  EXPECT_EQ(course.value_error, 0.1);
  EXPECT_EQ(course.slope_error, 0.0);
}

// A drive that is switched on in the n-th sample makes a corner there.
TEST(FirstCourse, EndsBeforeACorner) {
  const std::vector<double> times = every_millisecond(40);
  for (const std::size_t corner : {1u, 3u, 8u, 15u}) {
    std::vector<double> values;
    Normal normal(corner);
    for (std::size_t i = 0; i < times.size(); ++i)
      values.push_back(5.0 + 30.0 * std::max(0.0, times[i] - times[corner]) + 1e-4 * normal());
    const LocalCourse course = first_course(times, values, 20, 1e-4);
    EXPECT_NEAR(course.value, 5.0, 5e-4) << corner;
    EXPECT_NEAR(course.slope, 0.0, 5.0 * course.slope_error) << corner;
    if (corner == 15) continue;
    EXPECT_GT(std::abs(local_course(times, values, 0, 20, 0, 1e-4).value - 5.0), 1e-3) << corner;
  }
}

TEST(FirstCourse, TakesAllSamplesOfASmoothMotion) {
  const std::vector<double> times = every_millisecond(40);
  std::vector<double> values = cubic_at(times);
  Normal normal(7);
  for (double& x : values) x += 0.01 * normal();
  EXPECT_EQ(first_course(times, values, 20, 0.01).value,
            local_course(times, values, 0, 20, 0, 0.01).value);
}

/// Of position and velocity, which disagree so that they can be told apart.
Recording recording() {
  Recording r;
  r.times = every_millisecond(40);
  Measurement& position = r.measurements.emplace_back();
  position.signal = Signal::position;
  position.values = cubic_at(r.times);
  Measurement& velocity = r.measurements.emplace_back();
  velocity.signal = Signal::velocity;
  velocity.values = std::vector<double>(40, 8.0);
  for (Measurement& m : r.measurements) m.sigma = 0.1;
  return r;
}

std::optional<double> initial(const Recording& r, const char* name) {
  for (const auto& [quantity, value] : r.overrides)
    if (quantity == quantity_index(name)) return value;
  return std::nullopt;
}

TEST(InitialStateFromData, TakesAVelocityThatWasRecorded) {
  Recording r = recording();
  initial_state_from_data(r);
  EXPECT_NEAR(initial(r, "initial.y0").value(), 2.0, 1e-9);
  EXPECT_NEAR(initial(r, "initial.y1").value(), 8.0, 1e-9);
}

TEST(InitialStateFromData, TakesTheSlopeOfThePositionElse) {
  Recording r = recording();
  r.measurements.pop_back();
  initial_state_from_data(r);
  EXPECT_NEAR(initial(r, "initial.y1").value(), 3.0, 1e-6);
}

TEST(InitialStateFromData, LeavesOpenWhatWasNotRecorded) {
  Recording r = recording();
  r.measurements.erase(r.measurements.begin());
  initial_state_from_data(r);
  EXPECT_FALSE(initial(r, "initial.y0"));
  r.measurements[0].signal = Signal::acceleration;
  r.overrides.clear();
  initial_state_from_data(r);
  EXPECT_TRUE(r.overrides.empty());
}

TEST(InitialStateFromData, LeavesAloneWhatIsGiven) {
  Recording r = recording();
  r.overrides = {{quantity_index("initial.y0"), -1.0}};
  initial_state_from_data(r);
  EXPECT_EQ(initial(r, "initial.y0"), -1.0);
  EXPECT_EQ(r.overrides.size(), 2u);
}

TEST(InitialErrors, AreThoseOfAStateFromData) {
  Recording r = recording();
  EXPECT_EQ(initial_errors(r).position, 0.0);
  EXPECT_EQ(initial_errors(r).velocity, 0.0);
  r.initial_state = InitialState::data;
  const LocalCourse start = local_course(r.times, r.measurements[0].values, 0, 20, 0, 0.1);
  EXPECT_EQ(initial_errors(r).position, start.value_error);
  EXPECT_LT(initial_errors(r).velocity, 0.1) << "of the velocity itself";
  r.measurements.pop_back();
  EXPECT_EQ(initial_errors(r).velocity, start.slope_error);
}

}  // namespace
}  // namespace axisfit
