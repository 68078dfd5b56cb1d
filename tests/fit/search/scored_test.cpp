#include "fit/search/scored.h"

#include <gtest/gtest.h>

namespace axisfit {
namespace {

Scored scored(const std::vector<double>& shapes, std::size_t held) {
  Hypothesis hypothesis;
  hypothesis.strengths = {1};
  hypothesis.shapes = {2, 3};
  hypothesis.held = held;
  return {std::make_shared<const Hypothesis>(hypothesis), {{0.0}, shapes}};
}

TEST(IsSameLaw, AsksWhatIsHeldAlone) {
  EXPECT_TRUE(is_same_law(scored({0.1, 2.0}, 1), scored({0.3, 2.0}, 1)));
  EXPECT_FALSE(is_same_law(scored({0.1, 2.0}, 1), scored({0.1, 1.0}, 1)));
  EXPECT_TRUE(is_same_law(scored({0.1, 2.0}, 0), scored({0.3, 1.0}, 0)));
}

TEST(IsSameLaw, IsNoneOfAnotherHypothesis) {
  const Scored one = scored({0.1, 2.0}, 1);
  Hypothesis other = *one.hypothesis;
  other.strengths = {4};
  EXPECT_FALSE(is_same_law(one, {std::make_shared<const Hypothesis>(other), one.own}));
}

}  // namespace
}  // namespace axisfit
