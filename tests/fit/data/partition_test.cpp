#include "fit/data/partition.h"

#include <gtest/gtest.h>

namespace axisfit {
namespace {

TEST(Partition, CoversEverySampleOnceInPartsOfEqualLength) {
  for (const std::size_t samples : {1u, 10u, 97u, 1000u})
    for (std::size_t parts = 1; parts <= samples; parts += 3) {
      const Partition partition(samples, parts);
      EXPECT_EQ(partition.parts(), parts);
      EXPECT_EQ(partition.first(0), 0u);
      EXPECT_EQ(partition.first(parts), samples);
      for (std::size_t k = 0; k < parts; ++k) {
        EXPECT_EQ(partition.first(k) + partition.size(k), partition.first(k + 1));
        EXPECT_GE(partition.size(k), samples / parts);
        EXPECT_LE(partition.size(k), samples / parts + 1);
      }
    }
}

}  // namespace
}  // namespace axisfit
