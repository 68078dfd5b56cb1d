#include "exports/scratch_file.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace axisfit {
namespace {

namespace fs = std::filesystem;

TEST(ScratchFile, HoldsBytesAndGoesAway) {
  const std::string bytes("a\0b\r\n\xFF", 6);
  std::string path;
  {
    const ScratchFile file;
    path = file.path();
    file.write(bytes);
    EXPECT_EQ(file.read(), bytes);
    file.write("x");
    EXPECT_EQ(file.read(), "x");
  }
  EXPECT_FALSE(fs::exists(fs::path(path).parent_path()));
}

TEST(ScratchFile, IsNobodyElses) {
  const ScratchFile one, other;
  EXPECT_NE(one.path(), other.path());
  EXPECT_EQ(fs::status(fs::path(one.path()).parent_path()).permissions(), fs::perms::owner_all);
}

TEST(ScratchFile, SaysThatItCannotBeWritten) {
  const ScratchFile file;
  fs::remove_all(fs::path(file.path()).parent_path());
  EXPECT_THROW(file.write("x"), std::runtime_error);
}

}  // namespace
}  // namespace axisfit
