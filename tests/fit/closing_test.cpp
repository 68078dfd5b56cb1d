#include <gtest/gtest.h>

#include <iostream>
#include <set>

#include "fit/closing/close_loop.h"
#include "tests/fit/secrets.h"

namespace axisfit {
namespace {

std::set<std::string> names(const ClosedLoop& loop, Decision decision) {
  std::set<std::string> list;
  for (const EffectTrial& trial : loop.effects)
    if (trial.decision == decision) list.insert(trial.candidate.name);
  return list;
}

void print(const ClosedLoop& loop) {
  for (const EffectTrial& t : loop.effects) {
    std::cout << t.round << " " << t.candidate.name << " "
              << (t.decision == Decision::accepted    ? "ACCEPTED"
                  : t.decision == Decision::undecided ? "UNDECIDED"
                                                      : "refused")
              << " score " << t.score << " fit gain " << t.improvement.fit_gain << " z "
              << t.improvement.z << " " << t.improvement.validate_percent << " %: " << t.reason;
    for (const auto& p : t.parameters)
      std::cout << " | " << p.name << " " << p.value << " +- " << p.uncertainty.standard_error;
    std::cout << "\n";
  }
  for (const ParameterResult& p : loop.result.fit.parameters)
    std::cout << p.name << " " << p.value << " +- " << p.uncertainty.standard_error << "; ";
  std::cout << "\n" << loop.verdict << "\n";
  for (const auto& hint : loop.hints) std::cout << hint << "\n";
}

ClosedLoop close(const Job& job) {
  const FitResult fit = estimate(job);
  EXPECT_TRUE(fit.usable) << fit.verdict;
  std::cout << "declared: " << fit.reduced_chi_square << "\n";
  ClosedLoop loop = close_loop(job, fit);
  print(loop);
  return loop;
}

class CloseLoopOn : public testing::TestWithParam<Secret> {};

TEST_P(CloseLoopOn, FindsTheOneEffect) {
  const ClosedLoop loop = close(GetParam().job());
  EXPECT_EQ(names(loop, Decision::accepted), std::set<std::string>{GetParam().name});
  EXPECT_TRUE(loop.explained);
}

INSTANTIATE_TEST_SUITE_P(EverySlot, CloseLoopOn, testing::ValuesIn(secrets()),
                         [](const auto& one) { return one.param.label(); });
}  // namespace
}  // namespace axisfit
