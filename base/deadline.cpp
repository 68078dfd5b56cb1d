#include "base/deadline.h"

#include <chrono>
#include <ctime>

namespace axisfit {

Deadline::Deadline(const StopFlag* other, double seconds)
    : watch_([this, other, seconds] {
        const auto end = static_cast<double>(std::clock()) + seconds * CLOCKS_PER_SEC;
        constexpr std::chrono::milliseconds kPoll(20);  // the other flag tells nobody
        std::unique_lock lock(mutex_);
        while (!over_ && !is_set(other) && static_cast<double>(std::clock()) < end)
          changed_.wait_for(lock, kPoll);
        if (!over_) flag_ = true;
      }) {}

Deadline::~Deadline() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  changed_.notify_one();
  watch_.join();
}

}  // namespace axisfit
