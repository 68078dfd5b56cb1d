// What the fuzz targets share: files in memory, refusals that a user can read, and the end of the
// process where anything else happens.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <typeinfo>

#include "base/plain_text.h"
#include "io/config/config.h"
#include "io/recording/table.h"

namespace axisfit::fuzz {

/// A finding unless `holds`.
inline void require(bool holds, std::string_view what, const std::string& shown = {}) {
  if (holds) return;
  std::cerr << "finding: " << what << '\n' << shown << '\n';
  std::abort();
}

/// Every line of a text for a terminal is one that it can show, in UTF-8.
inline void require_harmless(const std::string& text, std::string_view what) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    require(is_sanitized(text.substr(at, end - at)), what, text);
    at = end + 1;
  }
}

/// A message says something, in no more than a user would read.
inline void require_message(const std::string& message) {
  constexpr std::size_t kLongest = 4096;
  require(!message.empty(), "a message is empty");
  require(message.size() <= kLongest, "a message is too long", message);
  require_harmless(message, "a message has what a terminal cannot show");
}

/// Reads something that may be refused. Any exception that is not meant for a user is a finding.
template <class Work>
void refusable(Work&& work) {
  try {
    work();
  } catch (const ConfigError& error) {
    for (const Diagnostic& diagnostic : error.diagnostics()) require_message(diagnostic.text());
  } catch (const RecordingError& error) {
    require_message(error.what());
  } catch (const std::runtime_error& error) {
    // Those derived from it come from a library, and tell a user nothing.
    if (typeid(error) != typeid(std::runtime_error)) throw;
    require_message(error.what());
  }
}

/// A folder of files, in memory where the system has such.
class Folder {
 public:
  Folder() {
    namespace fs = std::filesystem;
    const fs::path memory = "/dev/shm";
    std::string name = (fs::exists(memory) ? memory : fs::temp_directory_path()) / "axisfit-XXXXXX";
    require(::mkdtemp(name.data()) != nullptr, "no folder for files can be made", name);
    path_ = name;
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string path(const std::string& name) const { return path_ / name; }

  /// Writes a file and returns its path.
  std::string write(const std::string& name, std::string_view contents) const {
    const std::string file = path(name);
    std::ofstream(file, std::ios::binary) << contents;
    return file;
  }

  /// Removes all files.
  void clear() const {
    for (const auto& entry : std::filesystem::directory_iterator(path_))
      std::filesystem::remove_all(entry);
  }

 private:
  std::filesystem::path path_;
};

/// A MATLAB file of version 7.3. HDF5 reads those, in a process of its own since it does crash:
/// there is nothing to be found here.
inline bool is_hdf5(std::string_view file) {
  return file.find("\x89HDF") != file.npos ||
         file.substr(0, 128).ends_with(std::string_view("\0\2IM", 4)) ||
         file.substr(0, 128).ends_with(std::string_view("\2\0MI", 4));
}

/// Several files in one input: after a line "=== NAME" the contents of a file, up to the next such
/// line. Names are plain.
inline std::map<std::string, std::string_view> files_of(std::string_view input) {
  constexpr std::string_view kMark = "=== ";
  std::map<std::string, std::string_view> files;
  while (input.starts_with(kMark)) {
    input.remove_prefix(kMark.size());
    const std::size_t line = std::min(input.find('\n'), input.size());
    const std::string name(input.substr(0, line));
    input.remove_prefix(std::min(line + 1, input.size()));
    const std::size_t end = std::min(input.find("\n=== "), input.size());
    const std::string_view contents = input.substr(0, std::min(end + 1, input.size()));
    input.remove_prefix(contents.size());
    const bool plain =
        name.size() <= 20 && !name.starts_with('.') &&
        name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-.") == name.npos;
    if (!name.empty() && plain) files[name] = contents;
  }
  return files;
}

/// What a target does with an input, in a folder that has what earlier inputs left there.
void check_input(const Folder& folder, std::string_view input);

}  // namespace axisfit::fuzz
