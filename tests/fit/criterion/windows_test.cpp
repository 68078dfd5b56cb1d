#include "fit/criterion/windows.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <iostream>
#include <numbers>

#include "fit/estimate/horizon.h"
#include "tests/fit/example.h"

namespace axisfit {
namespace {

constexpr double kMass = 20.0, kDamping = 30.0, kFriction = 8.0;

/// A slide of a program of its own, in steps of 0.1 ms: besides its friction a force pushes it that
/// wanders slowly, with this amplitude (N), and that its model lacks. Its position is recorded.
Job wandering_slide(double amplitude) {
  Job job;
  job.model = driven_mass(kMass);
  job.model.axis.K_f = 40.0;
  job.model.axis.B_a = kDamping;
  add_effect<CoulombFriction>(job.model).F_c = kFriction;
  constexpr double kStep = 1e-4, kInterval = 5e-3, kDuration = 16.0;
  constexpr int kEvery = 50;
  Normal noise(7);
  std::vector<double> times, commands, positions;
  double position = 0.0, velocity = 0.0;
  const auto command_at = [](double t) {
    constexpr std::array kLevels{1.0, -1.2, 0.6, -0.3, 1.4, -0.9, -0.5, 0.8};
    return kLevels[static_cast<std::size_t>(t / 0.4) % kLevels.size()];
  };
  for (int i = 0; i <= static_cast<int>(kDuration / kStep); ++i) {
    const double t = i * kStep;
    if (i % kEvery == 0) {
      times.push_back(kInterval * static_cast<double>(times.size()));
      commands.push_back(command_at(t + 1e-9));
      positions.push_back(position + usual_noise(Signal::position) * noise());
    }
    const double pushed = 40.0 * command_at(t + 1e-9) - kDamping * velocity +
                          amplitude * std::sin(2.0 * std::numbers::pi * t / 11.0);
    const double next = velocity + kStep / kMass * pushed;
    const double most = kStep / kMass * kFriction;
    velocity = std::abs(next) <= most ? 0.0 : next - std::copysign(most, next);
    position += kStep * velocity;
  }
  Recording& recording = job.recordings.emplace_back();
  recording.name = "fit";
  recording.times = times;
  recording.command = schedule_from_samples(recording.times, commands);
  recording.initial_state = InitialState::data;
  Measurement& m = recording.measurements.emplace_back();
  m.signal = Signal::position;
  m.values = positions;
  m.sigma = usual_noise(Signal::position);
  m.noise = NoiseSource::given;
  job.free = {free_parameter("M", 25.0), free_parameter("B_a", 20.0),
              free_parameter("coulomb_friction.F_c", 5.0)};
  job.options.threads = 1;
  return job;
}

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
  job.options.horizon = 1.0;
  EXPECT_LT(error_of_gradient(job, {18.0, 35.0, 7.0}), 1e-4);
  // With a gear, currents and limits that go on from window to window.
  Job gear;
  gear.model = paper_axis();
  gear.recordings = {recorded_step(gear.model)};
  gear.free = {free_parameter("V_L", 2.7), free_parameter("B_a", 200.0),
               free_parameter("k_g", 5e6)};
  gear.options.horizon = 0.1;
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
  job.options.horizon = 1.0;
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

TEST(Windows, KeepToWhatIsKnown) {
  Job job = wandering_slide(0.0);
  EXPECT_TRUE(window_starts(job, 0).empty());
  job.options.horizon = 4.0;
  EXPECT_EQ(window_starts(job, 0).size(), 4u);
  job.recordings[0].initial_state = InitialState::given;
  EXPECT_FALSE(window_starts(job, 0)[0].position);
  EXPECT_TRUE(window_starts(job, 0)[1].position);
  EXPECT_EQ(window_states(job), 6u);
  job.options.horizon = 1e-4;  // ten samples at least
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
  job.options.horizon = 0.8;
  const FitResult windows = estimate(job);
  ASSERT_EQ(windows.status, Status::converged);
  std::cout << "farthest parameter, by a factor of: " << std::exp(farthest(whole)) << " whole, "
            << std::exp(farthest(windows)) << " in windows\n";
  EXPECT_LT(farthest(windows), 0.15);
  EXPECT_GT(farthest(whole), 1.0);
  // The simulation of the fit is that in windows.
  ASSERT_TRUE(windows.recordings[0].tracking);
  EXPECT_LT(*windows.recordings[0].signals[0].prediction_rmse,
            0.2 * windows.recordings[0].signals[0].rmse);
}

TEST(ChooseHorizon, IsShortWhereAForceWandersAndLongElsewhere) {
  const Job wandering = wandering_slide(3.0);
  const HorizonChoice choice = choose_horizon(wandering);
  EXPECT_EQ(choice.stretches, 4);
  EXPECT_NEAR(choice.longest, 4.0, 1e-9);
  const HorizonTrial& chosen = choice.trials[choice.chosen];
  EXPECT_TRUE(chosen.observer_gain > 0.0 || (chosen.horizon > 0.0 && chosen.horizon < 1.0));
  EXPECT_LT(chosen.error, 0.9 * choice.trials.back().error);

  const HorizonChoice other = choose_horizon(wandering_slide(0.0));
  std::cout << "one step ahead, error per that of the whole run: "
            << other.trials.front().error / other.trials.back().error << "\n";
  EXPECT_LT(other.trials.back().error, 1.05 * other.trials[other.chosen].error);
  EXPECT_GT(other.trials.front().error, 2.0 * other.trials.back().error);
}

TEST(ChooseHorizon, IsWhatFitsGoByThen) {
  FitOptions options;
  options.choose_horizon = true;
  set_criterion(options, {.observer_gain = 60.0});
  EXPECT_TRUE(options.choose_horizon);
  EXPECT_EQ(options.observer, ObserverMode::fixed);
  EXPECT_EQ(options.observer_gain, 60.0);
  set_criterion(options, {.horizon = 0.5});
  EXPECT_EQ(options.observer, ObserverMode::continuation);
  EXPECT_EQ(options.observer_gain, 0.0);
  EXPECT_EQ(options.horizon, 0.5);
}

}  // namespace
}  // namespace axisfit
