#include "fit/solve/journal.h"

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <mutex>
#include <set>

#include "fit/estimate/estimate.h"
#include "fit/search/select_effects.h"
#include "tests/fit/example.h"

namespace axisfit {
namespace {

class MemoryJournal : public Journal {
 public:
  std::optional<SolveResult> find(const ProblemKey& key) override {
    const std::lock_guard lock(mutex_);
    const auto known = solutions_.find(key);
    if (known == solutions_.end()) return std::nullopt;
    ++found;
    return known->second;
  }
  void store(const ProblemKey& key, const SolveResult& solution) override {
    const std::lock_guard lock(mutex_);
    solutions_.emplace(key, solution);
    ++kept;
    if (kept == stop_after) stop.set();
  }

  StopFlag stop;
  int found = 0, kept = 0, stop_after = -1;

 private:
  std::mutex mutex_;
  std::map<ProblemKey, SolveResult> solutions_;
};

Model<double> heavier() {
  Model<double> truth = slide();
  truth.axis.M *= 1.3;
  truth.axis.B_a *= 0.6;
  truth.structure.effects.set(*effect_named("coulomb_friction"));
  std::get<CoulombFriction<double>>(truth.effects).F_c = 12.0;
  return truth;
}

Job job() { return two_recordings(heavier(), slide(), {"M", "B_a"}); }

/// Every digit of a fit.
std::vector<double> digits(const FitResult& fit) {
  std::vector<double> list{fit.reduced_chi_square, fit.autocorrelation_time, fit.degrees_of_freedom,
                           static_cast<double>(fit.iterations)};
  for (const ParameterResult& p : fit.parameters)
    list.insert(list.end(), {p.value, p.uncertainty.standard_error});
  for (const StartResult& s : fit.starts) {
    list.push_back(s.reduced_cost);
    list.insert(list.end(), s.to.begin(), s.to.end());
  }
  return list;
}

TEST(JournalTest, AFitThatIsBegunAgainSolvesNothingAgain) {
  MemoryJournal journal;
  Job j = job();
  j.options.starts = 3;
  const FitResult without = estimate(j);
  const FitResult first = estimate(j, {nullptr, &journal});
  const int solved = journal.kept;
  EXPECT_GT(solved, 3);
  EXPECT_EQ(journal.found, 0);
  j.options.threads = 2;
  const FitResult again = estimate(j, {nullptr, &journal});
  EXPECT_EQ(journal.kept, solved);
  EXPECT_EQ(journal.found, solved);
  EXPECT_EQ(digits(first), digits(without));
  EXPECT_EQ(digits(again), digits(without));
}

TEST(JournalTest, ASearchForEffectsThatIsBegunAgainEndsTheSame) {
  const Job plain = job();
  const FitResult fit = estimate(plain);
  const EffectSelection wanted = select_effects(plain, fit);
  ASSERT_EQ(wanted.models.size(), 2u);
  EXPECT_EQ(wanted.models.back().added, "coulomb_friction");
  for (const int stop_after : {2, 7}) {
    MemoryJournal journal;
    journal.stop_after = stop_after;
    EXPECT_TRUE(select_effects(plain, fit, {}, {&journal.stop, &journal}).interrupted);
    const int kept = journal.kept;
    const EffectSelection again = select_effects(plain, fit, {}, {nullptr, &journal});
    EXPECT_GE(journal.found, kept);
    EXPECT_EQ(again.verdict, wanted.verdict);
    EXPECT_EQ(digits(again.result.fit), digits(wanted.result.fit));
    EXPECT_EQ(again.effects.size(), wanted.effects.size());
  }
}

TEST(JournalTest, ASolutionOfAnotherSizeIsNotTaken) {
  class Forged : public MemoryJournal {
    std::optional<SolveResult> find(const ProblemKey&) override {
      SolveResult forged;
      forged.usable = forged.converged = true;
      return forged;
    }
  } forged;
  const Job j = job();
  const FitResult without = estimate(j);
  EXPECT_EQ(digits(estimate(j, {nullptr, &forged})), digits(without));
}

TEST(JournalTest, TheKeyDependsOnAllThatTheSolutionFollowsFrom) {
  struct Problem {
    Job job;
    Eigen::VectorXd u = Eigen::Vector2d(1.0, 2.0);
    double rate = 3.0;
    SolveOptions options{};
    ProblemKey key() const { return problem_key(job, u, rate, options); }
  };
  static const ChannelList kTemperature{{"temperature", "degC", 20.0}},
      kOtherZero{{"temperature", "degC", 21.0}};
  const Job good = job();
  std::vector<std::function<void(Problem&)>> changes{
      [](Problem& p) { p.job.model.structure.drive = Drive::velocity_loop; },
      [](Problem& p) { p.job.model.structure.transmission = Transmission::backlash; },
      [](Problem& p) { p.job.model.structure.joint = Joint::revolute; },
      [](Problem& p) { p.job.model.structure.gearing = Gearing::turns; },
      [](Problem& p) { p.job.model.structure.closed_loop = true; },
      [](Problem& p) { p.job.model.structure.channels = kept(kTemperature); },
      [](Problem& p) { p.job.model.structure.channels = kept(kOtherZero); },
      [](Problem& p) { p.job.model.controller.timing.period = 4e-3; },
      [](Problem& p) { p.job.recordings[0].times.edit()[7] += 1e-9; },
      [](Problem& p) { p.job.recordings[0].command.times.edit()[1] += 1e-9; },
      [](Problem& p) { p.job.recordings[0].command.values.edit()[1] += 1e-9; },
      [](Problem& p) { p.job.recordings[0].measurements[1].values.edit()[5] += 1e-9; },
      [](Problem& p) { p.job.recordings[0].measurements[1].sigma *= 2.0; },
      [](Problem& p) { p.job.recordings[0].measurements[1].fitted = false; },
      [](Problem& p) { p.job.recordings[0].measurements[1].signal = Signal::position; },
      [](Problem& p) { p.job.recordings[0].measurements.pop_back(); },
      [](Problem& p) { p.job.recordings[0].measurements[0].excluded.resize(300); },
      [](Problem& p) { p.job.recordings[0].held_out.resize(300); },
      [](Problem& p) { p.job.recordings[0].held_out.resize(301); },
      [](Problem& p) { p.job.recordings[0].command.hold = Hold::linear; },
      [](Problem& p) {
        p.job.recordings[0].measurements[0].filter.kind = Filter::Kind::butterworth;
      },
      [](Problem& p) { p.job.recordings[0].initial_state = InitialState::data; },
      [](Problem& p) {
        p.job.recordings[0].channels = {Samples{1.0, 2.0}};
      },
      [](Problem& p) {
        p.job.recordings[0].channels = {Samples{1.0, 2.5}};
      },
      [](Problem& p) {
        p.job.recordings[0].channels = {Samples{1.0, 2.0}, Samples{0.0, 0.0}};
      },
      [](Problem& p) { p.job.recordings[0].overrides.emplace_back(3, 1.0); },
      [](Problem& p) { p.job.recordings[0].overrides.emplace_back(4, 1.0); },
      [](Problem& p) { p.job.recordings[0].role = Role::validate; },
      [](Problem& p) { p.job.recordings[1].role = Role::fit; },
      [](Problem& p) { p.job.free.pop_back(); },
      [](Problem& p) { p.job.free[0].quantity += 1; },
      [](Problem& p) { p.job.free[0].recording = 0; },
      [](Problem& p) { p.job.free[0].recording = 1; },
      [](Problem& p) { p.job.free[0].initial *= 2.0; },
      [](Problem& p) { p.job.free[0].lower *= 2.0; },
      [](Problem& p) { p.job.free[0].upper *= 2.0; },
      [](Problem& p) { p.job.free[0].scale = Scale::linear; },
      [](Problem& p) {
        p.job.free[0].prior = Prior{1.0, 2.0};
      },
      [](Problem& p) {
        p.job.free[0].prior = Prior{1.0, 3.0};
      },
      [](Problem& p) { p.job.options.loss = Loss::huber; },
      [](Problem& p) { p.job.options.huber_width = 4.0; },
      [](Problem& p) { p.job.options.step = 1e-3; },
      [](Problem& p) { p.job.options.criterion = Windows{0.5}; },
      [](Problem& p) { p.u[1] = std::nextafter(2.0, 3.0); },
      [](Problem& p) { p.rate = 0.0; },
      [](Problem& p) { p.options.max_iterations = 7; },
      [](Problem& p) { p.options.function_tolerance = 1e-3; },
      [](Problem& p) { p.options.parameter_tolerance = 1e-3; },
      [](Problem& p) { p.options.penalize_distance_from_start = true; },
      [](Problem& p) { p.options.fixed = {0}; },
      [](Problem& p) { p.options.fixed = {1}; },
  };
  for (std::size_t q = 0; q < quantity_list().size(); ++q)
    changes.emplace_back([q](Problem& p) { *members(p.job.model)[q] += 0.125; });
  for (std::size_t e = 0; e < kEffects; ++e)
    changes.emplace_back([e](Problem& p) { p.job.model.structure.effects.flip(e); });
  std::set<ProblemKey> keys{Problem{good}.key()};
  for (const auto& change : changes) {
    Problem changed{good};
    change(changed);
    EXPECT_TRUE(keys.insert(changed.key()).second) << "change " << keys.size();
  }
  // What only tells how to go about it does not matter.
  Problem same{good};
  same.job.options.threads = 7;
  same.job.options.starts = 5;
  same.job.recordings[0].name = "another";
  same.job.recordings[0].file = "another.csv";
  EXPECT_FALSE(keys.insert(same.key()).second);
}

}  // namespace
}  // namespace axisfit
