#include "tests/sim/hardship.h"

namespace axisfit {
namespace {

TEST(HardshipTest, AnyAxisEndsInFiniteReadingsOrIsGivenUp) { expect_endured(0, 300); }

}  // namespace
}  // namespace axisfit
