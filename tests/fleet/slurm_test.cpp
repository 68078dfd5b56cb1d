#include "fleet/slurm.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace axisfit {
namespace {

TEST(Slurm, ScriptsWorkOnAShardAndMerge) {
  SlurmOptions options;
  options.tasks = 50;
  options.program = "/opt/it's/axisfit-fleet";
  options.partition = "night";
  const std::string array = array_script("/data/plan", options);
  EXPECT_NE(array.find("#SBATCH --array=0-49\n"), std::string::npos);
  EXPECT_NE(array.find("#SBATCH --requeue\n"), std::string::npos);
  EXPECT_NE(array.find("#SBATCH --partition=night\n"), std::string::npos);
  EXPECT_NE(array.find("exec '/opt/it'\\''s/axisfit-fleet' work '/data/plan' --shard "
                       "\"$SLURM_ARRAY_TASK_ID/50\"\n"),
            std::string::npos)
      << array;
  EXPECT_NE(merge_script("/data/plan", options).find(" merge '/data/plan'\n"), std::string::npos);
}

TEST(Slurm, AsksForWhatATaskTakes) {
  SlurmOptions options;
  options.minutes = 30;
  options.megabytes = 512;
  options.program = "axisfit-fleet";
  const std::string array = array_script("/data/plan", options);
  EXPECT_NE(array.find("#SBATCH --mem=512M\n#SBATCH --time=30\n"), std::string::npos) << array;
  EXPECT_NE(array.find("#SBATCH --output=/data/plan/logs/work-%A-%a.log\n"), std::string::npos);
  EXPECT_NE(array.find("#SBATCH --array=0-0\n"), std::string::npos);
  EXPECT_EQ(array.find("--partition"), std::string::npos) << "the usual one";
  EXPECT_EQ(merge_script("/data/plan", options).find("--array"), std::string::npos);
}

TEST(Slurm, TakesNoFolderThatAScriptCannotName) {
  for (const std::string folder : {"/tmp/a b", "/tmp/it's", "/tmp/a%j"}) try {
      submit(folder, {});
      ADD_FAILURE() << folder;
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(std::string(error.what()),
                "'" + folder + "': Slurm takes no folder with such a character");
    }
}

}  // namespace
}  // namespace axisfit
