// A file for libraries that write to nothing else.
#pragma once

#include <filesystem>
#include <string>

namespace axisfit {

/// A file in a folder of its own that goes away with this object. Throws std::runtime_error where
/// there is no room for temporary files.
class ScratchFile {
 public:
  ScratchFile();
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  std::string path() const { return (folder_ / "file").string(); }
  /// Throws std::runtime_error.
  void write(std::string_view contents) const;
  std::string read() const;

 private:
  std::filesystem::path folder_;
};

}  // namespace axisfit
