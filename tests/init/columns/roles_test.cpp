#include "init/columns/roles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace axisfit {
namespace {

using Values = std::vector<double>;
constexpr std::size_t kSamples = 600;

/// A slow swing, some samples late and with noise.
Values swing(double size, double late = 0.0, double noise = 0.0, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Values values;
  for (std::size_t i = 0; i < kSamples; ++i)
    values.push_back(size * std::sin(0.03 * (double(i) - late)) + noise * normal(random));
  return values;
}

Candidate candidate(const std::string& name, Values values) {
  return {0, name, *guess_column(name), std::move(values)};
}

std::vector<std::string> names_of(const std::vector<Candidate>& candidates) {
  std::vector<std::string> names;
  for (const Candidate& c : candidates) names.push_back(c.shown);
  return names;
}

/// Position and current of two motors, called so.
std::vector<Candidate> two_motors(const std::string& first, const std::string& second,
                                  double motion_of_second) {
  return {candidate(first + " position", swing(1.0)),
          candidate(second + " position", swing(motion_of_second, 0.0, 1e-4)),
          candidate(first + " current", swing(3.0, 9.0)),
          candidate(second + " current", swing(3.0, 40.0))};
}

std::string refusal(std::vector<Candidate> candidates, const std::string& motor = {}) {
  std::vector<std::string> others;
  try {
    keep_one_axis(candidates, motor, others);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "none";
}

TEST(AxesOfAFile, GoByNumberPrefixAndWhatMoves) {
  for (const auto& [first, second] :
       {std::pair("motor 0", "motor 1"), {"left", "right"}, {"x", "y"}, {"Axis[1]", "Axis[2]"}}) {
    std::vector<Candidate> list = two_motors(first, second, 0.0);
    std::vector<std::string> others;
    EXPECT_EQ(keep_one_axis(list, "", others), words_of(first).back()) << first;
    EXPECT_EQ(names_of(list), (std::vector<std::string>{std::string(first) + " position",
                                                        std::string(first) + " current"}));
    EXPECT_EQ(others.size(), 2u);
  }
}

TEST(AxesOfAFile, AreAskedForWhereSeveralMove) {
  EXPECT_EQ(
      refusal(two_motors("elbow", "wrist", 0.7)),
      "the columns are of several axes: elbow (elbow position, elbow current); wrist (wrist "
      "position, wrist current). Say which by --motor, and make a job for each in a folder of "
      "its own: --motor \"elbow\" --output \"elbow\"");
  EXPECT_EQ(refusal(two_motors("elbow", "wrist", 0.7), "ankle").find("--motor ankle: there are"),
            0u);
  for (const char* motor : {"elbow", "wrist", "Wrist"}) {
    std::vector<Candidate> list = two_motors("elbow", "wrist", 0.7);
    std::vector<std::string> others;
    EXPECT_EQ(plain(motor), keep_one_axis(list, motor, others));
    EXPECT_EQ(list.size(), 2u);
  }
  // Both are named by the user.
  std::vector<Candidate> answered = two_motors("elbow", "wrist", 0.7);
  answered[1].is_answered = answered[3].is_answered = true;
  std::vector<std::string> others;
  EXPECT_EQ(keep_one_axis(answered, "", others), "");
  EXPECT_EQ(names_of(answered), (std::vector<std::string>{"wrist position", "wrist current"}));
}

TEST(AxesOfAFile, NeedAMotionAndADriveEach) {
  std::vector<Candidate> list{
      candidate("position", swing(1.0)), candidate("velocity raw", swing(1.0)),
      candidate("load position", swing(1.0)), candidate("motor current", swing(1.0))};
  EXPECT_TRUE(axes_in(list).empty());
  std::vector<std::string> others;
  EXPECT_EQ(keep_one_axis(list, "", others), "");
  EXPECT_EQ(list.size(), 4u);
  EXPECT_NE(refusal(list, "2").find("no columns are named after such an axis"), std::string::npos);
}

TEST(AxesOfAFile, OneAxisWithItsOwnDriveComesFirst) {
  std::vector<Candidate> list{candidate("motor 1 position", swing(1.0)),
                              candidate("motor 2 position", swing(1.0)),
                              candidate("motor 2 current", swing(1.0))};
  std::vector<std::string> others;
  keep_one_axis(list, "", others);
  EXPECT_LT(list[0].name.rank, list[1].name.rank);
}

TEST(References, LeadAndHaveNoNoise) {
  const Values reference = swing(1.0), late = swing(0.98, 4.0, 2e-3),
               early = swing(1.0, -4.0, 2e-3);
  EXPECT_TRUE(is_reference_of(reference, late));
  EXPECT_FALSE(is_reference_of(late, reference));
  EXPECT_FALSE(is_reference_of(reference, early)) << "it follows";
  EXPECT_FALSE(is_reference_of(swing(1.0, 0.0, 2e-3, 2), late)) << "both have noise";
  Values other = reference;
  std::ranges::reverse(other);
  EXPECT_FALSE(is_reference_of(other, swing(1.0, 300.0, 2e-3)) &&
               is_reference_of(Values(kSamples, 1.0), late));
  std::vector<Candidate> list{candidate("pos 1", reference), candidate("pos 2", late)};
  tell_references(list);
  EXPECT_TRUE(list[0].name.is_setpoint);
  EXPECT_FALSE(list[1].name.is_setpoint);
}

TEST(References, AreNoneThatANameOrTheUserCallsMeasured) {
  std::vector<Candidate> list{candidate("actual pos", swing(1.0)),
                              candidate("pos", swing(1.0, 4.0, 2e-3))};
  tell_references(list);
  EXPECT_FALSE(list[0].name.is_setpoint);
  list = {candidate("pos 1", swing(1.0)), candidate("pos 2", swing(1.0, 4.0, 2e-3))};
  list[0].is_answered = true;
  tell_references(list);
  EXPECT_FALSE(list[0].name.is_setpoint);
}

TEST(Sides, TheEncoderGoesWithTheTorque) {
  std::vector<Candidate> of_joint{candidate("motor position", swing(100.0)),
                                  candidate("joint position", swing(1.0)),
                                  candidate("joint torque", swing(1.0))};
  tell_sides(of_joint);
  EXPECT_LT(of_joint[0].name.rank, of_joint[1].name.rank);
  EXPECT_EQ(of_joint[1].name.kind, Kind::position);
  std::vector<Candidate> of_motor{candidate("motor position", swing(100.0)),
                                  candidate("load position", swing(1.0)),
                                  candidate("motor current", swing(1.0))};
  tell_sides(of_motor);
  EXPECT_EQ(of_motor[0].name.kind, Kind::position);
  EXPECT_EQ(of_motor[1].name.kind, Kind::load_position);
  std::vector<Candidate> alone{candidate("load position", swing(1.0))};
  tell_sides(alone);
  EXPECT_EQ(alone[0].name.kind, Kind::position);
}

TEST(RawCounts, ComeBehindWhatIsScaled) {
  Values counts = swing(4096.0);
  for (double& x : counts) x = std::floor(x);
  std::vector<Candidate> list{candidate("encoder position", counts),
                              candidate("position", swing(1.0))};
  const int before = list[1].name.rank;
  rank_raw_last(list);
  EXPECT_LT(list[0].name.rank, list[1].name.rank);
  EXPECT_EQ(list[1].name.rank, before);
  list.pop_back();
  const int alone = list[0].name.rank;
  rank_raw_last(list);
  EXPECT_EQ(list[0].name.rank, alone);
}

}  // namespace
}  // namespace axisfit
