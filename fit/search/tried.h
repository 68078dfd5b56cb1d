// A hypothesis that was added to a model, refitted, and put to the acceptance test.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "fit/search/acceptance.h"
#include "fit/search/replication.h"
#include "fit/search/scored.h"

namespace axisfit {

struct Tried {
  Hypothesis hypothesis;
  Job job;  ///< the parameters of the hypothesis are its last
  FitResult fit;
  std::vector<ResidualSeries> residuals;
  double score = 0.0;                        ///< gain that the score test promised
  Improvement gain;                          ///< against the model before
  std::optional<Rejection> rejection;        ///< by the acceptance test; none: it may stay
  std::optional<Replication> replication{};  ///< where it was asked for
  bool on_blocks = false;   ///< accepted by held-out blocks of the fitted recordings
  bool is_outdone = false;  ///< given up, since it did not come near another one that passes
};

/// Fits from close by, content with less than a final fit: one start, one continuation.
FitResult refit(const Job& job, const SearchContext& context, int max_iterations);
FitResult refit(const Job& job, const SearchContext& context = {});

/// The same from these values of the free parameters.
FitResult refit_from(Job job, const std::vector<double>& values, const SearchContext& context = {});

/// Fits with the full accuracy from close by, at once.
FitResult polished_fit(Job job, const std::vector<double>& values,
                       const SearchContext& context = {});

/// The same, and where that leaves more than noise, by a continuation.
FitResult final_fit(Job job, const std::vector<double>& values, const SearchContext& context = {});

/// What a refit with a hypothesis begins with, and has to reach.
struct Try {
  /// Given up where it would not come below this reduced cost (stage.h).
  double give_up_above = std::numeric_limits<double>::infinity();
  /// The fit without the hypothesis: what has no shapes to estimate and ends above it is tried
  /// again from a part of the way.
  const FitResult* before = nullptr;
  /// Whether that is close to the recordings: the simulation need not track them first.
  bool is_nearby = false;
};

/// Adds a hypothesis, started where its score puts it, and refits.
Tried try_hypothesis(const Job& job, const Scored& start, const SearchContext& context = {},
                     const Try& how = {});

/// A reduced cost at which a model with no more than that many parameters fewer is clearly worse
/// than the one of this fit, whose residuals are given, and twice as much: the units are those of
/// other residuals.
double worthless_cost(const FitResult& fit, const std::vector<ResidualSeries>& residuals,
                      std::size_t parameters, const SearchOptions& options);

/// Goes on with a refit that ended for want of iterations.
void resume(Tried& tried, const SearchContext& context = {});

/// Puts a refit, chosen as strictly as that, to the acceptance test: against these residuals.
void judge(Tried& tried, const std::vector<ResidualSeries>& before, const Strictness& strictness,
           const SearchOptions& options = {});

/// The missing force in per cent of the drive's (missing_force.h), of every recording that
/// validates, or where none does of all; not a number where it is not known.
std::vector<double> missing_percents(const Job& job, const FitResult& fit);

/// Whether it is raised in any of them by more than a model's own imperfection.
std::optional<Rejection> rejection_by_force(const std::vector<double>& before,
                                            const std::vector<double>& after,
                                            const SearchOptions::Acceptance& limits);

/// Why one is refused whose free run does not finish where that of the model before did, of a
/// recording to validate, too. None where it does.
std::optional<Rejection> rejection_by_free_run(const FitResult& before, const FitResult& after);

/// Why one is refused beside which a parameter of the model is not known any more: its standard
/// error is a hundred times what it was before, so that the two stand for the same. None where
/// there is no such parameter.
std::optional<Rejection> rejection_as_indistinct(const FitResult& before, const FitResult& after);

/// What its quantities are.
HypothesisValues values_in(const Tried& tried);

/// How many periods of an effect with a phase pass along the motion of a fitted recording, at most.
double periods_passed(const Job& job, const FitResult& fit, const Hypothesis& hypothesis);

/// Where a fit has driven a free shape of a hypothesis to its bound, or far beyond what was tried
/// of it, which is what the recordings span: there the effect is a simpler one. Dahl friction of no
/// length is Coulomb friction, and so is Stribeck's with a speed that the axis never reaches. None
/// where no shape is there.
std::optional<Rejection> rejection_as_simpler(const Job& job, const FitResult& fit,
                                              const Hypothesis& hypothesis,
                                              const SearchOptions& options = {});

/// By how much a explains all recordings better than b, parameters counted, see bic_difference().
double bic_advantage(const Tried& a, const Tried& b);

}  // namespace axisfit
