#include "base/suggest.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace axisfit {
namespace {

TEST(Nearest, FindsTypicalTypingErrors) {
  const std::vector<std::string> names = {"time", "position", "velocity", "motor_current"};
  EXPECT_EQ(closest_match("tiem", names), "time");                    // swapped
  EXPECT_EQ(closest_match("velocty", names), "velocity");             // left out
  EXPECT_EQ(closest_match("possition", names), "position");           // doubled
  EXPECT_EQ(closest_match("motor_currant", names), "motor_current");  // replaced
  EXPECT_EQ(closest_match("motor-curent", names), "motor_current");
  EXPECT_EQ(closest_match("position", names), "position");
}

TEST(Nearest, ReturnsNothingWhenNothingIsClose) {
  const std::vector<std::string> names = {"time", "position"};
  EXPECT_EQ(closest_match("torque", names), "");
  EXPECT_EQ(closest_match("", names), "");
  EXPECT_EQ(closest_match("time", {}), "");
}

TEST(Nearest, DoesNotTurnShortNamesIntoUnrelatedOnes) {
  const std::vector<std::string> names = {"q", "qdot", "tau"};
  EXPECT_EQ(closest_match("t", names), "");
  EXPECT_EQ(closest_match("tx_", names), "");
  EXPECT_EQ(closest_match("qd", names), "q");
  EXPECT_EQ(closest_match("ta", names), "tau");
  EXPECT_EQ(closest_match("qm", std::vector<std::string>{"mq"}), "mq");  // a swap is one edit
}

TEST(Nearest, AllowsMoreEditsInLongNames) {
  const std::vector<std::string> names = {"viscous_friction"};
  EXPECT_EQ(closest_match("viscosefrixion", names),
            "viscous_friction");  // 5 edits in 16 characters
  EXPECT_EQ(closest_match("viscoelastixxx", names), "");
}

TEST(Nearest, IgnoresCaseBeforeItCountsEdits) {
  const std::vector<std::string> names = {"tine", "TIME"};
  EXPECT_EQ(closest_match("time", names), "TIME");
}

TEST(Nearest, PrefersTheMoreSimilarCaseAndThenTheFirst) {
  EXPECT_EQ(closest_match("Qm", std::vector<std::string>{"QM", "qm", "Qm"}), "Qm");
  EXPECT_EQ(closest_match("timex", std::vector<std::string>{"timea", "timeb"}), "timea");
}

}  // namespace
}  // namespace axisfit
