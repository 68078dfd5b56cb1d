#include "io/results/output_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <new>
#include <optional>
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

/// Whether a file is a regular one that contains a text near its start, or nothing at all.
bool contains(const fs::path& path, const std::string& text) {
  std::error_code ignored;
  if (!fs::is_regular_file(fs::symlink_status(path, ignored))) return false;
  std::string head(1 << 16, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  return head.empty() || head.find(text) != std::string::npos;
}

/// A folder for files on their way to another, which goes away with this object.
class Staging {
 public:
  /// Makes it, or clears the one that a killed run has left. Throws std::runtime_error where one
  /// of that name is somebody else's.
  Staging(fs::path path, const std::vector<ResultName>& names)
      : path_(std::move(path)), names_(names) {
    remove();
    std::error_code failed;
    if (!fs::create_directory(path_, failed)) {
      if (failed) throw fs::filesystem_error("cannot create", path_, failed);
      throw std::runtime_error(fmt::format("{} is in the way: move it", path_.string()));
    }
    write_through(path_ / kMarker, kMarkerText);
  }
  ~Staging() { remove(); }
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;

  const fs::path& path() const { return path_; }

  void write(const Files& files) const {
    for (const auto& [name, contents] : files) write_through(path_ / name, contents);
  }

  /// From now on it is as any folder of results.
  void unmark() const { fs::remove(path_ / kMarker); }

 private:
  static constexpr const char* kMarker = ".axisfit";
  static constexpr const char* kMarkerText =
      "axisfit's temporary files, which its next run removes\n";

  /// Removes what is its own: any file on its way below a marker, else those with their signatures.
  void remove() const {
    std::error_code ignored;
    const bool marked = contains(path_ / kMarker, kMarkerText);
    for (const ResultName& file : names_)
      if (marked || contains(path_ / file.name, file.signature))
        fs::remove(path_ / file.name, ignored);
    if (marked) fs::remove(path_ / kMarker, ignored);
    fs::remove(path_, ignored);  // unless there is something else in it
  }

  fs::path path_;
  const std::vector<ResultName>& names_;
};

bool same_owner_and_mode(const fs::path& a, const fs::path& b) {
  struct stat of_a = {}, of_b = {};
  return ::stat(a.c_str(), &of_a) == 0 && ::stat(b.c_str(), &of_b) == 0 &&
         of_a.st_uid == of_b.st_uid && of_a.st_gid == of_b.st_gid && of_a.st_mode == of_b.st_mode;
}

}  // namespace

OutputFolder::OutputFolder(std::string folder, std::vector<ResultName> names,
                           const std::vector<std::string>& inputs)
    : folder_(std::move(folder)), names_(std::move(names)) {
  names_.push_back({kJournal, JournalFile::kSignature});
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
    for (const ResultName& file : names_) refuse_to_overwrite(target_ / file.name, inputs);
    refuse_foreign_files();
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

bool OutputFolder::is_own(const fs::path& file) const {
  const auto known = std::ranges::find(names_, file.filename().string(), &ResultName::name);
  return known != names_.end() && contains(file, known->signature);
}

void OutputFolder::refuse_foreign_files() const {
  std::error_code ignored;
  for (const ResultName& file : names_)
    if (const fs::path path = target_ / file.name;
        fs::exists(fs::symlink_status(path, ignored)) && !is_own(path))
      throw std::runtime_error(fmt::format(
          "{} there was not written by axisfit; move it, or choose another folder", file.name));
}

bool OutputFolder::holds_results_only() const {
  std::error_code ignored;
  if (fs::equivalent(target_, ".", ignored)) return false;  // somebody is in it
  return std::ranges::all_of(fs::directory_iterator(target_),
                             [&](const fs::directory_entry& e) { return is_own(e.path()); });
}

bool OutputFolder::exchange(const Files& files, bool complete) const {
  const fs::path path =
      target_.parent_path() / fmt::format(".{}.partial", target_.filename().string());
  std::error_code failed;
  if (fs::exists(path, failed) && !fs::is_directory(path)) return false;
  if (failed || ::access(target_.parent_path().c_str(), W_OK) != 0) return false;
  std::optional<Staging> staging;
  try {
    staging.emplace(path, names_);
  } catch (const std::runtime_error&) {
    return false;  // a name that is too long, or somebody else's folder
  }
  if (!same_owner_and_mode(path, target_)) return false;
  staging->write(files);
  if (!complete) fs::create_hard_link(target_ / kJournal, path / kJournal, failed);
  if (failed) return false;
  staging->unmark();
  if (::renameat2(AT_FDCWD, path.c_str(), AT_FDCWD, target_.c_str(), RENAME_EXCHANGE) != 0)
    return false;
  // Now it holds the earlier results, which go; what somebody else has put there just now stays.
  for (const fs::directory_entry& e : fs::directory_iterator(path, failed))
    if (!is_own(e.path())) fs::rename(e.path(), target_ / e.path().filename(), failed);
  return true;
}

void OutputFolder::replace_one_by_one(const Files& files, bool complete) const {
  const Staging staging(target_ / ".partial", names_);
  staging.write(files);
  for (const auto& [name, contents] : files) fs::rename(staging.path() / name, target_ / name);
  for (const ResultName& file : names_)
    if (file.name != kJournal &&
        std::ranges::find(files, file.name, &Files::value_type::first) == files.end())
      fs::remove(target_ / file.name);
  if (complete) fs::remove(target_ / kJournal);
}

void OutputFolder::write(const Files& files, bool complete) {
  try {
    fs::create_directories(target_);  // somebody may have removed it meanwhile,
    refuse_foreign_files();           // or put something there
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

void refuse_to_overwrite(const std::string& path, const std::vector<std::string>& inputs) {
  std::error_code ignored;
  for (const std::string& input : inputs)
    if (fs::equivalent(path, input, ignored))
      throw std::runtime_error(fmt::format(
          "{} is read by this run and would be overwritten; choose another output", input));
}

void write_file(const std::string& path, const std::string& contents) {
  std::error_code ignored;
  // Devices and pipes must not be replaced by a file.
  if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored))
    throw std::runtime_error(fmt::format("{} not written: it exists and is not a file", path));
  // A short name of its own, since that of the file may be as long as names can be.
  const fs::path folder = fs::path(path).parent_path();
  fs::path partial;
  for (int i = 0; partial.empty() || fs::exists(fs::symlink_status(partial, ignored)); ++i)
    partial = folder / fmt::format(".partial-{}-{}", ::getpid(), i);
  try {
    write_through(partial, contents);
    fs::rename(partial, path);
  } catch (const std::exception& error) {
    fs::remove(partial, ignored);
    throw std::runtime_error(fmt::format("{} not written: {}", path, reason(error)));
  }
}

}  // namespace axisfit
