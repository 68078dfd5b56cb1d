#include "io/config/job_parameters.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/sim/axes.h"

namespace axisfit {
namespace {

/// Two recordings of the paper's axis to fit and one to validate, without samples.
class FreeTest : public ::testing::Test {
 protected:
  FreeTest() {
    job_.model = paper_axis();
    job_.recordings.resize(3);
    for (std::size_t r = 0; r < 3; ++r) job_.recordings[r].name = "run-" + std::to_string(r + 1);
    job_.recordings[2].role = Role::validate;
  }

  /// What is freed, and what is said of it.
  std::vector<FreeParameter> free(const std::string& yaml) {
    Job job = job_;
    Diagnostics diagnostics;
    read_free(*ConfigNode::parse(yaml, "job.yaml", diagnostics), diagnostics, job);
    said_.clear();
    for (const Diagnostic& d : diagnostics.sorted()) said_ += d.message + "\n";
    return job.free;
  }
  static double range(const char* name, bool upper) {
    const Quantity& q = quantity_list()[quantity_index(name)].quantity;
    return upper ? q.upper : q.lower;
  }

  Job job_;
  std::string said_;
};

TEST_F(FreeTest, WhatEveryAxisHasIsEstimatedByItsOrderOfMagnitude) {
  const FreeParameter p = free("{B_a: }").at(0);
  EXPECT_EQ(p.initial, 200.0);
  EXPECT_EQ(p.scale, Scale::from_zero) << "it may be none";
  EXPECT_EQ(p.lower, 0.0);
  EXPECT_EQ(p.upper, range("B_a", true));
  EXPECT_FALSE(p.prior);
  EXPECT_FALSE(p.recording);
  const FreeParameter mass = free("{M: {initial: 50 t}}").at(0);
  EXPECT_EQ(mass.scale, Scale::logarithmic);
  EXPECT_EQ(mass.lower, range("M", false));
  EXPECT_EQ(mass.upper, range("M", true));
}

TEST_F(FreeTest, WhatMayBeZeroIsLinearInItsRange) {
  const FreeParameter p = free("{F_s: }").at(0);
  EXPECT_EQ(p.scale, Scale::linear);
  EXPECT_EQ(p.lower, range("F_s", false));
  EXPECT_EQ(p.upper, range("F_s", true));
  EXPECT_EQ(free("{F_s: {initial: 2 N, bounds: [1 N, 5 N]}}").at(0).scale, Scale::logarithmic)
      << "where the bounds leave out zero";
  EXPECT_EQ(free("{F_s: {initial: 2 N, bounds: [0 N, 5 N]}}").at(0).scale, Scale::linear);
  EXPECT_EQ(free("{B_a: {scale: linear}}").at(0).scale, Scale::linear);
}

TEST_F(FreeTest, APriorHasAMeanAndASigma) {
  const FreeParameter p = free("{B_a: {prior: {mean: 150 N s/m, sigma: 20 N s/m}}}").at(0);
  ASSERT_TRUE(p.prior);
  EXPECT_EQ(p.prior->mean, 150.0);
  EXPECT_EQ(p.prior->sigma, 20.0);
  free("{B_a: {bounds: [180 N s/m, 300 N s/m], prior: {mean: 150 N s/m, sigma: 20 N s/m}}}");
  EXPECT_EQ(said_,
            "the prior mean of B_a, 150 N s/m, lies outside its bounds, 180 N s/m to 300 N s/m\n");
}

TEST_F(FreeTest, PerRecordingIsOneForEachThatIsFitted) {
  job_.recordings[1].overrides = {{quantity_index("M"), 161.0}};
  const auto list = free("{M: {per_recording: true}}");
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[0].recording, 0u);
  EXPECT_EQ(list[0].initial, 146.0);
  EXPECT_EQ(list[1].recording, 1u);
  EXPECT_EQ(list[1].initial, 161.0) << "what is set there";
  EXPECT_EQ(free("{M: {initial: 100 kg, per_recording: true}}")[1].initial, 100.0);
}

TEST_F(FreeTest, PerRecordingMayNameThem) {
  job_.recordings[0].name = "empty";
  job_.recordings[1].name = "loaded";
  const auto list = free("{M: {per_recording: [loaded]}}");
  ASSERT_EQ(list.size(), 1u);
  EXPECT_EQ(list[0].recording, 1u);
  EXPECT_TRUE(free("{M: {per_recording: [loded]}}").empty());
  EXPECT_EQ(said_, "no recording with the role fit is called 'loded': there are empty, loaded\n");
  EXPECT_TRUE(free("{M: {per_recording: []}}").empty());
  EXPECT_EQ(said_, "per_recording must name at least one recording\n");
}

}  // namespace
}  // namespace axisfit
