#include "exports/export.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "tests/exports/axes.h"

namespace axisfit {
namespace {

TEST(Export, SaysWhatIsLost) {
  Rig rig = rubbing_slide();
  rig.model.axis.T_d = 1e-3;
  add_effect<QuadraticDrag>(rig.model).c = 5.0;
  const Export mjcf = export_axis(rig, ExportTarget::mjcf, "a", "");
  ASSERT_EQ(mjcf.lost.size(), 3u);
  EXPECT_EQ(mjcf.lost[0].substr(0, 27), "quadratic_drag is left out:");
  EXPECT_EQ(mjcf.carried.model.axis.T_d, 0.0);
  EXPECT_NE(mjcf.files[0].second.find(mjcf.lost[1]), std::string::npos);
  add_effect<ConstantForce>(rig.model).F_0 = 3.0;
  EXPECT_EQ(export_axis(rig, ExportTarget::urdf, "a", "").lost.size(), 3u);
  rig.uncertainty.emplace();
  EXPECT_EQ(export_axis(rig, ExportTarget::urdf, "a", "").lost.back().substr(0, 19),
            "The standard errors");
  EXPECT_TRUE(export_axis(rig, ExportTarget::matlab, "a", "").lost.empty());
}

TEST(Export, RefusesAPreamplifier) {
  Rig rig;
  rig.model = paper_axis();
  for (const ExportTarget target : {ExportTarget::mjcf, ExportTarget::urdf}) try {
      export_axis(rig, target, "a", "");
      ADD_FAILURE();
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find("cannot express this axis"), std::string::npos);
      EXPECT_NE(std::string(error.what()).find("velocity_loop"), std::string::npos);
    }
  EXPECT_NO_THROW(export_axis(rig, ExportTarget::matlab, "a", ""));
}

}  // namespace
}  // namespace axisfit
