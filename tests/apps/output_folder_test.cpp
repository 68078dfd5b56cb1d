#include "apps/output_folder.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <functional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tests/apps/files.h"

namespace axisfit {
namespace {

using Names = std::set<std::string>;
using Files = std::vector<std::pair<std::string, std::string>>;

const Files kFiles{{"result.json", "{}\n"}, {"residuals.csv", std::string("a\0b", 3)}};

std::string error_of(const std::function<void()>& write) {
  try {
    write();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

// The tests may run as root, to whom every folder is writable: failures are of other kinds here.
class OutputFolderTest : public ::testing::Test {
 protected:
  std::string error_in(const std::string& name, const Files& files = kFiles) {
    return folder_.without_path(error_of([&] { write_folder(folder_.path(name), files); }));
  }
  std::string error_at(const std::string& name) {
    return folder_.without_path(error_of([&] { write_file(folder_.path(name), "new"); }));
  }
  TempFolder folder_;
};

TEST_F(OutputFolderTest, MakesTheFolderWithTheFiles) {
  write_folder(folder_.path("results"), kFiles);
  EXPECT_EQ(folder_.names(), Names{"results"});
  EXPECT_EQ(folder_.names("results"), (Names{"result.json", "residuals.csv"}));
  EXPECT_EQ(folder_.read("results/result.json"), "{}\n");
  EXPECT_EQ(folder_.read("results/residuals.csv"), std::string("a\0b", 3));
}

TEST_F(OutputFolderTest, MakesTheFoldersAbove) {
  write_folder(folder_.path("a/b/c"), kFiles);
  EXPECT_EQ(folder_.names("a"), Names{"b"});
  EXPECT_EQ(folder_.names("a/b"), Names{"c"});
  EXPECT_EQ(folder_.names("a/b/c").size(), 2u);
}

TEST_F(OutputFolderTest, TakesAnyFormOfAPath) {
  for (const char* name : {"slash/", "./dot", "./x/../up", "with blank", "größe"}) {
    SCOPED_TRACE(name);
    EXPECT_EQ(error_in(name), "");
    const std::string made = std::filesystem::path(name).lexically_normal().string();
    EXPECT_EQ(folder_.names(made), (Names{"result.json", "residuals.csv"}));
  }
  EXPECT_EQ(folder_.names(), (Names{"slash", "dot", "up", "with blank", "größe"}));
}

TEST_F(OutputFolderTest, TakesARelativePath) {
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder_.path());
  const std::string error = error_of([] { write_folder("results", kFiles); });
  const std::string again = error_of([] { write_folder(".", kFiles); });
  std::filesystem::current_path(before);
  EXPECT_EQ(error, "");
  EXPECT_EQ(again, "");
  EXPECT_EQ(folder_.names(), (Names{"results", "result.json", "residuals.csv"}));
}

TEST_F(OutputFolderTest, ReplacesItsFilesAndLeavesOthers) {
  write_folder(folder_.path("results"), {{"result.json", "old"}, {"notes.txt", "mine"}});
  write_folder(folder_.path("results"), kFiles);
  EXPECT_EQ(folder_.names(), Names{"results"});
  EXPECT_EQ(folder_.names("results"), (Names{"result.json", "residuals.csv", "notes.txt"}));
  EXPECT_EQ(folder_.read("results/result.json"), "{}\n");
  EXPECT_EQ(folder_.read("results/notes.txt"), "mine");
}

TEST_F(OutputFolderTest, LeavesNothingBelowARegularFile) {
  folder_.write("file", "mine");
  EXPECT_EQ(error_in("file"), "results not written to file: Not a directory");
  EXPECT_EQ(error_in("file/results"), "results not written to file/results: Not a directory");
  EXPECT_EQ(folder_.names(), Names{"file"});
  EXPECT_EQ(folder_.read("file"), "mine");
}

TEST_F(OutputFolderTest, LeavesNothingWhenTheFolderCannotBeMade) {
  const std::string name(300, 'x');
  EXPECT_EQ(error_in(name), "results not written to " + name + ": File name too long");
  EXPECT_EQ(error_in("new/" + name), "results not written to new/" + name + ": File name too long");
  EXPECT_EQ(folder_.names(), Names{});
}

TEST_F(OutputFolderTest, LeavesNothingWhenTheLastFileCannotBeWritten) {
  Files files = kFiles;
  files.emplace_back(std::string(300, 'x'), "");
  EXPECT_EQ(error_in("results", files), "results not written to results: File name too long");
  EXPECT_EQ(error_in("a/b/results", files),
            "results not written to a/b/results: File name too long");
  EXPECT_EQ(folder_.names(), Names{});
}

TEST_F(OutputFolderTest, ChangesNothingWhenTheLastFileCannotBeWritten) {
  write_folder(folder_.path("results"), {{"result.json", "old"}});
  Files files = kFiles;
  files.emplace_back(std::string(300, 'x'), "");
  EXPECT_EQ(error_in("results", files), "results not written to results: File name too long");
  EXPECT_EQ(folder_.names(), Names{"results"});
  EXPECT_EQ(folder_.names("results"), Names{"result.json"});
  EXPECT_EQ(folder_.read("results/result.json"), "old");
}

TEST_F(OutputFolderTest, ChangesNothingWhenTheLastFileCannotBeReplaced) {
  write_folder(folder_.path("results"), {{"result.json", "old"}});
  std::filesystem::create_directory(folder_.path("results/residuals.csv"));
  EXPECT_EQ(error_in("results"), "results not written to results: Is a directory");
  EXPECT_EQ(folder_.names(), Names{"results"});
  EXPECT_EQ(folder_.read("results/result.json"), "old");
}

TEST_F(OutputFolderTest, ACheckFailsAsWritingWouldAndLeavesNothing) {
  const auto check = [&](const std::string& name) {
    return folder_.without_path(error_of([&] {
      check_folder(folder_.path(name), {"result.json", "residuals.csv"});
    }));
  };
  EXPECT_EQ(check("results"), "");
  EXPECT_EQ(check("a/b/c"), "");
  EXPECT_EQ(folder_.names(), Names{});
  folder_.write("file", "mine");
  write_folder(folder_.path("results"), {{"result.json", "old"}});
  std::filesystem::create_directories(folder_.path("taken/residuals.csv"));
  const std::string name(300, 'x');
  EXPECT_EQ(check("results"), "");
  EXPECT_EQ(check("file"), "results not written to file: Not a directory");
  EXPECT_EQ(check("file/results"), "results not written to file/results: Not a directory");
  EXPECT_EQ(check("new/" + name), "results not written to new/" + name + ": File name too long");
  EXPECT_EQ(check("taken"), "results not written to taken: Is a directory");
  EXPECT_EQ(folder_.names(), (Names{"file", "results", "taken"}));
  EXPECT_EQ(folder_.names("results"), Names{"result.json"});
  EXPECT_EQ(folder_.names("taken"), Names{"residuals.csv"});
}

TEST_F(OutputFolderTest, WritesAFile) {
  EXPECT_EQ(error_at("step.csv"), "");
  EXPECT_EQ(folder_.read("step.csv"), "new");
  folder_.write("step.csv", "old and longer");
  EXPECT_EQ(error_at("step.csv"), "");
  EXPECT_EQ(folder_.read("step.csv"), "new");
  EXPECT_EQ(folder_.names(), Names{"step.csv"});
}

TEST_F(OutputFolderTest, LeavesNothingOfAFileThatCannotBeWritten) {
  const std::string name(255, 'x');
  EXPECT_EQ(error_at("none/step.csv"), "none/step.csv not written: No such file or directory");
  EXPECT_EQ(error_at(name), name + " not written: File name too long");
  EXPECT_EQ(folder_.names(), Names{});
}

TEST_F(OutputFolderTest, DoesNotReplaceWhatIsNoFile) {
  std::filesystem::create_directory(folder_.path("folder"));
  ASSERT_EQ(::mkfifo(folder_.path("pipe").c_str(), 0600), 0);
  EXPECT_EQ(error_at("folder"), "folder not written: it is there and not a file");
  EXPECT_EQ(error_at("pipe"), "pipe not written: it is there and not a file");
  EXPECT_TRUE(std::filesystem::is_fifo(folder_.path("pipe")));
  EXPECT_EQ(folder_.names(), (Names{"folder", "pipe"}));
}

}  // namespace
}  // namespace axisfit
