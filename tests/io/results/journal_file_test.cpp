#include "io/results/journal_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <zlib.h>

#include <array>
#include <bit>
#include <cmath>
#include <filesystem>
#include <limits>

#include "tests/apps/files.h"

namespace axisfit {
namespace {

SolveResult solution(double x) {
  SolveResult s;
  s.usable = true;
  s.u = Eigen::Vector3d(x, -0.0, 1.0 / 3.0);
  s.cost = std::numeric_limits<double>::denorm_min();
  s.reduced_cost = std::nextafter(1.0, 2.0);
  s.iterations = 12;
  s.message = "größer";
  return s;
}

void expect_same(const SolveResult& a, const SolveResult& b) {
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
  EXPECT_EQ(a.usable, b.usable);
  EXPECT_EQ(a.converged, b.converged);
  ASSERT_EQ(a.u.size(), b.u.size());
  for (Eigen::Index i = 0; i < a.u.size(); ++i) EXPECT_EQ(bits(a.u[i]), bits(b.u[i]));
  EXPECT_EQ(bits(a.cost), bits(b.cost));
  EXPECT_EQ(bits(a.reduced_cost), bits(b.reduced_cost));
  EXPECT_EQ(a.iterations, b.iterations);
  EXPECT_EQ(a.message, b.message);
}

class JournalFileTest : public ::testing::Test {
 protected:
  /// Two solutions; the length of the file with the first alone.
  std::size_t write() {
    JournalFile journal(path_);
    journal.store(first_, solution(std::numeric_limits<double>::infinity()));
    const std::size_t length = folder_.read("journal").size();
    journal.store(second_, solution(1e-300));
    EXPECT_EQ(journal.failure(), "");
    EXPECT_FALSE(journal.is_empty());
    return length;
  }
  std::size_t found() { return JournalFile(path_).recovered(); }

  const ProblemKey first_{1, 2}, second_{1, 3};
  TempFolder folder_;
  const std::string path_ = folder_.path("journal");
};

TEST_F(JournalFileTest, GivesBackWhatItWasGivenBitForBit) {
  write();
  JournalFile journal(path_);
  EXPECT_EQ(journal.recovered(), 2u);
  EXPECT_FALSE(journal.find(first_)) << "nobody asked to go on";
  journal.resume();
  ASSERT_TRUE(journal.find(first_) && journal.find(second_));
  expect_same(*journal.find(first_), solution(std::numeric_limits<double>::infinity()));
  expect_same(*journal.find(second_), solution(1e-300));
  EXPECT_FALSE(journal.find({2, 1}));
}

TEST_F(JournalFileTest, WhatWasNotWrittenToItsEndDoesNotCount) {
  const std::size_t one = write();
  const std::string whole = folder_.read("journal");
  for (std::size_t length = one; length < whole.size(); ++length) {
    folder_.write("journal", whole.substr(0, length));
    EXPECT_EQ(found(), 1u) << length;
    EXPECT_EQ(folder_.read("journal").size(), one);
  }
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    folder_.write("journal", damaged);
    EXPECT_EQ(found(), at >= one ? 1u : 0u) << at;
  }
}

TEST_F(JournalFileTest, GoesOnBehindWhatWasNotWrittenToItsEnd) {
  const std::size_t one = write();
  folder_.write("journal", folder_.read("journal").substr(0, one + 20));
  JournalFile(path_).store(second_, solution(2.0));
  JournalFile journal(path_);
  EXPECT_EQ(journal.recovered(), 2u);
  journal.resume();
  expect_same(journal.find(second_).value(), solution(2.0));
}

TEST_F(JournalFileTest, HoldsSolutionsOfAnyNumberOfParameters) {
  SolveResult large = solution(1.0);
  large.u = Eigen::VectorXd::LinSpaced(100'000, 0.0, 1.0);
  JournalFile(path_).store(first_, large);
  JournalFile journal(path_);
  ASSERT_EQ(journal.recovered(), 1u);
  journal.resume();
  expect_same(*journal.find(first_), large);
}

TEST_F(JournalFileTest, WhatIsNoSolutionDoesNotCount) {
  // Arrays within arrays, more of them than a stack can hold, with a right checksum.
  const std::string nested(10'000'000, '\x81');
  const std::array<std::uint32_t, 3> frame{
      static_cast<std::uint32_t>(nested.size()), 0,
      static_cast<std::uint32_t>(
          crc32_z(0, reinterpret_cast<const Bytef*>(nested.data()), nested.size()))};
  const std::string deep =
      std::string(reinterpret_cast<const char*>(frame.data()), sizeof frame) + nested;
  folder_.write("journal", deep);
  EXPECT_EQ(found(), 0u);
  const std::string header = folder_.read("journal");  // a record, too
  const std::size_t one = write();
  const std::string good = folder_.read("journal").substr(0, one);
  for (const std::string& wrong : {header, deep}) {
    folder_.write("journal", good + wrong);
    EXPECT_EQ(found(), 1u);
    EXPECT_EQ(folder_.read("journal").size(), one);
  }
}

TEST_F(JournalFileTest, ForeignFilesAreBegunAnew) {
  for (const std::string& text :
       {std::string(), std::string("{}\n"), std::string(1000, '\0'), std::string(1000, '\xff')}) {
    folder_.write("journal", text);
    JournalFile journal(path_);
    EXPECT_EQ(journal.recovered(), 0u);
    EXPECT_TRUE(journal.is_empty());
  }
}

TEST_F(JournalFileTest, DoesNotReadWhatIsNoFile) {
  ASSERT_EQ(::mkfifo(path_.c_str(), 0600), 0);
  EXPECT_THROW(JournalFile{path_}, std::runtime_error);
  EXPECT_TRUE(std::filesystem::is_fifo(path_));
}

TEST_F(JournalFileTest, IsOpenOnce) {
  const JournalFile journal(path_);
  EXPECT_THROW(JournalFile{path_}, std::runtime_error);
}

}  // namespace
}  // namespace axisfit
