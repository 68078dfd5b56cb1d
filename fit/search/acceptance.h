// Whether an effect that was added to a model may stay.
#pragma once

#include <optional>
#include <vector>

#include "fit/judge/series.h"
#include "fit/search/hypothesis.h"
#include "fit/search/options.h"

namespace axisfit {

/// What an extended model does to the errors of a simpler one. Sums of squares are in units of the
/// information of one independent sample: divided by the variance of the extended model's residual
/// along the change that the extension makes, series by series; see variance_along().
struct Improvement {
  bool comparable = false;  ///< false: the extended model could not be simulated everywhere
  double fit_gain = 0.0;    ///< fall of the sum of squares of what was fitted
  double samples = 0.0;     ///< effective number of independent samples that were fitted
  /// Fall of the sum of squares of what was not fitted, by its standard deviation if the effect
  /// were chance, and the probability of that or more.
  double z = 0.0;
  double p_value = 1.0;
  /// What z would be on average if the effect were as the fit found it: small where the motion that
  /// was not fitted hardly shows it.
  double expected_z = 0.0;
  double validate_percent = 0.0;  ///< fall of the root mean square of what was not fitted
  /// The same of its part beyond the noise of the stated size, which is all that a model can take
  /// away.
  double missing_percent = 0.0;
};

Improvement improvement(const std::vector<ResidualSeries>& before,
                        const std::vector<ResidualSeries>& after);

/// How much worse `other` explains all recordings than `best`, in the same units, each parameter
/// beyond those of `best` at the price of Schwarz's criterion, log of the number of samples.
/// Negative when `other` is better after all.
double bic_difference(const std::vector<ResidualSeries>& best, std::size_t best_parameters,
                      const std::vector<ResidualSeries>& other, std::size_t other_parameters);

/// About what bic_difference() is to the model of these residuals, of another with so many
/// parameters more that leaves nothing but noise. Minus infinity where the size of the noise is not
/// known.
double least_bic_difference(const std::vector<ResidualSeries>& best, double more_parameters);

/// The least difference of that which is ground for a preference.
double clear_difference(const SearchOptions& options = {});
/// Whether this one is.
bool is_clearly_worse(double bic_difference, const SearchOptions& options = {});

/// What the fit says of a hypothesis's own parameters, which are free in the job.
struct Determination {
  /// Sum of squares that would be lost with strengths of zero, in units as above: the square of
  /// value over standard error where there is one strength.
  double wald = 0.0;
  double required = 0.0;  ///< the least that counts as determined
  double distinct = 0.0;  ///< part of the strengths' effect that no other parameter can imitate
  std::optional<ParameterId> at_bound;      ///< a parameter held by a bound
  std::optional<ParameterId> undetermined;  ///< a shape that the data leave open
};

Determination determination(const Job& job, const FitResult& result, const Hypothesis& hypothesis,
                            const std::vector<ResidualSeries>& residuals,
                            const SearchOptions& options = {});

/// Whether an accepted effect is needed beside those that were accepted later. `gain` is what it
/// does to the model without it: more to the fit than the price of its parameters by Schwarz's
/// criterion, and more than chance to what was not fitted.
/// With `replicates` only the former counts, see replication.h.
bool is_needed(const Improvement& gain, std::size_t parameters, bool replicates,
               const SearchOptions& options = {});

/// A test that a hypothesis failed.
struct Rejection {
  enum class Test {
    fit,              ///< there is no usable fit with it
    simulation,       ///< with it the simulation does not finish for all recordings
    significance,     ///< the best of many by chance lowers the sum of squares as much
    validation,       ///< it does not lower the validation error
    power,            ///< nor could it: what was not fitted hardly shows it
    validation_size,  ///< it hardly does
    bound,            ///< a parameter of it is held by a bound
    span,             ///< a shape of it is beyond what the recordings span: it is a simpler effect
    shape,            ///< the data leave a shape of it open
    distinct,         ///< other parameters can imitate it
    strength,         ///< the data leave its strength open
    share,            ///< it lowers the validation error too little where most remains unexplained
    misfit,           ///< the declared model does not fit, with it or without
    force,            ///< it raises the missing force of a recording that validates
    period,           ///< the recordings to validate, fitted by themselves, show another period
  };
  Test test = Test::fit;
  /// By test, significance: the fall of the sum of squares; validation and power: the p-value;
  /// validation_size: the fall of the validation error, %; share: that beyond the noise; strength:
  /// the standard errors from zero; period: that which they show; span: the shape; force: the
  /// missing force, % of the drive's.
  double found = 0.0;
  /// Of significance: the least fall of the sum of squares; of force: the missing force without it.
  double required = 0.0;
  std::size_t tried = 0;  ///< of significance: hypotheses and settings among which it was chosen
  std::optional<ParameterId> parameter{};  ///< of bound, span and shape

  bool operator==(const Rejection&) const = default;
};

/// The fall of the sum of squares that a hypothesis must bring: the price of its parameters by
/// Schwarz's criterion, and that of having been chosen among so many.
double least_gain(const Hypothesis& hypothesis, double samples, std::size_t tried);

/// Where the sum of squares falls by less.
std::optional<Rejection> rejection_as_chance(const Hypothesis& hypothesis, const Improvement& gain,
                                             std::size_t tried);

/// How strict the acceptance test is.
struct Strictness {
  std::size_t tried = 1;  ///< hypotheses and settings among which one was chosen
  double chance = 1e-3;   ///< how probable it may be that it lowers the validation error by chance
  bool replicates = false;  ///< other recordings tell the same: nothing is asked of that error
};

/// The first test that the hypothesis fails; none when it may stay.
std::optional<Rejection> rejection_of(const Hypothesis& hypothesis, const Improvement& gain,
                                      const Determination& determined, const Strictness& strictness,
                                      const SearchOptions& options = {});

}  // namespace axisfit
