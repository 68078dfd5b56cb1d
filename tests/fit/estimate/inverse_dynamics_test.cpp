#include "fit/estimate/inverse_dynamics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fit/judge/second_opinion.h"
#include "tests/fit/example.h"

namespace axisfit {
namespace {

/// A slide with Coulomb friction and an offset, as somebody declares it who is off by `factor`.
struct Slide {
  explicit Slide(double factor = 1.0) {
    truth = slide();
    truth.structure.effects.set(*effect_named("coulomb_friction"));
    truth.structure.effects.set(*effect_named("constant_force"));
    set(truth, "coulomb_friction.F_c", 12.0);
    set(truth, "constant_force.F_0", -7.0);
    declared = truth;
    for (const char* name : {"M", "B_a", "coulomb_friction.F_c"})
      *members(declared)[quantity_index(name)] *= factor;
    set(declared, "constant_force.F_0", 0.0);
  }
  static void set(Model<double>& model, const char* name, double value) {
    *members(model)[quantity_index(name)] = value;
  }
  double true_value(std::size_t of) { return *members(truth)[of]; }
  Job job(std::uint64_t seed, const std::vector<Signal>& signals = {Signal::velocity}) const {
    Job job =
        two_recordings(truth, declared, {"M", "B_a", "coulomb_friction.F_c", "constant_force.F_0"},
                       3.0, signals, seed);
    return job;
  }

  Model<double> truth, declared;
};

TEST(InverseDynamics, EstimatesWithinItsErrors) {
  Slide slide;
  double squares = 0.0;
  int count = 0, outside = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto found = inverse_dynamics(slide.job(seed));
    ASSERT_TRUE(found);
    EXPECT_TRUE(found->exact);
    EXPECT_LT(found->residual, 0.1 * found->drive_rms);
    ASSERT_EQ(found->parameters.size(), 4u);
    for (const InverseEstimate& e : found->parameters) {
      const double z = (e.value - slide.true_value(e.id.quantity)) / e.uncertainty.standard_error;
      EXPECT_LT(std::abs(e.value - slide.true_value(e.id.quantity)),
                0.1 * std::abs(slide.true_value(e.id.quantity)))
          << name_of(e.id);
      squares += z * z;
      ++count;
      outside += std::abs(z) > 4.0;
    }
  }
  EXPECT_EQ(outside, 0);
  EXPECT_LT(std::sqrt(squares / count), 1.6);
}

TEST(InverseDynamics, DoesNotDependOnTheStart) {
  const auto near = inverse_dynamics(Slide().job(1));
  ASSERT_TRUE(near);
  for (const double factor : {30.0, 1.0 / 30.0}) {
    const auto far = inverse_dynamics(Slide(factor).job(1));
    ASSERT_TRUE(far);
    ASSERT_EQ(far->parameters.size(), near->parameters.size());
    for (std::size_t i = 0; i < near->parameters.size(); ++i)
      EXPECT_NEAR(far->parameters[i].value, near->parameters[i].value,
                  0.01 * near->parameters[i].uncertainty.standard_error)
          << name_of(near->parameters[i].id);
  }
}

TEST(InverseDynamics, TakesTheRecordedCurrentOfAnElectricDrive) {
  Job job = two_recordings(motor_axis(), motor_axis(), {"M", "B_a", "T_p"}, 4.0,
                           {Signal::velocity, Signal::motor_current});
  job.free[0].initial *= 5.0;
  const auto found = inverse_dynamics(job);
  ASSERT_TRUE(found);
  // The balance of forces tells nothing of the preamplifier.
  ASSERT_EQ(found->parameters.size(), 2u);
  EXPECT_EQ(found->parameters[0].id, id_of("M"));
  EXPECT_NEAR(found->parameters[0].value, motor_axis().axis.M, 0.03 * motor_axis().axis.M);
  for (Recording& r : job.recordings) r.measurements.pop_back();
  EXPECT_FALSE(inverse_dynamics(job));
}

TEST(InverseDynamics, KeepsTheGainOfTheDriveWhereTheMassIsFree) {
  Job job = Slide().job(1);
  job.free.insert(job.free.begin(), free_parameter("K_f", slide().axis.K_f));
  const auto found = inverse_dynamics(job);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->parameters.size(), 4u);
  EXPECT_EQ(found->parameters[0].id, id_of("M"));
  EXPECT_EQ(found->parameters[0].parameter, 1u);
  // Free, both would shrink until one is at its bound: that balances best.
  EXPECT_NEAR(found->parameters[0].value, slide().axis.M, 0.1 * slide().axis.M);
  EXPECT_EQ(start_from(job, *found)[0], slide().axis.K_f);
  EXPECT_EQ(start_from(job, *found)[1], found->parameters[0].value);
}

TEST(SecondOpinion, BeginsAgainWhereNoMinimumWasFound) {
  Job job = Slide(30.0).job(1);
  job.options.continuation.reset();
  job.options.max_iterations = 12;
  FitResult fit = estimate_with_noise(job);
  ASSERT_FALSE(fit.is_usable());
  EXPECT_EQ(try_inverse_start(job, fit), InverseStart::better);
  EXPECT_TRUE(fit.is_usable());
  EXPECT_NEAR(fit.reduced_chi_square, 1.0, 0.2);
  EXPECT_EQ(fit.starts.size(), 2u);
  EXPECT_EQ(job.options.max_iterations, 12);
  // From where it is, there is nothing to gain.
  EXPECT_EQ(try_inverse_start(job, fit), InverseStart::not_tried);
}

TEST(SecondOpinion, ContradictsWhatItCannotConfirm) {
  const Job job = Slide().job(1);
  FitResult fit = estimate(job);
  auto opinion = second_opinion(job, fit);
  ASSERT_TRUE(opinion);
  EXPECT_TRUE(opinion->contradictions.empty());
  fit.parameters[2].value *= 2.0;
  opinion = second_opinion(job, fit);
  ASSERT_TRUE(opinion);
  EXPECT_EQ(opinion->contradictions, std::vector<std::size_t>{2});
  // An error that allows for it.
  fit.parameters[2].uncertainty.standard_error = fit.parameters[2].value;
  EXPECT_TRUE(second_opinion(job, fit)->contradictions.empty());
}

}  // namespace
}  // namespace axisfit
