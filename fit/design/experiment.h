// The next experiment: the motion that is expected to improve the least determined parameter most.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fit/estimate/estimate.h"
#include "sim/controller_settings.h"
#include "sim/motion.h"

namespace axisfit {

/// The job's limits, completed: all of them are given.
MachineLimits complete_limits(const Job& job, const FitResult& fit);

/// Whether a place (m) and a speed (m/s) of the arm are within complete limits.
bool is_within(const MachineLimits& limits, double position, double velocity);

/// A motion from standstill, and its duration.
struct Experiment {
  Motion motion;
  double duration = 0.0;  ///< s
};

/// Steps, levels, sines, chirps, pseudo-random sequences, each at several amplitudes up to the
/// largest command and either way, where nothing else commands the axis, and moves up to the travel
/// and the speed where it has a set-velocity input or a controller. Limits are complete; only the
/// simulation of a motion shows whether it stays within them.
std::vector<Experiment> candidate_motions(const Structure& structure, const MachineLimits& limits,
                                          double duration);

/// The commands of an experiment over the times (s) from zero; those of a move as the controller
/// writes them to the axis.
Schedule commands_of(const Experiment& experiment, const Model<double>& model,
                     std::span<const double> times);

/// The sampling times (s) of one more recording: those of the first one that is fitted, from zero
/// and for at most 10 s.
std::vector<double> next_sampling_times(const Job& job);

/// How far an arm goes in a motion, and how fast, either way.
struct Reach {
  double lowest = 0.0, highest = 0.0;  ///< m
  double speed = 0.0;                  ///< m/s
};

/// The first parameter at a bound other than the end of its quantity's range, such as zero
/// friction: its true value may lie beyond, and no simulation shows what the machine would do.
std::optional<std::size_t> held_by_bound(const Job& job, const FitResult& fit);

/// The reach for all values of the parameters that the fit allows: the estimates, and 32 corners of
/// their 95 % intervals, which are all of up to five parameters and otherwise drawn with a seed. A
/// parameter without an interval goes to its bounds: what is not known must not wreck a machine.
/// Samples as next_sampling_times(). None where a simulation does not finish or leaves the limits,
/// which are complete.
std::optional<Reach> reach_of(const Experiment& experiment, const Job& job, const FitResult& fit,
                              const MachineLimits& limits);

struct Suggestion {
  Experiment experiment;
  Reach reach;
  std::size_t parameter = 0;  ///< the one whose interval is the widest now
  Uncertainty predicted;      ///< after one more recording, of that motion
  MachineLimits limits;       ///< as they were taken, all given
  int tried = 0;              ///< motions of the family
  int feasible = 0;           ///< those that kept to the limits at the estimates
};

/// The motion, of all that keep to the limits (see reach_of()), after which the least determined
/// parameter is determined best: the largest standard error, relative to the parameter's size, is
/// smallest (E. Walter and L. Pronzato, Identification of Parametric Models, Springer 1997, chapter
/// 6). Assumes that the new recording has the signals, the sampling and the noise of the first one
/// that was fitted, starts where that started, from rest, and leaves residuals of the size and
/// colour that the fit has left; that the estimates are right; and that the model is linear over
/// their errors. None when the fit is not usable, a parameter is at a bound, see held_by_bound(),
/// or no motion keeps to the limits.
std::optional<Suggestion> suggest_experiment(const Job& job, const FitResult& fit,
                                             const RunContext& context = {});

}  // namespace axisfit
