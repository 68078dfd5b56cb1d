#include "apps/output_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <system_error>

namespace axisfit {
namespace {

namespace fs = std::filesystem;

/// Writes a new file through to the disk.
void write_through(const fs::path& path, const std::string& contents) {
  const auto fail = [&] {
    throw fs::filesystem_error("cannot write", path,
                               std::error_code(errno, std::generic_category()));
  };
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) fail();
  std::size_t written = 0;
  bool good = true;
  while (good && written < contents.size()) {
    const ssize_t n = ::write(file, contents.data() + written, contents.size() - written);
    if (n < 0 && errno == EINTR) continue;
    good = n >= 0;
    if (good) written += static_cast<std::size_t>(n);
  }
  good = good && ::fsync(file) == 0;
  const int problem = errno;
  ::close(file);
  errno = problem;
  if (!good) fail();
}

/// What went wrong, without the names of temporary files.
std::string reason(const std::exception& error) {
  const auto* known = dynamic_cast<const fs::filesystem_error*>(&error);
  return known != nullptr ? known->code().message() : error.what();
}

/// The folder where files are made before they go into the one the user named.
class PartialFolder {
 public:
  explicit PartialFolder(const std::string& folder) : folder_(folder) {
    const fs::path given = fs::absolute(folder).lexically_normal();
    target_ = given.has_filename() ? given : given.parent_path();
    path_ = target_.parent_path() /
            fmt::format(".{}.partial-{}", target_.filename().string(), ::getpid());
    made_ = path_;
    std::error_code ignored;
    while (fs::symlink_status(made_.parent_path(), ignored).type() == fs::file_type::not_found)
      made_ = made_.parent_path();
  }

  const fs::path& path() const { return path_; }
  const fs::path& target() const { return target_; }

  void remove() const {
    std::error_code ignored;
    fs::remove_all(made_, ignored);
  }

  /// Makes the folder and does `work`. Whatever goes wrong, the remains are removed.
  template <class Work>
  void use(Work&& work) const {
    try {
      fs::create_directories(path_);
      work();
    } catch (const std::exception& error) {
      remove();
      throw std::runtime_error(
          fmt::format("results not written to {}: {}", folder_, reason(error)));
    }
  }

  /// Found out before anything is replaced.
  void refuse_folder_at(const std::string& name) const {
    if (fs::is_directory(target_ / name))
      throw fs::filesystem_error("cannot replace", target_ / name,
                                 std::make_error_code(std::errc::is_a_directory));
  }

 private:
  std::string folder_;
  fs::path target_, path_;
  fs::path made_;  // what a failure must remove again: the topmost folder that was not there
};

}  // namespace

void write_folder(const std::string& folder,
                  const std::vector<std::pair<std::string, std::string>>& files) {
  const PartialFolder partial(folder);
  partial.use([&] {
    for (const auto& [name, contents] : files) {
      write_through(partial.path() / name, contents);
      partial.refuse_folder_at(name);
    }
    if (!fs::exists(partial.target())) {
      fs::rename(partial.path(), partial.target());
      return;
    }
    for (const auto& [name, contents] : files)
      fs::rename(partial.path() / name, partial.target() / name);
    fs::remove_all(partial.path());
  });
}

void check_folder(const std::string& folder, const std::vector<std::string>& names) {
  const PartialFolder partial(folder);
  partial.use([&] {
    for (const std::string& name : names) partial.refuse_folder_at(name);
    // The way that results would go, with a file that is not there for long.
    const std::string probe = fmt::format(".probe-{}", ::getpid());
    write_through(partial.path() / probe, "");
    if (!fs::exists(partial.target())) return;
    fs::rename(partial.path() / probe, partial.target() / probe);
    fs::remove(partial.target() / probe);
  });
  partial.remove();
}

void write_file(const std::string& path, const std::string& contents) {
  std::error_code ignored;
  // Devices and pipes must not be replaced by a file.
  if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored))
    throw std::runtime_error(fmt::format("{} not written: it is there and not a file", path));
  const fs::path partial = fmt::format("{}.partial-{}", path, ::getpid());
  try {
    write_through(partial, contents);
    fs::rename(partial, path);
  } catch (const std::exception& error) {
    fs::remove(partial, ignored);
    throw std::runtime_error(fmt::format("{} not written: {}", path, reason(error)));
  }
}

}  // namespace axisfit
