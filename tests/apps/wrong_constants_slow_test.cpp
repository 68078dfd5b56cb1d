// Data sheets err: one constant after the other of every shipped axis, declared a third too small,
// through the whole program.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/apps/fit_job.h"
#include "tests/apps/shell.h"

namespace axisfit {
namespace {

/// The shipped axes, of all drives but one, both joints and transmissions. Two are like x.
std::vector<std::string> axis_names() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(AXISFIT_CONFIGS "/axes"))
    if (const std::string name = entry.path().stem().string(); name != "y" && name != "z")
      names.push_back(name);
  std::ranges::sort(names);
  return names;
}

std::string unit_of_column(const std::string& column) {
  const std::string suffix = column.substr(column.rfind('_') + 1);
  return suffix == "mps"     ? "m/s"
         : suffix == "radps" ? "rad/s"
         : suffix == "v"     ? "V"
         : suffix == "a"     ? "A"
                             : suffix;
}

/// A recording of two seconds in both directions, and its entry in a job.
std::string recorded(const TempFolder& folder, const Rig& rig, const std::string& role,
                     double scale) {
  const double level = scale * rig.model.controller.gains.limit;
  const Table table =
      record_levels(rig, {{level, -0.6 * level, 0.4 * level, -level, 0.0}, 0.4}, 2.0,
                    {Signal::position, Signal::velocity}, 250.0, role == "fit" ? 1 : 2);
  folder.write(role + ".csv", table, 9);
  std::string signals;
  for (std::size_t c = 1; c < table.columns.size(); ++c) {
    const std::string& name = table.columns[c].name;
    signals += name.substr(0, name.rfind('_')) + ": {column: " + name + ", unit: '" +
               unit_of_column(name) + "'}, ";
  }
  return "  - {file: " + role + ".csv, role: " + role +
         ", time: {column: time_s, unit: s}, signals: {" + signals + "}}\n";
}

class WrongConstantsSlowTest : public testing::TestWithParam<std::string> {};

TEST_P(WrongConstantsSlowTest, EndInAResult) {
  const std::string axis = AXISFIT_CONFIGS "/axes/" + GetParam() + ".yaml";
  Diagnostics diagnostics;
  Rig declared = *read_axis_file(axis, diagnostics);
  int constants = 0;
  for (const QuantityEntry& entry : quantity_list()) {
    if (!entry.group.empty() || entry.name == "B_a" ||
        *members(declared.model)[entry.index] == 0.0 || !is_used(entry, declared.model.structure))
      continue;
    SCOPED_TRACE(entry.name);
    Rig truth = declared;
    *members(truth.model)[entry.index] *= 1.5;
    truth.noise.fill(1e-3);  // m, m/s; rad, rad/s
    const TempFolder folder;
    const std::string fit = recorded(folder, truth, "fit", 0.9),
                      validate = recorded(folder, truth, "validate", 0.7);
    folder.write("job.yaml",
                 "axis: " + axis + "\nrecordings:\n" + fit + validate + "free: {B_a: {}}\n");
    const Answer closed =
        shell(folder, "fit-params job.yaml --close-loop --time-limit 20 --json --output results");
    EXPECT_TRUE(closed.exit_code == 0 || closed.exit_code == 3 || closed.exit_code == 124)
        << closed.exit_code << "\n"
        << closed.err;
    EXPECT_FALSE(YAML::Load(closed.out)["verdict"].as<std::string>().empty());
    EXPECT_TRUE(folder.names("results").contains("report.html"));
    ++constants;
  }
  EXPECT_GE(constants, 2);
}

INSTANTIATE_TEST_SUITE_P(OfEveryAxis, WrongConstantsSlowTest, testing::ValuesIn(axis_names()),
                         [](const auto& one) {
                           std::string name = one.param;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace axisfit
