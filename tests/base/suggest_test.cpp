#include "base/suggest.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace axisfit {
namespace {

TEST(Nearest, FindsTypicalTypingErrors) {
  const std::vector<std::string> names = {"time", "position", "velocity", "motor_current"};
  EXPECT_EQ(nearest("tiem", names), "time");                    // swapped
  EXPECT_EQ(nearest("velocty", names), "velocity");             // left out
  EXPECT_EQ(nearest("possition", names), "position");           // doubled
  EXPECT_EQ(nearest("motor_currant", names), "motor_current");  // replaced
  EXPECT_EQ(nearest("motor-curent", names), "motor_current");
  EXPECT_EQ(nearest("position", names), "position");
}

TEST(Nearest, ReturnsNothingWhenNothingIsClose) {
  const std::vector<std::string> names = {"time", "position"};
  EXPECT_EQ(nearest("torque", names), "");
  EXPECT_EQ(nearest("", names), "");
  EXPECT_EQ(nearest("time", {}), "");
}

TEST(Nearest, DoesNotTurnShortNamesIntoUnrelatedOnes) {
  const std::vector<std::string> names = {"q", "qdot", "tau"};
  EXPECT_EQ(nearest("t", names), "");
  EXPECT_EQ(nearest("tx_", names), "");
  EXPECT_EQ(nearest("qd", names), "q");
  EXPECT_EQ(nearest("ta", names), "tau");
  EXPECT_EQ(nearest("qm", std::vector<std::string>{"mq"}), "mq");  // a swap is one edit
}

TEST(Nearest, AllowsMoreEditsInLongNames) {
  const std::vector<std::string> names = {"viscous_friction"};
  EXPECT_EQ(nearest("viscosefrixion", names), "viscous_friction");  // 5 edits in 16 characters
  EXPECT_EQ(nearest("viscoelastixxx", names), "");
}

TEST(Nearest, IgnoresCaseBeforeItCountsEdits) {
  const std::vector<std::string> names = {"tine", "TIME"};
  EXPECT_EQ(nearest("time", names), "TIME");
}

TEST(Nearest, PrefersTheMoreSimilarCaseAndThenTheFirst) {
  EXPECT_EQ(nearest("Qm", std::vector<std::string>{"QM", "qm", "Qm"}), "Qm");
  EXPECT_EQ(nearest("timex", std::vector<std::string>{"timea", "timeb"}), "timea");
}

}  // namespace
}  // namespace axisfit
