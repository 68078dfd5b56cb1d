// Reads tables from texts.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "io/recording/csv.h"

namespace axisfit {

// A directory of its own for each test, so that tests can run at the same time.
class TableTest : public ::testing::Test {
 protected:
  TableTest() {
    const auto* const info = ::testing::UnitTest::GetInstance()->current_test_info();
    directory_ = std::filesystem::temp_directory_path() /
                 ("axisfit_table_test." + std::to_string(::getpid()) + "." + info->name());
    std::filesystem::create_directories(directory_);
  }
  ~TableTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(directory_, ignored);
  }

  std::string path() const { return (directory_ / "rec.csv").string(); }

  Table read(std::string_view text) const {
    std::ofstream(path(), std::ios::binary) << text;
    return read_csv(path());
  }

  // The message of the error for this text, without the directory.
  std::string error(std::string_view text) const {
    try {
      read(text);
    } catch (const RecordingError& caught) {
      return without_directory(caught.what());
    }
    return "no error";
  }

  std::string without_directory(const std::string& message) const {
    const std::string prefix = directory_.string() + "/";
    return message.starts_with(prefix) ? message.substr(prefix.size()) : message;
  }

  std::filesystem::path directory_;
};

using Values = std::vector<double>;

}  // namespace axisfit
