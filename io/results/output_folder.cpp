#include "io/results/output_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <new>
#include <stdexcept>
#include <system_error>

namespace axisfit {
namespace {

namespace fs = std::filesystem;

constexpr const char* kJournal = "unfinished.journal";

/// Writes a new file through to the disk. Fails where there is one, or a link that somebody has put
/// there to have another file overwritten.
void write_through(const fs::path& path, const std::string& contents) {
  const auto fail = [&] {
    throw fs::filesystem_error("cannot write", path,
                               std::error_code(errno, std::generic_category()));
  };
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
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

/// A folder for files on their way to another, which goes away with this object.
class Staging {
 public:
  explicit Staging(fs::path path) : path_(std::move(path)) {
    fs::remove_all(path_);  // of a run that was killed
    fs::create_directory(path_);
  }
  ~Staging() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;

  const fs::path& path() const { return path_; }

  void write(const Files& files) const {
    for (const auto& [name, contents] : files) write_through(path_ / name, contents);
  }

 private:
  fs::path path_;
};

bool same_owner_and_mode(const fs::path& a, const fs::path& b) {
  struct stat of_a = {}, of_b = {};
  return ::stat(a.c_str(), &of_a) == 0 && ::stat(b.c_str(), &of_b) == 0 &&
         of_a.st_uid == of_b.st_uid && of_a.st_gid == of_b.st_gid && of_a.st_mode == of_b.st_mode;
}

}  // namespace

OutputFolder::OutputFolder(std::string folder, std::vector<std::string> names)
    : folder_(std::move(folder)), names_(std::move(names)) {
  // Where it is: a link to a folder must stay one.
  const fs::path given = fs::absolute(folder_).lexically_normal();
  std::error_code ignored;
  const fs::path found = fs::canonical(given, ignored);
  target_ = !found.empty() ? found : given.has_filename() ? given : given.parent_path();
  if (found.empty()) created_ = target_;
  while (!created_.empty() &&
         fs::symlink_status(created_.parent_path(), ignored).type() == fs::file_type::not_found)
    created_ = created_.parent_path();
  try {
    fs::create_directories(target_);
    for (const std::string& name : names_)
      if (fs::is_directory(target_ / name))
        throw fs::filesystem_error("cannot replace", target_ / name,
                                   std::make_error_code(std::errc::is_a_directory));
    journal_ = std::make_unique<JournalFile>(target_ / kJournal);
  } catch (const std::exception& error) {
    remove_created_folders();
    fail(error);
  }
}

OutputFolder::~OutputFolder() {
  if (!has_result_ && journal_->is_empty()) discard_journal();
}

void OutputFolder::discard_journal() const {
  std::error_code ignored;
  fs::remove(target_ / kJournal, ignored);
  remove_created_folders();
}

void OutputFolder::remove_created_folders() const {
  if (created_.empty()) return;
  std::error_code ignored;  // those into which somebody has put something stay
  for (fs::path folder = target_; folder != created_.parent_path(); folder = folder.parent_path())
    fs::remove(folder, ignored);
}

void OutputFolder::fail(const std::exception& error, const char* advice) const {
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) throw;
  throw std::runtime_error(
      fmt::format("results could not be written to {}: {}{}", folder_, reason(error), advice));
}

bool OutputFolder::holds_results_only() const {
  std::error_code ignored;
  if (fs::equivalent(target_, ".", ignored)) return false;  // somebody is in it
  return std::ranges::all_of(fs::directory_iterator(target_), [&](const fs::directory_entry& e) {
    const std::string name = e.path().filename();
    return name == kJournal || std::ranges::find(names_, name) != names_.end();
  });
}

bool OutputFolder::exchange(const Files& files, bool complete) const {
  const fs::path path =
      target_.parent_path() / fmt::format(".{}.partial", target_.filename().string());
  if (::access(target_.parent_path().c_str(), W_OK) != 0) return false;
  const Staging staging(path);
  if (!same_owner_and_mode(staging.path(), target_)) return false;
  staging.write(files);
  std::error_code failed;
  if (!complete) fs::create_hard_link(target_ / kJournal, staging.path() / kJournal, failed);
  if (failed) return false;
  // What it holds after that are the earlier results, which go.
  return ::renameat2(AT_FDCWD, staging.path().c_str(), AT_FDCWD, target_.c_str(),
                     RENAME_EXCHANGE) == 0;
}

void OutputFolder::replace_one_by_one(const Files& files, bool complete) const {
  const Staging staging(target_ / ".partial");
  staging.write(files);
  for (const auto& [name, contents] : files) fs::rename(staging.path() / name, target_ / name);
  for (const std::string& name : names_)
    if (std::ranges::find(files, name, &Files::value_type::first) == files.end())
      fs::remove(target_ / name);
  if (complete) fs::remove(target_ / kJournal);
}

void OutputFolder::write(const Files& files, bool complete) {
  try {
    fs::create_directories(target_);  // somebody may have removed it meanwhile
    if (!holds_results_only() || !exchange(files, complete)) replace_one_by_one(files, complete);
    has_result_ = true;
  } catch (const std::exception& error) {
    std::error_code ignored;
    const bool kept = !journal_->is_empty() && fs::exists(target_ / kJournal, ignored);
    fail(error, kept ? "\nThe solutions found so far are kept there: once this is fixed, the same "
                       "command with --resume finishes quickly."
                     : "");
  }
}

void write_file(const std::string& path, const std::string& contents) {
  std::error_code ignored;
  // Devices and pipes must not be replaced by a file.
  if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored))
    throw std::runtime_error(fmt::format("{} not written: it exists and is not a file", path));
  const fs::path partial = fmt::format("{}.partial-{}", path, ::getpid());
  try {
    fs::remove(partial);  // of a run that was killed
    write_through(partial, contents);
    fs::rename(partial, path);
  } catch (const std::exception& error) {
    fs::remove(partial, ignored);
    throw std::runtime_error(fmt::format("{} not written: {}", path, reason(error)));
  }
}

}  // namespace axisfit
