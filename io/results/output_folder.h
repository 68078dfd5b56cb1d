// Results are written whole or not at all.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "io/results/journal_file.h"

namespace axisfit {

/// Names and contents.
using Files = std::vector<std::pair<std::string, std::string>>;

/// The folder of a run's results. It belongs to this run alone as long as this object lives.
///
/// All errors are std::runtime_error: "results not written to FOLDER: " and the reason.
class OutputFolder {
 public:
  /// Makes the folder if need be. `names` are those that results can have. Throws, and leaves
  /// nothing behind, when they cannot be put into it or another run is at work in it: before the
  /// work rather than after.
  OutputFolder(std::string folder, std::vector<std::string> names);
  /// Leaves nothing behind that no run can use.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Stays in the folder when the run ends without its whole result.
  JournalFile& journal() { return *journal_; }

  /// Puts results in the place of those that are there; where that fails, those remain. A folder of
  /// nothing but results is exchanged as a whole, so that there is no instant at which it holds
  /// some files of either. In a folder that is shared with other files, which stay, and where the
  /// file system cannot exchange folders, one file after the other is replaced. Unless the result
  /// is `whole`, the journal stays.
  void write(const Files& files, bool complete);

  /// Removes the journal, for nobody needs to go on with this run.
  void discard_journal() const;

 private:
  bool holds_results_only() const;
  bool exchange(const Files& files, bool complete) const;
  void replace_one_by_one(const Files& files, bool complete) const;
  void remove_created_folders() const;
  /// In the handler of `error`: throws what the user is told, or that memory ran out.
  [[noreturn]] void fail(const std::exception& error, const char* advice = "") const;

  std::string folder_;
  std::vector<std::string> names_;
  std::filesystem::path target_;
  std::filesystem::path created_;  ///< the topmost folder that was not there
  std::unique_ptr<JournalFile> journal_;
  bool has_result_ = false;
};

/// As OutputFolder::write, for a single file, which is not locked: "FILE not written: " and the
/// reason.
void write_file(const std::string& path, const std::string& contents);

}  // namespace axisfit
