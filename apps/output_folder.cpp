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

}  // namespace

void write_folder(const std::string& folder,
                  const std::vector<std::pair<std::string, std::string>>& files) {
  const fs::path target = fs::absolute(folder).lexically_normal();
  const fs::path parent =
      target.has_filename() ? target.parent_path() : target.parent_path().parent_path();
  const fs::path partial =
      parent / fmt::format(".{}.partial-{}",
                           target.has_filename() ? target.filename().string()
                                                 : target.parent_path().filename().string(),
                           ::getpid());
  // What a failure must remove again: the topmost folder that was not there.
  std::error_code ignored;
  fs::path made = partial;
  while (fs::symlink_status(made.parent_path(), ignored).type() == fs::file_type::not_found)
    made = made.parent_path();
  try {
    fs::create_directories(partial);
    for (const auto& [name, contents] : files) {
      write_through(partial / name, contents);
      // Found out before anything is replaced.
      if (fs::is_directory(target / name))
        throw fs::filesystem_error("cannot replace", target / name,
                                   std::make_error_code(std::errc::is_a_directory));
    }
    if (!fs::exists(target)) {
      fs::rename(partial, target.has_filename() ? target : target.parent_path());
      return;
    }
    for (const auto& [name, contents] : files) fs::rename(partial / name, target / name);
    fs::remove_all(partial);
  } catch (const std::exception& error) {
    fs::remove_all(made, ignored);
    throw std::runtime_error(fmt::format("results not written to {}: {}", folder, reason(error)));
  }
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
