// A model extended by one effect and refitted.
#pragma once

#include <optional>
#include <vector>

#include "fit/search/acceptance.h"
#include "fit/search/replication.h"

namespace axisfit {

struct ExtendedModel {
  Candidate candidate;
  Job job;  ///< the candidate's parameters are its last
  FitResult fit;
  std::vector<ResidualSeries> residuals;
  double score = 0.0;                        ///< gain that the score test promised
  Improvement gain;                          ///< against the model before
  std::optional<Rejection> rejection;        ///< by the gate; none: it may stay
  std::optional<Replication> replication{};  ///< where it was asked for
  bool on_stretches = false;  ///< accepted by held-out stretches of the fitted recordings
};

/// Fits from close by, content with less than a final fit: one start, one continuation.
FitResult refit(const Job& job, const RunContext& context = {}, int max_iterations = 25);

/// The same from these values of the free parameters.
FitResult refit_from(Job job, const std::vector<double>& values, const RunContext& context = {});

/// Adds a candidate, started from these strengths and shapes, and refits.
ExtendedModel fit_extended_model(const Job& job, const Candidate& candidate,
                                 const std::vector<double>& values,
                                 const std::vector<double>& strengths,
                                 const std::vector<double>& shapes, const RunContext& context = {});

/// Goes on with a refit that ended for want of iterations.
void resume(ExtendedModel& e, const RunContext& context = {});

/// What a candidate's quantities are in a fitted model that has it.
struct CandidateValues {
  std::vector<double> strengths, shapes;
};
CandidateValues candidate_values(const Job& job, const FitResult& fit, const Candidate& candidate);

/// A free shape of a candidate that a fit has driven to its bound: there the effect is a simpler
/// one, as Dahl friction of no length is Coulomb friction.
std::optional<ParameterId> shape_at_bound(const Job& job, const FitResult& fit,
                                          const Candidate& candidate);

/// By how much a explains all recordings better than b, parameters counted, see bic_difference().
double bic_advantage(const ExtendedModel& a, const ExtendedModel& b);

}  // namespace axisfit
