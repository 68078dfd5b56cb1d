// Reads recordings of any kind, which is told by their contents.
#pragma once

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "io/recording/recording_file.h"
#include "tests/apps/files.h"

namespace axisfit {

class KindTest : public ::testing::Test {
 protected:
  RecordingFile read(const std::string& contents) const {
    return RecordingFile(folder_.write("run.dat", contents));
  }

  /// The message of the error for these contents, without the folder.
  std::string error(const std::string& contents) const {
    try {
      read(contents);
    } catch (const RecordingError& caught) {
      return folder_.without_path(caught.what());
    }
    return "no error";
  }

  /// A column that can be used.
  static const Column& column(const RecordingFile& file, const std::string& name) {
    const auto found = file.column(name);
    if (const auto* const problem = std::get_if<std::string>(&found))
      throw std::runtime_error(*problem);
    return *std::get<const Column*>(found);
  }

  /// What is wrong with a column.
  std::string problem(const RecordingFile& file, const std::string& name) const {
    const auto found = file.column(name);
    const auto* const problem = std::get_if<std::string>(&found);
    return problem == nullptr ? "no problem" : folder_.without_path(*problem);
  }

  /// The column with its times.
  static const Column& clock(const RecordingFile& file, const std::string& name) {
    return file.columns().at(column(file, name).clock.value());
  }

  TempFolder folder_;
};

using Values = std::vector<double>;

}  // namespace axisfit
