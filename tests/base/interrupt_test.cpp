#include "base/interrupt.h"

#include <gtest/gtest.h>

namespace axisfit {
namespace {

TEST(StopFlag, IsSetFromOutside) {
  StopFlag flag;
  EXPECT_FALSE(is_set(&flag));
  EXPECT_FALSE(flag.set());
  EXPECT_TRUE(is_set(&flag));
  EXPECT_TRUE(flag.set()) << "it was before";
  EXPECT_FALSE(is_set(nullptr));
}

TEST(StopFlag, IsSetByWork) {
  const StopFlag flag(nullptr, 10);
  flag.count(4);
  flag.count(6);
  EXPECT_FALSE(is_set(&flag)) << "as much as allowed";
  flag.count(1);
  EXPECT_TRUE(is_set(&flag));
}

TEST(StopFlag, ObeysTheOuterOne) {
  StopFlag outer;
  const StopFlag inner(&outer, 10);
  inner.count(11);
  EXPECT_TRUE(is_set(&inner));
  EXPECT_FALSE(is_set(&outer));
  const StopFlag next(&outer, 10);
  outer.set();
  EXPECT_TRUE(is_set(&next));
}

TEST(StopFlag, CountsTheWorkOfItsParts) {
  const StopFlag outer(nullptr, 10);
  StopFlag(&outer, 100).count(6);
  StopFlag(&outer, 100).count(5);
  EXPECT_TRUE(is_set(&outer));
}

}  // namespace
}  // namespace axisfit
