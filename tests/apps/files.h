// What the tests of the programs share: folders of their own, small files, and messages that do not
// depend on where those folders are.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>

#include "io/recording/csv.h"

namespace axisfit {

/// A folder below ::testing::TempDir() that goes away with this object. Tests run in parallel, one
/// process each, so that the process makes its name unique.
class TempFolder {
 public:
  TempFolder() {
    static int count = 0;
    path_ = std::filesystem::path(::testing::TempDir()) /
            ("axisfit-" + std::to_string(::getpid()) + "-" + std::to_string(++count));
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  std::string path() const { return path_.string(); }
  std::string path(const std::string& name) const { return (path_ / name).string(); }

  /// Writes a file and returns its path.
  std::string write(const std::string& name, const std::string& contents) const {
    std::ofstream out(path_ / name, std::ios::binary);
    out << contents;
    out.close();
    if (!out) throw std::runtime_error("cannot write " + path(name));
    return path(name);
  }

  /// Writes a CSV file with so many digits, or all of them, and returns its path.
  std::string write(const std::string& name, const Table& table, int digits = 0) const {
    std::ostringstream out;
    write_csv(out, table.columns, digits);
    return write(name, out.str());
  }

  std::string read(const std::string& name) const {
    std::ifstream in(path_ / name, std::ios::binary);
    if (!in) throw std::runtime_error("cannot read " + path(name));
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }

  /// The names of everything in the folder, or in a folder below it.
  std::set<std::string> names(const std::string& below = ".") const {
    std::set<std::string> result;
    for (const auto& entry : std::filesystem::directory_iterator(path_ / below))
      result.insert(entry.path().filename().string());
    return result;
  }

  /// A message without the folder in front of the files in it.
  std::string without_path(std::string message) const {
    const std::string prefix = path() + "/";
    for (std::size_t at; (at = message.find(prefix)) != std::string::npos;)
      message.erase(at, prefix.size());
    return message;
  }

 private:
  std::filesystem::path path_;
};

/// `text` with the only occurrence of `from` replaced.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos || text.find(from, at + 1) != std::string::npos)
    throw std::logic_error("not exactly one '" + from + "' in the text");
  return text.replace(at, from.size(), to);
}

}  // namespace axisfit
