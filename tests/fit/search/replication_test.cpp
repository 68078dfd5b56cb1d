#include "fit/search/replication.h"

#include <gtest/gtest.h>

#include "sim/model.h"
#include "tests/fit/parameter_ids.h"

namespace axisfit {
namespace {

struct Estimate {
  const char* name;
  double value, error;
};

FitResult fit_of(const std::vector<Estimate>& estimates) {
  FitResult fit;
  for (const auto& [name, value, error] : estimates) {
    ParameterResult p;
    p.id = id_of(name);
    p.value = value;
    p.uncertainty.standard_error = error;
    fit.parameters.push_back(std::move(p));
  }
  return fit;
}

Job job_with(const std::vector<Estimate>& estimates) {
  Job job;
  for (const Estimate& e : estimates) job.free.push_back(free_parameter(e.name, e.value));
  return job;
}

Hypothesis hypothesis(std::vector<std::string_view> strengths,
                      std::vector<std::string_view> shapes = {}) {
  Hypothesis c;
  for (const auto name : strengths) c.strengths.push_back(quantity_index(name));
  for (const auto name : shapes) c.shapes.push_back(quantity_index(name));
  c.neutral.assign(strengths.size(), 0.0);
  return c;
}

Replication of_friction(double here, double there, double error) {
  const std::vector<Estimate> a{{"M", 10.0, 0.1}, {"coulomb_friction.F_c", here, error}},
      b{{"M", 12.0, 0.1}, {"coulomb_friction.F_c", there, error}};
  return replication(job_with(a), fit_of(a), fit_of(b), hypothesis({"coulomb_friction.F_c"}));
}

TEST(ReplicationTest, IsOfTheEffectAndNotOfTheOtherParameters) {
  const Replication found = of_friction(20.0, 20.5, 0.3);
  EXPECT_TRUE(found.is_alike);
  ASSERT_EQ(found.parameters.size(), 1u);
  EXPECT_EQ(found.parameters[0].value, 20.5);
}

TEST(ReplicationTest, EstimatesMayDifferByTheirErrorsOrByATenth) {
  EXPECT_TRUE(of_friction(20.0, 21.9, 0.01).is_alike);
  EXPECT_FALSE(of_friction(20.0, 22.2, 0.01).is_alike);
  EXPECT_TRUE(of_friction(20.0, 28.0, 2.0).is_alike);
  EXPECT_FALSE(of_friction(20.0, 29.0, 2.0).is_alike);
}

TEST(ReplicationTest, BothMustBeFarFromZeroAndOfOneSign) {
  EXPECT_FALSE(of_friction(3.9, 3.9, 1.0).is_alike);
  EXPECT_TRUE(of_friction(4.1, 4.1, 1.0).is_alike);
  EXPECT_FALSE(of_friction(6.0, 3.5, 1.0).is_alike);
  EXPECT_FALSE(of_friction(20.0, -20.0, 3.0).is_alike);
}

TEST(ReplicationTest, EstimatesThatProveNothingMayAgree) {
  EXPECT_TRUE(of_friction(6.0, 3.5, 1.0).is_near);
  EXPECT_FALSE(of_friction(20.0, 29.0, 2.0).is_near);
  EXPECT_FALSE(of_friction(20.0, -20.0, 3.0).is_near);
}

TEST(ReplicationTest, NeedsStandardErrors) { EXPECT_FALSE(of_friction(20.0, 20.0, 0.0).is_alike); }

TEST(ReplicationTest, AShapeMustBeAlikeToo) {
  const auto found = [](double period) {
    const std::vector<Estimate> a{{"stribeck_friction.F_st", 9.0, 0.1},
                                  {"stribeck_friction.v_st", 0.010, 0.0005}},
        b{{"stribeck_friction.F_st", 9.1, 0.1}, {"stribeck_friction.v_st", period, 0.0005}};
    return replication(job_with(a), fit_of(a), fit_of(b),
                       hypothesis({"stribeck_friction.F_st"}, {"stribeck_friction.v_st"}))
        .is_alike;
  };
  EXPECT_TRUE(found(0.011));
  EXPECT_FALSE(found(0.02));
}

// Homing shifts the phase of a ripple; its amplitude and its period are the machine's.
TEST(ReplicationTest, OfAPhaseOnlyTheAmplitudeCounts) {
  const auto found = [](double sine, double cosine, bool has_phase) {
    const std::vector<Estimate> a{{"periodic_force.F_s1", 3.0, 0.1},
                                  {"periodic_force.F_c1", 4.0, 0.1}},
        b{{"periodic_force.F_s1", sine, 0.1}, {"periodic_force.F_c1", cosine, 0.1}};
    Hypothesis ripple = hypothesis({"periodic_force.F_s1", "periodic_force.F_c1"});
    ripple.has_phase = has_phase;
    return replication(job_with(a), fit_of(a), fit_of(b), ripple).is_alike;
  };
  EXPECT_TRUE(found(-5.0, 0.1, true));
  EXPECT_FALSE(found(-5.0, 0.1, false));
  EXPECT_FALSE(found(-3.0, 0.1, true));
}

TEST(ReplicationTest, APeriodMustNotBeAnother) {
  const auto ripples = [](double period, double error, double strength = 3.0) {
    const std::vector<Estimate> a{{"periodic_force.F_s1", 3.0, 0.1},
                                  {"periodic_force.F_c1", 4.0, 0.1},
                                  {"periodic_force.period", 2.1, 0.02}},
        b{{"periodic_force.F_s1", strength, 0.1},
          {"periodic_force.F_c1", 0.1, 0.1},
          {"periodic_force.period", period, error}};
    Hypothesis ripple =
        hypothesis({"periodic_force.F_s1", "periodic_force.F_c1"}, {"periodic_force.period"});
    ripple.has_phase = true;
    return replication(job_with(a), fit_of(a), fit_of(b), ripple);
  };
  const auto found = [&](auto... of) { return ripples(of...).has_other_period; };
  EXPECT_TRUE(ripples(2.14, 0.001, -5.0).is_alike);
  EXPECT_TRUE(ripples(2.25, 0.05, -5.0).is_alike);
  EXPECT_FALSE(ripples(2.25, 0.01, -5.0).is_alike) << "a tenth is much of a period";
  EXPECT_TRUE(found(1.3, 0.05));
  EXPECT_FALSE(found(2.2, 0.05));
  EXPECT_FALSE(found(1.3, 0.5)) << "nothing is known of it there";
  EXPECT_FALSE(found(1.3, 0.05, 0.1)) << "it is not seen there";
}

TEST(ReplicationTest, ACurveIsNoEvidence) {
  const std::vector<Estimate> a{{"coulomb_friction.F_c", 20.0, 0.1}};
  Hypothesis curve = hypothesis({"coulomb_friction.F_c"});
  curve.kind = HypothesisKind::curve;
  EXPECT_FALSE(replication(job_with(a), fit_of(a), fit_of(a), curve).is_alike);
}

TEST(ReplicationTest, NeedsARecordingToValidateAndNoParameterOfOneRecording) {
  Job job;
  job.recordings.resize(1);
  EXPECT_FALSE(fit_elsewhere(job, fit_of({})));
  job.recordings.resize(2);
  job.recordings[1].role = Role::validate;
  job.free.push_back(free_parameter("M", 10.0));
  job.free.front().recording = 0;
  EXPECT_FALSE(fit_elsewhere(job, fit_of({{"M", 10.0, 0.1}})));
}

}  // namespace
}  // namespace axisfit
