#include "base/deadline.h"

#include <gtest/gtest.h>

#include <thread>

namespace axisfit {
namespace {

void wait_for(const StopFlag* flag) {
  while (!is_set(flag)) std::this_thread::yield();
}

TEST(Deadline, IsSetWhenTheTimeIsSpent) {
  const Deadline deadline(nullptr, 0.01);
  wait_for(deadline.flag());
}

TEST(Deadline, IsSetWhenTheOtherFlagIs) {
  StopFlag other = false;
  const Deadline deadline(&other, 1e6);
  EXPECT_FALSE(is_set(deadline.flag()));
  other = true;
  wait_for(deadline.flag());
}

TEST(Deadline, EndsBeforeItsTime) {
  for (int i = 0; i < 20; ++i) const Deadline deadline(nullptr, 1e6);
}

}  // namespace
}  // namespace axisfit
