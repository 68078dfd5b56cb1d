// The grade of a fit: how far it can be relied on.
#pragma once

#include <optional>

#include "fit/judge/diagnosis.h"

namespace axisfit {

/// Best first.
enum class Grade {
  explained,           ///< every signal of every recording shows no more than its noise
  usable,              ///< the simulation follows the recordings, but something is missing
  model_wrong,         ///< a minimum was found, of a model that does not describe the machine
  nothing_determined,  ///< a minimum was found, but the recordings say nothing of any parameter
  not_converged,       ///< no minimum was found, or nothing could be simulated
};

/// What a model is good for, by the recordings to validate, or by all where none are.
struct FitUses {
  /// Forces, as feed-forward and diagnosis need them: the missing force in per cent of the drive's,
  /// of the recording where it is largest. None where
  /// their noise would hide it, or nothing tells the force.
  std::optional<double> missing_force_percent{};
  std::size_t force_recording = 0;
  /// Tracking, as a controller or an observer does it: s for which a free run stays within a
  /// hundredth of the range of every signal, of the recording where that is the shortest, and
  /// whether it does so to the end. None where nothing was recorded that moves.
  std::optional<double> followed_for{};
  bool is_followed_to_the_end = false;

  bool operator==(const FitUses&) const = default;
};

FitUses uses_of(const Job& job, const FitResult& fit, const std::optional<Diagnosis>& diagnosis,
                const GradeOptions& options = {});

/// A grade and what it rests on: the best use that the recordings can judge. A free run of all
/// recordings, those to validate included, or the forces alone where that drifts.
struct FitGrade {
  Grade grade = Grade::not_converged;
  enum class Reason {
    solver,         ///< FitResult::verdict tells why there is no minimum
    parameters,     ///< none is determined
    standstill,     ///< no fitted signal changes by more than its noise
    simulation,     ///< follows a signal too badly
    force,          ///< the missing force is too large a part of the drive's
    drift,          ///< the forces are right, but a free run drifts
    residual,       ///< is larger than the noise
    contradiction,  ///< a recorded rate is not the derivative of the other signal
    stopped,        ///< the residual is no more than noise, but the errors were not found in time
    none,           ///< nothing speaks against the model
  };
  Reason reason = Reason::solver;
  std::size_t recording = 0;         ///< that is worst in this respect
  Signal signal = Signal::velocity;  ///< likewise; not of force
  /// Of simulation and drift: 100 (1 - root mean square error of the free-running
  /// simulation / standard deviation of the signal), noise set aside in both; not a number where it
  /// does not finish. Of force: the missing force in per cent of the drive's. Of residual: part of
  /// the residual's root mean square beyond the noise.
  double percent = 0.0;

  FitUses uses{};

  bool is_usable() const { return grade <= Grade::usable; }
  bool operator==(const FitGrade&) const = default;
};

/// `diagnosis` is that of the fit; without one a fit is not called explained.
FitGrade grade_of(const Job& job, const FitResult& fit, const std::optional<Diagnosis>& diagnosis,
                  const GradeOptions& options = {});

}  // namespace axisfit
