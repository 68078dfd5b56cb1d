#include "base/parallel.h"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <list>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace axisfit {
namespace {

/// A call of parallel_for() that has not returned.
struct Loop {
  const std::function<void(std::size_t)>& work;
  std::size_t count;
  int depth;  ///< the number of loops that it is called from
  std::size_t next = 0, running = 0;
  std::exception_ptr failure = nullptr;
};

/// Where this thread is.
thread_local Crew::Members* crew = nullptr;
thread_local int depth = 0;

}  // namespace

class Crew::Members {
 public:
  explicit Members(int threads) : most_(static_cast<std::size_t>(threads - 1)) { crew = this; }
  ~Members() {
    {
      const std::lock_guard lock(mutex_);
      dismissed_ = true;
    }
    changed_.notify_all();
    helpers_.clear();
    crew = nullptr;
  }

  void run(std::size_t count, const std::function<void(std::size_t)>& work) {
    Loop loop{work, count, depth};
    std::unique_lock lock(mutex_);
    const auto place = loops_.insert(loops_.end(), &loop);
    hire(count - 1);
    changed_.notify_all();
    while (loop.next < loop.count) take(loop, lock);
    // Only what lies deeper is worth a delay of this loop's end. Nor can two threads then wait for
    // each other: whatever a thread waits for lies deeper than all that it is in the midst of.
    while (loop.running > 0)
      if (Loop* inner = open_loop(loop.depth + 1))
        take(*inner, lock);
      else
        changed_.wait(lock);
    loops_.erase(place);
    if (loop.failure) std::rethrow_exception(loop.failure);
  }

 private:
  void help() {
    crew = this;
    std::unique_lock lock(mutex_);
    while (!dismissed_) {
      if (Loop* loop = open_loop(0)) {
        take(*loop, lock);
        continue;
      }
      ++idle_;
      changed_.wait(lock);
      --idle_;
    }
  }

  /// Helpers for so many pieces, as far as nobody is idle.
  void hire(std::size_t pieces) {
    try {
      for (std::size_t i = idle_; i < pieces && helpers_.size() < most_; ++i)
        helpers_.emplace_back([this] { help(); });
    } catch (const std::exception&) {
      // The system has no more threads to give: it takes longer with those there are.
    }
  }

  /// Of the loops with something left to begin that are no less deep than `least` the first.
  Loop* open_loop(int least) const {
    const auto found = std::ranges::find_if(
        loops_, [&](const Loop* loop) { return loop->next < loop->count && loop->depth >= least; });
    return found == loops_.end() ? nullptr : *found;
  }

  /// Does the next piece of a loop. Locked before and after.
  void take(Loop& loop, std::unique_lock<std::mutex>& lock) {
    const std::size_t i = loop.next++;
    ++loop.running;
    lock.unlock();
    std::exception_ptr failure;
    const int outside = std::exchange(depth, loop.depth + 1);
    try {
      loop.work(i);
    } catch (...) {
      failure = std::current_exception();
    }
    depth = outside;
    lock.lock();
    --loop.running;
    if (failure) {
      loop.next = loop.count;
      if (!loop.failure) loop.failure = failure;
    }
    if (loop.running == 0 && loop.next == loop.count) changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::list<Loop*> loops_;
  bool dismissed_ = false;
  std::size_t most_, idle_ = 0;  ///< of the helpers
  std::vector<std::jthread> helpers_;
};

int thread_count(int wanted) {
  return wanted > 0 ? wanted : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

Crew::Crew(int threads) {
  if (crew == nullptr) members_ = std::make_unique<Members>(thread_count(threads));
}

Crew::~Crew() = default;

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& work) {
  if (crew != nullptr && count > 1) return crew->run(count, work);
  for (std::size_t i = 0; i < count; ++i) work(i);
}

}  // namespace axisfit
