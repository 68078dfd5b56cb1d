#include "base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <latch>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "base/subprocess.h"

namespace axisfit {
namespace {

using namespace std::chrono_literals;

std::vector<int> numbers(int threads) {
  std::vector<int> list(100, 0);
  const ThreadPool pool(threads);
  parallel_for(10, [&](std::size_t i) {
    parallel_for(10, [&](std::size_t k) { list[10 * i + k] += static_cast<int>(10 * i + k); });
  });
  return list;
}

TEST(Parallel, DoesEveryPieceOnce) {
  std::vector<int> expected(100);
  for (int i = 0; i < 100; ++i) expected[static_cast<std::size_t>(i)] = i;
  for (const int threads : {1, 2, 3, 8}) EXPECT_EQ(numbers(threads), expected) << threads;
}

TEST(Parallel, WithoutACrewIsALoop) {
  std::vector<std::size_t> order;
  parallel_for(3, [&](std::size_t i) { order.push_back(i); });
  EXPECT_EQ(order, (std::vector<std::size_t>{0, 1, 2}));
}

TEST(Parallel, ACrewWithinAnotherSharesItsThreads) {
  std::atomic<int> at_work = 0, most = 0;
  const auto at_most = std::chrono::steady_clock::now() + 60s;  // for who would wait for ever
  const ThreadPool pool(2);
  parallel_for(4, [&](std::size_t) {
    const ThreadPool none(8);
    parallel_for(8, [&](std::size_t) {
      const int now = ++at_work;
      for (int known = most; now > known && !most.compare_exchange_weak(known, now);) continue;
      while (most < 2 && std::chrono::steady_clock::now() < at_most) std::this_thread::yield();
      std::this_thread::sleep_for(1ms);  // a third would come meanwhile
      --at_work;
    });
  });
  EXPECT_EQ(most, 2);
}

// Each of the two pieces of the inner loop waits until the other has started.
TEST(Parallel, WhoHasNothingLeftHelpsWithinTheLastPiece) {
  for (const std::size_t pieces : {1u, 2u, 5u}) {
    const ThreadPool pool(2);
    parallel_for(pieces, [&](std::size_t i) {
      if (i + 1 < pieces) return;
      std::this_thread::sleep_for(5ms);  // the others are at their end by now
      std::latch both(2);
      parallel_for(2, [&](std::size_t) { both.arrive_and_wait(); });
    });
  }
}

TEST(Parallel, AnExceptionEndsItsLoopAndIsThrownOnce) {
  for (const int threads : {1, 2, 4}) {
    const ThreadPool pool(threads);
    std::atomic<int> started = 0;
    EXPECT_THROW(parallel_for(100'000,
                              [&](std::size_t i) {
                                ++started;
                                parallel_for(3, [&](std::size_t k) {
                                  if (i == 5 && k == 1) throw std::runtime_error("five");
                                });
                                std::this_thread::sleep_for(100us);
                              }),
                 std::runtime_error);
    EXPECT_LT(started, 50'000) << threads;
    // The pool goes on.
    std::atomic<int> sum = 0;
    parallel_for(10, [&](std::size_t i) { sum += static_cast<int>(i); });
    EXPECT_EQ(sum, 45);
  }
}

int leaves(int depth) {
  if (depth <= 0) return 1;
  std::atomic<int> sum = 0;
  parallel_for(3, [&](std::size_t i) { sum += leaves(depth - 1 - static_cast<int>(i % 2)); });
  return sum;
}

// Deep and uneven, so that threads wait for and help each other in many orders.
TEST(Parallel, NestedLoopsComeToTheirEnd) {
  const int expected = leaves(8);
  for (const int threads : {2, 3, 8}) {
    const ThreadPool pool(threads);
    for (int turn = 0; turn < 20; ++turn) ASSERT_EQ(leaves(8), expected) << threads;
  }
}

// Where the system has no room for another thread's stack.
TEST(Parallel, GoesOnWithoutMoreThreads) {
  const auto work = [] {
    std::latch end(1);
    std::vector<std::jthread> all;
    bool refused = false;
    while (!refused && all.size() < 100) {
      try {
        all.emplace_back([&] { end.wait(); });
      } catch (const std::system_error&) {
        refused = true;
      }
    }
    std::atomic<int> sum = 0;
    {
      const ThreadPool pool(4);
      parallel_for(10, [&](std::size_t i) { sum += static_cast<int>(i); });
    }
    end.count_down();
    return std::string(refused ? "refused " : "granted ") + std::to_string(sum);
  };
  EXPECT_EQ(run_in_subprocess(work, std::size_t{4} << 20), "refused 45");
}

}  // namespace
}  // namespace axisfit
