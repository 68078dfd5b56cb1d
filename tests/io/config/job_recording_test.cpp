#include "io/config/job_recording.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "io/config/axis_file.h"

namespace axisfit {
namespace {

/// Reads a recording of a driven mass: 100 samples at 100 Hz, from 1.7e9 s on where it is told.
class JobRecordingTest : public ::testing::Test {
 protected:
  JobRecordingTest() {
    Diagnostics diagnostics;
    rig_ = *read_axis(*ConfigNode::parse("drive: force_source\ntransmission: rigid\n"
                                         "parameters: {K_f: 1 N/V, M: 1 kg, B_a: 0 N s/m}\n",
                                         "axis.yaml", diagnostics),
                      diagnostics);
  }

  Recording read(const std::string& more, double begin = 0.0,
                 const std::string& clock = "time: {column: t, unit: s}\n") {
    Column time{"t", {}}, u{"u", {}}, v{"v", {}};
    for (int i = 0; i < 100; ++i) {
      time.values.push_back(begin + 0.01 * i);
      u.values.push_back(i < 50 ? 1.0 : -1.0);
      v.values.push_back(std::sin(0.1 * i));
    }
    const RecordingSources sources{{}, {{"run/a.csv", {"run/a.csv", {time, u, v}, {}}}}};
    Diagnostics diagnostics;
    const auto node = ConfigNode::parse("file: run/a.csv\n" + clock +
                                            "signals: {command: {column: u, unit: V, sigma: 0 V}, "
                                            "velocity: {column: v, unit: m/s, sigma: 1 mm/s}}\n" +
                                            more,
                                        "job.yaml", diagnostics);
    Recording recording = read_recording(*node, rig_, sources);
    said_.clear();
    for (const Diagnostic& d : diagnostics.sorted()) said_ += d.message + "\n";
    return recording;
  }

  Rig rig_;
  std::string said_;
};

TEST_F(JobRecordingTest, SamplesMayHaveARateInsteadOfTimes) {
  const Recording r = read("", 0.0, "rate: 0.2 kHz\n");
  EXPECT_EQ(said_, "");
  ASSERT_EQ(r.times.size(), 100u);
  EXPECT_DOUBLE_EQ(r.times[10], 0.05);
  EXPECT_EQ(r.command.times, (Samples{0.0, 0.25}));
  read("", 0.0, "rate: 1 kHz\ntime: {column: t, unit: s}\n");
  EXPECT_EQ(said_, "give either the column of the times or the rate of the samples, not both\n");
  read("", 0.0, "");
  EXPECT_NE(said_.find("time"), std::string::npos);
}

TEST_F(JobRecordingTest, IsCalledByItsFileUnlessItHasAName) {
  Recording r = read("");
  EXPECT_EQ(said_, "");
  EXPECT_EQ(r.name, "a");
  EXPECT_EQ(r.file, "run/a.csv");
  EXPECT_EQ(r.role, Role::fit);
  EXPECT_EQ(r.times.size(), 100u);
  EXPECT_EQ(r.command.times, (Samples{0.0, 0.5}));
  r = read("name: first\nrole: validate\n");
  EXPECT_EQ(r.name, "first");
  EXPECT_EQ(r.role, Role::validate);
}

// A double is too coarse to step on at that time; nearer to zero it stays as it was recorded.
TEST_F(JobRecordingTest, OnTheEpochBeginsAtZero) {
  EXPECT_EQ(read("", 1.7e9).times.front(), 0.0);
  EXPECT_EQ(read("", 1.7e9).command.times[0], 0.0);
  EXPECT_EQ(read("", 1000.0).times.front(), 1000.0);
}

TEST_F(JobRecordingTest, TrimKeepsWhatActsOnIt) {
  const Recording r = read("trim: {from: 0.8 s, to: 900 ms}\n");
  EXPECT_EQ(r.times.size(), 11u);
  EXPECT_EQ(r.times.front(), 0.8);
  EXPECT_EQ(r.command.value_at(0.8), -1.0) << "since 0.5 s";
  read("trim: {from: 0.955 s}\n");
  EXPECT_EQ(said_, "only 4 samples of 100, from 0 s to 0.99 s, remain: at least 10 are needed\n");
  read("trim: {from: 0.985 s}\n");
  EXPECT_EQ(said_, "only 1 sample of 100, from 0 s to 0.99 s, remain: at least 10 are needed\n");
}

TEST_F(JobRecordingTest, OverridesAreOfItAlone) {
  const Recording r = read("set: {M: 3 kg, initial.y0: 20 mm}\n");
  EXPECT_EQ(said_, "");
  ASSERT_EQ(r.overrides.size(), 2u);
  EXPECT_EQ(r.overrides[0], (std::pair<std::size_t, double>(quantity_index("M"), 3.0)));
  EXPECT_EQ(r.overrides[1].second, 0.02);
}

TEST_F(JobRecordingTest, AnInitialStateComesFromItsSamples) {
  const Recording r = read("initial_state: data\n");
  ASSERT_EQ(r.overrides.size(), 1u);
  EXPECT_EQ(r.overrides[0].first, quantity_index("initial.y1"));
  EXPECT_NEAR(r.overrides[0].second, 0.0, 1e-2);
}

TEST_F(JobRecordingTest, HasTheChannelsOfItsAxis) {
  rig_.model.structure.channels = kept({{"oil", "degC", 20.0}});
  read("");
  EXPECT_EQ(said_,
            "'a' lacks the channels of the axis, or of the other recordings: name their columns "
            "under 'channels'\n");
  const Recording r = read("channels: {oil: {column: v, unit: degC}}\n");
  EXPECT_EQ(said_, "");
  ASSERT_EQ(r.channels.size(), 1u);
  EXPECT_NEAR(r.channels[0][0], -20.0, 1e-9) << "beyond its zero";
}

}  // namespace
}  // namespace axisfit
