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

/// What a result can be called, and how one is told from a file of the same name that is somebody
/// else's: by a text that it contains.
struct ResultName {
  std::string name, signature;
};

/// The folder of a run's results. It belongs to this run alone as long as this object lives. Only
/// files of those names with their signatures are ever replaced or removed.
///
/// All errors are std::runtime_error: "results not written to FOLDER: " and the reason.
class OutputFolder {
 public:
  /// Makes the folder if need be. `names` are those that results can have, `inputs` the files that
  /// the run reads. Throws, and leaves nothing behind, when results cannot be put into the folder,
  /// would replace an input or somebody else's file, or another run is at work in it: before the
  /// work rather than after.
  OutputFolder(std::string folder, std::vector<ResultName> names,
               const std::vector<std::string>& inputs = {});
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
  bool is_own(const std::filesystem::path& file) const;
  void refuse_foreign_files() const;
  bool holds_results_only() const;
  bool exchange(const Files& files, bool complete) const;
  void replace_one_by_one(const Files& files, bool complete) const;
  void remove_created_folders() const;
  /// In the handler of `error`: throws what the user is told, or that memory ran out.
  [[noreturn]] void fail(const std::exception& error, const char* advice = "") const;

  std::string folder_;
  std::vector<ResultName> names_;
  std::filesystem::path target_;
  std::filesystem::path created_;  ///< the topmost folder that was not there
  std::unique_ptr<JournalFile> journal_;
  bool has_result_ = false;
};

/// Throws std::runtime_error where `path` is one of the files that were read, by whatever name.
void refuse_to_overwrite(const std::string& path, const std::vector<std::string>& inputs);

/// As OutputFolder::write, for a single file, which is not locked: "FILE not written: " and the
/// reason.
void write_file(const std::string& path, const std::string& contents);

}  // namespace axisfit
