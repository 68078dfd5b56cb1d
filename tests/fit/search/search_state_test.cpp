#include "fit/search/search_state.h"

#include <gtest/gtest.h>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

/// A state whose models are those of a list, fitted to nothing: transmission and its part,
/// friction.
class StateOfThree : public testing::Test {
 protected:
  StateOfThree() {
    int round = 0;
    for (const char* name : {"compliance", "backlash", "friction"}) {
      Hypothesis h;
      h.name = name;
      h.strengths = {static_cast<std::size_t>(round)};
      if (h.name == "compliance") h.kind = HypothesisKind::transmission;
      if (h.name == "backlash") h.extends = "compliance";
      Tried tried;
      tried.hypothesis = h;
      tried.job.free.resize(1);
      tried.fit.parameters.resize(1);
      state_.outcomes.record(tried, &tried, ++round);
      state_.chain.append({h}, tried.job, tried.fit);
    }
  }

  static inline const SearchContext kContext{};
  SearchState state_{ModelChain({}, kContext)};
};

TEST_F(StateOfThree, LosesTheParts) {
  state_.strike_off(0);
  ASSERT_EQ(state_.accepted().size(), 1u);
  EXPECT_EQ(state_.accepted()[0].hypothesis.name, "friction");
  EXPECT_EQ(state_.outcomes.list()[1].reason, Reason::not_needed);     // the part
  EXPECT_EQ(state_.outcomes.list()[0].reason, Reason::explains_best);  // its own reason is given
}

TEST_F(StateOfThree, LosesAllForOneReason) {
  state_.take_out_all({.test = Rejection::Test::misfit});
  EXPECT_TRUE(state_.accepted().empty());
  for (const Outcome& o : state_.outcomes.list()) {
    EXPECT_EQ(o.rejection->test, Rejection::Test::misfit);
    EXPECT_FALSE(o.in_model);
  }
}

TEST_F(StateOfThree, ForgetsEverythingWhenItBeginsAnew) {
  state_.degenerate = {state_.accepted()[2].hypothesis};
  state_.restart({});
  EXPECT_TRUE(state_.accepted().empty());
  EXPECT_TRUE(state_.outcomes.list().empty());
  EXPECT_TRUE(state_.degenerate.empty());
}

TEST_F(StateOfThree, MayBePutAsideAndTakenUpAgain) {
  const SearchState before = state_;
  state_.take_out_all({.test = Rejection::Test::misfit});
  state_ = before;
  EXPECT_EQ(state_.accepted().size(), 3u);
  EXPECT_TRUE(state_.outcomes.list()[0].in_model);
}

}  // namespace
}  // namespace axisfit
