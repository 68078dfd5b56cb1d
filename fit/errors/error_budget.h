// The parts of the error of one estimate, and how they combine.
//
//   part         from                                  assumes
//   sampling     Jacobian and residual of the fit      residuals stationary, model linear over the
//                (uncertainty.h)                       interval and correct
//   input noise  stated noise of readings and inputs   sizes as stated, white
//                (uncertainty.h)
//   gain         fits at other observer gains          the move is independent of the rest
//                (gain_error.h)
//   scatter      recordings or stretches one by one    a normal distribution from group to group
//                (scatter.h)
//   rival        fits with another effect              the move is independent of the rest
//                (rival_error.h)
//
// Input noise is a floor: the larger of the first two counts. The others are independent and add in
// squares. The residual behind the sampling error has the scatter in it. With scatter, that error
// is therefore split into a part inside groups and a part between them:
//
//   one^2   = max(sampling, input noise)^2 + gain^2
//   all^2   = min(one^2, inside^2 + gain^2) + between^2     with scatter, otherwise one^2
//   total^2 = all^2 + rival^2
//
// An interval is Student's, for the degrees of freedom of the larger of the first two, or with
// scatter for those of the sum (F. E. Satterthwaite, Biometrics Bulletin 2, 1946); a gain and a
// rival widen it in proportion. A wrong model is no part of the budget: it is a judgement of the
// fit, after which no error means anything.
#pragma once

#include <limits>
#include <optional>
#include <string>

#include "fit/data/job.h"
#include "fit/errors/error_options.h"
#include "fit/errors/parameter_uncertainty.h"

namespace axisfit {

/// The error by noise in the readings, as the residual shows it. All lengths are in the quantity's
/// unit.
struct SamplingError {
  bool at_bound = false;  ///< the error is then the one without the bound
  /// Not finite where the recordings leave the parameter open.
  double standard_error = std::numeric_limits<double>::infinity();
  double inflation = 1.0;  ///< see ParameterUncertainty
  double degrees_of_freedom = 1.0;
  double step = 0.0;  ///< at a bound: from there to the minimum without bounds
};

/// The error by white noise of the stated sizes in readings and inputs.
struct InputNoiseError {
  double standard_error = 0.0;
  double degrees_of_freedom = 1.0;  ///< draws of the noise
};

/// The estimate at another observer gain. Its move counts as a standard error.
struct GainShift {
  double observer_gain = 0.0;  ///< 1/s
  double value = 0.0;
};

/// The error of a parameter that differs between groups: recordings, or stretches of one.
struct ScatterError {
  double inside = 0.0;              ///< standard error by the residual of each group alone
  double between = 0.0;             ///< standard error by the differences between groups
  double degrees_of_freedom = 1.0;  ///< of the latter: groups that determine it, less one
};

/// The estimate with a rival in the place of an effect: another that explains the recordings as
/// well. Its move counts as a standard error.
struct RivalShift {
  std::string chosen, rival;
  double value = 0.0;
};

/// The budget of one parameter. A part that is unset adds nothing.
struct ErrorBudget {
  SamplingError sampling;
  std::optional<InputNoiseError> input_noise{};
  std::optional<GainShift> gain{};
  std::optional<ScatterError> scatter{};
  std::optional<RivalShift> rival{};
};

/// The budget without its rival, as for predictions: models that explain the recordings equally
/// well predict alike.
ErrorBudget without_rival(ErrorBudget budget);

/// The combined uncertainty of an estimate `value`. Intervals are on the parameter's scale, within
/// its bounds. An estimate is determined if the total is small enough: what moves to another order
/// of magnitude at another gain is as open as what noise leaves open, and neither has a standard
/// error. One at a bound has a one-sided interval, where the likelihood ratio is not significant
/// with all others free.
ParameterUncertainty combined(const ErrorBudget& budget, double value, const FreeParameter& free,
                              const ErrorOptions& options = {});

/// The standard error of a determined estimate for one group: all parts but scatter between groups,
/// and rivals.
double error_within_groups(const ErrorBudget& budget, double value);

/// Half of a 95 % interval over the standard error, for so many degrees of freedom (at least one is
/// assumed): Student's quantile.
double student_95(double degrees_of_freedom);

}  // namespace axisfit
