// A run of fit-params that is killed at random instants, and gone on with.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <map>
#include <random>
#include <regex>
#include <set>
#include <string>

#include "base/random.h"
#include "tests/apps/shell.h"

namespace axisfit {

using Contents = std::map<std::string, std::string>;

/// The files of the folder `results`, without what differs from run to run.
inline Contents contents_of_results(const TempFolder& folder) {
  Contents found;
  if (!std::filesystem::exists(folder.path("results"))) return found;
  for (const std::string& name : folder.names("results"))
    if (!name.ends_with(".journal")) found[name] = folder.read("results/" + name);
  static const std::regex wall_time("\"(wall|processor)_time_s\": [^,\n]*");
  if (found.contains("result.json"))
    found["result.json"] = std::regex_replace(found["result.json"], wall_time, "");
  // It has the time too; its other text and numbers are those of the other files.
  if (found.contains("report.html") && found["report.html"].ends_with("</html>\n"))
    found["report.html"] = "whole";
  return found;
}

/// The command `fit-params ARGUMENTS` in a folder that has what it needs.
class Killing {
 public:
  Killing(const TempFolder& folder, const std::string& arguments)
      : folder_(folder),
        command_("fit-params " + arguments + " --quiet --output results --resume") {
    const auto begin = std::chrono::steady_clock::now();
    const Answer whole = shell(folder_, command_);
    longest_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    EXPECT_EQ(whole.exit_code, 0) << whole.err;
    wanted_ = contents();
    EXPECT_GE(wanted_.size(), 4u);
    for (const auto& [name, text] : wanted_)
      older_[name] = folder_.read("results/" + name) + "<!-- old -->";
  }

  /// Kills it `times` times, and lets it end after every third time. Whatever the instant, the
  /// folder has the old result or the whole new one; and the new one is that of a run which was
  /// never killed, digit for digit.
  void kill(int times) {
    std::mt19937_64 generator(1);
    int killed = 0, ended = 0;
    while (killed < times) {
      begin(ended % 2 == 1);
      for (int i = 0; i < 3; ++i) {
        const double seconds = 0.01 + longest_ * uniform(generator);
        // In the foreground it ends after the program has, and with it the lock on the folder.
        const Answer answer = shell(
            folder_, "timeout --foreground -s KILL " + std::to_string(seconds) + " " + command_);
        killed += answer.exit_code == 137 ? 1 : 0;
        // 124: it came to its end at the very instant.
        ASSERT_TRUE(std::set({0, 124, 137}).contains(answer.exit_code))
            << answer.exit_code << ": " << answer.err;
        const Contents found = contents();
        ASSERT_TRUE(found == old_ || found == wanted_) << "killed after " << seconds << " s";
      }
      const Answer answer = shell(folder_, command_);
      ASSERT_EQ(answer.exit_code, 0) << answer.err;
      ASSERT_EQ(contents(), wanted_);
      ASSERT_EQ(folder_.names("results").size(), wanted_.size());
      ++ended;
    }
    std::cout << killed << " times killed, " << ended << " times let go on to the end; the run of "
              << longest_ << " s\n";
  }

 private:
  Contents contents() const { return contents_of_results(folder_); }

  void begin(bool with_old_result) {
    std::filesystem::remove_all(folder_.path("results"));
    old_.clear();
    if (!with_old_result) return;
    std::filesystem::create_directory(folder_.path("results"));
    for (const auto& [name, text] : older_) folder_.write("results/" + name, text);
    old_ = contents();
  }

  const TempFolder& folder_;
  const std::string command_;
  double longest_ = 0.0;  ///< s, of the run that is not killed
  Contents wanted_, old_;
  Contents older_;  ///< files of another result, as they stand
};

}  // namespace axisfit
