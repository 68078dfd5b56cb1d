#include "tests/sim/hardship.h"

namespace axisfit {
namespace {

TEST(HardshipSlowTest, AnyAxisEndsInFiniteReadingsOrIsGivenUp) { expect_endured(300, 10'000); }

}  // namespace
}  // namespace axisfit
