// A closed form for a curve that was accepted because no named effect explains the residual.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fit/search/model_chain.h"

namespace axisfit {

/// A sum of few terms that a fitted curve is as well as its coefficients say.
struct ClosedForm {
  struct Term {
    double factor = 0.0, standard_error = 0.0;
    std::string unit;  ///< of the factor
    std::string form;  ///< of the variable: "exp(-(|v| / 0.02 m/s)^2)"; empty: 1
  };
  std::vector<Term> terms;
  double chi_square = 0.0;  ///< of the coefficients about it, their covariance as estimated
  double degrees_of_freedom = 0.0;
  std::size_t parameters = 0;  ///< factors, and what was chosen inside the terms
  /// The curve that is nearest to the terms, with what other effects hold of it.
  std::vector<double> coefficients{};
};

/// The best of the sums of up to three terms: powers, an exponential, a bell or a sine, as goes
/// with the variable. A constant, and over the velocity a line, count as nothing: other effects and
/// the declared parameters hold that part of a curve. Parameters are paid for by Schwarz's
/// criterion, those inside a term, too.
///
/// Nothing where the coefficients contradict every such sum (beyond the 99.9 % quantile of
/// chi-square), or are cheaper than it. Assumes that the fit is linear in the coefficients, as
/// far as they are uncertain, and their covariance is right.
std::optional<ClosedForm> closed_form(const Job& job, const FitResult& fit,
                                      const Hypothesis& curve);

/// Whether what is not fitted confirms the form as it did the curve: in the curve's place, all else
/// refitted, it lowers the validation error of the model without either by more than chance, and
/// explains the recordings not clearly worse than the curve.
bool is_confirmed(const ClosedForm& form, const Hypothesis& curve, const FittedModel& with_curve,
                  const FittedModel& without, const SearchContext& context = {});

}  // namespace axisfit
