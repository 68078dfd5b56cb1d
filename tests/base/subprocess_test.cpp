#include "base/subprocess.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <cstdlib>
#include <new>

namespace axisfit {
namespace {

constexpr std::size_t kMemory = std::size_t{256} << 20;

TEST(RunInSubprocess, ReturnsWhatTheWorkReturns) {
  EXPECT_EQ(run_in_subprocess([] { return std::string(); }, kMemory), "");
  const std::string large(10'000'000, 'x');  // more than a pipe holds
  EXPECT_EQ(run_in_subprocess([&] { return large; }, kMemory), large);
}

TEST(RunInSubprocess, SurvivesTheEndOfTheWork) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGKILL})
    EXPECT_EQ(run_in_subprocess(
                  [&]() -> std::string {
                    ::raise(signal);
                    return "not reached";
                  },
                  kMemory),
              std::nullopt)
        << signal;
  EXPECT_EQ(run_in_subprocess([]() -> std::string { throw std::bad_alloc(); }, kMemory),
            std::nullopt);
}

TEST(RunInSubprocess, LimitsItsMemory) {
  const auto half_and_one_and_a_half = [] {
    std::string fits;
    for (const std::size_t bytes : {kMemory / 2, kMemory + kMemory / 2}) {
      void* const volatile room = std::malloc(bytes);  // volatile: not optimised away
      fits += room == nullptr ? "no " : "yes ";
      std::free(room);
    }
    return fits;
  };
  EXPECT_EQ(run_in_subprocess(half_and_one_and_a_half, kMemory), "yes no ");
  EXPECT_EQ(half_and_one_and_a_half(), "yes yes ");  // this process has no limit
}

}  // namespace
}  // namespace axisfit
