#include "fit/errors/rival_error.h"

#include <gtest/gtest.h>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

ParameterResult estimate_of(const char* name, double value, double error) {
  ParameterResult p{id_of(name), value, {}};
  p.budget.sampling.standard_error = error;
  return p;
}

/// A mass that is undecided against two gains, and two parameters of the machine, of which one
/// differs with the gains.
class RivalErrorsTest : public ::testing::Test {
 protected:
  RivalErrorsTest() {
    job_.model = slide();
    for (const char* name : {"B_a", "M", "added_mass.dM"}) {
      FreeParameter free = free_parameter(name, 1.0);
      free.scale = Scale::linear;
      free.lower = -1e3;
      free.upper = 1e3;
      job_.free.push_back(free);
    }
    const auto with = [](double friction, double mass, double added) {
      Model<double> model = slide();
      *members(model)[quantity_index("B_a")] = friction;
      *members(model)[quantity_index("M")] = mass;
      *members(model)[quantity_index("added_mass.dM")] = added;
      return model;
    };
    for (const auto& [rival, friction] :
         {std::pair("velocity.gain", 10.5), std::pair("position.gain", 9.6)})
      rivals_.push_back({"added_mass",
                         rival,
                         with(10.1, 5.0, 1.0),
                         with(friction, 5.2, 0.0),
                         {id_of("added_mass.dM")}});
  }

  std::vector<std::optional<RivalShift>> found() const {
    return rival_errors(job_, parameters_, rivals_);
  }

  Job job_;
  std::vector<ParameterResult> parameters_{estimate_of("B_a", 10.0, 0.3),
                                           estimate_of("M", 5.0, 0.3),
                                           estimate_of("added_mass.dM", 1.0, 0.1)};
  std::vector<RivalModels> rivals_;
};

TEST_F(RivalErrorsTest, AreTheLargestMove) {
  const std::optional<RivalShift> friction = found()[0];
  ASSERT_TRUE(friction);
  EXPECT_EQ(friction->chosen, "added_mass");
  EXPECT_EQ(friction->rival, "position.gain");
  EXPECT_DOUBLE_EQ(friction->value, 9.5);
}

TEST_F(RivalErrorsTest, LeaveWhatHardlyMovesAndTheEffectItself) {
  EXPECT_FALSE(found()[1]);
  EXPECT_FALSE(found()[2]);
}

// Whatever a move is compared with, it is not what it has made of the error itself.
TEST_F(RivalErrorsTest, AreComparedWithTheRestOfTheBudget) {
  parameters_[0].budget.rival = found()[0];
  EXPECT_TRUE(found()[0]);
  parameters_[0].budget.gain = {100.0, 10.6};
  EXPECT_FALSE(found()[0]);
}

TEST_F(RivalErrorsTest, LeaveWhatIsOpenAnyway) {
  parameters_[0].budget.sampling.standard_error = 1e4;
  EXPECT_FALSE(found()[0]);
}

}  // namespace
}  // namespace axisfit
