#include "fit/errors/hold_shift.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

/// What is fitted with the command as a drive takes it, and its shifts; the recordings count for so
/// much less than they say.
struct Shifted {
  explicit Shifted(double excess)
      : job(two_recordings(slide(), slide(), {"M", "B_a"})),
        fit(estimate(job)),
        shifts(hold_shifts(job, fit.parameters, *fit.at_solution, excess, fit.observer_gain)) {}

  Job job;
  FitResult fit;
  std::vector<std::optional<HoldShift>> shifts;
};

TEST(HoldShift, IsThatOfARefit) {
  const Shifted held(1e9);
  const FitResult refitted = estimate(with_other_hold(held.job));
  std::size_t shifted = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    if (!held.shifts[i]) continue;
    ++shifted;
    const double before = held.fit.parameters[i].value;
    EXPECT_NEAR(held.shifts[i]->value - before, refitted.parameters[i].value - before,
                0.05 * std::abs(refitted.parameters[i].value - before));
    EXPECT_FALSE(held.shifts[i]->is_better);
  }
  EXPECT_GE(shifted, 1u);
}

TEST(HoldShift, IsNoneWhereTheRecordingsExcludeIt) {
  for (const auto& shift : Shifted(1.0).shifts) EXPECT_FALSE(shift);
}

TEST(HoldShift, SaysThatTheOtherHoldIsBetter) {
  const Job wrong = with_other_hold(two_recordings(slide(), slide(), {"M", "B_a"}));
  const FitResult fit = estimate(wrong);
  const auto shifts =
      hold_shifts(wrong, fit.parameters, *fit.at_solution, fit.reduced_chi_square, 0.0);
  ASSERT_TRUE(shifts[0] || shifts[1]);
  for (const auto& shift : shifts) EXPECT_TRUE(!shift || shift->is_better);
}

// Samples that a held schedule leaves out, since they repeat, are where its lines begin.
TEST(HoldShift, GoesStraightFromTheSampleBefore) {
  Job job = two_recordings(slide(), slide(), {"M"});
  job.recordings[0].times = std::vector<double>{0.0, 0.1, 0.2, 0.3, 0.4};
  job.recordings[0].command = schedule_from_samples({0.0, 0.1, 0.2, 0.3}, {1.0, 1.0, 1.0, 3.0});
  const Schedule straight = with_other_hold(job).recordings[0].command;
  EXPECT_NEAR(straight.value_at(0.19), 1.0, 1e-9);
  EXPECT_NEAR(straight.value_at(0.25), 2.0, 1e-9);
  job.recordings[0].command = straight;
  const Schedule held = with_other_hold(job).recordings[0].command;
  EXPECT_EQ(held.value_at(0.25), 1.0);
  EXPECT_EQ(held.value_at(0.31), 3.0);
}

TEST(HoldShift, LeavesReferencesAlone) {
  Job job = two_recordings(slide(), slide(), {"M"});
  job.recordings[0].command.meaning = Meaning::reference;
  EXPECT_EQ(with_other_hold(job).recordings[0].command.hold, Hold::zero_order);
}

}  // namespace
}  // namespace axisfit
