#include "io/results/output_folder.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

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

/// What the library asks of the system, before it is done.
std::function<void(const std::string& call)> on_call;

void report(const std::string& call) {
  if (on_call) on_call(call);
}

}  // namespace
}  // namespace axisfit

// In place of the C library's, for other libraries, too.
#pragma GCC visibility push(default)
extern "C" {
int fsync(int file) {
  axisfit::report(
      "fsync " +
      std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(file)).filename().string());
  return static_cast<int>(::syscall(SYS_fsync, file));
}
int rename(const char* from, const char* to) noexcept {
  axisfit::report("rename " + std::filesystem::path(from).filename().string());
  return static_cast<int>(::syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}
int renameat2(int from_folder, const char* from, int to_folder, const char* to,
              unsigned flags) noexcept {
  axisfit::report("rename " + std::filesystem::path(from).filename().string());
  return static_cast<int>(::syscall(SYS_renameat2, from_folder, from, to_folder, to, flags));
}
}
#pragma GCC visibility pop

namespace axisfit {
namespace {

using Names = std::set<std::string>;
const Files kFiles{{"result.json", "{}\n"}, {"residuals.csv", std::string("a\0b", 3)}};

const std::vector<ResultName> kNames{
    {"result.json", ""}, {"residuals.csv", ""}, {"next-motion.yaml", ""}};
const std::string kTooLong(300, 'x');
constexpr const char* kJournal = "unfinished.journal";

/// As a run does that ends well.
void write_folder(const std::string& folder, const Files& files) {
  OutputFolder(folder, kNames).write(files, true);
}

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
  ino_t inode(const std::string& name) {
    struct stat found = {};
    EXPECT_EQ(stat(folder_.path(name).c_str(), &found), 0);
    return found.st_ino;
  }
  /// The calls to the system that write() makes, and what the file `name` holds at each.
  std::vector<std::string> calls_of(const std::string& name, const std::function<void()>& write) {
    std::vector<std::string> calls;
    on_call = [&](const std::string& call) {
      const bool there = std::filesystem::exists(folder_.path(name));
      calls.push_back(call + ": " + (there ? folder_.read(name) : "nothing"));
    };
    write();
    on_call = nullptr;
    return calls;
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

TEST_F(OutputFolderTest, ExchangesAFolderOfResults) {
  write_folder(folder_.path("results"), {{"result.json", "old"}, {"next-motion.yaml", "old"}});
  const auto before = inode("results");
  write_folder(folder_.path("results"), kFiles);
  EXPECT_NE(inode("results"), before);
  EXPECT_EQ(folder_.names(), Names{"results"});
  EXPECT_EQ(folder_.names("results"), (Names{"result.json", "residuals.csv"}));
  EXPECT_EQ(folder_.read("results/result.json"), "{}\n");
}

TEST_F(OutputFolderTest, LeavesTheOtherFilesOfAFolder) {
  write_folder(folder_.path("results"), {{"result.json", "old"}, {"next-motion.yaml", "old"}});
  folder_.write("results/notes.txt", "mine");
  std::filesystem::create_directory(folder_.path("results/plots"));
  const auto before = inode("results");
  write_folder(folder_.path("results"), kFiles);
  EXPECT_EQ(inode("results"), before);
  EXPECT_EQ(folder_.names(), Names{"results"});
  EXPECT_EQ(folder_.names("results"),
            (Names{"result.json", "residuals.csv", "notes.txt", "plots"}));
  EXPECT_EQ(folder_.read("results/result.json"), "{}\n");
  EXPECT_EQ(folder_.read("results/notes.txt"), "mine");
}

TEST_F(OutputFolderTest, LeavesALinkAndTheModeOfAFolder) {
  write_folder(folder_.path("disk"), {{"result.json", "old"}});
  std::filesystem::create_directory_symlink("disk", folder_.path("results"));
  std::filesystem::permissions(folder_.path("disk"), std::filesystem::perms::owner_all);
  write_folder(folder_.path("results"), kFiles);
  EXPECT_TRUE(std::filesystem::is_symlink(folder_.path("results")));
  EXPECT_EQ(std::filesystem::status(folder_.path("disk")).permissions(),
            std::filesystem::perms::owner_all);
  EXPECT_EQ(folder_.read("disk/result.json"), "{}\n");
}

TEST_F(OutputFolderTest, TheRemainsOfAKilledRunGoAway) {
  write_folder(folder_.path("results"), {{"result.json", "old"}});
  const pid_t run = ::fork();
  ASSERT_GE(run, 0);
  if (run == 0) {
    on_call = [](const std::string&) { ::_exit(0); };  // with the first file half written
    write_folder(folder_.path("results"), kFiles);
    ::_exit(1);
  }
  int status = 1;
  ASSERT_EQ(::waitpid(run, &status, 0), run);
  ASSERT_EQ(status, 0);
  ASSERT_EQ(folder_.names(), (Names{"results", ".results.partial"}));
  write_folder(folder_.path("results"), kFiles);
  EXPECT_EQ(folder_.names(), Names{"results"});
  EXPECT_EQ(folder_.names("results"), (Names{"result.json", "residuals.csv"}));
}

TEST_F(OutputFolderTest, BelongsToOneRunAtATime) {
  {
    OutputFolder first(folder_.path("results"), kNames);
    EXPECT_EQ(error_in("results"),
              "results could not be written to results: another run is using this folder; wait "
              "until it has finished, or choose another folder");
    first.write(kFiles, true);
    EXPECT_EQ(folder_.read("results/result.json"), "{}\n");
  }
  EXPECT_EQ(error_in("results", {{"result.json", "second"}}), "");
  EXPECT_EQ(folder_.read("results/result.json"), "second");
}

TEST_F(OutputFolderTest, AFolderThatVanishedIsMadeAnew) {
  OutputFolder folder(folder_.path("a/results"), kNames);
  std::filesystem::remove_all(folder_.path("a"));
  folder.write(kFiles, true);
  EXPECT_EQ(folder_.names("a/results"), (Names{"result.json", "residuals.csv"}));
}

TEST_F(OutputFolderTest, AJournalWithAnythingInItOutlivesTheRun) {
  const ProblemKey key{1, 2};
  {
    const OutputFolder nothing_found(folder_.path("a/results"), kNames);
    EXPECT_EQ(folder_.names("a/results"), Names{kJournal});
  }
  EXPECT_EQ(folder_.names(), Names{});
  OutputFolder(folder_.path("results"), kNames).journal().store(key, {});
  EXPECT_EQ(folder_.names("results"), Names{kJournal});
  {
    OutputFolder folder(folder_.path("results"), kNames);
    EXPECT_EQ(folder.journal().recovered(), 1u);
    folder.write(kFiles, false);
    EXPECT_EQ(folder_.names("results"), (Names{kJournal, "result.json", "residuals.csv"}));
  }
  {
    OutputFolder folder(folder_.path("results"), kNames);
    EXPECT_EQ(folder.journal().recovered(), 1u);
    folder.write(kFiles, true);
  }
  EXPECT_EQ(folder_.names("results"), (Names{"result.json", "residuals.csv"}));
}

TEST_F(OutputFolderTest, WhatOthersPutIntoAFolderStays) {
  {
    const OutputFolder folder(folder_.path("a/results"), kNames);
    folder_.write("a/notes.txt", "mine");
  }
  EXPECT_EQ(folder_.names("a"), Names{"notes.txt"});
}

TEST_F(OutputFolderTest, LeavesNothingBelowARegularFile) {
  folder_.write("file", "mine");
  EXPECT_EQ(error_in("file"), "results could not be written to file: Not a directory");
  EXPECT_EQ(error_in("file/results"),
            "results could not be written to file/results: Not a directory");
  EXPECT_EQ(folder_.names(), Names{"file"});
  EXPECT_EQ(folder_.read("file"), "mine");
}

TEST_F(OutputFolderTest, LeavesNothingWhenTheFolderCannotBeMade) {
  EXPECT_EQ(error_in(kTooLong),
            "results could not be written to " + kTooLong + ": File name too long");
  EXPECT_EQ(error_in("new/" + kTooLong),
            "results could not be written to new/" + kTooLong + ": File name too long");
  EXPECT_EQ(folder_.names(), Names{});
}

TEST_F(OutputFolderTest, LeavesNothingWhenTheLastFileCannotBeWritten) {
  Files files = kFiles;
  files.emplace_back(kTooLong, "");
  EXPECT_EQ(error_in("results", files),
            "results could not be written to results: File name too long");
  EXPECT_EQ(error_in("a/b/results", files),
            "results could not be written to a/b/results: File name too long");
  EXPECT_EQ(folder_.names(), Names{});
}

TEST_F(OutputFolderTest, ChangesNothingWhenTheLastFileCannotBeWritten) {
  Files files = kFiles;
  files.emplace_back(kTooLong, "");
  const auto expect_unchanged = [&] {
    EXPECT_EQ(error_in("results", files),
              "results could not be written to results: File name too long");
    EXPECT_EQ(folder_.names(), Names{"results"});
    EXPECT_EQ(folder_.read("results/result.json"), "old");
  };
  write_folder(folder_.path("results"), {{"result.json", "old"}});
  expect_unchanged();
  EXPECT_EQ(folder_.names("results"), Names{"result.json"});
  folder_.write("results/notes.txt", "mine");
  expect_unchanged();
  EXPECT_EQ(folder_.names("results"), (Names{"result.json", "notes.txt"}));
}

TEST_F(OutputFolderTest, WhatCannotBeReplacedIsSaidBeforeTheWork) {
  std::filesystem::create_directories(folder_.path("results/residuals.csv"));
  folder_.write("results/result.json", "old");
  EXPECT_EQ(folder_.without_path(
                error_of([&] { const OutputFolder folder(folder_.path("results"), kNames); })),
            "results could not be written to results: residuals.csv there was not written by "
            "axisfit; move it, or choose another folder");
  EXPECT_EQ(folder_.names(), Names{"results"});
  EXPECT_EQ(folder_.names("results"), (Names{"result.json", "residuals.csv"}));
  EXPECT_EQ(folder_.read("results/result.json"), "old");
}

TEST_F(OutputFolderTest, ReplacesNothingThatItCannotProveToBeItsOwn) {
  const std::vector<ResultName> names{{"result.json", "by axisfit"},
                                      {"residuals.csv", "by axisfit"}};
  const Files files{{"result.json", "{} by axisfit"}};
  const auto error = [&](const std::string& name) {
    return folder_.without_path(
        error_of([&] { OutputFolder(folder_.path(name), names).write(files, true); }));
  };
  EXPECT_EQ(error("results"), "");
  for (const char* name : {"residuals.csv", "result.json", kJournal}) {
    SCOPED_TRACE(name);
    std::filesystem::remove_all(folder_.path("results"));
    std::filesystem::create_directory(folder_.path("results"));
    folder_.write(std::string("results/") + name, "mine");
    EXPECT_EQ(error("results"), std::string("results could not be written to results: ") + name +
                                    " there was not written by axisfit; move it, or choose another "
                                    "folder");
    EXPECT_EQ(folder_.names("results"), Names{name});
    EXPECT_EQ(folder_.read(std::string("results/") + name), "mine");
    folder_.write(std::string("results/") + name, "");  // in which there is nothing to lose
    EXPECT_EQ(error("results"), "");
  }
  // Put there while the run was at work.
  OutputFolder folder(folder_.path("results"), names);
  folder_.write("results/residuals.csv", "mine");
  EXPECT_NE(error_of([&] { folder.write(files, true); }), "");
  EXPECT_EQ(folder_.read("results/residuals.csv"), "mine");
}

TEST_F(OutputFolderTest, LeavesFoldersOfOthersThatAreNamedAsItsTemporaryOnes) {
  const std::vector<ResultName> names{{"result.json", "by axisfit"}};
  const Files files{{"result.json", "{} by axisfit"}};
  const auto error = [&] {
    return folder_.without_path(
        error_of([&] { OutputFolder(folder_.path("results"), names).write(files, true); }));
  };
  std::filesystem::create_directories(folder_.path(".results.partial/below"));
  folder_.write(".results.partial/result.json", "mine");
  EXPECT_EQ(error(), "");
  EXPECT_EQ(folder_.read("results/result.json"), "{} by axisfit");
  EXPECT_EQ(folder_.names(".results.partial"), (Names{"below", "result.json"}));
  EXPECT_EQ(folder_.read(".results.partial/result.json"), "mine");

  std::filesystem::create_directory(folder_.path("results/.partial"));
  folder_.write("results/.partial/notes.txt", "mine");
  EXPECT_EQ(error(),
            "results could not be written to results: results/.partial is in the way: move it");
  EXPECT_EQ(folder_.read("results/.partial/notes.txt"), "mine");
}

TEST_F(OutputFolderTest, OverwritesNothingThatWasRead) {
  folder_.write("axis.yaml", "mine");
  std::filesystem::create_directory(folder_.path("results"));
  std::filesystem::create_symlink("../axis.yaml", folder_.path("results/result.json"));
  const auto error = [&](const std::vector<std::string>& inputs) {
    return folder_.without_path(
        error_of([&] { const OutputFolder folder(folder_.path("results"), kNames, inputs); }));
  };
  EXPECT_EQ(error({folder_.path("none"), folder_.path("axis.yaml")}),
            "results could not be written to results: axis.yaml is read by this run and would be "
            "overwritten; choose another output");
  EXPECT_EQ(folder_.read("axis.yaml"), "mine");
  EXPECT_EQ(folder_.names("results"), Names{"result.json"});

  const std::string same = folder_.path("results/../axis.yaml");
  EXPECT_EQ(folder_.without_path(
                error_of([&] { refuse_to_overwrite(same, {folder_.path("axis.yaml")}); })),
            "axis.yaml is read by this run and would be overwritten; choose another output");
  EXPECT_NO_THROW(refuse_to_overwrite(folder_.path("new.yaml"), {folder_.path("axis.yaml"), ""}));
}

TEST_F(OutputFolderTest, TakesNamesOfAnyLengthThatTheSystemTakes) {
  const std::string longest(255, 'x');
  EXPECT_EQ(error_in(longest), "");
  EXPECT_EQ(error_in(longest), "") << "over the earlier results";
  EXPECT_EQ(folder_.names(), Names{longest});
  EXPECT_EQ(folder_.names(longest), (Names{"result.json", "residuals.csv"}));
  EXPECT_EQ(error_at(longest + "/" + longest), "");
  EXPECT_EQ(folder_.read(longest + "/" + longest), "new");
}

TEST_F(OutputFolderTest, AfterAFailureTheJournalIsThereToGoOnFrom) {
  OutputFolder folder(folder_.path("results"), kNames);
  folder.journal().store({1, 2}, {});
  EXPECT_EQ(
      folder_.without_path(error_of([&] {
        folder.write({{kTooLong, ""}}, true);
      })),
      "results could not be written to results: File name too long\nThe solutions found so far are "
      "kept there: once this is fixed, the same command with --resume finishes quickly.");
  EXPECT_EQ(folder_.names("results"), Names{kJournal});
}

TEST_F(OutputFolderTest, WritesAFile) {
  EXPECT_EQ(error_at("step.csv"), "");
  EXPECT_EQ(folder_.read("step.csv"), "new");
  folder_.write("step.csv", "old and longer");
  EXPECT_EQ(error_at("step.csv"), "");
  EXPECT_EQ(folder_.read("step.csv"), "new");
  EXPECT_EQ(folder_.names(), Names{"step.csv"});
}

// Else a crash of the machine could leave the new name with nothing in it.
TEST_F(OutputFolderTest, FilesAreOnTheDiskBeforeTheyGetTheirNames) {
  const auto calls = [&] {
    return calls_of("results/result.json", [&] { write_folder(folder_.path("results"), kFiles); });
  };
  const std::vector<std::string> exchanged{"fsync .axisfit: old", "fsync result.json: old",
                                           "fsync residuals.csv: old",
                                           "rename .results.partial: old"};
  const std::vector<std::string> one_by_one{"fsync .axisfit: old", "fsync result.json: old",
                                            "fsync residuals.csv: old", "rename result.json: old",
                                            "rename residuals.csv: {}\n"};
  write_folder(folder_.path("results"), {{"result.json", "old"}});
  EXPECT_EQ(calls(), exchanged);
  EXPECT_EQ(folder_.read("results/result.json"), "{}\n");
  folder_.write("results/result.json", "old");
  folder_.write("results/notes.txt", "mine");
  EXPECT_EQ(calls(), one_by_one);
}

TEST_F(OutputFolderTest, AFileIsTheOldOneUntilTheNewOneIsOnTheDisk) {
  const std::string partial = ".partial-" + std::to_string(::getpid()) + "-0";
  folder_.write("step.csv", "old");
  EXPECT_EQ(
      calls_of("step.csv", [&] { EXPECT_EQ(error_at("step.csv"), ""); }),
      (std::vector<std::string>{"fsync " + partial + ": old", "rename " + partial + ": old"}));
  EXPECT_EQ(folder_.read("step.csv"), "new");
}

TEST_F(OutputFolderTest, FollowsNoLinkThatAwaitsItsTemporaryFile) {
  const std::string other = folder_.write("other", "precious");
  const std::string link = ".partial-" + std::to_string(::getpid()) + "-0";
  std::filesystem::create_symlink(other, folder_.path(link));
  EXPECT_EQ(error_at("step.csv"), "");
  EXPECT_EQ(folder_.read("step.csv"), "new");
  EXPECT_EQ(folder_.read("other"), "precious");
  EXPECT_EQ(folder_.names(), (Names{link, "other", "step.csv"}));
}

TEST_F(OutputFolderTest, LeavesNothingOfAFileThatCannotBeWritten) {
  const std::string name(256, 'x');
  EXPECT_EQ(error_at("none/step.csv"), "none/step.csv not written: No such file or directory");
  EXPECT_EQ(error_at(name), name + " not written: File name too long");
  EXPECT_EQ(folder_.names(), Names{});
}

TEST_F(OutputFolderTest, DoesNotReplaceWhatIsNoFile) {
  std::filesystem::create_directory(folder_.path("folder"));
  ASSERT_EQ(::mkfifo(folder_.path("pipe").c_str(), 0600), 0);
  EXPECT_EQ(error_at("folder"), "folder not written: it exists and is not a file");
  EXPECT_EQ(error_at("pipe"), "pipe not written: it exists and is not a file");
  EXPECT_TRUE(std::filesystem::is_fifo(folder_.path("pipe")));
  EXPECT_EQ(folder_.names(), (Names{"folder", "pipe"}));
}

}  // namespace
}  // namespace axisfit
