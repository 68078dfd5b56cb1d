#include "io/config/axis_uncertainty.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <string>

#include "tests/sim/axes.h"

namespace axisfit {
namespace {

/// What is read of a section, and what is said of it.
std::optional<AxisUncertainty> read(const std::string& yaml, std::string* said = nullptr) {
  Diagnostics diagnostics;
  const auto found = read_axis_uncertainty(*ConfigNode::parse(yaml, "axis.yaml", diagnostics),
                                           driven_mass(1.0).structure);
  if (said != nullptr)
    for (const Diagnostic& d : diagnostics.sorted()) *said += d.message + "\n";
  return found;
}

TEST(AxisUncertainty, HasDefaults) {
  const auto known = read(
      "{parameters: [{name: M, scale: logarithmic, error: 2 %}, "
      "{name: B_a, scale: linear, error: 3}]}");
  ASSERT_TRUE(known);
  ASSERT_EQ(known->quantities.size(), 2u);
  EXPECT_EQ(known->quantities[0].quantity, quantity_index("M"));
  EXPECT_TRUE(known->quantities[0].logarithmic);
  EXPECT_EQ(known->quantities[0].error, 0.02);
  EXPECT_EQ(known->quantities[0].scatter, 0.0);
  EXPECT_EQ(known->quantities[0].freedom, 1.0);
  EXPECT_FALSE(known->quantities[1].logarithmic);
  EXPECT_EQ(known->correlation, (std::vector<double>{1.0, 0.0, 0.0, 1.0}));
  EXPECT_FALSE(known->missing_force);
}

TEST(AxisUncertainty, ACorrelationIsSquare) {
  const std::string parameters = "{parameters: [{name: M, scale: linear, error: 1}], correlation: ";
  EXPECT_EQ(read(parameters + "[[1]]}")->correlation, std::vector<double>{1.0});
  for (const char* wrong : {"[[1, 0], [0, 1]]}", "[[1, 0]]}", "[]}", "1}"}) {
    std::string said;
    read(parameters + wrong, &said);
    EXPECT_NE(said.find("correlation must have 1 rows of 1 numbers"), std::string::npos) << said;
  }
}

TEST(AxisUncertainty, AQuantityIsOneOfTheAxis) {
  std::string said;
  read("{parameters: [{name: k_g, scale: linear, error: 1}]}", &said);
  EXPECT_NE(said.find("k_g"), std::string::npos) << "a rigid axis has none";
  said.clear();
  EXPECT_FALSE(read("{parameter: []}", &said));
  EXPECT_NE(said.find("did you mean 'parameters'?"), std::string::npos) << said;
}

TEST(AxisUncertainty, AMissingTorqueIsInItsUnit) {
  AxisUncertainty known;
  known.missing_force = MissingForceProcess{0.01, 1.5, 0.5, {0.75}};
  YAML::Emitter out;
  out << YAML::BeginMap;
  write_axis_uncertainty(out, known, Joint::revolute);
  out << YAML::EndMap;
  EXPECT_EQ(std::string(out.c_str()),
            "uncertainty:\n  missing_force:\n    interval: 0.01 s\n    deviation: 1.5 N m\n"
            "    innovation: 0.5 N m\n    coefficients: [0.75]");
}

}  // namespace
}  // namespace axisfit
