#include "fit/selection/extended_model.h"

#include <gtest/gtest.h>

#include "sim/model.h"

namespace axisfit {
namespace {

class ShapeAtBoundTest : public testing::Test {
 protected:
  ShapeAtBoundTest() {
    for (const char* name : {"B_a", "dahl_friction.F_d", "dahl_friction.l_d"}) {
      job_.free.push_back(free_parameter(name, 1.0));
      fit_.parameters.emplace_back().name = name;
    }
    candidate_.strengths = {find_quantity("dahl_friction.F_d")->index};
    candidate_.shapes = {find_quantity("dahl_friction.l_d")->index};
  }
  std::string found() const { return shape_at_bound(job_, fit_, candidate_); }

  Job job_;
  FitResult fit_;
  Candidate candidate_;
};

TEST_F(ShapeAtBoundTest, IsThatOfTheEffect) {
  EXPECT_EQ(found(), "");
  fit_.parameters[0].uncertainty.at_bound = true;  // of the axis
  fit_.parameters[1].uncertainty.at_bound = true;  // a strength
  EXPECT_EQ(found(), "");
  fit_.parameters[2].uncertainty.at_bound = true;
  EXPECT_EQ(found(), "dahl_friction.l_d");
}

TEST_F(ShapeAtBoundTest, IsNoneWhereShapesAreNotEstimated) {
  fit_.parameters[2].uncertainty.at_bound = true;
  candidate_.shapes_are_free = false;
  EXPECT_EQ(found(), "");
}

}  // namespace
}  // namespace axisfit
