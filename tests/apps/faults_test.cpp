// What the machine does to a run: fit-params is killed, and finds the disk full, the memory used
// up, its folder in use or gone, its input in the making.
#include <gtest/gtest.h>
#include <sys/mount.h>

#include <thread>

#include "tests/apps/fit_job.h"
#include "tests/apps/killing.h"

namespace axisfit {
namespace {

using Names = std::set<std::string>;

class FaultsTest : public ::testing::Test {
 protected:
  FaultsTest() { write_recordings(folder_); }
  void job(const std::string& fit = "{}") { folder_.write("job.yaml", fit_job(fit)); }
  /// As an earlier run may have left it.
  std::string usable_result() {
    EXPECT_EQ(shell(folder_, "fit-params job.yaml --quiet --output results").exit_code, 0);
    return folder_.read("results/result.json");
  }

  TempFolder folder_;
};

TEST_F(FaultsTest, AKilledMultistartGoesOn) {
  job("{starts: 8}");
  Killing(folder_, "job.yaml").kill(3);
}

TEST_F(FaultsTest, AKilledLoopGoesOn) {
  write_rubbing_mass(folder_);
  folder_.write("job.yaml", rubbing_job());
  Killing(folder_, "job.yaml --close-loop").kill(3);
}

// A journal with something in it is locked.
TEST_F(FaultsTest, AFolderIsUsedByOneRunAtATime) {
  job("{starts: 100000}");
  const Answer answer = shell(folder_, R"(fit-params job.yaml --quiet --output results &
    until [ -s results/unfinished.journal ]; do sleep 0.01; done
    fit-params job.yaml --output results
    echo $? >second
    kill -KILL $!)");
  EXPECT_EQ(folder_.read("second"), "2\n");
  EXPECT_EQ(answer.err,
            "results could not be written to results: another run is using this folder; wait until "
            "it has finished, or choose another folder\n");
}

TEST_F(FaultsTest, AFolderThatVanishedDuringTheRunIsMadeAnew) {
  job("{starts: 20}");
  const Answer answer = shell(folder_, R"(fit-params job.yaml --quiet --output results &
    until [ -s results/unfinished.journal ]; do sleep 0.01; done
    rm -r results
    wait $!)");
  EXPECT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(folder_.names("results"),
            (Names{"fitted.yaml", "report.html", "residuals.csv", "result.json"}));
}

/// A small disk of its own.
class Disk {
 public:
  explicit Disk(const std::string& path) : path_(path) {
    std::filesystem::create_directory(path_);
    mounted_ = ::mount("none", path_.c_str(), "tmpfs", 0, "size=4m") == 0;
  }
  ~Disk() {
    if (mounted_) ::umount(path_.c_str());
  }
  Disk(const Disk&) = delete;
  Disk& operator=(const Disk&) = delete;
  bool is_mounted() const { return mounted_; }

 private:
  std::string path_;
  bool mounted_ = false;
};

TEST_F(FaultsTest, AFullDiskLeavesTheOldResultAndTheWork) {
  const Disk disk(folder_.path("disk"));
  if (!disk.is_mounted()) GTEST_SKIP() << "only root may make a small disk";
  const std::string fit = "fit-params job.yaml --output disk/results";
  job();
  EXPECT_EQ(shell(folder_, fit).exit_code, 0);
  const std::string before = folder_.read("disk/results/result.json");
  const Names whole = folder_.names("disk/results");

  // Room for the journal and a part of the results.
  shell(folder_, "dd if=/dev/zero of=disk/filler bs=64k; truncate --size=-128k disk/filler");
  job("{starts: 3}");
  const Answer full = shell(folder_, fit);
  EXPECT_EQ(full.exit_code, 2);
  EXPECT_EQ(full.err,
            "results could not be written to disk/results: No space left on device\nThe solutions "
            "found so far are kept there: once this is fixed, the same command with --resume "
            "finishes quickly.\n");
  EXPECT_EQ(folder_.names("disk"), (Names{"filler", "results"}));
  EXPECT_EQ(folder_.read("disk/results/result.json"), before);

  std::filesystem::remove(folder_.path("disk/filler"));
  const Answer on = shell(folder_, fit + " --resume");
  EXPECT_EQ(on.exit_code, 0);
  EXPECT_EQ(on.err.find("Resuming the run in disk/results: "), 0u) << on.err;
  EXPECT_EQ(folder_.names("disk/results"), whole);
  EXPECT_NE(folder_.read("disk/results/result.json"), before);

  // No room for anything.
  shell(folder_, "dd if=/dev/zero of=disk/filler bs=64k; dd if=/dev/zero of=disk/rest bs=1k");
  EXPECT_EQ(shell(folder_, "fit-params job.yaml --output disk/more").err,
            "results could not be written to disk/more: No space left on device\n");
  EXPECT_EQ(folder_.names("disk"), (Names{"filler", "rest", "results"}));
}

TEST_F(FaultsTest, ResultsAreWrittenEvenIfNobodySeesThem) {
  job();
  for (const std::string unseen :
       {"2>&- >/dev/null", ">&-", "<&- >&- 2>&-", ">/dev/full", "| true"}) {
    SCOPED_TRACE(unseen);
    shell(folder_, "fit-params job.yaml --output results " + unseen);
    EXPECT_EQ(folder_.names("results"),
              (Names{"fitted.yaml", "report.html", "residuals.csv", "result.json"}));
    EXPECT_TRUE(folder_.read("results/result.json").starts_with("{\n"));
    std::filesystem::remove_all(folder_.path("results"));
  }
  EXPECT_EQ(shell(folder_, "fit-params job.yaml >/dev/full").exit_code, 2);
  EXPECT_EQ(shell(folder_, "fit-params job.yaml >&-").exit_code, 2);
  EXPECT_EQ(shell(folder_, "fit-params job.yaml 2>&- >/dev/null").exit_code, 0);
}

TEST_F(FaultsTest, ASignalThatIsIgnoredStaysIgnored) {
  job("{starts: 3}");
  for (const std::string signal : {"INT", "TERM"})
    EXPECT_EQ(shell(folder_, "trap '' " + signal +
                                 "; fit-params job.yaml --quiet & "
                                 "while kill -" +
                                 signal + " $!; do :; done 2>/dev/null; wait $!")
                  .exit_code,
              0)
        << signal;
}

TEST_F(FaultsTest, AFileThatGrowsTooLargeIsAnErrorLikeAnother) {
  job();
  const std::string before = usable_result();
  const Answer answer = shell(folder_, "ulimit -f 40; fit-params job.yaml --output results");
  EXPECT_EQ(answer.exit_code, 2);
  EXPECT_EQ(
      answer.err,
      "results could not be written to results: File too large\nThe solutions found so far are "
      "kept there: once this is fixed, the same command with --resume finishes quickly.\n");
  EXPECT_EQ(folder_.read("results/result.json"), before);
}

TEST_F(FaultsTest, AUsableResultIsNotReplacedByAnother) {
  job();
  const std::string before = usable_result();
  constexpr const char* kKeeps =
      "results already holds a usable result, which was kept. To save this one, choose\nanother "
      "folder with --output.\n";
  job("{max_iterations: 1}");
  const Answer poor = shell(folder_, "fit-params job.yaml --output results");
  EXPECT_EQ(poor.exit_code, 3);
  EXPECT_EQ(poor.err, kKeeps);
  job("{starts: 100000}");
  Answer stopped;
  int limit = 1;  // s, or so much longer that a start is finished
  do {
    std::filesystem::remove(folder_.path("results/unfinished.journal"));
    stopped = shell(folder_, "fit-params job.yaml --threads 1 --output results --time-limit " +
                                 std::to_string(limit));
    EXPECT_EQ(stopped.exit_code, 124);
    limit *= 2;
  } while (stopped.out.empty() && limit < 500);
  EXPECT_EQ(stopped.err.find(kKeeps), 0u) << stopped.err;
  EXPECT_EQ(folder_.read("results/result.json"), before);
}

TEST_F(FaultsTest, LittleMemoryEndsInARefusal) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer maps terabytes";
#endif
  job();
  const std::string before = usable_result();
  int refused = 0;
  for (int mb = 20; mb <= 260; mb += 10) {
    SCOPED_TRACE(mb);
    const Answer answer =
        shell(folder_, "ulimit -v " + std::to_string(1000 * mb) +
                           "; fit-params job.yaml --quiet --starts 3 --threads 2 --output results");
    // Below some size not even the libraries can be loaded, which is not up to the program.
    if (answer.exit_code == 127) continue;
    if (answer.exit_code == 0) break;
    ++refused;
    ASSERT_EQ(answer.exit_code, 2) << answer.err;
    EXPECT_EQ(
        answer.err,
        "out of memory: this needs more than the machine has or a limit (ulimit -v) allows\n");
    EXPECT_EQ(folder_.read("results/result.json"), before);
  }
  EXPECT_GT(refused, 0);
}

TEST_F(FaultsTest, KilledAtAnyStepOfWritingAFolderHasOneResultOrTheOther) {
  if (shell(folder_, "strace -o trace true").exit_code != 0)
    GTEST_SKIP() << "there is no strace, or it may not trace";
  job("{starts: 2}");
  usable_result();
  const Contents after = contents_of_results(folder_);
  job();
  usable_result();
  const Contents before = contents_of_results(folder_);
  ASSERT_NE(before, after);
  shell(folder_, "cp -r results old");
  job("{starts: 2}");
  int old = 0, whole = 0;
  std::map<std::string, int> calls;
  for (const std::string call : {"flock", "pwrite64", "fsync", "renameat2", "unlink", "rmdir"})
    for (int when = 1; when < 100; ++when) {
      SCOPED_TRACE(call + " " + std::to_string(when));
      shell(folder_, "rm -r results; cp -r old results");
      // Where strace looks the leak sanitizer cannot, and would say so.
      const Answer answer =
          shell(folder_, "export ASAN_OPTIONS=detect_leaks=0; strace -f -o trace -e trace=" + call +
                             " -e inject=" + call + ":signal=KILL:when=" + std::to_string(when) +
                             " fit-params job.yaml --quiet --output results");
      if (answer.exit_code == 0) break;
      ASSERT_EQ(answer.exit_code, 137) << answer.err;
      const Contents found = contents_of_results(folder_);
      EXPECT_TRUE(found == before || found == after);
      ++(found == before ? old : whole);
      ++calls[call];
    }
  // A call that never comes kills nobody. Each file of the result goes through to the disk, and so
  // does the marker of the temporary folder.
  EXPECT_EQ(calls["flock"], 1);
  EXPECT_GE(calls["pwrite64"], 1);
  EXPECT_EQ(calls["fsync"], static_cast<int>(after.size()) + 1);
  EXPECT_EQ(calls["renameat2"], 1);
  EXPECT_GE(calls["unlink"], 1);
  EXPECT_GE(calls["rmdir"], 1);
  EXPECT_GT(old, 10);
  EXPECT_GE(whole, 2);
}

TEST_F(FaultsTest, ARecordingInTheMakingIsRefused) {
  job();
  std::string text = folder_.read("short.csv");
  const std::string header = text.substr(0, text.find('\n') + 1);
  const std::string path = folder_.path("growing.csv");
  {
    std::ofstream out(path);
    out << header;
    for (int i = 0; i < 200'000; ++i) out << i * 0.002 << ",5,0.1,0.2\n";
  }
  std::jthread writer([&](const std::stop_token& stop) {
    std::ofstream out(path, std::ios::app);
    while (!stop.stop_requested()) {
      out << std::flush << "0,0,0,0\n";
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  folder_.write("job.yaml", replaced(folder_.read("job.yaml"), "short.csv", "growing.csv"));
  const Answer answer = shell(folder_, "fit-params job.yaml --check");
  EXPECT_EQ(answer.exit_code, 2);
  EXPECT_NE(
      answer.err.find(
          "growing.csv: changed while it was being read; wait until it is complete and try again"),
      std::string::npos)
      << answer.err;
}

}  // namespace
}  // namespace axisfit
