// What the error of one estimate is made of, and what the parts come to together.
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
// squares. Scatter besides parts the sampling error, whose residual has the scatter in it, into
// what is inside groups and what differs between them:
//
//   one^2   = max(sampling, input noise)^2 + gain^2
//   all^2   = min(one^2, inside^2 + gain^2) + between^2     with scatter, otherwise one^2
//   total^2 = all^2 + rival^2
//
// An interval is Student's, for the degrees of freedom of the larger of the first two, or with
// scatter for those of the sum (F. E. Satterthwaite, Biometrics Bulletin 2, 1946); a gain and a
// rival widen it in proportion. That a model is wrong is no error: it is a judgement of the fit,
// after which no error means anything.
#pragma once

#include <limits>
#include <optional>
#include <string>

#include "fit/data/job.h"
#include "fit/errors/error_options.h"
#include "fit/errors/parameter_uncertainty.h"

namespace axisfit {

/// Of noise in the readings, as the residual shows it. All lengths are in the quantity's unit.
struct SamplingError {
  bool at_bound = false;  ///< the error is that which it would have if there were no bound
  /// Not finite where the recordings leave the parameter open.
  double standard_error = std::numeric_limits<double>::infinity();
  double inflation = 1.0;  ///< see ParameterUncertainty
  double degrees_of_freedom = 1.0;
  double step = 0.0;  ///< at a bound: to where the minimum would be if there were none
};

/// Of white noise of the stated sizes in readings and inputs.
struct InputNoiseError {
  double standard_error = 0.0;
  double degrees_of_freedom = 1.0;  ///< draws of the noise
};

/// What an estimate is at another observer gain. The move is a standard error.
struct GainShift {
  double observer_gain = 0.0;  ///< 1/s
  double value = 0.0;
};

/// Of a parameter that differs between groups, which are recordings or stretches of one.
struct ScatterError {
  double inside = 0.0;              ///< standard error by what groups leave of themselves
  double between = 0.0;             ///< standard error by what differs between them
  double degrees_of_freedom = 1.0;  ///< of the latter: groups that tell it, but one
};

/// What an estimate is with a rival in the place of an effect: another that explains the recordings
/// as well. The move is a standard error.
struct RivalShift {
  std::string chosen, rival;
  double value = 0.0;
};

/// Of one parameter. What is unset adds nothing.
struct ErrorBudget {
  SamplingError sampling;
  std::optional<InputNoiseError> input_noise{};
  std::optional<GainShift> gain{};
  std::optional<ScatterError> scatter{};
  std::optional<RivalShift> rival{};
};

/// The rest, which is the budget of predictions: what explains the recordings equally well predicts
/// alike.
ErrorBudget without_rival(ErrorBudget budget);

/// What the parts come to for an estimate `value`. Intervals are on the parameter's scale, within
/// its bounds. An estimate that noise alone leaves open has no standard error, whatever else is in
/// its budget, and one at a bound has a one-sided interval, where the likelihood ratio is not
/// significant with all others free.
ParameterUncertainty combined(const ErrorBudget& budget, double value, const FreeParameter& free,
                              const ErrorOptions& options = {});

/// The standard error of a determined estimate for one group: of all but what differs between
/// groups, and but rivals.
double error_within_groups(const ErrorBudget& budget, double value);

/// The factor of a standard error that makes half of a 95 % interval, for so many degrees of
/// freedom (at least one is assumed): Student's quantile.
double student_95(double degrees_of_freedom);

}  // namespace axisfit
