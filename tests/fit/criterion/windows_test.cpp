#include "fit/criterion/windows.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <iostream>

#include "fit/data/initial_state.h"
#include "fit/estimate/estimate.h"
#include "tests/fit/wandering.h"

namespace axisfit {
namespace {

/// Half the sum of squares at u, and its gradient by the Jacobian.
std::pair<double, Eigen::VectorXd> cost_at(const RecordingCost& cost, const Eigen::VectorXd& u) {
  Eigen::VectorXd residuals(cost.num_residuals());
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> jacobian(
      cost.num_residuals(), u.size());
  const double* parameters = u.data();
  double* rows = jacobian.data();
  EXPECT_TRUE(cost.Evaluate(&parameters, residuals.data(), &rows));
  return {0.5 * residuals.squaredNorm(), jacobian.transpose() * residuals};
}

/// Farthest of the gradient from that of differences, in parts of its size.
double error_of_gradient(const Job& job, const std::vector<double>& values) {
  const ParameterSpace space(job);
  const RecordingCost cost(job, space, 0, {});
  const Eigen::VectorXd u = space.internal(values);
  const Eigen::VectorXd gradient = cost_at(cost, u).second;
  double error = 0.0;
  constexpr double kStep = 1e-5;
  for (Eigen::Index k = 0; k < u.size(); ++k) {
    const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(u.size(), k);
    const double difference =
        (cost_at(cost, u + step).first - cost_at(cost, u - step).first) / (2.0 * kStep);
    error = std::max(error, std::abs(gradient[k] - difference));
  }
  return error / gradient.norm();
}

TEST(Windows, GradientIsThatOfDifferences) {
  Job job = wandering_slide(5.0);
  job.options.criterion = Windows{1.0};
  EXPECT_LT(error_of_gradient(job, {18.0, 35.0, 7.0}), 1e-4);
  // With a gear, currents and limits that go on from window to window.
  Job gear;
  gear.model = paper_axis();
  gear.recordings = {recorded_step(gear.model)};
  gear.free = {free_parameter("V_L", 2.7), free_parameter("B_a", 200.0),
               free_parameter("k_g", 5e6)};
  gear.options.criterion = Windows{0.1};
  EXPECT_LT(error_of_gradient(gear, {2.6, 210.0, 5.2e6}), 1e-2);
}

/// What is left may be less than what events round to: then no step is better, however short.
TEST(Windows, EndWhereNothingIsLeftToGain) {
  WindowStates states({{.position = 0.0, .velocity = 0.0}}, {0, 0, 0});
  WindowStates::Columns derivatives = WindowStates::Columns::Identity(3, WindowStates::kStates);
  int passes = 0;
  for (bool goes_on = true; goes_on; ++passes) {
    const double x = *states.starts().front().position - 1.0;
    const double v = *states.starts().front().velocity - 2.0;
    goes_on =
        states.improve(Eigen::Vector3d(x, v + 2e-5 * v * v, 1.0 + 1e-8 * passes), derivatives);
  }
  EXPECT_LE(passes, 5);
  // Halfway to what the residuals ask for: the deviations allowed are as small.
  EXPECT_NEAR(*states.starts().front().position, 0.5, 1e-4);
  EXPECT_NEAR(*states.starts().front().velocity, 1.0, 1e-4);
}

TEST(Windows, BeginWithTheStateThatSuitsThemBest) {
  Job job = wandering_slide(0.0);
  job.options.criterion = Windows{1.0};
  const ParameterSpace space(job);
  const Eigen::VectorXd truth = space.internal({{kMass, kDamping, kFriction}});
  const SimulatedRecording whole = simulate_recording(job, space, 0, truth.data(), {});
  const RecordingCost cost(job, space, 0, {});
  const std::vector<WindowStart> first = window_starts(job, 0), found = cost.starts(truth.data());
  ASSERT_EQ(found.size(), 16u);
  double guessed = 0.0, fitted = 0.0;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const double true_velocity = whole.samples[found[k].sample].velocity;
    guessed += std::pow(*first[k].velocity - true_velocity, 2);
    fitted += std::pow(*found[k].velocity - true_velocity, 2);
    EXPECT_NEAR(*found[k].position, whole.samples[found[k].sample].position, 1e-4) << k;
  }
  EXPECT_LT(std::sqrt(fitted / 16.0), 4e-4);
  EXPECT_LT(fitted, 0.1 * guessed);
  // And leave no more than the noise: 3201 samples, two states a window.
  EXPECT_NEAR(2.0 * cost_at(cost, truth).first / (3201.0 - 32.0), 1.0, 0.1);
  EXPECT_EQ(window_states(job), 32u);
}

/// The slide, recorded from an instant on at which it moves.
Job moving_slide() {
  Job job = wandering_slide(0.0);
  Recording& recording = job.recordings[0];
  constexpr std::ptrdiff_t kFirst = 150;
  recording.times = std::vector(recording.times.begin() + kFirst, recording.times.end());
  Samples& values = recording.measurements[0].values;
  values = std::vector(values.begin() + kFirst, values.end());
  initial_state_from_data(recording);
  return job;
}

// A cubic through twenty samples errs by so much in the speed that the rest of the recording would
// have to take it upon itself.
TEST(Windows, AFreeRunBeginsWithTheStateThatSuitsItBest) {
  Job job = moving_slide();
  EXPECT_EQ(window_states(job), 2u);
  EXPECT_LT(error_of_gradient(job, {18.0, 35.0, 7.0}), 1e-4);
  const FitResult found = estimate(job);
  ASSERT_TRUE(found.is_usable()) << found.message;
  EXPECT_NEAR(found.reduced_chi_square, 1.0, 0.1);
  EXPECT_NEAR(found.recordings[0].signals[0].reduced_chi_square, 1.0, 0.1);
  const double truth[] = {kMass, kDamping, kFriction};
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(found.parameters[i].value, truth[i],
                4.0 * found.parameters[i].uncertainty.standard_error);
  job.recordings[0].initial_state = InitialState::given;  // as if the cubic were the truth
  EXPECT_GT(estimate(job).reduced_chi_square, 2.0);
}

TEST(Windows, KeepToWhatIsKnown) {
  Job job = wandering_slide(0.0);
  EXPECT_EQ(window_starts(job, 0).size(), 1u);
  job.recordings[0].initial_state = InitialState::given;
  EXPECT_TRUE(window_starts(job, 0).empty());
  job.recordings[0].initial_state = InitialState::data;
  job.options.criterion = Tracking{10.0};
  EXPECT_TRUE(window_starts(job, 0).empty());
  job.options.criterion = Windows{4.0};
  job.recordings[0].knows_velocity = true;
  EXPECT_TRUE(window_starts(job, 0)[0].position);
  EXPECT_FALSE(window_starts(job, 0)[0].velocity);
  EXPECT_TRUE(window_starts(job, 0)[1].velocity);
  job.recordings[0].knows_velocity = false;
  EXPECT_EQ(window_starts(job, 0).size(), 4u);
  job.recordings[0].initial_state = InitialState::given;
  EXPECT_FALSE(window_starts(job, 0)[0].position);
  EXPECT_TRUE(window_starts(job, 0)[1].position);
  EXPECT_EQ(window_states(job), 6u);
  job.options.criterion = Windows{1e-4};  // ten samples at least
  EXPECT_EQ(window_starts(job, 0).size(), 320u);
  job.recordings[0].measurements[0].signal = Signal::acceleration;
  EXPECT_TRUE(window_starts(job, 0).empty());
  job.recordings[0].measurements[0].signal = Signal::velocity;
  EXPECT_FALSE(window_starts(job, 0)[1].position);
  EXPECT_TRUE(window_starts(job, 0)[1].velocity);
  job.recordings[0].command.meaning = Meaning::reference;
  EXPECT_TRUE(window_starts(job, 0).empty());
}

double farthest(const FitResult& fit) {
  const std::array truth{kMass, kDamping, kFriction};
  double error = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i)
    error = std::max(error, std::abs(std::log(fit.parameters[i].value / truth[i])));
  return error;
}

TEST(Windows, FindWhatAWholeRunLosesWhereAForceWanders) {
  Job job = wandering_slide(3.0);
  const FitResult whole = estimate(job);
  job.options.criterion = Windows{0.8};
  const FitResult windows = estimate(job);
  ASSERT_TRUE(windows.verdict.has_minimum());
  std::cout << "farthest parameter, by a factor of: " << std::exp(farthest(whole)) << " whole, "
            << std::exp(farthest(windows)) << " in windows\n";
  EXPECT_LT(farthest(windows), 0.15);
  EXPECT_GT(farthest(whole), 3.0 * farthest(windows));
  // The simulation of the fit is that in windows.
  ASSERT_TRUE(windows.recordings[0].tracking);
  EXPECT_LT(*windows.recordings[0].signals[0].prediction_rmse,
            0.2 * windows.recordings[0].signals[0].rmse);
}

}  // namespace
}  // namespace axisfit
