// The search for what a model lacks where the controller is simulated with the axis.
#include <gtest/gtest.h>

#include "fit/run.h"
#include "tests/fit/parameter_ids.h"
#include "tests/fit/servo.h"

namespace axisfit {
namespace {

// What the model lacks acts through the loop, too.
TEST(ClosedLoop, NamesAFrictionThatIsMissing) {
  Job job = servo_job(Servo());
  job.model.structure.effects = {};
  job.free.pop_back();
  const RunResult result = run(job, {.select_effects = true});
  ASSERT_TRUE(result.selection);
  ASSERT_EQ(result.selection->models.size(), 2u);
  EXPECT_TRUE(result.job().model.structure.effects[*effect_named("coulomb_friction")]);
  for (const ParameterResult& p : result.fit().parameters) {
    if (p.id == id_of("M")) {
      EXPECT_NEAR(p.value, 23.0, 0.23);
    }
    if (p.id == id_of("coulomb_friction.F_c")) {
      EXPECT_NEAR(p.value, 18.0, 0.18);
    }
  }
}

}  // namespace
}  // namespace axisfit
