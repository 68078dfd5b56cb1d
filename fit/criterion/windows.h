// Multiple shooting: a simulation that runs free in windows of a recording, each from a state of
// its own.
//
// A free run integrates what the model lacks, and over a long recording that error decides the
// parameters; a simulation that tracks forgets it within milliseconds. Windows are between the two:
// they choose the horizon over which the model is to predict. The arm's position and velocity where
// a window begins are eliminated: found for every point of the parameters, with their columns taken
// out of the Jacobian (variable projection; G. H. Golub and V. Pereyra, SIAM J. Numer. Anal. 10
// (1973), in the form of L. Kaufman, BIT 15 (1975), whose gradient is exact). All other states go
// on from window to window. H. G. Bock (1981) has the method for differential equations.
//
// A free run whose initial state is unknown is one such window: the samples at its start tell the
// state only roughly, and what they err by adds up.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "fit/data/job.h"
#include "fit/data/partition.h"
#include "sim/recorder.h"

namespace axisfit {

/// Where a window begins, and with which state of the arm; none: the state in which it arrives.
struct WindowStart {
  std::size_t sample = 0;
  std::optional<double> position{}, velocity{};               ///< m, m/s
  double position_deviation = 1.0, velocity_deviation = 1.0;  ///< within which they are sought
};

/// The windows of a recording, close to a length (s), and of ten samples at least.
Partition windows_of(const Recording& recording, double length);

/// The windows of a recording by the job's criterion, with states from the samples around each
/// start, unset where not recorded. None where the simulation runs through from a known state: by
/// another criterion, under a controller (whose loop forgets by itself), and where neither position
/// nor velocity was recorded.
std::vector<WindowStart> window_starts(const Job& job, std::size_t recording);

/// How many states of windows a fit of the job estimates besides its parameters.
std::size_t window_states(const Job& job);

/// Moves a simulated arm at the starts of windows. With `seeded` the first two dual parts are those
/// of the latest window's position and velocity.
template <class T>
class WindowRestarts {
 public:
  /// Starts and recorder must outlive it.
  WindowRestarts(std::span<const WindowStart> starts, const Recorder<T>& recorder,
                 bool seeded = false)
      : starts_(starts), recorder_(recorder), seeded_(seeded) {}

  /// To be called at every instant of the recorder, in turn, before the axis is read.
  void at(std::size_t instant, Integrator<T>& axis) {
    if (next_ == starts_.size() || recorder_.instant_of(starts_[next_].sample) != instant) return;
    const WindowStart& start = starts_[next_++];
    if (!start.position && !start.velocity) return;
    const T position = started(start.position, axis.state()[0], 0);
    axis.move_arm(position, started(start.velocity, axis.state()[1], 1));
  }

 private:
  T started(const std::optional<double>& value, const T& arrived, int part) const {
    if (!value) return arrived;
    T started(*value);
    if constexpr (!std::is_same_v<T, double>)
      if (seeded_) started.v[part] = 1.0;
    return started;
  }

  std::span<const WindowStart> starts_;
  const Recorder<T>& recorder_;
  bool seeded_;
  std::size_t next_ = 0;
};

/// Residuals of a recording as functions of the states with which its windows begin.
class WindowStates {
 public:
  static constexpr Eigen::Index kStates = 2;  ///< of a window: position, velocity
  using Columns = Eigen::Matrix<double, Eigen::Dynamic, kStates, Eigen::RowMajor>;

  /// From these states; `window_of` says to which of the windows a residual belongs.
  WindowStates(std::vector<WindowStart> starts, std::vector<std::size_t> window_of);

  const std::vector<WindowStart>& starts() const { return starts_; }

  /// Goes on with residuals and their derivatives at starts(): to better states, or, where a
  /// window's last step made it worse, back by half of it. False: nothing more can be gained, and
  /// starts() are the best states.
  bool improve(const Eigen::VectorXd& residuals, const Columns& derivatives);

  /// Takes out of columns, one row per residual, the part that changes of the states can make.
  void eliminate_from(
      Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> columns)
      const;

 private:
  struct Window {
    Eigen::Vector2d nominal, best, step;
    Eigen::Vector2d weight;  ///< of the distance from the nominal state
    double cost = 0.0;       ///< of the best
    double promise = 0.0;    ///< about how much less it is behind the step
  };
  void set_start(std::size_t window, const Eigen::Vector2d& state);

  std::vector<WindowStart> starts_;
  std::vector<std::size_t> window_of_;
  std::vector<Window> windows_;
  Columns derivatives_;  ///< at the best states
  int passes_ = 0;
};

}  // namespace axisfit
