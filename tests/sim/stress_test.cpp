#include "tests/sim/stress.h"

namespace axisfit {
namespace {

TEST(StressTest, AnyAxisEndsInFiniteReadingsOrIsGivenUp) { expect_endured(0, 300); }

}  // namespace
}  // namespace axisfit
