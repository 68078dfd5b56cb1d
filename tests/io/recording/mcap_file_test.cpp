#include "io/recording/mcap_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/apps/files.h"

namespace axisfit {
namespace {

std::string kept(const std::string& name) {
  return std::string(AXISFIT_TESTDATA) + "/mcap/" + name + ".mcap";
}

std::string contents(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class McapTest : public ::testing::Test {
 protected:
  Table read(const std::string& bytes) { return read_mcap(folder_.write("bag.mcap", bytes)); }
  std::string error(const std::string& bytes) {
    try {
      read(bytes);
    } catch (const RecordingError& caught) {
      return folder_.without_path(caught.what());
    }
    return "no error";
  }

  TempFolder folder_;
};

/// What testdata/mcap/make.mjs writes.
void expect_the_recording(const Table& table, std::size_t samples = 40) {
  const auto column = [&](const char* name) -> const Column& {
    const Column* found = table.find(name);
    if (found == nullptr) throw std::runtime_error(std::string("no column ") + name);
    return *found;
  };
  const auto clock = [&](const char* name) -> const Column& {
    return table.columns[column(name).clock.value()];
  };
  // Joints by name, though they change places in every message.
  const Column& elbow = column("/joint_states.position.elbow");
  const Column& speed = column("/joint_states.velocity.wrist");
  ASSERT_EQ(elbow.values.size(), samples);
  for (std::size_t i = 0; i < samples; ++i) {
    EXPECT_DOUBLE_EQ(elbow.values[i], 0.1 * double(i));
    if (i == 5) {
      EXPECT_TRUE(std::isnan(speed.values[i]));
    } else {
      EXPECT_DOUBLE_EQ(speed.values[i], -0.4 * double(i));
    }
  }
  EXPECT_EQ(clock("/joint_states.position.elbow").name, "/joint_states.header.stamp");
  EXPECT_EQ(clock("/joint_states.position.elbow").unit, "s");
  EXPECT_NEAR(clock("/joint_states.position.elbow").values[3], 0.029, 1e-12);
  // A topic at half the rate has its own times.
  EXPECT_EQ(column("/current.data").values.size(), (samples + 1) / 2);
  EXPECT_EQ(clock("/current.data").name, "/current log time");
  EXPECT_NEAR(clock("/current.data").values[2], 0.04, 1e-12);
  EXPECT_EQ(column("/current.data").values[2], 6.0);
  // A stamp of zero is none.
  EXPECT_EQ(clock("/wrench.wrench.force.z").name, "/wrench log time");
  EXPECT_EQ(column("/wrench.wrench.force.z").values[7], 21.0);
  // Constants, defaults, bounds, texts, fixed and variable sequences, messages in messages.
  EXPECT_EQ(column("/mixed.ready").values[3], 0.0);
  EXPECT_EQ(column("/mixed.ready").values[4], 1.0);
  EXPECT_EQ(column("/mixed.small").values[9], -9.0);
  EXPECT_EQ(column("/mixed.fixed[2]").values[9], 11.0);
  EXPECT_EQ(column("/mixed.few[0]").values[8], 0.5);
  EXPECT_EQ(column("/mixed.few[1]").values[8], 8.0);
  EXPECT_TRUE(std::isnan(column("/mixed.few[1]").values[9]));
  EXPECT_EQ(column("/mixed.large").values[0], std::ldexp(1.0, 40));
  EXPECT_EQ(column("/mixed.pairs[0].a").values[8], 8.0);
  EXPECT_EQ(column("/mixed.pairs[1].b").values[8], 0.0);
  EXPECT_EQ(table.find("/mixed.picture[0]"), nullptr);
  // JSON.
  EXPECT_EQ(column("/json.q[1]").values[6], 12.0);
  EXPECT_EQ(column("/json.deep.tau").values[6], -3.0);
  EXPECT_EQ(column("/json.on").values[6], 1.0);
  EXPECT_EQ(clock("/json.on").name, "/json.header.stamp");
  EXPECT_EQ(column("/proto").obstacle,
            "has messages in protobuf; convert the recording to ros2msg or JSON, or export CSV");
}

TEST_F(McapTest, ReadsEveryTopicWhateverTheCompression) {
  for (const char* name : {"plain", "lz4", "zstd"}) {
    SCOPED_TRACE(name);
    expect_the_recording(read_mcap(kept(name)));
  }
}

TEST_F(McapTest, ReadsAFileWhoseRecorderWasStopped) {
  const std::string whole = contents(kept("plain"));
  std::size_t fewest = 40;
  for (std::size_t size = 10000; size < whole.size(); size += 1777) {
    const Table table = read(whole.substr(0, size));
    const std::size_t rows = table.rows();
    EXPECT_GT(rows, 5u);
    EXPECT_LE(rows, 40u);
    fewest = std::min(fewest, rows);
  }
  EXPECT_LT(fewest, 20u);
}

TEST_F(McapTest, RefusesWhatIsDamaged) {
  EXPECT_EQ(error("t,x\n0,1\n"),
            "bag.mcap: is no MCAP file; convert the recording with 'mcap convert' or 'ros2 bag "
            "convert'");
  const std::string whole = contents(kept("zstd"));
  EXPECT_EQ(error(whole.substr(0, 8)), "bag.mcap: has no messages");
  // Anywhere in the first chunk that has messages.
  std::string flipped = whole;
  flipped[5000] = static_cast<char>(~flipped[5000]);
  EXPECT_NE(error(flipped).find("is damaged before byte "), std::string::npos) << error(flipped);
  std::string plain = contents(kept("plain"));
  plain[4000] = static_cast<char>(~plain[4000]);
  EXPECT_NE(error(plain).find("the checksum of a chunk is wrong; copy it again, or repair it with "
                              "'mcap recover'"),
            std::string::npos)
      << error(plain);
}

}  // namespace
}  // namespace axisfit
