#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "report/text/report_text.h"
#include "tests/report/found.h"

namespace axisfit {
namespace {

SharedInertia shared(double apart) {
  return {"x", "y", "kg", {4.0, 0.1}, {4.2, 0.2}, {4.04, 0.089}, apart};
}

TEST(CouplingsText, NamesBothAxesAndWhatEachOfThemSays) {
  EXPECT_EQ(on_one_line(couplings_text({shared(0.9)})),
            "Couplings x and y share an inertia of 4.040 +- 0.089 kg: by the recordings of x 4.00 "
            "+- 0.1 kg, by those of y 4.20 +- 0.2 kg, 0.9 standard errors apart.");
}

TEST(CouplingsText, DoubtsWhatIsBeyondFourStandardErrors) {
  const std::string doubt =
      "standard errors apart; that is too far for one inertia: something else goes with these "
      "accelerations.";
  EXPECT_EQ(on_one_line(couplings_text({shared(4.0)})).find(doubt), std::string::npos);
  EXPECT_NE(on_one_line(couplings_text({shared(4.1)})).find("4.1 " + doubt), std::string::npos);
}

TEST(CouplingsText, OfNoneIsNothing) {
  EXPECT_EQ(couplings_text({}), "");
  expect_narrow(couplings_text({shared(0.9), shared(9.0)}));
}

}  // namespace
}  // namespace axisfit
