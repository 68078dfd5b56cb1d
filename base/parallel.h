// Independent pieces of work spread over threads.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace axisfit {

/// Number of threads if `wanted` are requested; zero means as many as the machine has.
int thread_count(int wanted);

/// For as long as it lives, parallel_for() on this thread has `threads` threads to spread its work
/// over, this one included; 0 as for thread_count(). Nested work shares the same threads: another
/// pool has no effect there.
class ThreadPool {
 public:
  explicit ThreadPool(int threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  class Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

/// Calls work(i) for every i below `count`, on all threads of the pool that have nothing else to
/// do, in no particular order; without a pool on this one. Work may call it in turn: threads that
/// have finished the outer loop help with the inner ones. The first exception is rethrown when all
/// calls that were begun have ended.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& work);

}  // namespace axisfit
