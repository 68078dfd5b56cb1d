#include "base/samples.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace axisfit {
namespace {

TEST(Samples, CopiesShareThemUntilOneIsEdited) {
  const Samples original{1.0, 2.0, 3.0};
  Samples copy = original;
  EXPECT_EQ(copy.data(), original.data());
  copy.edit()[1] = 5.0;
  EXPECT_NE(copy.data(), original.data());
  EXPECT_EQ(original[1], 2.0);
  EXPECT_EQ(copy[1], 5.0);
}

TEST(Samples, OfOneOwnerAreEditedInPlace) {
  Samples samples{1.0, 2.0};
  const double* const before = samples.data();
  samples.edit()[0] = 4.0;
  EXPECT_EQ(samples.data(), before);
}

TEST(Samples, AreEqualByTheirValues) {
  Samples one{1.0, 2.0};
  EXPECT_EQ(one, (Samples{1.0, 2.0}));
  EXPECT_FALSE(one == (Samples{1.0, 3.0}));
  EXPECT_EQ(Samples(), Samples(std::vector<double>()));
}

TEST(Samples, ThatWereMadeOfNothingCanBeEdited) {
  Samples samples;
  EXPECT_TRUE(samples.empty());
  samples.edit().push_back(7.0);
  EXPECT_EQ(samples.back(), 7.0);
  EXPECT_TRUE(Samples().empty());
}

}  // namespace
}  // namespace axisfit
