// Notices files that are written to while they are read.
#pragma once

#include <sys/stat.h>

#include <string>

namespace axisfit {

/// A recording that is copied or recorded while it is read would be half of one and half of
/// another, and could pass for one.
class FileWatch {
 public:
  /// To be made before the file is opened.
  explicit FileWatch(std::string path) : path_(std::move(path)), before_(state()) {}

  /// Whether the file has been written to, replaced or removed since. Pipes never have.
  bool has_changed() const {
    const struct stat now = state();
    return S_ISREG(before_.st_mode) &&
           (now.st_ino != before_.st_ino || now.st_size != before_.st_size ||
            now.st_mtim.tv_sec != before_.st_mtim.tv_sec ||
            now.st_mtim.tv_nsec != before_.st_mtim.tv_nsec);
  }

  /// What messages say of it.
  static constexpr const char* kMessage =
      "changed while it was being read; wait until it is complete and try again";

 private:
  struct stat state() const {
    struct stat found = {};
    ::stat(path_.c_str(), &found);
    return found;
  }

  std::string path_;
  struct stat before_;
};

}  // namespace axisfit
