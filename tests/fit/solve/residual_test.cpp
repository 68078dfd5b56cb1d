#include "fit/solve/residual.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

struct Evaluated {
  std::vector<double> residuals, jacobian;
  bool finite;
};

Evaluated evaluate(const RecordingCost& cost, const Eigen::VectorXd& u) {
  Evaluated e;
  e.residuals.resize(static_cast<std::size_t>(cost.num_residuals()));
  e.jacobian.resize(e.residuals.size() * static_cast<std::size_t>(u.size()));
  const double* parameters = u.data();
  double* jacobian = e.jacobian.data();
  e.finite = cost.Evaluate(&parameters, e.residuals.data(), &jacobian);
  return e;
}

/// How far a column of the Jacobian at u is from central differences, and how large these are. Of
/// the first signal only: the acceleration jumps with the contact, where differences mean nothing.
struct ColumnError {
  double error = 0.0, size = 0.0;
};
ColumnError error_of_column(const RecordingCost& cost, const Eigen::VectorXd& u, std::size_t k) {
  constexpr double kStep = 1e-5;  // smaller ones drown the least of the derivatives in rounding
  const auto columns = static_cast<std::size_t>(u.size());
  Eigen::VectorXd above = u, below = u;
  above[static_cast<Eigen::Index>(k)] += kStep;
  below[static_cast<Eigen::Index>(k)] -= kStep;
  const Evaluated e = evaluate(cost, u), a = evaluate(cost, above), b = evaluate(cost, below);
  double error = 0.0, size = 0.0;
  for (std::size_t i = 0; i < e.residuals.size() / 2; ++i) {
    const double difference = (a.residuals[i] - b.residuals[i]) / (2.0 * kStep);
    error += std::pow(e.jacobian[i * columns + k] - difference, 2);
    size += std::pow(difference, 2);
  }
  return {std::sqrt(error), std::sqrt(size)};
}

Job example_job() {
  Job job;
  job.model = paper_axis();
  job.recordings = {recorded_step(job.model)};
  job.free = {free_parameter("V_L", 2.7), free_parameter("B_a", 200.0),
              free_parameter("b_g", 1500.0), free_parameter("k_g", 5e6),
              free_parameter("T_p", 0.04)};
  return job;
}

TEST(RecordingCost, IsWhiteNoiseAtTheTruth) {
  const Job job = example_job();
  const ParameterSpace space(job);
  const RecordingCost cost(job, space, 0, {});
  const Evaluated e = evaluate(cost, space.internal({{2.7, 200.0, 1500.0, 5e6, 0.04}}));
  ASSERT_TRUE(e.finite);
  double sum = 0.0;
  for (const double r : e.residuals) sum += r * r;
  // 1402 squares of unit normals: mean 1, standard deviation sqrt(2 / 1402) = 0.038
  EXPECT_NEAR(sum / static_cast<double>(e.residuals.size()), 1.0, 0.15);
}

// Every width of dual number gives the same columns, and they are those of differences.
TEST(RecordingCost, JacobianIsThatOfDifferencesForAnyNumberOfParameters) {
  const char* const names[] = {"V_L",
                               "B_a",
                               "b_g",
                               "k_g",
                               "T_p",
                               "M",
                               "J_m",
                               "B_m",
                               "K_t",
                               "r_g",
                               "T_z",
                               "T_r",
                               "K_1",
                               "K_2",
                               "K_i",
                               "V_s",
                               "K_v",
                               "R",
                               "L",
                               "K_e",
                               "K_m",
                               "H",
                               "velocity.gain",
                               "acceleration.gain",
                               "velocity.bias",
                               "acceleration.bias",
                               "initial.y1"};
  Job job = example_job();
  job.free.clear();
  const std::vector<double*> member = members(job.model);
  for (const char* name : names) {
    const double value = *member[quantity_index(name)];
    FreeParameter p = free_parameter(name, value == 0.0 ? 0.01 : value);
    if (value == 0.0) {
      p.initial = 0.0;
      p.lower = -1.0;
      p.upper = 1.0;
      p.scale = Scale::linear;
    }
    job.free.push_back(p);
    const ParameterSpace space(job);
    std::vector<double> start;
    for (const FreeParameter& f : job.free) start.push_back(f.initial);
    const Eigen::VectorXd u = space.internal(start);
    const RecordingCost cost(job, space, 0, Observer::of_velocity(100.0, false));
    const Evaluated e = evaluate(cost, u);
    ASSERT_TRUE(e.finite);
    const auto [error, size] = error_of_column(cost, u, job.free.size() - 1);
    EXPECT_LE(error, 2e-4 * size + 1e-6) << name;
  }
}

TEST(RecordingCost, JacobianIsThatOfDifferencesThroughAFilter) {
  for (const bool zero_phase : {false, true}) {
    Job job = example_job();
    Measurement& velocity = job.recordings[0].measurements[0];
    const Evaluated plain =
        evaluate(RecordingCost(job, ParameterSpace(job), 0, {}),
                 ParameterSpace(job).internal({{2.6, 190.0, 1600.0, 5.1e6, 0.041}}));
    velocity.filter.kind = Filter::Kind::butterworth;
    velocity.filter.order = 3;
    velocity.filter.cutoff = 0.06;
    velocity.filter.zero_phase = zero_phase;
    const ParameterSpace space(job);
    const RecordingCost cost(job, space, 0, {});
    const Eigen::VectorXd u = space.internal({{2.6, 190.0, 1600.0, 5.1e6, 0.041}});
    const Evaluated e = evaluate(cost, u);
    ASSERT_TRUE(e.finite);
    EXPECT_NE(e.residuals, plain.residuals);
    for (std::size_t k = 0; k < space.size(); ++k) {
      const auto [error, size] = error_of_column(cost, u, k);
      EXPECT_LT(error, 1e-4 * size) << name_of(space[k].id());
    }
  }
}

TEST(SimulateRecording, FiltersWhatItSimulates) {
  Job job = example_job();
  const ParameterSpace space(job);
  const Eigen::VectorXd u = space.internal({{2.7, 200.0, 1500.0, 5e6, 0.04}});
  const SimulatedRecording plain = simulate_recording(job, space, 0, u.data(), {});
  Filter& filter = job.recordings[0].measurements[0].filter;
  filter.kind = Filter::Kind::moving_average;
  filter.length = 21;
  const SimulatedRecording through = simulate_recording(job, space, 0, u.data(), {});
  EXPECT_EQ(through.simulated[0], filtered(filter, plain.simulated[0]));
  EXPECT_EQ(through.simulated[1], plain.simulated[1]);
}

TEST(RecordingCost, RejectsWhatCannotBeSimulated) {
  Job job = example_job();
  job.free[4].upper = 1e300;
  const ParameterSpace space(job);
  const RecordingCost cost(job, space, 0, {});
  Eigen::VectorXd u = space.internal({{2.7, 200.0, 1500.0, 5e6, 0.04}});
  u[2] = std::nan("");
  EXPECT_FALSE(evaluate(cost, u).finite);
}

// So that the end of an evaluation, which may take minutes, need not be waited for.
TEST(RecordingCost, IsNotFinishedOnceItIsToStop) {
  const Job job = example_job();
  const ParameterSpace space(job);
  StopFlag stop;
  const RecordingCost cost(job, space, 0, {}, &stop);
  const Eigen::VectorXd truth = space.internal({{2.7, 200.0, 1500.0, 5e6, 0.04}});
  EXPECT_TRUE(evaluate(cost, truth).finite);
  stop.set();
  EXPECT_FALSE(evaluate(cost, truth).finite);
}

TEST(RecordingCost, CountsItsStepsAndEndsWhereTheyAreSpent) {
  const Job job = example_job();
  const ParameterSpace space(job);
  const Eigen::VectorXd truth = space.internal({{2.7, 200.0, 1500.0, 5e6, 0.04}});
  constexpr long kMuch = 1'000'000'000;
  const StopFlag much(nullptr, kMuch);
  EXPECT_TRUE(evaluate(RecordingCost(job, space, 0, {}, &much), truth).finite);
  const long work = kMuch - much.left();
  EXPECT_GT(work, static_cast<long>(job.recordings[0].times.size()));
  const StopFlag enough(nullptr, work), half(nullptr, work / 2);
  EXPECT_TRUE(evaluate(RecordingCost(job, space, 0, {}, &enough), truth).finite);
  EXPECT_FALSE(is_set(&enough));
  EXPECT_FALSE(evaluate(RecordingCost(job, space, 0, {}, &half), truth).finite);
  EXPECT_TRUE(is_set(&half));
}

/// The slide with an outlier of a hundred and one of minus fifty sigma.
Job job_with_outliers() {
  Job job = two_recordings(slide(), slide(), {"M", "B_a"}, 6.0, {Signal::velocity});
  job.recordings.pop_back();
  Measurement& m = job.recordings[0].measurements[0];
  m.values.edit()[300] += 100.0 * m.sigma;
  m.values.edit()[700] -= 50.0 * m.sigma;
  job.options.huber_width = 3.0;
  return job;
}

TEST(RecordingCost, HuberCountsOutliersLinearly) {
  Job job = job_with_outliers();
  const ParameterSpace space(job);
  const Eigen::VectorXd u = space.internal({{20.0, 30.0}});
  const std::vector<double> plain = evaluate(RecordingCost(job, space, 0, {}), u).residuals;
  job.options.loss = Loss::huber;
  const std::vector<double> robust = evaluate(RecordingCost(job, space, 0, {}), u).residuals;
  EXPECT_NEAR(plain[300], 100.0, 5.0);
  EXPECT_NEAR(plain[700], -50.0, 5.0);
  for (std::size_t i = 0; i < plain.size(); ++i) {
    if (std::abs(plain[i]) <= 3.0) {
      EXPECT_EQ(robust[i], plain[i]) << i;
    } else {
      EXPECT_EQ(std::signbit(robust[i]), std::signbit(plain[i])) << i;
      EXPECT_NEAR(robust[i] * robust[i], 2.0 * 3.0 * std::abs(plain[i]) - 9.0, 1e-9) << i;
    }
  }
}

TEST(RecordingCost, HuberJacobianIsThatOfDifferences) {
  Job job = job_with_outliers();
  job.options.loss = Loss::huber;
  const ParameterSpace space(job);
  const RecordingCost cost(job, space, 0, {});
  const Eigen::VectorXd u = space.internal({{20.0, 30.0}});
  const Evaluated e = evaluate(cost, u);
  ASSERT_TRUE(e.finite);
  constexpr double kStep = 1e-5;
  for (Eigen::Index k = 0; k < 2; ++k) {
    const Eigen::VectorXd step = kStep * Eigen::Vector2d::Unit(k);
    const Evaluated above = evaluate(cost, u + step), below = evaluate(cost, u - step);
    for (const std::size_t i : {100u, 300u, 700u}) {
      const double difference = (above.residuals[i] - below.residuals[i]) / (2.0 * kStep);
      const double derivative = e.jacobian[2 * i + static_cast<std::size_t>(k)];
      EXPECT_GT(std::abs(difference), 0.1) << i;
      EXPECT_NEAR(derivative, difference, 1e-6 * std::abs(difference)) << i << " " << k;
    }
  }
}

/// Relative errors of M and B_a that a fit finds in exact samples of an axis, `interval` s apart,
/// while it tracks the signal closely. The command is a chirp from 1 to 17 Hz in fine stairs.
std::pair<double, double> errors_when_tracking(const Model<double>& truth, Signal signal,
                                               double gain, double interval, double jitter = 0.0) {
  constexpr double kDuration = 2.0, kStair = 1e-4;
  Job job;
  job.model = truth;
  job.options.threads = 1;
  job.options.criterion = Tracking{gain};
  Recording& recording = job.recordings.emplace_back();
  recording.name = "fit";
  const int samples = static_cast<int>(std::lround(kDuration / interval));
  std::mt19937_64 generator(1);
  for (int i = 0; i <= samples; ++i)
    recording.times.edit().push_back(interval * (i + jitter * (2.0 * uniform(generator) - 1.0)));
  for (int i = 0; i * kStair < kDuration; ++i) {
    const double t = (i + 0.5) * kStair;
    recording.command.append(i * kStair,
                             4.0 * std::sin(2.0 * std::numbers::pi * (1.0 + 4.0 * t) * t));
  }
  Measurement& m = recording.measurements.emplace_back();
  m.signal = signal;
  m.sigma = 1e-5;
  m.noise = NoiseSource::given;
  simulate(truth, recording.command, recording.times,
           [&](std::size_t, const Integrator<double>& axis) {
             m.values.edit().push_back(
                 reading(axis.equations(), signal, axis.mode(), axis.state(), axis.input()));
           });
  job.free = {free_parameter("M", 1.3 * truth.axis.M), free_parameter("B_a", 1.5 * truth.axis.B_a)};
  const FitResult fit = estimate(job);
  EXPECT_TRUE(fit.is_usable());
  return {fit.parameters[0].value / truth.axis.M - 1.0,
          fit.parameters[1].value / truth.axis.B_a - 1.0};
}

/// The quick slide, with a friction that shows in two seconds.
Model<double> rubbing_slide() {
  Model<double> model = slide();
  model.axis.B_a = 300.0;
  return model;
}

// Chords between the samples would make M heavier by 1.8 % at 4 ms and 0.44 % at 2 ms.
TEST(StrongObserver, ToAnExactPositionFindsTheTruthToFourthOrder) {
  const auto [mass, friction] =
      errors_when_tracking(rubbing_slide(), Signal::position, 100.0, 4e-3);
  const auto [finer_mass, finer_friction] =
      errors_when_tracking(rubbing_slide(), Signal::position, 100.0, 2e-3);
  std::cout << "M " << mass << " and " << finer_mass << ", B_a " << friction << " and "
            << finer_friction << "\n";
  EXPECT_LT(std::abs(mass), 4e-4);
  EXPECT_LT(std::abs(friction), 4e-4);
  EXPECT_NEAR(mass / finer_mass, 16.0, 2.0);
  EXPECT_NEAR(friction / finer_friction, 16.0, 2.0);
}

TEST(StrongObserver, FindsItInUnevenSamplesToo) {
  const auto [mass, friction] =
      errors_when_tracking(rubbing_slide(), Signal::position, 100.0, 4e-3, 0.3);
  std::cout << "M " << mass << ", B_a " << friction << "\n";
  EXPECT_LT(std::abs(mass), 1e-3);
  EXPECT_LT(std::abs(friction), 1e-3);
}

// Chords would make B_a smaller by 9.8 %.
TEST(StrongObserver, ToAnExactVelocityFindsTheTruth) {
  const auto [mass, friction] = errors_when_tracking(motor_axis(), Signal::velocity, 200.0, 2e-3);
  std::cout << "M " << mass << ", B_a " << friction << "\n";
  EXPECT_LT(std::abs(mass), 1e-3);
  EXPECT_LT(std::abs(friction), 1e-2);
}

}  // namespace
}  // namespace axisfit
