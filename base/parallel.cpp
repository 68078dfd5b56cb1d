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
thread_local ThreadPool::Impl* pool = nullptr;
thread_local int depth = 0;

}  // namespace

class ThreadPool::Impl {
 public:
  explicit Impl(int threads) : most_(static_cast<std::size_t>(threads - 1)) { pool = this; }
  ~Impl() {
    {
      const std::lock_guard lock(mutex_);
      ended_ = true;
    }
    changed_.notify_all();
    threads_.clear();
    pool = nullptr;
  }

  void run(std::size_t count, const std::function<void(std::size_t)>& work) {
    Loop loop{work, count, depth};
    std::unique_lock lock(mutex_);
    const auto place = loops_.insert(loops_.end(), &loop);
    start_threads(count - 1);
    changed_.notify_all();
    while (loop.next < loop.count) do_next(loop, lock);
    // Only what lies deeper is worth a delay of this loop's end. Nor can two threads then wait for
    // each other: whatever a thread waits for lies deeper than all that it is in the midst of.
    while (loop.running > 0)
      if (Loop* inner = open_loop(loop.depth + 1))
        do_next(*inner, lock);
      else
        changed_.wait(lock);
    loops_.erase(place);
    if (loop.failure) std::rethrow_exception(loop.failure);
  }

 private:
  void serve() {
    pool = this;
    std::unique_lock lock(mutex_);
    while (!ended_) {
      if (Loop* loop = open_loop(0)) {
        do_next(*loop, lock);
        continue;
      }
      ++idle_;
      changed_.wait(lock);
      --idle_;
    }
  }

  /// Threads for so many pieces, as far as none are idle.
  void start_threads(std::size_t pieces) {
    try {
      for (std::size_t i = idle_; i < pieces && threads_.size() < most_; ++i)
        threads_.emplace_back([this] { serve(); });
    } catch (const std::exception&) {
      // The system has no more threads to give: it takes longer with those there are.
    }
  }

  /// The first loop at this depth or deeper that has pieces left to begin; null if there is none.
  Loop* open_loop(int least) const {
    const auto found = std::ranges::find_if(
        loops_, [&](const Loop* loop) { return loop->next < loop->count && loop->depth >= least; });
    return found == loops_.end() ? nullptr : *found;
  }

  /// Does the next piece of a loop. Locked before and after.
  void do_next(Loop& loop, std::unique_lock<std::mutex>& lock) {
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
  bool ended_ = false;
  std::size_t most_, idle_ = 0;  ///< of the threads
  std::vector<std::jthread> threads_;
};

int thread_count(int wanted) {
  return wanted > 0 ? wanted : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

ThreadPool::ThreadPool(int threads) {
  if (pool == nullptr) impl_ = std::make_unique<Impl>(thread_count(threads));
}

ThreadPool::~ThreadPool() = default;

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& work) {
  if (pool != nullptr && count > 1) return pool->run(count, work);
  for (std::size_t i = 0; i < count; ++i) work(i);
}

}  // namespace axisfit
