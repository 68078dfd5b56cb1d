// The journal of a run in its output folder (fit/journal.h says what it is for).
#pragma once

#include <atomic>
#include <cstddef>
#include <mutex>
#include <string>
#include <unordered_map>

#include "fit/solve/journal.h"

namespace axisfit {

/// A file to which every solution is added when it is found, and which is locked as long as this
/// object lives. A record that was not written to its end or is no solution, and all after it,
/// count as not written. Solutions of another build of the program do not count.
class JournalFile : public Journal {
 public:
  static constexpr const char* kSignature = "axisfit";  ///< near the start of every journal

  /// Opens the file, or makes it. Throws std::runtime_error with a reason, without the path, when
  /// that is not possible or another process has it locked.
  explicit JournalFile(const std::string& path);
  ~JournalFile() override;
  JournalFile(const JournalFile&) = delete;
  JournalFile& operator=(const JournalFile&) = delete;

  /// Solutions of earlier runs that the file holds.
  std::size_t recovered() const { return recovered_.size(); }
  /// From now on they are found.
  void resume() { resuming_ = true; }
  /// Whether there is anything in it.
  bool is_empty() const { return recovered_.empty() && stored_ == 0; }
  /// Why the latest solution was not kept, as when the disk is full; empty where it was.
  std::string failure() const;

  std::optional<SolveResult> find(const ProblemKey& key) override;
  void store(const ProblemKey& key, const SolveResult& solution) override;

 private:
  struct KeyHash {
    std::size_t operator()(const ProblemKey& key) const { return key[0]; }
  };

  void open_and_lock(const std::string& path);
  void read();
  void append(const std::string& record);

  int file_ = -1;
  std::size_t end_ = 0;  ///< of the last whole record
  std::unordered_map<ProblemKey, SolveResult, KeyHash> recovered_;
  bool resuming_ = false;
  std::atomic<std::size_t> stored_ = 0;
  mutable std::mutex mutex_;
  std::string failure_;
};

}  // namespace axisfit
