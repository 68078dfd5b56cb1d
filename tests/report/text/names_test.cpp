#include "report/text/names.h"

#include <gtest/gtest.h>

namespace axisfit {
namespace {

TEST(NamesTest, OfAParameterAreThoseOfTheAxisAndItsRecording) {
  Job job;
  job.model.structure = {.drive = Drive::motor_current, .joint = Joint::revolute};
  for (const char* name : {"day1", "day2"}) job.recordings.emplace_back().name = name;
  const ParameterId friction{quantity_index("coulomb_friction.F_c")};
  EXPECT_EQ(name_of(job, friction), "coulomb_friction.T_c");
  EXPECT_EQ(quantity_of(job, friction).unit, "N m");
  const ParameterId gain{quantity_index("K_f"), 1};
  EXPECT_EQ(name_of(job, gain), "K_f@day2");
  EXPECT_EQ(quantity_of(job, gain).unit, "N m/A");
}

}  // namespace
}  // namespace axisfit
