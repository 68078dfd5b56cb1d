#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "exports/export.h"
#include "tests/apps/files.h"
#include "tests/exports/axes.h"

namespace axisfit {
namespace {

TEST(Urdf, IsWhatTheCheckerTakes) {
  TempFolder folder;
  for (const bool turns : {false, true}) {
    Rig rig = rubbing_slide();
    if (turns) rig.model.structure.joint = Joint::revolute;
    const std::string path = folder.write(
        "axis.urdf", only_file(export_axis(rig, ExportTarget::urdf, "axis", "By a test")));
    if (std::system("command -v check_urdf > /dev/null") != 0)
      GTEST_SKIP() << "check_urdf (liburdfdom-tools) is not installed";
    EXPECT_EQ(std::system(("check_urdf " + path + " > /dev/null").c_str()), 0);
  }
}

}  // namespace
}  // namespace axisfit
