#include "base/subprocess.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <new>

namespace axisfit {
namespace {

TEST(RunApart, ReturnsWhatTheWorkReturns) {
  EXPECT_EQ(run_in_subprocess([] { return std::string(); }), "");
  const std::string large(10'000'000, 'x');  // more than a pipe holds
  EXPECT_EQ(run_in_subprocess([&] { return large; }), large);
}

TEST(RunApart, SurvivesTheEndOfTheWork) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGKILL})
    EXPECT_EQ(run_in_subprocess([&]() -> std::string {
                ::raise(signal);
                return "not reached";
              }),
              std::nullopt)
        << signal;
  EXPECT_EQ(run_in_subprocess([]() -> std::string { throw std::bad_alloc(); }), std::nullopt);
}

}  // namespace
}  // namespace axisfit
