// The programs as their users run them.
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <matio.h>
#include <spawn.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <mutex>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "io/recording/csv.h"
#include "tests/apps/files.h"
#include "tests/apps/fit_job.h"

extern char** environ;

namespace axisfit {
namespace {

using Json = nlohmann::ordered_json;
using Names = std::set<std::string>;

const std::string kXAxis = AXISFIT_CONFIGS "/axes/x.yaml";

struct Outcome {
  int exit_code = -1;
  std::string out, err;
};

/// A terminal that shows nothing to anybody, but keeps what is written to it.
class Terminal {
 public:
  explicit Terminal(unsigned short columns = 0) : master_(posix_openpt(O_RDWR | O_NOCTTY)) {
    if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0)
      throw std::runtime_error("no terminal to be had");
    path_ = ptsname(master_);
    slave_ = open(path_.c_str(), O_RDWR | O_NOCTTY);  // else reading would end at once
    const winsize size{.ws_row = 0, .ws_col = columns, .ws_xpixel = 0, .ws_ypixel = 0};
    ioctl(slave_, TIOCSWINSZ, &size);
    reader_ = std::thread([this] {
      char buffer[4096];
      for (ssize_t n; (n = read(master_, buffer, sizeof buffer)) > 0;) {
        const std::lock_guard lock(mutex_);
        text_.append(buffer, static_cast<std::size_t>(n));
      }
    });
  }
  ~Terminal() {
    finish();
    close(master_);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  const std::string& path() const { return path_; }
  /// What was written so far.
  std::string text() {
    const std::lock_guard lock(mutex_);
    return text_;
  }
  /// All that was written, when nobody writes any more.
  const std::string& finish() {
    if (reader_.joinable()) {
      close(slave_);
      reader_.join();
    }
    return text_;
  }

 private:
  int master_ = -1, slave_ = -1;
  std::string path_, text_;
  std::mutex mutex_;  ///< of the text
  std::thread reader_;
};

/// Solutions in the journal of a run that may be adding to it.
std::size_t solutions_in(const std::string& journal) {
  std::ifstream in(journal, std::ios::binary);
  std::size_t records = 0;
  for (std::array<std::uint32_t, 3> frame; in.read(reinterpret_cast<char*>(frame.data()), 12);) {
    const std::streamsize size = frame[0] + std::streamsize{8} * frame[1];
    in.ignore(size);
    if (in.gcount() == size) ++records;
  }
  return records > 0 ? records - 1 : 0;  // the first says whose it is
}

class CommandLineTest : public ::testing::Test {
 protected:
  CommandLineTest() {
    write_recordings(folder_);
    setenv("TERM", "xterm", 1);
    unsetenv("NO_COLOR");
  }

  /// Runs a program with its outputs going to files; returns its exit code.
  int spawn(const std::string& program, std::vector<std::string> arguments, const std::string& out,
            const std::string& err) {
    arguments.insert(arguments.begin(), std::string(AXISFIT_BIN) + "/" + program);
    std::vector<char*> argv;
    for (std::string& a : arguments) argv.push_back(a.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    constexpr int kNew = O_WRONLY | O_CREAT | O_TRUNC | O_NOCTTY;
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 1, out.c_str(), kNew, 0600);
    posix_spawn_file_actions_addopen(&actions, 2, err.c_str(), kNew, 0600);
    pid_t child = 0;
    const int failed = posix_spawn(&child, argv[0], &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed != 0) throw std::runtime_error("cannot run " + arguments.front());
    if (interrupt_when_) interrupt(child);
    int status = 0;
    rusage used = {};
    if (wait4(child, &status, 0, &used) != child) throw std::runtime_error("lost " + program);
    const auto seconds = [](const timeval& t) {
      return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    cpu_time_ = seconds(used.ru_utime) + seconds(used.ru_stime);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  /// Interrupts a program as Ctrl-C does, as soon as interrupt_when_() holds. One that ends before
  /// that is left alone.
  void interrupt(pid_t child) {
    const auto at_most = std::chrono::steady_clock::now() + std::chrono::minutes(10);
    while (!interrupt_when_()) {
      siginfo_t ended = {};
      waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT);
      if (ended.si_pid == child) return;
      if (std::chrono::steady_clock::now() > at_most) {
        kill(child, SIGKILL);
        ADD_FAILURE() << "what was waited for did not happen";
        return;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    kill(child, SIGINT);
  }
  Outcome run(const std::string& program, std::vector<std::string> arguments) {
    const int exit_code =
        spawn(program, std::move(arguments), outputs_.path("out"), outputs_.path("err"));
    return {exit_code, outputs_.read("out"), outputs_.read("err")};
  }
  Outcome fit(std::vector<std::string> arguments) {
    return run("fit-params", std::move(arguments));
  }
  Outcome simulate(std::vector<std::string> arguments) {
    return run("simulate-axis", std::move(arguments));
  }

  std::string job(const std::string& text = fit_job()) { return folder_.write("job.yaml", text); }
  std::string motion() {
    return folder_.write("motion.yaml", "type: step\nlevel: 5 V\nduration: 0.1 s\n");
  }
  Table recorded(const std::string& contents) {
    return read_csv(outputs_.write("recorded.csv", contents));
  }

  TempFolder folder_, outputs_;
  std::function<bool()> interrupt_when_;  ///< never, if empty
  double cpu_time_ = 0.0;                 ///< s, of the latest run: whatever else the machine does
};

// fit-params

TEST_F(CommandLineTest, HelpHasExamples) {
  for (const char* program : {"fit-params", "simulate-axis"}) {
    const Outcome help = run(program, {"--help"});
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_NE(help.out.find("Examples:\n  " + std::string(program) + " "), std::string::npos);
    EXPECT_NE(help.out.find("Exit codes: 0 "), std::string::npos);
    EXPECT_EQ(help.err, "");
    std::istringstream lines(help.out);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
    const Outcome version = run(program, {"--version"});
    EXPECT_EQ(version.exit_code, 0);
    EXPECT_TRUE(version.out.starts_with("axisfit "));
  }
}

TEST_F(CommandLineTest, HelpIsTheSameByAnyName) {
  for (const char* program : {"fit-params", "simulate-axis"}) {
    const std::string help = run(program, {"--help"}).out;
    for (const char* asked : {"-h", "help"}) {
      const Outcome outcome = run(program, {asked});
      EXPECT_EQ(outcome.exit_code, 0);
      EXPECT_EQ(outcome.out, help);
    }
    EXPECT_EQ(run(program, {"-V"}).out, run(program, {"--version"}).out);
  }
}

TEST_F(CommandLineTest, HelpHasGroupsOfOptions) {
  const std::string help = fit({"--help"}).out;
  std::size_t at = 0;
  for (const char* part :
       {"\n\nFit:\n  --check", "\n\nEffect selection:\n  --close-loop", "\n\nFirst job:\n  --init",
        "\n\nResults:\n  -o,--output FOLDER", "\n\nOther:\n  -h,--help", "\n\nExamples:\n"}) {
    const std::size_t found = help.find(part, at);
    ASSERT_NE(found, std::string::npos) << part << help;
    at = found;
  }
  EXPECT_EQ(help.find("\n\n\n"), std::string::npos);
}

TEST_F(CommandLineTest, WithoutArgumentsHelpIsShort) {
  for (const std::string program : {"fit-params", "simulate-axis"}) {
    const Outcome outcome = run(program, {});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(outcome.err.starts_with("Usage: " + program + " [OPTIONS] ")) << outcome.err;
    EXPECT_TRUE(outcome.err.ends_with("All options: " + program + " --help\n"));
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 8);  // three examples among them
  }
}

TEST_F(CommandLineTest, OptionsHaveShortNames) {
  const Outcome outcome = fit({job(), "-q", "-o", folder_.path("short")});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_TRUE(folder_.names("short").contains("report.html"));
}

/// The contents of a file below packaging/, without the backslashes of a manual page's hyphens.
std::string packaged(const std::string& file) {
  std::ifstream in(AXISFIT_CONFIGS "/../packaging/" + file);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  std::erase(text, '\\');
  return text;
}

TEST_F(CommandLineTest, EveryOptionIsInTheManualAndTheCompletions) {
  for (const std::string program :
       {"fit-params", "simulate-axis", "axisfit-export", "axisfit-fleet", "simulate-fleet"}) {
    std::string help = run(program, {"--help"}).out;
    if (program == "axisfit-fleet")
      for (const char* command : {"plan", "work", "merge", "submit", "report", "table", "job"})
        help += run(program, {command, "--help"}).out;
    const std::regex option("\n  (?:-., ?)?(?:-.,)?--([a-z-]+)");
    int options = 0;
    for (std::sregex_iterator it(help.begin(), help.end(), option), end; it != end; ++it) {
      const std::string name = (*it)[1];
      SCOPED_TRACE(program + " --" + name);
      EXPECT_NE(packaged("man/" + program + ".1").find("--" + name), std::string::npos);
      EXPECT_NE(packaged("completions/" + program).find("--" + name), std::string::npos);
      EXPECT_NE(packaged("completions/_" + program).find("--" + name), std::string::npos);
      EXPECT_NE(packaged("completions/" + program + ".fish").find("-l " + name + " "),
                std::string::npos);
      ++options;
    }
    EXPECT_GE(options, 6) << program;
  }
}

TEST_F(CommandLineTest, WrongArgumentsAreBadInput) {
  const std::string good = job();
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{},
                                             {"--bogus", good},
                                             {good, good},
                                             {good, "--threads", "0"},
                                             {good, "--starts", "many"},
                                             {good, "--starts", "1e3"},
                                             {good, "--seed", "-1"},
                                             {good, "--seed", "18446744073709551616"},
                                             {good, "--time-limit", "nan"},
                                             {good, "--output", ""},
                                             {good, "--data", ""},
                                             {good, "--from", ""},
                                             {good, "--output"},
                                             {folder_.path("none.yaml")},
                                             {folder_.path()}}) {
    const Outcome outcome = fit(arguments);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(outcome.out, "");
    EXPECT_NE(outcome.err, "");
  }
}

TEST_F(CommandLineTest, NumbersAreDecimal) {
  const auto starts = [&](const char* number) {
    return Json::parse(fit({job(), "--json", "--starts", number}).out).at("starts").size();
  };
  EXPECT_EQ(starts("010"), 10u);
  EXPECT_EQ(fit({job(), "--seed", "18446744073709551615", "--quiet"}).exit_code, 0);
  const Outcome wrong = fit({job(), "--starts", "0x10"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_NE(wrong.err.find("'0x10' is not a whole number from 1 to 1000000"), std::string::npos)
      << wrong.err;
  for (const char* rate : {"nan", "inf", "1e300"})
    EXPECT_EQ(simulate({kXAxis, motion(), "--rate", rate}).exit_code, 2) << rate;
}

TEST_F(CommandLineTest, MessagesControlNoTerminal) {
  const Outcome none = fit({"no\x1B[2J\u202Esuch.yaml"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.err.find("no?[2J?such.yaml"), std::string::npos) << none.err;
  EXPECT_EQ(fit({"--\x1B[2J"}).err.find('\x1B'), std::string::npos);
}

TEST_F(CommandLineTest, OverwritesNothingThatItRead) {
  const std::string original = job();
  const Outcome once = fit({original, "--quiet", "--output", folder_.path("results")});
  EXPECT_EQ(once.exit_code, 0) << once.err;
  const std::string fitted = folder_.read("results/fitted.yaml");
  const Outcome again = fit({original, "--quiet", "--output", folder_.path("results"), "--from",
                             folder_.path("results/fitted.yaml")});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_EQ(folder_.without_path(again.err),
            "results could not be written to results: results/fitted.yaml is read by this run and "
            "would be overwritten; choose another output\n");
  EXPECT_EQ(folder_.read("results/fitted.yaml"), fitted);
  EXPECT_EQ(fit({original, "--quiet", "--output", folder_.path("results")}).exit_code, 0)
      << "its own results are replaced";

  std::filesystem::create_directory(folder_.path("mine"));
  std::filesystem::copy_file(folder_.path("short.csv"), folder_.path("mine/residuals.csv"));
  const std::string recorded = folder_.read("mine/residuals.csv");
  const std::string reads = job(replaced(fit_job(), "short.csv", "mine/residuals.csv"));
  EXPECT_EQ(fit({reads, "--quiet", "--output", folder_.path("mine")}).exit_code, 2);
  EXPECT_EQ(folder_.read("mine/residuals.csv"), recorded);

  const std::string path = motion(), level = folder_.read("motion.yaml");
  EXPECT_EQ(simulate({kXAxis, path, "--output", path}).exit_code, 2);
  EXPECT_EQ(folder_.read("motion.yaml"), level);
}

TEST_F(CommandLineTest, APipeForAResultBlocksNobody) {
  std::filesystem::create_directory(folder_.path("results"));
  ASSERT_EQ(::mkfifo(folder_.path("results/result.json").c_str(), 0600), 0);
  EXPECT_EQ(fit({job(), "--quiet", "--output", folder_.path("results")}).exit_code, 2);
  EXPECT_TRUE(std::filesystem::is_fifo(folder_.path("results/result.json")));
}

TEST_F(CommandLineTest, OneRecordingCountsOnce) {
  std::filesystem::copy_file(folder_.path("short.csv"), folder_.path("copy.csv"));
  const Outcome copied = fit({job(replaced(fit_job(), "judge.csv", "copy.csv"))});
  EXPECT_EQ(copied.exit_code, 2);
  EXPECT_NE(copied.err.find("'copy' has the same samples as 'short', and a recording counts once"),
            std::string::npos)
      << copied.err;
  const std::string twice = folder_.path("short.csv");
  const Outcome init = fit({"--init", twice, twice, "--output", folder_.path("new")});
  EXPECT_EQ(init.exit_code, 2);
  EXPECT_NE(init.err.find("is given twice"), std::string::npos) << init.err;
}

TEST_F(CommandLineTest, MisspeltOptionsGetASuggestion) {
  EXPECT_NE(fit({job(), "--close-lop"}).err.find("Did you mean --close-loop?\n"),
            std::string::npos);
  EXPECT_NE(fit({"--chekc"}).err.find("Did you mean --check?\n"), std::string::npos);
  EXPECT_EQ(fit({job(), "--bogus"}).err.find("Did you mean"), std::string::npos);
  EXPECT_NE(simulate({kXAxis, motion(), "--sginals", "velocity"}).err.find("mean --signals?"),
            std::string::npos);
}

TEST_F(CommandLineTest, AUsableFitIsReported) {
  const Outcome outcome = fit({job()});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.err, "");  // no progress where nobody looks
  EXPECT_TRUE(outcome.out.starts_with("Recordings\n"));
  EXPECT_NE(outcome.out.find("\nExplained: "), std::string::npos);
  EXPECT_EQ(outcome.out.find('\r'), std::string::npos);
  EXPECT_EQ(outcome.out.find('\033'), std::string::npos);
  EXPECT_EQ(folder_.names(), (Names{"job.yaml", "judge.csv", "short.csv"}));
}

TEST_F(CommandLineTest, QuietPrintsNothing) {
  const Outcome outcome = fit({job(), "--quiet"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err, "");
}

TEST_F(CommandLineTest, JsonIsOneDocumentAndNothingElse) {
  const Outcome outcome = fit({job(), "--json"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.err, "");
  const Json json = Json::parse(outcome.out);  // throws if anything follows
  EXPECT_EQ(json.at("status"), "converged");
  EXPECT_GT(json.at("wall_time_s"), 0.0);
  EXPECT_GT(json.at("work").at("fits").at("processor_time_s"), 0.0);
}

TEST_F(CommandLineTest, NoUsableFitHasItsOwnExitCode) {
  const std::string poor = job(fit_job("{max_iterations: 1, observer: none}"));
  const Outcome outcome = fit({poor, "--output", folder_.path("results")});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.out.find("Not converged"), std::string::npos);
  // What was found is there to look at.
  EXPECT_EQ(Json::parse(folder_.read("results/result.json")).at("usable"), false);
}

TEST_F(CommandLineTest, ABadJobWritesNothing) {
  const std::string bad =
      job(replaced(replaced(fit_job(), "B_a:", "B_b:"), "unit: A,", "unit: kg,"));
  const Outcome outcome = fit({bad, "--output", folder_.path("results"), "--json"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(folder_.without_path(outcome.err),
            "job.yaml:8:54: 'kg' cannot be converted to 'A'; use for example 'A'\njob.yaml:16:3: "
            "unknown quantity 'B_b'; did you mean 'B_m'?\n");
  EXPECT_EQ(folder_.names(), (Names{"job.yaml", "judge.csv", "short.csv"}));
}

TEST_F(CommandLineTest, OutputThatCannotBeWrittenIsAnError) {
  const Outcome outcome = fit({job(), "--output", folder_.path("job.yaml/results")});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(folder_.without_path(outcome.err),
            "results could not be written to job.yaml/results: Not a directory\n");
  EXPECT_EQ(folder_.names(), (Names{"job.yaml", "judge.csv", "short.csv"}));
}

TEST_F(CommandLineTest, OutputThatCannotBeWrittenIsFoundBeforeTheFit) {
  // A fit that would take hours.
  const std::string slow = job(fit_job("{starts: 1000000}"));
  EXPECT_EQ(fit({slow, "--output", folder_.path("job.yaml")}).exit_code, 2);
  std::filesystem::create_directories(folder_.path("results/fitted.yaml"));
  const Outcome outcome = fit({slow, "--output", folder_.path("results")});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(
      folder_.without_path(outcome.err),
      "results could not be written to results: fitted.yaml there was not written by axisfit; "
      "move it, or choose another folder\n");
}

TEST_F(CommandLineTest, ModelsAreComparedOnDemand) {
  write_rubbing_mass(folder_);
  const std::string results = folder_.path("results");
  const Outcome first = fit({job(rubbing_job()), "--close-loop", "--compare", "--output", results});
  EXPECT_EQ(first.exit_code, 0) << first.err;
  EXPECT_NE(first.out.find("Preferred: + coulomb_friction."), std::string::npos) << first.out;
  // What was found there is no better than what is found here.
  const Json found =
      Json::parse(fit({job(rubbing_job()), "--compare=" + results + "/fitted.yaml", "--json"}).out)
          .at("comparison");
  ASSERT_EQ(found.at("models").size(), 2u);
  EXPECT_EQ(found.at("preferred"), 1);
  EXPECT_GT(found.at("models")[0].at("log_ratio"), 0.5);
  EXPECT_GT(found.at("models")[1].at("inside_percent"), 80.0);
  const std::string other = folder_.write("other.yaml",
                                          "drive: current_source\ntransmission: "
                                          "rigid\nparameters: {M: 2 kg, K_m: 1 N "
                                          "m/A, J_m: 1 kg m^2, r_g: 1 m}\n");
  const Outcome refused = fit({job(rubbing_job()), "--compare=" + other});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("other.yaml"), std::string::npos) << refused.err;
}

TEST_F(CommandLineTest, AMotionIsPredictedOnDemand) {
  write_rubbing_mass(folder_);
  const std::string results = folder_.path("results");
  const Outcome outcome = fit({job(rubbing_job()), "--predict=" + motion(), "--within", "1 mm/s",
                               "--within=3mm", "--output", results});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("--within '3mm': no signal of the job can be given in mm"),
            std::string::npos)
      << outcome.err;
  const Outcome predicted =
      fit({job(rubbing_job()), "--predict=" + motion(), "--within", "1 mm/s", "--output", results});
  EXPECT_NE(predicted.out.find("motion.yaml, with 95 % bands"), std::string::npos) << predicted.out;
  EXPECT_NE(predicted.out.find("below 1 mm/s"), std::string::npos);
  const Table table = read_csv(results + "/predicted-motion.csv");
  EXPECT_EQ(table.columns.back().name.substr(table.columns.back().name.size() - 9), "_of_whole");
  for (const char* wrong : {"much", "-1 mm/s", "3", "nan m/s"})
    EXPECT_EQ(fit({job(rubbing_job()), "--predict", "--within", wrong}).exit_code, 2) << wrong;
}

TEST_F(CommandLineTest, AnAxisIsExportedWithWhatIsLost) {
  write_rubbing_mass(folder_);
  const std::string results = folder_.path("results");
  const std::string declared = job(rubbing_job());
  ASSERT_EQ(fit({declared, "--close-loop", "--quiet", "--output", results}).exit_code, 0);
  const std::string fitted = results + "/fitted.yaml", robot = folder_.path("robot");
  const Outcome whole =
      run("axisfit-export", {fitted, "--to", "mjcf", "--job", declared, "--output", robot});
  EXPECT_EQ(whole.exit_code, 0) << whole.err;
  EXPECT_NE(whole.out.find("Stops and break-aways are not located"), std::string::npos)
      << whole.out;
  EXPECT_NE(whole.out.find("The standard errors, correlations and scatter"), std::string::npos);
  EXPECT_NE(folder_.read("robot/fitted.xml").find("frictionloss"), std::string::npos);
  const Outcome urdf =
      run("axisfit-export", {fitted, "--to", "urdf", "--job", declared, "--output", robot});
  EXPECT_EQ(urdf.exit_code, 0) << urdf.err;
  EXPECT_NE(urdf.out.find("What that does to the job's recordings"), std::string::npos) << urdf.out;
  EXPECT_EQ(run("axisfit-export", {fitted, "--to", "matlab", "--output", robot}).exit_code, 0);
  EXPECT_NE(folder_.read("robot/fitted.m").find("axis.fitted.covariance = ["), std::string::npos);
  const Outcome code = run("axisfit-export", {fitted, "--to", "c", "--output", robot});
  EXPECT_NE(code.out.find("fitted_sfun.c"), std::string::npos) << code.out << code.err;
  EXPECT_NE(folder_.read("robot/fitted.c").find("coulomb_friction"), std::string::npos);
  const Outcome unit = run("axisfit-export", {fitted, "--to", "fmu3", "--output", robot});
  EXPECT_EQ(unit.out.find("left out: "), std::string::npos) << unit.out << unit.err;
  EXPECT_EQ(folder_.read("robot/fitted.fmu").substr(0, 2), "PK");

  const Outcome refused = run("axisfit-export", {kXAxis, "--to", "mjcf", "--output", robot});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("MJCF cannot express this axis"), std::string::npos) << refused.err;
  EXPECT_FALSE(std::filesystem::exists(robot + "/x.xml"));
  EXPECT_EQ(run("axisfit-export", {fitted, "--to", "fmu"}).exit_code, 2);
  EXPECT_EQ(run("axisfit-export", {fitted}).exit_code, 2);
}

TEST_F(CommandLineTest, TheLoopIsClosedOnDemand) {
  write_rubbing_mass(folder_);
  const std::string results = folder_.path("results");
  const Outcome outcome = fit({job(rubbing_job()), "--close-loop", "--json", "--output", results});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.err, "");
  const Json json = Json::parse(outcome.out);
  EXPECT_EQ(folder_.read("results/result.json"), outcome.out);
  EXPECT_EQ(json.at("after").at("added"), "coulomb_friction");
  EXPECT_EQ(json.at("residual").at("explained"), true);
  // The axis that was found has dry friction.
  EXPECT_NE(folder_.read("results/fitted.yaml").find("coulomb_friction:\n    F_c: "),
            std::string::npos);
  EXPECT_EQ(simulate({results + "/fitted.yaml", motion()}).exit_code, 0);

  // The next job goes on where this one stands; the declared one cannot.
  const std::string next = results + "/next-job.yaml";
  EXPECT_NE(folder_.read("results/next-job.yaml").find("axis: fitted.yaml\n"), std::string::npos);
  const Outcome again = fit({next, "--json"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_NEAR(Json::parse(again.out).at("reduced_chi_square").get<double>(),
              json.at("after").at("reduced_chi_square").get<double>(), 1e-3);
  EXPECT_EQ(fit({next, "--check"}).exit_code, 0);
  const Outcome lost = fit({job(rubbing_job()), "--from", results + "/fitted.yaml"});
  EXPECT_EQ(lost.exit_code, 2);
  EXPECT_EQ(folder_.without_path(lost.err),
            "--from results/fitted.yaml: this axis has the effect coulomb_friction, which the job "
            "has not: run the next-job.yaml beside it, or name the effect in the job\n");
}

TEST_F(CommandLineTest, CtrlCKeepsWhatIsFinished) {
  // Each start solves one problem; one thread starts them in turn.
  const std::string results = outputs_.path("results"), axis = results + "/fitted.yaml";
  const std::string path = job(fit_job("{observer: none}")), output = "--output=" + results;
  const std::vector<std::string> arguments{path, "--starts=100000", "--threads=1", output};
  const auto solutions = [&] { return solutions_in(results + "/unfinished.journal"); };
  interrupt_when_ = [&] { return solutions() >= 1; };
  const Outcome stopped = fit(arguments);
  EXPECT_LT(cpu_time_, 20.0 * kSlower);
  EXPECT_EQ(stopped.exit_code, 130);
  EXPECT_NE(stopped.out.find("Stopped early"), std::string::npos) << stopped.err;
  const Json json = Json::parse(outputs_.read("results/result.json"));
  const std::size_t finished = json.at("starts").size();
  EXPECT_EQ(json.at("interrupted"), true);
  EXPECT_GE(finished, 1u);
  EXPECT_LT(finished, 100000u);
  EXPECT_EQ(finished, solutions());

  // How to go on is for the user, not for who reads the result; and it works.
  EXPECT_EQ(stopped.out.find("--resume"), std::string::npos);
  const std::string command = path + " --starts=100000 --threads=1 " + output + " --resume";
  EXPECT_EQ(stopped.err, "\nTo continue:\n  fit-params " + command + "\n");
  std::vector<std::string> resume = arguments;
  resume.emplace_back("--resume");
  interrupt_when_ = [&] { return solutions() > finished; };
  const Outcome on = fit(resume);
  EXPECT_EQ(on.exit_code, 130);
  EXPECT_EQ(on.err.find("Resuming the run in"), 0u) << on.err;
  EXPECT_TRUE(on.err.ends_with("\nTo continue:\n  fit-params " + command + "\n")) << on.err;
  const Json further = Json::parse(outputs_.read("results/result.json"));
  EXPECT_GT(further.at("starts").size(), finished);
  EXPECT_EQ(further.at("starts").size(), solutions());

  interrupt_when_ = nullptr;
  const Json again = Json::parse(fit({path, "--json", "--from", axis}).out).at("parameters");
  for (std::size_t i = 0; i < again.size(); ++i)
    EXPECT_EQ(again[i].at("initial"), further.at("parameters")[i].at("value"));
}

TEST_F(CommandLineTest, CtrlCBeforeAnythingIsFinishedSaysSo) {
  // The journal is made between reading the recordings and the fit.
  const std::string journal = outputs_.path("results/unfinished.journal");
  interrupt_when_ = [&] { return std::filesystem::exists(journal); };
  const Outcome stopped =
      fit({AXISFIT_CONFIGS "/jobs/close-loop.yaml", "--output", outputs_.path("results")});
  EXPECT_EQ(stopped.exit_code, 130);
  EXPECT_EQ(stopped.out, "");
  EXPECT_TRUE(stopped.err.starts_with("Stopped before any fit finished")) << stopped.err;
  EXPECT_FALSE(std::filesystem::exists(outputs_.path("results/result.json")));
}

TEST_F(CommandLineTest, ATimeLimitKeepsWhatIsFinished) {
  // Until it is long enough for one start, which depends on the machine and what else it does.
  double limit = 0.25;
  Outcome stopped;
  do {
    limit *= 2.0;
    std::filesystem::remove_all(outputs_.path("results"));
    const auto begin = std::chrono::steady_clock::now();
    stopped = fit({job(), "--starts=1000000", "--threads=1", fmt::format("--time-limit={}", limit),
                   "--output", outputs_.path("results")});
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
    EXPECT_GE(taken.count(), limit);
    EXPECT_LT(cpu_time_, limit + 20.0 * kSlower);
    EXPECT_EQ(stopped.exit_code, 124);
  } while (stopped.out.empty() && limit < 300.0);
  EXPECT_NE(stopped.out.find(fmt::format("Stopped early by the time limit of {} s", limit)),
            std::string::npos)
      << stopped.err;
  EXPECT_NE(stopped.err.find("To continue:"), std::string::npos) << stopped.err;
  const Json json = Json::parse(outputs_.read("results/result.json"));
  EXPECT_EQ(json.at("interrupted"), true);
  EXPECT_EQ(json.at("time_limit_reached"), true);
  EXPECT_GE(json.at("starts").size(), 1u);
  EXPECT_LT(json.at("starts").size(), 1000000u);

  // Where it is enough nothing is said of it; where it is far too short there is nothing to keep.
  const Json whole = Json::parse(fit({job(), "--time-limit=1000", "--threads=1", "--json"}).out);
  EXPECT_EQ(whole.at("interrupted"), false);
  EXPECT_EQ(whole.at("time_limit_reached"), false);
  const Outcome nothing = fit({job(), "--time-limit", "0.001"});
  EXPECT_EQ(nothing.exit_code, 124);
  EXPECT_EQ(nothing.out, "");
  EXPECT_TRUE(nothing.err.starts_with(
      "Stopped by the time limit before any fit finished: there is no result.\n"))
      << nothing.err;
}

TEST_F(CommandLineTest, ProgressIsShownOnATerminalAndTakenAway) {
  const std::string many = job(fit_job("{starts: 1000000}"));
  constexpr const char* kClear = "\r\033[K";
  std::string text;
  {
    Terminal terminal;
    const std::regex some_done("[1-9][0-9]* of 1000000 done");
    interrupt_when_ = [&] { return std::regex_search(terminal.text(), some_done); };
    EXPECT_EQ(spawn("fit-params", {many}, outputs_.path("out"), terminal.path()), 130);
    text = terminal.finish();
  }
  EXPECT_NE(text.find(std::string(kClear) + "starts  "), std::string::npos) << text;
  EXPECT_NE(text.find(" of 1000000 done"), std::string::npos) << text;
  // What follows begins on a clean line.
  EXPECT_TRUE(text.substr(text.rfind(kClear)).starts_with(std::string(kClear) + "\r\nNothing was"))
      << text;
  EXPECT_EQ(outputs_.read("out").find('\033'), std::string::npos);

  // Where none is shown a run has to last longer than the second after which it would be.
  interrupt_when_ = nullptr;
  const auto shown_until = [&](double limit, const std::vector<std::string>& more) {
    Terminal terminal;
    std::vector<std::string> arguments{many, fmt::format("--time-limit={}", limit)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(spawn("fit-params", arguments, outputs_.path("out"), terminal.path()), 124);
    return terminal.finish();
  };
  EXPECT_EQ(shown_until(1.5, {"--quiet"}), "");
  setenv("TERM", "dumb", 1);
  double limit = 0.75;
  do {
    limit *= 2.0;
    text = shown_until(limit, {});
    EXPECT_EQ(text.find('\033'), std::string::npos) << text;
  } while (outputs_.read("out").empty() && limit < 300.0);  // no start was finished
  EXPECT_TRUE(text.starts_with("\r\nNothing was saved")) << text;
}

TEST_F(CommandLineTest, WhatIsQuickShowsNoProgress) {
  Terminal terminal;
  EXPECT_EQ(spawn("simulate-axis", {kXAxis, motion()}, outputs_.path("out"), terminal.path()), 0);
  EXPECT_EQ(terminal.finish(), "");
}

TEST_F(CommandLineTest, ColoursAreForTerminalsThatTakeThem) {
  const std::string path = job();
  const auto printed = [&](const std::vector<std::string>& more = {}) {
    Terminal terminal;
    std::vector<std::string> arguments{path};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(spawn("fit-params", arguments, terminal.path(), outputs_.path("err")), 0);
    return terminal.finish();
  };
  EXPECT_NE(printed().find("\033[1mParameters\033[0m"), std::string::npos);
  EXPECT_EQ(printed({"--no-color"}).find('\033'), std::string::npos);
  setenv("NO_COLOR", "1", 1);
  const std::string plain = printed();
  EXPECT_NE(plain.find("Parameters"), std::string::npos);
  EXPECT_EQ(plain.find('\033'), std::string::npos);
  setenv("NO_COLOR", "", 1);  // as if it were not set
  EXPECT_NE(printed().find('\033'), std::string::npos);
  setenv("TERM", "dumb", 1);
  EXPECT_EQ(printed().find('\033'), std::string::npos);
}

TEST_F(CommandLineTest, TablesFitANarrowTerminal) {
  const auto longest_row = [&](unsigned short columns, const std::vector<std::string>& arguments) {
    Terminal terminal(columns);
    EXPECT_EQ(spawn("fit-params", arguments, terminal.path(), outputs_.path("err")), 0);
    std::istringstream lines(terminal.finish());
    std::string longest;
    for (std::string line; std::getline(lines, line, '\r');)
      if (line.starts_with("\n ") && line.size() > longest.size()) longest = line.substr(1);
    return longest;
  };
  const std::string path = job();
  for (const std::vector<std::string>& arguments :
       {std::vector{path, std::string("--no-color")}, {path, "--no-color", "--check"}}) {
    const std::string line = longest_row(50, arguments);
    EXPECT_LE(line.size(), 50u) << line;
    EXPECT_GT(longest_row(200, arguments).size(), 60u);
  }
  // What is written to a file does not depend on the window.
  const std::string wide = fit({path, "--check"}).out;
  setenv("COLUMNS", "50", 1);
  const std::string narrow = fit({path, "--check"}).out;
  unsetenv("COLUMNS");
  const auto recordings = [](const std::string& text) {
    return text.substr(0, text.find("Estim"));
  };
  EXPECT_EQ(recordings(narrow), recordings(wide));
}

TEST_F(CommandLineTest, AMisspeltColumnIsNamedWithTheColumnsThereAre) {
  const std::string bad =
      job(replaced(fit_job(), "{column: velocity_mps, unit: m/s, sigma: 2 mm/s}",
                   "{column: velocty_mps, unit: m/s}"));
  const std::string csv = folder_.path("short.csv");
  EXPECT_EQ(folder_.without_path(fit({bad}).err),
            "job.yaml:7:26: no column 'velocty_mps' in short.csv; did you mean 'velocity_mps'? It "
            "has time_s, command_v, velocity_mps, motor_current_a\n");
}

TEST_F(CommandLineTest, NoLoopIsClosedAroundAnUnusableFit) {
  const std::string poor = job(fit_job("{max_iterations: 1, observer: none}"));
  const Outcome outcome = fit({poor, "--close-loop", "--json"});
  EXPECT_EQ(outcome.exit_code, 3);
  const Json json = Json::parse(outcome.out);
  EXPECT_FALSE(json.contains("selection"));
  // What is missing is shown all the same.
  EXPECT_GT(json.at("residual").at("missing_force")[0].at("rms_n"), 1.0);
  EXPECT_FALSE(json.at("residual").at("suspected_effects").empty());
  std::string told = fit({poor, "--close-loop"}).out;
  std::ranges::replace(told, '\n', ' ');
  EXPECT_NE(told.find("The declared model does not fit: nothing can be said about effects yet."),
            std::string::npos)
      << told;
}

TEST_F(CommandLineTest, WhatCanBeDeterminedIsToldBeforeTheFit) {
  const Outcome text = fit({job(), "--check"});
  EXPECT_EQ(text.exit_code, 0);
  EXPECT_TRUE(
      text.out.starts_with("What the recordings show\nshort (fit): 151 samples in 0.3 s, "
                           "500 Hz, no gaps\n"))
      << text.out;
  EXPECT_NE(text.out.find("\nWhat these recordings determine"), std::string::npos) << text.out;
  // How long depends on what else the machine does.
  const std::regex time("\nEstimated run time on this machine with [0-9]+ threads?: [0-9.]+ s if");
  EXPECT_TRUE(std::regex_search(text.out, time)) << text.out;
  EXPECT_EQ(text.out.find("\n  ! "), std::string::npos) << text.out;  // nothing looks wrong
  EXPECT_EQ(text.out.find("chi-square"), std::string::npos);
  const Json json = Json::parse(fit({job(), "--check", "--json"}).out);
  ASSERT_FALSE(json.at("parameters").empty());
  for (const Json& parameter : json.at("parameters")) {
    EXPECT_EQ(parameter.at("verdict"), "determined");
    EXPECT_GT(parameter.at("standard_error"), 0.0);
    for (const Json& shown : parameter.at("sensitivity"))
      EXPECT_GT(shown.at("rms_over_noise"), 0.0);
  }
  const auto evaluations = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {job(), "--check", "--json", "--threads", "1"});
    const Json timed = Json::parse(fit(std::move(more)).out);
    EXPECT_GT(timed.at("evaluation_time_s"), 0.0);
    const Json& expected = timed.at("expected_time_s");
    EXPECT_GT(expected.at("unexplained"), expected.at("explained"));
    EXPECT_GT(expected.at("close_loop_nothing_missing"), expected.at("explained"));
    EXPECT_GT(expected.at("close_loop_one_effect"), expected.at("unexplained"));
    EXPECT_GT(expected.at("close_loop_no_effect"), expected.at("close_loop_one_effect"));
    return expected.at("unexplained").get<double>() / timed.at("evaluation_time_s").get<double>();
  };
  EXPECT_GT(evaluations({"--starts", "40"}), 10.0 * evaluations({}));
  EXPECT_EQ(fit({job(), "--check", "--profile"}).exit_code, 2);
}

TEST_F(CommandLineTest, WhatLooksWrongInTheRecordingsIsToldBeforeTheFit) {
  const auto concerns = [&](const std::string& from, const std::string& to) {
    const Outcome outcome = fit(
        {folder_.write("wrong.yaml", replaced(rubbing_job(false), from, to)), "--check", "--json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    std::string all;
    const Json json = Json::parse(outcome.out);
    for (const Json& concern : json.at("recordings")[0].at("warnings"))
      all += concern.get<std::string>() + "\n";
    return all;
  };
  write_rubbing_mass(folder_);
  EXPECT_EQ(concerns("fit: false", "fit: true"), "");
  EXPECT_NE(concerns("unit: m/s, sigma", "unit: km/s, sigma").find("acceleration is 0.00"),
            std::string::npos);
  EXPECT_NE(concerns("unit: m/s, sigma", "unit: m/s, sign: -1, sigma").find("use 'sign: -1'"),
            std::string::npos);
  EXPECT_NE(concerns("column: acceleration_mps2, unit: m/s^2",
                     "column: acceleration_mps2, unit: m/s^2, factor: 0.1019716")
                .find("factor: 9.80665"),
            std::string::npos);
  EXPECT_NE(concerns("unit: s}", "unit: min}").find("Is the unit of time right?"),
            std::string::npos);
  EXPECT_NE(concerns("sigma: 2 mm/s", "sigma: 0.02 mm/s").find("velocity scatters by 0.001"),
            std::string::npos);
}

TEST_F(CommandLineTest, AJobIsMadeForRecordings) {
  const std::string results = folder_.path("new");
  write_rubbing_mass(folder_);
  const Outcome made =
      fit({"--init", folder_.path("fitted.csv"), folder_.path("judged.csv"), "--output", results});
  EXPECT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(made.out, "");
  EXPECT_EQ(folder_.names("new"), (Names{"axis.yaml", "job.yaml"}));
  EXPECT_TRUE(
      folder_.without_path(made.err).starts_with("Wrote new/axis.yaml\nWrote new/job.yaml\n"))
      << made.err;
  EXPECT_TRUE(folder_.without_path(made.err).ends_with("      fit-params new/job.yaml\n"));
  EXPECT_EQ(fit({results + "/job.yaml", "--check"}).exit_code, 0);
  EXPECT_EQ(fit({results + "/job.yaml"}).exit_code, 0);
  for (const std::string kind : {"axis", "job"})  // for editors
    EXPECT_TRUE(folder_.read("new/" + kind + ".yaml")
                    .starts_with("# yaml-language-server: $schema=/usr/share/axisfit/schema/" +
                                 kind + ".schema.json\n# "));

  // What is there stays.
  const std::string before = folder_.read("new/job.yaml");
  const Outcome again = fit({"--init", folder_.path("judged.csv"), "--output", results});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_EQ(folder_.without_path(again.err),
            "new/axis.yaml already exists and would be overwritten: move it, or choose another "
            "folder with --output\n");
  EXPECT_EQ(folder_.read("new/job.yaml"), before);

  // With an axis file there is none to write; and a recording is no job.
  const Outcome given =
      fit({"--init", folder_.path("fitted.csv"), "--axis", folder_.path("plain.yaml"), "--output",
           folder_.path("given"), "--quiet"});
  EXPECT_EQ(given.exit_code, 0);
  EXPECT_EQ(given.err, "");
  EXPECT_EQ(folder_.names("given"), Names{"job.yaml"});
  EXPECT_EQ(fit({folder_.path("fitted.csv")}).exit_code, 2);
  EXPECT_EQ(fit({"--init", folder_.path("fitted.csv"), "--check"}).exit_code, 2);
  EXPECT_EQ(fit({job(), "--axis", folder_.path("plain.yaml")}).exit_code, 2);
}

TEST_F(CommandLineTest, ProfilesAreOfParametersThatAreFitted) {
  const std::string name =
      Json::parse(fit({job(), "--json"}).out).at("parameters")[0].at("name").get<std::string>();
  const Outcome one = fit({job(), "--json", "--profile=" + name});
  EXPECT_EQ(one.exit_code, 0);
  const Json profiles = Json::parse(one.out).at("profile");
  ASSERT_EQ(profiles.size(), 1u);
  EXPECT_EQ(profiles[0].at("name"), name);
  EXPECT_LT(profiles[0].at("lower").at("value"), profiles[0].at("upper").at("value"));
  EXPECT_GE(profiles[0].at("points").size(), 5u);
  EXPECT_NE(fit({job(), "--profile"}).out.find("\n95 % intervals\n"), std::string::npos);

  const Outcome none = fit({job(), "--profile=nonsense", "--output", outputs_.path("results")});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_EQ(none.out, "");
  EXPECT_TRUE(none.err.starts_with(
      "--profile: nonsense is not a free parameter; free parameters are " + name));
  EXPECT_FALSE(std::filesystem::exists(outputs_.path("results")));
}

TEST_F(CommandLineTest, TheNextExperimentCanBeRun) {
  const std::string results = outputs_.path("results");
  const Outcome suggested = fit({job(), "--suggest-experiment", "--output", results});
  EXPECT_EQ(suggested.exit_code, 0) << suggested.err;
  EXPECT_NE(suggested.out.find("\nNext experiment\n"), std::string::npos);
  const Json next = Json::parse(outputs_.read("results/result.json")).at("next_experiment");
  EXPECT_GT(next.at("motions_feasible"), 0);
  const Outcome run = simulate({results + "/fitted.yaml", results + "/next-motion.yaml"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const Table recording = recorded(run.out);
  for (const double x : recording.columns[2].values) {
    EXPECT_GE(x, next.at("limits").at("travel_m")[0].get<double>() - 1e-3);
    EXPECT_LE(x, next.at("limits").at("travel_m")[1].get<double>() + 1e-3);
  }
}

TEST_F(CommandLineTest, AxesOfAMachineAreFittedInTurn) {
  const auto job_of = [&](const std::string& axis, const std::string& other, const char* mass) {
    folder_.write(
        axis + ".yaml",
        "axis: " AXISFIT_CONFIGS "/jobs/three-axes/axis.yaml\neffects: {channel_force: {" + other +
            "_acceleration: 0 N/(m/s^2)}}\nrecordings:\n  - file: " AXISFIT_TESTDATA
            "/three-axes-fit.csv\n    time: {column: t, unit: s}\n    initial_state: data\n"
            "    signals:\n      drive_force: {column: " +
            axis + "_force, unit: N}\n      position: {column: " + axis +
            "_position, unit: mm}\n    channels:\n      " + other + "_acceleration: {column: " +
            other + "_position, unit: mm, derivative: 2}\nfree: {M: {initial: " + mass +
            "}, B_a: {}, coulomb_friction.F_c: {}, channel_force." + other +
            "_acceleration: {}}\nfit: {observer: {fixed: 30 1/s}}\n");
  };
  job_of("x", "y", "14 kg");
  job_of("y", "x", "9 kg");
  const std::string both = folder_.write("axes.yaml", "axes: {x: x.yaml, y: y.yaml}\n");
  const std::string results = folder_.path("results");
  const Outcome run = fit({both, "--output", results});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  for (const char* expected : {"Axis x\n\nRecordings\n", "\n\nAxis y\n\nRecordings\n",
                               "\n\nCouplings\n  x and y share an inertia of 0.2"})
    EXPECT_NE(run.out.find(expected), std::string::npos) << expected << run.out;
  EXPECT_EQ(folder_.names("results"), (Names{"x", "y"}));
  EXPECT_TRUE(folder_.names("results/y").contains("fitted.yaml"));
  const Outcome json = fit({both, "--json"});
  const Json parsed = Json::parse(json.out);
  const Json& shared = parsed.at("shared_inertias").at(0);
  EXPECT_EQ(shared.at("axes"), Json({"x", "y"}));
  EXPECT_NEAR(shared.at("value").get<double>(), 0.230, 0.002);
  EXPECT_EQ(parsed.at("axes").at("x").at("usable"), true);
  // Of one axis at least there is nothing to say together.
  const auto refused = [&](const std::string& text, const std::string& message) {
    const Outcome bad = fit({folder_.write("bad.yaml", text)});
    EXPECT_EQ(bad.exit_code, 2);
    EXPECT_NE(bad.err.find(message), std::string::npos) << bad.err;
  };
  refused("axes: {x: x.yaml}\n", "a job of several axes has at least two");
  refused("axes: {x: {axis: x.yaml}, y: {axis: y.yaml}}\n", "this is a machine file");
  refused("axes: {x: x.yaml, y: no.yaml}\n", "no.yaml");
  refused("axes: {x: x.yaml, y: y.yaml}\nfree: {}\n", "unknown key 'free'");
  EXPECT_EQ(fit({both, "--from", results + "/x/fitted.yaml"}).exit_code, 2);
}

TEST_F(CommandLineTest, ResultsServeBothPrograms) {
  const std::string results = folder_.path("results");
  const Outcome first = fit({job(), "--output", results, "--json"});
  ASSERT_EQ(first.exit_code, 0);
  EXPECT_EQ(folder_.names("results"),
            (Names{"fitted.yaml", "report.html", "residuals.csv", "result.json"}));
  EXPECT_EQ(folder_.read("results/result.json"), first.out);
  EXPECT_TRUE(folder_.read("results/residuals.csv").starts_with("recording,time_s,velocity_"));
  const Json found = Json::parse(first.out);

  // The axis that was found moves ...
  const Outcome moved = simulate({results + "/fitted.yaml", motion()});
  EXPECT_EQ(moved.exit_code, 0);
  EXPECT_EQ(moved.err, "");
  EXPECT_EQ(recorded(moved.out).rows(), 101u);

  // ... and a fit that starts from it stays there.
  std::string again = fit_job("{}", "results/fitted.yaml");
  again = replaced(replaced(again, "{initial: 100 N s/m}", "{}"), "{initial: 4 V}", "{}");
  const Outcome second = fit({job(again), "--json"});
  ASSERT_EQ(second.exit_code, 0);
  const Json same = Json::parse(second.out);
  for (std::size_t i = 0; i < 2; ++i) {
    const Json &a = found.at("parameters")[i], &b = same.at("parameters")[i];
    EXPECT_EQ(a.at("value"), b.at("initial"));  // to the last digit
    EXPECT_NEAR(a.at("value"), b.at("value"), 0.01 * a.at("standard_error").get<double>());
  }
}

TEST_F(CommandLineTest, ResultsDoNotDependOnTheNumberOfThreads) {
  const auto result = [&](const std::string& threads, const std::string& seed,
                          const std::string& starts = "4") {
    const Outcome outcome =
        fit({job(), "--json", "--starts", starts, "--seed", seed, "--threads", threads});
    EXPECT_EQ(outcome.exit_code, 0);
    Json json = Json::parse(outcome.out);
    json.erase("wall_time_s");
    json.erase("work");
    return json;
  };
  const Json one = result("1", "3");
  EXPECT_EQ(one.at("starts").size(), 4u);
  EXPECT_EQ(one.at("seed"), 3);
  EXPECT_EQ(one.dump(), result("2", "3").dump());
  const Json other = result("2", "4", "2");
  EXPECT_EQ(other.at("starts")[0].at("from"), one.at("starts")[0].at("from"));
  EXPECT_NE(other.at("starts")[1].at("from"), one.at("starts")[1].at("from"));
}

TEST_F(CommandLineTest, MatRecordingsFitLikeCsvOnes) {
  const Table table = read_csv(folder_.path("short.csv"));
  mat_t* mat = Mat_CreateVer(folder_.path("short.mat").c_str(), nullptr, MAT_FT_MAT5);
  ASSERT_NE(mat, nullptr);
  for (const Column& c : table.columns) {
    std::vector<double> values = c.values;
    std::array<std::size_t, 2> size{1, values.size()};
    matvar_t* variable =
        Mat_VarCreate(c.name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(), values.data(), 0);
    EXPECT_EQ(Mat_VarWrite(mat, variable, MAT_COMPRESSION_ZLIB), 0);
    Mat_VarFree(variable);
  }
  Mat_Close(mat);
  const Json csv = Json::parse(fit({job(), "--json"}).out);
  const Outcome outcome =
      fit({folder_.write("mat.yaml", replaced(fit_job(), "short.csv", "short.mat")), "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(Json::parse(outcome.out).at("parameters"), csv.at("parameters"));
}

TEST_F(CommandLineTest, RecordingsMayBeInAnotherFolder) {
  const TempFolder elsewhere;
  const std::string path = elsewhere.write("job.yaml", fit_job());
  EXPECT_EQ(fit({path, "--quiet"}).exit_code, 2);
  EXPECT_EQ(fit({path, "--quiet", "--data", folder_.path()}).exit_code, 0);
}

TEST_F(CommandLineTest, AFullDeviceIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "There is no /dev/full here.";
  EXPECT_EQ(spawn("simulate-axis", {kXAxis, motion()}, "/dev/full", outputs_.path("err")), 2);
  EXPECT_EQ(spawn("fit-params", {job()}, "/dev/full", outputs_.path("err")), 2);
}

// simulate-axis

TEST_F(CommandLineTest, TheSeedDecidesTheNoise) {
  const std::string one = simulate({kXAxis, motion(), "--seed", "1"}).out;
  EXPECT_EQ(one, simulate({kXAxis, motion()}).out);
  EXPECT_NE(one, simulate({kXAxis, motion(), "--seed", "2"}).out);
  EXPECT_TRUE(one.starts_with(
      "time_s,command_v,position_m,velocity_mps,acceleration_mps2,tachometer_v,motor_current_a\n"));
  // The noise of a signal does not depend on what else is recorded.
  const std::string alone = simulate({kXAxis, motion(), "--signals", "velocity"}).out;
  EXPECT_EQ(recorded(alone).find("velocity_mps")->values,
            recorded(one).find("velocity_mps")->values);
}

TEST_F(CommandLineTest, OutputGoesToAFile) {
  const std::string printed = simulate({kXAxis, motion()}).out;
  const Outcome outcome = simulate({kXAxis, motion(), "-o", folder_.path("step.csv")});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.out + outcome.err, "");
  EXPECT_EQ(folder_.read("step.csv"), printed);
  const Outcome failed = simulate({kXAxis, motion(), "-o", folder_.path("none/step.csv")});
  EXPECT_EQ(failed.exit_code, 2);
  EXPECT_EQ(folder_.without_path(failed.err),
            "none/step.csv not written: No such file or directory\n");
}

TEST_F(CommandLineTest, SetChangesQuantities) {
  const std::string plain = simulate({kXAxis, motion(), "--exact"}).out;
  EXPECT_EQ(plain, simulate({kXAxis, motion(), "--exact", "--set", "M=146000 g"}).out);
  const Outcome heavy =
      simulate({kXAxis, motion(), "--exact", "--set", "M=200 kg", "--set", "velocity.bias=1 m/s"});
  EXPECT_EQ(heavy.exit_code, 0);
  EXPECT_EQ(recorded(heavy.out).find("velocity_mps")->values.front(), 1.0);
  EXPECT_LT(recorded(heavy.out).find("velocity_mps")->values.back() - 1.0,
            recorded(plain).find("velocity_mps")->values.back());

  for (const auto& [text, message] : std::vector<std::pair<std::string, std::string>>{
           {"M=161", "--set:1:4: M needs a unit, for example '161 kg'\n"},
           {"M=0 kg", "--set:1:4: M must lie between 0.001 kg and 1e+05 kg, not 0 kg\n"},
           {"m=161 kg", "--set:1:1: unknown quantity 'm'; did you mean 'M'?\n"},
           {"M", "--set 'M': write NAME=VALUE, for example --set 'M=161 kg'\n"},
           {"J_m=0 kg m^2",
            "J_m must be above zero with backlash: while the teeth are apart, the motor torque "
            "acts on J_m alone\n"}}) {
    const Outcome outcome = simulate({kXAxis, motion(), "--set", text});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err, message);
  }
}

TEST_F(CommandLineTest, BandsComeFromWhatAFitLeavesOpen) {
  const Outcome refused = simulate({kXAxis, motion(), "--band"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("bands are for the fitted.yaml that fit-params writes"),
            std::string::npos)
      << refused.err;
  const std::string axis = folder_.write("fitted.yaml", R"(drive: force_source
transmission: rigid
parameters: {K_f: 35 N/V, M: 95 kg, B_a: 200 N s/m}
uncertainty:
  parameters: [{name: B_a, scale: logarithmic, error: 2 %}]
)");
  const std::string step = folder_.write("step.yaml", "type: step\nlevel: 4 V\nduration: 3 s\n");
  const Outcome outcome =
      simulate({axis, step, "--band", "--exact", "--rate", "100", "--signals", "velocity"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Table table = recorded(outcome.out);
  ASSERT_EQ(table.columns.size(), 5u);
  EXPECT_EQ(table.columns[3].name, "velocity_mps_half_width");
  EXPECT_EQ(table.columns[4].name, "velocity_mps_half_width_of_whole");
  // v = F / B (1 - e), e = exp(-t B / M): a relative error of B changes it so.
  const double x = 3.0 * 200.0 / 95.0, e = std::exp(-x), v = 35.0 * 4.0 / 200.0;
  EXPECT_NEAR(table.columns[2].values.back(), v * (1.0 - e), 1e-6);
  const double half = 1.96 * 0.02 * v * (1.0 - e - x * e);
  EXPECT_NEAR(table.columns[3].values.back(), half, 0.15 * half);
  EXPECT_EQ(table.columns[3].values.front(), 0.0);
  EXPECT_GE(table.columns[4].values.back(), table.columns[3].values.back());

  // A missing force of no size changes nothing, whatever the samples: the last is at 2.996 s.
  const std::string forced = folder_.write("forced.yaml", R"(drive: force_source
transmission: rigid
parameters: {K_f: 35 N/V, M: 95 kg, B_a: 200 N s/m}
uncertainty:
  parameters: [{name: B_a, scale: logarithmic, error: 2 %}]
  missing_force: {interval: 10 ms, deviation: 0 N, innovation: 0 N}
)");
  const std::string odd = folder_.write("odd.yaml", "type: step\nlevel: 4 V\nduration: 2.996 s\n");
  const auto half_width = [&](const std::string& of) {
    return recorded(
               simulate({of, odd, "--band", "--exact", "--rate", "100", "--signals", "velocity"})
                   .out)
        .columns.at(3)
        .values;
  };
  const std::vector<double> without = half_width(axis), with = half_width(forced);
  ASSERT_EQ(without.size(), with.size());
  for (std::size_t i = 0; i < with.size(); ++i) EXPECT_NEAR(with[i], without[i], 1e-6) << i;
}

TEST_F(CommandLineTest, AMachineIsRecordedAxisByAxis) {
  const std::string robot = AXISFIT_CONFIGS "/machines/robot.yaml", results = folder_.path("robot");
  const Outcome outcome = simulate({robot, "--output", results, "--rate", "100"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("4 axes, each simulated"), std::string::npos);
  const Table x = recorded(folder_.read("robot/x.csv"));
  EXPECT_EQ(x.columns[x.columns.size() - 2].name, "y_acceleration_mps2");
  EXPECT_EQ(x.columns.back().name, "hand_1ps2");
  EXPECT_EQ(x.columns.back().values.size(), 401u);
  EXPECT_EQ(folder_.read("robot/z.csv").find("time_s,command_v"), 0u);

  EXPECT_EQ(simulate({robot}).exit_code, 2);
  EXPECT_NE(simulate({robot}).err.find("name a folder"), std::string::npos);
  EXPECT_NE(simulate({robot, motion(), "--output", results}).err.find("is a machine"),
            std::string::npos);
  EXPECT_NE(simulate({kXAxis}).err.find("name the motion of"), std::string::npos);
}

TEST_F(CommandLineTest, SignalsAreRecordedInTheOrderGiven) {
  const Outcome outcome =
      simulate({kXAxis, motion(), "--signals", "V_c", "position", "--rate", "50"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_TRUE(outcome.out.starts_with("time_s,command_v,V_c_v,position_m\n0,5,"));
  EXPECT_EQ(recorded(outcome.out).rows(), 6u);
  EXPECT_EQ(simulate({kXAxis, motion(), "--signals", "speed"}).exit_code, 2);
  const Outcome twice = simulate({kXAxis, motion(), "--signals", "position", "position"});
  EXPECT_EQ(twice.exit_code, 2);
  EXPECT_EQ(twice.err, "--signals: position is named twice\n");
}

TEST_F(CommandLineTest, ExactHasNoNoiseAndAllDigits) {
  const std::string exact = simulate({kXAxis, motion(), "--exact", "--seed", "1"}).out;
  EXPECT_EQ(exact, simulate({kXAxis, motion(), "--exact", "--seed", "2"}).out);
  const Table table = recorded(exact);
  EXPECT_EQ(table.find("velocity_mps")->values.front(), 0.0);
  EXPECT_EQ(table.find("motor_current_a")->values.front(), 0.0);
  // Speeds up smoothly: what noise would never do.
  const std::vector<double>& velocity = table.find("velocity_mps")->values;
  for (std::size_t i = 20; i < velocity.size(); ++i) EXPECT_GT(velocity[i], velocity[i - 1]);
  EXPECT_GT(exact.size(), simulate({kXAxis, motion()}).out.size());
}

TEST_F(CommandLineTest, FilesInTheWrongPlaceAreBadInput) {
  const Outcome outcome = simulate({motion(), kXAxis});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_TRUE(folder_.without_path(outcome.err)
                  .starts_with("motion.yaml:1:1: key 'drive' is missing in the file\n"));
  const Outcome both = simulate({kXAxis, folder_.write("fast.yaml", "type: step\nlevel: 50 V\n")});
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_EQ(folder_.without_path(both.err),
            "fast.yaml:1:1: key 'duration' is missing in the file\n"
            "fast.yaml:2:8: level must lie between -10 V and 10 V, not 50 V\n");
}

}  // namespace
}  // namespace axisfit
