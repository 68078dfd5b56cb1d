// The fit of a job again, at observer gains beside its own: what gain_error.h needs.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "fit/errors/error_options.h"
#include "fit/estimate/estimate.h"

namespace axisfit {

/// Fits a job of fixed observer gain again at a third and at three times that gain, from the fit's
/// values: returns those that are usable; none for other jobs, or for a fit that is not usable.
std::vector<FitResult> fits_at_other_gains(const Job& job, const FitResult& fit,
                                           const RunContext& context = {},
                                           const ErrorOptions& options = {});

/// The same, with the moves that they show entered in the fit's budgets (gain_error.h).
std::vector<FitResult> add_gain_errors(const Job& job, FitResult& fit,
                                       const RunContext& context = {},
                                       const ErrorOptions& options = {});

/// The moves to first order: by one step of least squares at each of these gains, where there is no
/// time for fits. Costs two residuals with their Jacobians.
void add_linear_gain_errors(const Job& job, FitResult& fit, const ErrorOptions& options = {});

/// The gain of the other fit whose estimates predict the recordings to validate best, simulated
/// freely; none where none does clearly better than the fit.
std::optional<double> better_gain(const Job& job, const FitResult& fit,
                                  std::span<const FitResult> others,
                                  const ErrorOptions& options = {});

}  // namespace axisfit
