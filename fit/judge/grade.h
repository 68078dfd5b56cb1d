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

/// A grade and what it rests on. It judges the free-running simulation of all recordings, those to
/// validate included: whoever uses a model simulates with it.
struct FitGrade {
  Grade grade = Grade::not_converged;
  enum class Reason {
    solver,         ///< FitResult::verdict tells why there is no minimum
    parameters,     ///< none is determined
    simulation,     ///< follows a signal too badly
    force,          ///< the missing force is too large a part of the drive's
    tracking_only,  ///< of a fit with a fixed observer gain: forces are right, simulations drift
    residual,       ///< is larger than the noise
    none,           ///< nothing speaks against the model
  };
  Reason reason = Reason::solver;
  std::size_t recording = 0;         ///< that is worst in this respect
  Signal signal = Signal::velocity;  ///< likewise; not of force
  /// Of simulation and tracking_only: 100 (1 - root mean square error of the free-running
  /// simulation / standard deviation of the signal), noise set aside in both; not a number where it
  /// does not finish. Of force: the missing force in per cent of the drive's. Of residual: part of
  /// the residual's root mean square beyond the noise.
  double percent = 0.0;

  bool is_usable() const { return grade <= Grade::usable; }
  bool operator==(const FitGrade&) const = default;
};

/// `diagnosis` is that of the fit; without one a fit is not called explained.
FitGrade grade_of(const Job& job, const FitResult& fit, const std::optional<Diagnosis>& diagnosis,
                  const GradeOptions& options = {});

}  // namespace axisfit
