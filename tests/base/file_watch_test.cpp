#include "base/file_watch.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/apps/files.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;

class FileWatchTest : public ::testing::Test {
 protected:
  TempFolder folder_;
  const std::string path_ = folder_.write("a.csv", "t,x\n0,1\n");
  const FileWatch watch_{path_};
};

TEST_F(FileWatchTest, SeesNothingWhereNothingHappens) {
  std::ifstream(path_).get();
  EXPECT_FALSE(watch_.has_changed());
}

TEST_F(FileWatchTest, SeesAFileThatGrows) {
  std::ofstream(path_, std::ios::app) << "1,2\n";
  EXPECT_TRUE(watch_.has_changed());
}

TEST_F(FileWatchTest, SeesWhatIsWrittenInPlace) {
  // Of the same size: only the time tells.
  const auto before = fs::last_write_time(path_);
  fs::last_write_time(path_, before + std::chrono::nanoseconds(1));
  EXPECT_TRUE(watch_.has_changed());
}

TEST_F(FileWatchTest, SeesAFileInThePlaceOfAnother) {
  const auto before = fs::last_write_time(path_);
  folder_.write("b.csv", "t,x\n0,2\n");
  fs::rename(folder_.path("b.csv"), path_);
  fs::last_write_time(path_, before);
  EXPECT_TRUE(watch_.has_changed());
}

TEST_F(FileWatchTest, SeesThatAFileIsGone) {
  fs::remove(path_);
  EXPECT_TRUE(watch_.has_changed());
}

TEST_F(FileWatchTest, OfWhatIsNoFileSaysNothing) {
  const FileWatch none(folder_.path("none"));
  folder_.write("none", "now there is one");
  EXPECT_FALSE(none.has_changed());
  EXPECT_FALSE(FileWatch(folder_.path()).has_changed());
}

}  // namespace
}  // namespace axisfit
