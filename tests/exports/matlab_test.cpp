#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "exports/export.h"
#include "io/recording/mat_file.h"
#include "tests/apps/files.h"
#include "tests/exports/axes.h"

namespace axisfit {
namespace {

TEST(Matlab, HasTheCovariance) {
  Rig rig = rubbing_slide();
  rig.name = "the arm's";
  AxisUncertainty& known = rig.uncertainty.emplace();
  known.quantities = {{quantity_index("M"), true, 0.0125, 0.025, 3.0},
                      {quantity_index("B_a"), false, 2.0, 0.0, 1.0}};
  known.correlation = {1.0, 0.5, 0.5, 1.0};
  const Export made = export_axis(rig, ExportTarget::matlab, "arm", "Exported by a test");
  ASSERT_EQ(made.files.size(), 2u);
  const std::string& text = made.files[0].second;
  EXPECT_NE(text.find("function axis = arm()\n"), std::string::npos);
  EXPECT_NE(text.find("axis.name = 'the arm''s';"), std::string::npos);
  EXPECT_NE(text.find("axis.parameters.M = 20;  % kg: arm mass\n"), std::string::npos) << text;
  EXPECT_NE(text.find("axis.effects.coulomb_friction.F_c = 4;"), std::string::npos);
  TempFolder folder;
  const Table table = read_mat(folder.write("arm.mat", made.files[1].second));
  const Column* values = table.find("values");
  ASSERT_NE(values, nullptr);
  EXPECT_EQ(values->values, (std::vector{20.0, 30.0}));
  EXPECT_NE(text.find("axis.fitted.covariance = ["), std::string::npos);
  // 0.25 and 0.5 kg; 2 N s/m; correlation 0.5.
  EXPECT_NE(text.find("covariance_of_machine = [0.3125, 0.25; 0.25, 4];"), std::string::npos)
      << text;
}

TEST(Matlab, FunctionsHaveNamesThatItTakes) {
  const auto name = [](const char* file) {
    return export_axis(slide(), ExportTarget::matlab, file, "").files[0].first;
  };
  EXPECT_EQ(name("fitted"), "fitted.m");
  EXPECT_EQ(name("x-axis 2"), "x_axis_2.m");
  EXPECT_EQ(name("2nd"), "axis_2nd.m");
}

}  // namespace
}  // namespace axisfit
