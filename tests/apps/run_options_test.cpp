#include "apps/run_options.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "tests/apps/files.h"
#include "tests/base/message_of.h"
#include "tests/sim/axes.h"

namespace axisfit {
namespace {

/// A job of a driven mass whose velocity was recorded.
Job job() {
  Job job;
  job.model = driven_mass(2.0);
  job.recordings.emplace_back().measurements.emplace_back().signal = Signal::velocity;
  return job;
}

TEST(RunOptions, AToleranceIsOfASignalThatThereIs) {
  const Tolerance found = tolerance_of("2.5 mm/s", job());
  EXPECT_EQ(found.value, 2.5);
  EXPECT_EQ(found.unit, "mm/s");
  EXPECT_EQ(tolerance_of("1mm/s", job()).unit, "mm/s");
  EXPECT_EQ(message_of([] { tolerance_of("1 mm", job()); }),
            "--within '1 mm': no signal of the job can be given in mm");
  for (const char* text : {"", "mm/s", "0 mm/s", "-1 mm/s", "1", "inf mm/s", "nan mm/s"})
    EXPECT_EQ(message_of([&] { tolerance_of(text, job()); }),
              "--within '" + std::string(text) +
                  "': write a number above zero and its unit, such as 1mm");
}

TEST(RunOptions, AnAxisOfTheMachineHasItsJointCommandAndChannels) {
  Rig rig;
  rig.model = driven_mass(3.0);
  Job own = job();
  EXPECT_EQ(message_of([&] { check_is_of_machine(rig, own, "here"); }), "");
  rig.model.structure.joint = Joint::revolute;
  EXPECT_EQ(message_of([&] { check_is_of_machine(rig, own, "here"); }),
            "here: joint or unit of the command are not those of the job's axis");
  const auto with = [&](const ChannelList& of_job, const ChannelList& of_axis) {
    own.model.structure.channels = kept(of_job);
    Rig other;
    other.model = driven_mass(3.0);
    other.model.structure.channels = of_axis.empty() ? nullptr : kept(of_axis);
    return message_of([&] { check_is_of_machine(other, own, "here"); });
  };
  const Channel oil{"oil", "degC", 20.0}, supply{"supply", "V", 0.0};
  EXPECT_EQ(with({oil, supply}, {oil, supply}), "");
  EXPECT_NE(with({oil, supply}, {supply, oil}), "");
  EXPECT_NE(with({oil}, {oil, supply}), "");
}

TEST(RunOptions, OtherModelsAreThoseOfTheirFiles) {
  const TempFolder folder;
  const std::string file = folder.write("other.yaml",
                                        "drive: force_source\ntransmission: rigid\n"
                                        "parameters: {K_f: 10 N/V, M: 4 kg, B_a: 8 N s/m}\n");
  const auto models = models_of({file}, job());
  ASSERT_EQ(models.size(), 1u);
  EXPECT_EQ(models[0].name, file);
  EXPECT_EQ(models[0].model.axis.M, 4.0);
  EXPECT_FALSE(models[0].uncertainty);
  Job turning = job();
  turning.model.structure.joint = Joint::revolute;
  EXPECT_TRUE(
      message_of([&] { models_of({file}, turning); }).starts_with("--compare " + file + ": "));
}

TEST(RunOptions, AMotionIsForTheRigOfTheJob) {
  const TempFolder folder;
  Rig rig;
  rig.model = driven_mass(3.0);
  const std::string file = folder.write("motion.yaml", "type: step\nlevel: 2 V\nduration: 1.5 s\n");
  const MotionToPredict found = motion_of(file, rig);
  EXPECT_EQ(found.name, file);
  EXPECT_EQ(found.duration, 1.5);
  EXPECT_EQ(std::get<StepMotion>(found.motion).level, 2.0);
  EXPECT_EQ(found.rig.model.axis.M, 3.0);
}

}  // namespace
}  // namespace axisfit
