// The whitened residuals of one recording, and their exact Jacobian, as a cost of Ceres Solver.
#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "base/interrupt.h"
#include "fit/criterion/windows.h"
#include "fit/data/simulated_recording.h"
#include "fit/solve/parameters.h"
#include "sim/recorder.h"
#include "sim/simulate.h"

namespace axisfit {

/// Simulates a recording with the parameters at u.
SimulatedRecording simulate_recording(const Job& job, const ParameterSpace& space,
                                      std::size_t recording, const double* u,
                                      const Observer& observer);

/// The same for a given model, with the job's options.
SimulatedRecording simulate_recording(const Job& job, const Recording& recording,
                                      const Model<double>& model, const Observer& observer);

/// The free run that a fit compares with the recording: from the initial state that suits it best,
/// where the fit estimates that, see window_starts().
SimulatedRecording simulate_freely(const Job& job, const ParameterSpace& space,
                                   std::size_t recording, const double* u);

/// Without an observer, in the windows of the job's criterion. They begin with the states
/// that suit the recording best: all of it, or this share at the beginning of each window, at least
/// 20 samples. None where it has no windows.
std::optional<SimulatedRecording> simulate_in_windows(const Job& job, const ParameterSpace& space,
                                                      std::size_t recording, const double* u,
                                                      double share = 1.0);

/// The axis at one instant of a simulation.
struct AxisInstant {
  Mode mode;
  State<double> state;
  Input<double> input;
  bool is_moved = false;  ///< whether a window begins here, with a state of its own
};

/// Small accelerations at the instants of a simulation: instants by columns, each column one of
/// them. As in Disturbance, m/s^2 and rad/s^2.
struct Disturbances {
  Eigen::MatrixXd arm, motor;
  Eigen::MatrixXd arm_mean{};  ///< of the arm's since the instant before; empty: of the two
};

/// Residuals (measured - simulated) / sigma of all fitted measurements of a recording, measurement
/// by measurement, without the samples that are left out. One parameter block: the whole vector u
/// of the space.
///
/// Without an observer the simulation runs free in the windows of the job's criterion. Their states
/// are then those that suit the recording best at u, and the columns of the Jacobian lack what
/// these could make, see windows.h: the gradient of the sum of squares is exact.
///
/// A point whose simulation does not finish makes Evaluate return false: for the solver a rejected
/// step. With a Huber loss every residual r is replaced by sign(r) sqrt(rho(r^2)), so that the sum
/// of squares is the robust cost.
class RecordingCost : public ceres::CostFunction {
 public:
  /// Job and space must outlive the cost, and stay as they are. When `stop` is set no point
  /// finishes any more.
  RecordingCost(const Job& job, const ParameterSpace& space, std::size_t recording,
                const Observer& observer, const StopFlag* stop = nullptr);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

  /// The axis at all instants at which its simulation is read, the first of them the first sample;
  /// none where it does not finish.
  std::vector<AxisInstant> trajectory(const double* u) const;

  /// The states with which the windows begin at u.
  std::vector<WindowStart> starts(const double* u) const;

  /// The derivatives of the residuals with respect to disturbances at those instants, residuals by
  /// columns. Exact but for the course of a disturbance between two instants, and much cheaper than
  /// effects that make such forces. Empty where the simulation does not finish.
  Eigen::MatrixXd disturbance_response(const double* u, const Disturbances& disturbances) const;

 private:
  /// Where derivatives go: that of the k-th dual part to column columns[k] of a row-major matrix.
  struct Derivatives {
    double* data = nullptr;
    std::size_t stride = 0;
    std::span<const std::size_t> columns;
  };
  /// Residuals and Jacobian where they are not null.
  template <class T>
  bool evaluate(const double* u, std::span<const WindowStart> starts, double* residuals,
                double* jacobian, std::span<const std::size_t> columns) const;
  /// The states of the windows that suit the recording best; none where no simulation finishes.
  std::optional<WindowStates> window_states(const double* u) const;
  /// From what the recorder was shown; residuals may be null.
  template <class T>
  bool compare(Recorder<T>& recorder, double* residuals, const Derivatives& derivatives) const;
  struct Transitions;
  template <class T>
  std::optional<Transitions> transitions(const Model<double>& model,
                                         std::span<const WindowStart> starts) const;
  bool is_controlled() const {
    return job_.recordings[recording_].command.meaning == Meaning::reference;
  }

  const Job& job_;
  const ParameterSpace& space_;
  std::size_t recording_;
  Observer observer_;
  const StopFlag* stop_;
  std::vector<std::size_t> fitted_;      // indices of measurements
  std::vector<Signal> signals_;          // their signals
  std::vector<std::size_t> applicable_;  // indices of parameters
  std::vector<WindowStart> windows_;     // none: it runs through
  std::vector<std::size_t> window_of_;   // of each residual
};

}  // namespace axisfit
