#include "apps/output_folder.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>

namespace axisfit {
namespace {

namespace fs = std::filesystem;

/// Writes a new file through to the disk.
void write_through(const fs::path& path, const std::string& contents) {
  const auto fail = [&] {
    throw std::runtime_error(fmt::format("cannot write {}: {}", path.string(), std::strerror(errno)));
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

}  // namespace

void write_folder(const std::string& folder,
                  const std::vector<std::pair<std::string, std::string>>& files) {
  const fs::path target = fs::absolute(folder).lexically_normal();
  const fs::path parent = target.has_filename() ? target.parent_path()
                                                : target.parent_path().parent_path();
  const fs::path partial =
      parent / fmt::format(".{}.partial-{}", target.has_filename()
                                                 ? target.filename().string()
                                                 : target.parent_path().filename().string(),
                           ::getpid());
  try {
    fs::create_directories(partial);
    for (const auto& [name, contents] : files) write_through(partial / name, contents);
    if (!fs::exists(target)) {
      fs::rename(partial, target.has_filename() ? target : target.parent_path());
      return;
    }
    for (const auto& [name, contents] : files) fs::rename(partial / name, target / name);
    fs::remove_all(partial);
  } catch (const std::exception& error) {
    std::error_code ignored;
    fs::remove_all(partial, ignored);
    throw std::runtime_error(fmt::format("results not written to {}: {}", folder, error.what()));
  }
}

void write_file(const std::string& path, const std::string& contents) {
  const fs::path partial = fmt::format("{}.partial-{}", path, ::getpid());
  try {
    write_through(partial, contents);
    fs::rename(partial, path);
  } catch (const std::exception& error) {
    std::error_code ignored;
    fs::remove(partial, ignored);
    throw std::runtime_error(fmt::format("{} not written: {}", path, error.what()));
  }
}

}  // namespace axisfit
