#include "exports/fmu/instance.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "exports/fmu/axis_text.h"
#include "tests/apps/files.h"
#include "tests/sim/axes.h"

namespace axisfit {
namespace {

class InstanceTest : public ::testing::Test {
 protected:
  InstanceTest() { folder_.write("axis.txt", "token\n" + axis_text(driven_mass(2.0))); }
  FmuInstance made(const std::string& token = "token") {
    return {folder_.path(), token, [this](const std::string& message) { log_ = message; }};
  }

  TempFolder folder_;
  std::string log_;
};

TEST_F(InstanceTest, IsOfTheDescriptionWithItsToken) {
  EXPECT_NO_THROW(made());
  EXPECT_THROW(made("another"), std::runtime_error);
  folder_.write("axis.txt", "");
  EXPECT_THROW(made(), std::runtime_error);
}

TEST_F(InstanceTest, DoesThingsOnlyInTheirPhases) {
  FmuInstance instance = made();
  int acts = 0;
  const auto act = [&](FmuInstance&) { ++acts; };
  EXPECT_FALSE(instance.attempt("step", {Phase::stepping}, act));
  EXPECT_EQ(log_, "step: it must not be called now");
  EXPECT_TRUE(instance.attempt("setup", {Phase::stepping, Phase::instantiated}, act));
  instance.enter(Phase::stepping);
  EXPECT_TRUE(instance.attempt("step", {Phase::stepping}, act));
  EXPECT_EQ(acts, 2);
  EXPECT_FALSE(instance.attempt("step", {Phase::stepping},
                                [](FmuInstance&) { throw std::runtime_error("the reason"); }));
  EXPECT_EQ(log_, "step: the reason");
  instance.reset();
  EXPECT_TRUE(instance.attempt("setup", {Phase::instantiated}, act));
}

TEST_F(InstanceTest, AStateHasThePhaseToo) {
  FmuInstance instance = made();
  instance.enter(Phase::stepping);
  instance.unit.set(kCommandVariable, 3.0);
  instance.unit.step(0.0, 0.5);
  void* state = nullptr;
  instance.take(state);
  std::vector<char> bytes(size_of_state(state));
  EXPECT_THROW(write_state(state, bytes.data(), bytes.size() - 1), std::runtime_error);
  write_state(state, bytes.data(), bytes.size());
  free_state(state);
  EXPECT_EQ(state, nullptr);

  FmuInstance other = made();
  void* again = read_state(bytes.data(), bytes.size());
  other.restore(again);
  free_state(again);
  EXPECT_EQ(other.unit.time(), 0.5);
  EXPECT_TRUE(other.attempt("step", {Phase::stepping}, [](FmuInstance&) {}));
  EXPECT_THROW(read_state(bytes.data(), 0), std::runtime_error);
  bytes[0] = 17;
  EXPECT_THROW(read_state(bytes.data(), bytes.size()), std::runtime_error);
}

TEST(PathOfUri, IsThePathOfAFile) {
  EXPECT_EQ(path_of_uri("/a b/c"), "/a b/c");
  EXPECT_EQ(path_of_uri("file:///a/b"), "/a/b");
  EXPECT_EQ(path_of_uri("file:/a/b"), "/a/b");
  EXPECT_EQ(path_of_uri("file://host/a/b"), "/a/b");
  EXPECT_EQ(path_of_uri("file:///a%20b/100%"), "/a b/100%");
  EXPECT_EQ(path_of_uri("file:///a%zz"), "/a%zz");
}

}  // namespace
}  // namespace axisfit
