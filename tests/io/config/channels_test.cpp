#include "io/config/channels.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/config/axis_file.h"
#include "io/config/job_file.h"
#include "tests/apps/files.h"

namespace axisfit {
namespace {

constexpr const char* kMass = R"(drive: force_source
transmission: rigid
parameters: {K_f: 2 N/V, M: 4 kg, B_a: 8 N s/m}
)";

// Lines count: the messages below name them.
constexpr const char* kJob = R"(axis: mass.yaml
recordings:
  - file: a.csv
    time: {column: t, unit: s}
    signals: {command: {column: u, unit: V}, velocity: {column: v, unit: m/s, sigma: 1 mm/s}}
    channels:
      oil: {column: T, unit: degC}
      other: {column: y, unit: mm}
  - file: b.csv
    role: validate
    time: {column: t, unit: s}
    signals: {command: {column: u, unit: V}, velocity: {column: v, unit: m/s, sigma: 1 mm/s}}
    channels:
      oil: {column: T, unit: degC, time: {column: t, unit: s}, offset: 0.5 s}
      other: {column: y, unit: m, factor: 1e-3}
free:
  M: {}
)";

class ChannelsTest : public ::testing::Test {
 protected:
  ChannelsTest() {
    folder_.write("mass.yaml", kMass);
    for (const char* name : {"a.csv", "b.csv"}) {
      std::vector<double> t, u, v, warm, y;
      for (int i = 0; i < 16; ++i) {
        t.push_back(i);
        u.push_back(i % 5);
        v.push_back((name[0] - 'a') + 0.1 * i * i);
        warm.push_back(20.0 + i);
        y.push_back(10.0 * (i - 4));
      }
      Table table;
      table.columns = {{"t", t}, {"u", u}, {"v", v}, {"T", warm}, {"y", y}};
      folder_.write(name, table);
    }
  }

  Job job(const std::string& text = kJob) {
    return read_job_file(folder_.write("job.yaml", text), {}).job;
  }
  std::string errors(const std::string& text) {
    try {
      job(text);
    } catch (const ConfigError& error) {
      return folder_.without_path(error.what());
    }
    return "";
  }
  std::string errors_with(const std::string& from, const std::string& to) {
    return errors(replaced(kJob, from, to));
  }
  void axis_with(const std::string& lines) { folder_.write("mass.yaml", kMass + lines); }

  TempFolder folder_;
};

TEST_F(ChannelsTest, MayBeDerivativesOfColumns) {
  const std::string text = replaced(
      replaced(kJob, "other: {column: y, unit: mm}", "other: {column: y, unit: mm, derivative: 1}"),
      "other: {column: y, unit: m, factor: 1e-3}",
      "other: {column: y, unit: m, factor: 1e-3, derivative: 1}");
  for (const char* name : {"a.csv", "b.csv"}) {
    std::vector<double> t, u, v, warm, y;
    for (int i = 0; i < 400; ++i) {
      t.push_back(0.01 * i);
      u.push_back(i % 5);
      v.push_back((name[0] - 'a') + 0.1 * i);
      warm.push_back(20.0);
      y.push_back(10.0 * t.back());
    }
    Table table;
    table.columns = {{"t", t}, {"u", u}, {"v", v}, {"T", warm}, {"y", y}};
    folder_.write(name, table);
  }
  const Job read = job(text);
  EXPECT_EQ((*read.model.structure.channels)[1].unit, "mm/s");
  for (const Recording& r : read.recordings)
    EXPECT_NEAR(r.channels[1][200] + (*read.model.structure.channels)[1].zero, 10.0, 1e-6);
  axis_with("channels: {other: {unit: m/s}}\n");
  EXPECT_NEAR(job(text).recordings[0].channels[0][200], 10e-3, 1e-9);
  axis_with("channels: {other: {unit: N}}\n");
  EXPECT_NE(errors(text).find("'mm' cannot be converted to '(N) s'"), std::string::npos)
      << errors(text);
}

TEST_F(ChannelsTest, AreReadWithUnitsTimesAndZeros) {
  const Job read = job();
  ASSERT_NE(read.model.structure.channels, nullptr);
  // Its mean over what is fitted, 27.5 degC; the other one passes zero.
  EXPECT_EQ(*read.model.structure.channels,
            (ChannelList{{"oil", "degC", 27.5}, {"other", "mm", 0.0}}));
  for (const Recording& r : read.recordings) {
    ASSERT_EQ(r.channels.size(), 2u);
    EXPECT_EQ(r.channels[1].size(), r.times.size());
    EXPECT_DOUBLE_EQ(r.channels[1][6], 20.0);
  }
  EXPECT_DOUBLE_EQ(read.recordings[0].channels[0][3], 23.0 - 27.5);
  // Half a second late, and held before it begins.
  EXPECT_DOUBLE_EQ(read.recordings[1].channels[0][3], 22.5 - 27.5);
  EXPECT_DOUBLE_EQ(read.recordings[1].channels[0][0], 20.0 - 27.5);
  const ChannelCourse course = read.recordings[0].course_at(3.25);
  EXPECT_DOUBLE_EQ(course.value[0], 23.25 - 27.5);
  EXPECT_DOUBLE_EQ(course.at(1, 3.5), -5.0);
}

TEST_F(ChannelsTest, CanBeDeclaredByTheAxisWithTheirZero) {
  axis_with(
      "channels: {oil: {unit: degC, zero: 25 degC}}\n"
      "effects: {channel_friction: {oil: -0.2 N/K}}\n");
  const Job read = job();
  EXPECT_EQ(read.model.structure.channels->front().zero, 25.0);
  EXPECT_DOUBLE_EQ(read.recordings[0].channels[0][3], -2.0);
  EXPECT_DOUBLE_EQ(std::get<ChannelFriction<double>>(read.model.effects).k[0], -0.2);
}

TEST_F(ChannelsTest, HaveEffectsThatAJobDeclaresFreesAndSets) {
  std::string text =
      replaced(kJob, "  M: {}\n", "  M: {}\n  channel_force.other: {bounds: [-1 N/m, 1 N/m]}\n");
  text = replaced(text, "recordings:", "effects: {channel_force: {other: 3 N/m}}\nrecordings:");
  text = replaced(text, "    role: validate\n",
                  "    role: validate\n    set: {channel_force.oil: 1 N/K}\n");
  EXPECT_NE(errors(text), "");  // the initial value is beyond the bounds
  text = replaced(text, "3 N/m", "0.5 N/m");
  const Job read = job(text);
  ASSERT_EQ(read.free.size(), 2u);
  EXPECT_EQ(read.entry(read.free[1].quantity).name, "channel_force.other");
  EXPECT_DOUBLE_EQ(read.free[1].initial, 0.5e-3);  // N/mm
  EXPECT_EQ(read.recordings[1].overrides.size(), 1u);
}

TEST_F(ChannelsTest, AnAxisFileReadsBackAsItWas) {
  axis_with(
      "channels: {oil: {unit: degC, zero: 25 degC}, load: {unit: N}, part: {unit: '%'}}\n"
      "effects: {channel_gain: {oil: 0.1 1/K}, channel_mass: {part: 2 kg}}\n");
  Diagnostics diagnostics;
  const auto rig = read_axis_file(folder_.path("mass.yaml"), diagnostics);
  ASSERT_TRUE(rig.has_value());
  const auto again =
      read_axis_file(folder_.write("again.yaml", format_axis_file(*rig, "Again.")), diagnostics);
  ASSERT_TRUE(again.has_value());
  EXPECT_EQ(rig->model.structure.channels, again->model.structure.channels);
  EXPECT_EQ(std::get<ChannelGain<double>>(again->model.effects).k[0], 0.1);
  EXPECT_EQ(std::get<ChannelMass<double>>(again->model.effects).k[2], 2.0);
}

TEST_F(ChannelsTest, OfEveryRecordingAreTheSame) {
  EXPECT_EQ(errors_with("      other: {column: y, unit: m, factor: 1e-3}\n", ""),
            "job.yaml:14:7: key 'other' is missing in channels");
  const std::string without =
      replaced(replaced(kJob, "      other: {column: y, unit: m, factor: 1e-3}\n", ""),
               "    channels:\n      oil: {column: T, unit: degC, time: {column: t, unit: s}, "
               "offset: 0.5 s}\n",
               "");
  EXPECT_NE(errors(without).find("'b' lacks the channels of the axis, or of the other recordings"),
            std::string::npos)
      << errors(without);
}

TEST_F(ChannelsTest, MistakesAreToldWithTheirPlace) {
  const auto expect = [&](const char* from, const char* to, const char* message) {
    const std::string found = errors_with(from, to);
    EXPECT_NE(found.find(message), std::string::npos) << found;
  };
  expect("oil: {column: T, unit: degC}", "oil: {column: T, unit: degX}",
         "7:30: unknown unit 'degX'");
  expect("oil: {column: T, unit: degC}", "oil: {column: none, unit: degC}", "job.yaml:7:");
  expect("other: {column: y, unit: mm}", "2nd: {column: y, unit: mm}",
         "'2nd' cannot be the name of a channel");
  expect("other: {column: y, unit: m, factor: 1e-3}", "other: {column: y, unit: V}",
         "'V' cannot be converted to 'mm'");
  expect("      other: {column: y, unit: mm}\n",
         "      c2: {column: y, unit: mm}\n      c3: {column: y, unit: mm}\n"
         "      c4: {column: y, unit: mm}\n      c5: {column: y, unit: mm}\n",
         "an axis has at most 4 channels");
  expect("  M: {}\n", "  M: {}\n  channel_force.oil: {}\n", "effect that is not active");
}

TEST_F(ChannelsTest, AnEffectOfThemNeedsOne) {
  axis_with("effects: {channel_friction: {oil: 1 N/K}}\n");
  Diagnostics diagnostics;
  EXPECT_FALSE(read_axis_file(folder_.path("mass.yaml"), diagnostics).has_value());
  try {
    diagnostics.throw_if_any();
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("channel_friction needs a channel: declare it"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace axisfit
