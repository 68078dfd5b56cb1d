#include "fit/solve/run_context.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "fit/solve/journal.h"

namespace axisfit {
namespace {

TEST(RunContext, ThrowsOnceItIsToStop) {
  StopFlag stop;
  const RunContext context{.stop = &stop};
  EXPECT_NO_THROW(context.check_stop());
  stop.set();
  EXPECT_THROW(context.check_stop(), Interrupted);
  EXPECT_NO_THROW(RunContext().check_stop());
}

TEST(RunContext, QuietWorkReportsNothingAndIsElseTheSame) {
  class EmptyJournal : public Journal {
    std::optional<SolveResult> find(const ProblemKey&) override { return std::nullopt; }
    void store(const ProblemKey&, const SolveResult&) override {}
  } journal;
  StopFlag stop;
  stop.set();
  std::vector<std::string> phases;
  const RunContext context{&stop, &journal,
                           [&](const Progress& now) { phases.push_back(now.phase); }};
  context.report({.phase = "outer"});
  context.quiet().report({.phase = "inner"});
  EXPECT_EQ(phases, std::vector<std::string>{"outer"});
  EXPECT_EQ(context.quiet().journal, &journal);
  EXPECT_THROW(context.quiet().check_stop(), Interrupted);
}

}  // namespace
}  // namespace axisfit
