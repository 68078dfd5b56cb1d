// What a rival promises in the place of an accepted hypothesis, without a refit.
//
// At the model with the accepted one, with r the residuals, J their Jacobian with respect to the
// other parameters, a the change that the accepted one makes and D the derivatives with respect to
// the rival's strengths, the best model with the rival instead has, to first order, the residuals
//
//   min | r - a + J x + D s | over x and s.
//
// What is left of a while nothing replaces it is what the accepted one explains. A linear step of
// that size is right to a part of it: a rival that leaves a large part is no equal.
#pragma once

#include <optional>
#include <vector>

#include "fit/search/model_chain.h"

namespace axisfit {

/// Rises of the sum of squares, in units of the residuals' mean square or of noise, if that is
/// more.
struct ExchangeScore {
  double with_rival = 0.0;
  double with_nothing = 0.0;  ///< in the place of what is taken out
};

/// Whether a rival leaves so much of what it would replace that no refit makes them equal.
bool is_out_of_reach(const ExchangeScore& score, const SearchOptions& options);

/// `others` is the job of the present model without what is taken out of its accepted ones. None
/// where one linear step says little: of another transmission, of delays, and where the effect is
/// absent at infinity.
std::optional<ExchangeScore> exchange_score(const FittedModel& present,
                                            const std::vector<Accepted>& accepted,
                                            const Job& others, const Scored& rival);

}  // namespace axisfit
