// A limit of time for a part of long work.
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "base/interrupt.h"

namespace axisfit {

/// A stop flag that is set when the process has spent some time of its processors, or when another
/// flag is, while it lives. Others that load the machine do not count.
class Deadline {
 public:
  /// s of all threads together. `other` may be null, and must outlive it.
  Deadline(const StopFlag* other, double seconds);
  ~Deadline();
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;

  const StopFlag* flag() const { return &flag_; }

 private:
  StopFlag flag_ = false;
  bool over_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::thread watch_;
};

}  // namespace axisfit
