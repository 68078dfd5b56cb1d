// Residuals of one signal of one recording, and whether they are explained.
#pragma once

#include <algorithm>
#include <vector>

#include "base/autocovariance.h"
#include "fit/estimate/estimate.h"
#include "fit/judge/options.h"

namespace axisfit {

/// Which samples a series holds.
struct SeriesKey {
  std::size_t recording = 0;
  std::size_t measurement = 0;  ///< of the recording
  bool fitted = false;          ///< whether the fit minimised them

  bool operator==(const SeriesKey&) const = default;
};

/// The element of a list with this key, of a type derived from SeriesKey; null where there is none.
template <class List>
auto* find_series(List& list, const SeriesKey& key) {
  const auto at = std::ranges::find_if(list, [&](const SeriesKey& k) { return k == key; });
  return at == list.end() ? nullptr : &*at;
}

struct ResidualSeries : SeriesKey {
  NoiseSource noise = NoiseSource::given;  ///< fit: estimated from this series
  std::vector<std::size_t> samples;        ///< that count, in order
  std::vector<double> values;              ///< (measured - simulated) / sigma at those
  /// Samples of the noise per independent one: above one where the filter of the measurement made
  /// it so.
  double noise_time = 1.0;
  /// Mean square that readings add, beyond the noise, at whose instant an event passes: an
  /// acceleration jumps there, and no clock tells on which side it was read.
  double at_events = 0.0;
  /// Mean square that the uncertainty of the estimates adds, on average; zero where the series was
  /// fitted, and until allow_for_parameters() finds it.
  double allowance = 0.0;
  /// Mean square that noise of the input of the stated size adds, the largest of its draws.
  double input_noise = 0.0;
  /// Whether the size of that is given. One that was estimated excuses nothing.
  bool input_noise_given = false;
};

/// The residuals by which a fit is assessed: of the simulation as it was fitted, free-running or
/// with a fixed observer gain. Signals that are only compared are omitted, and so are recordings
/// whose simulation did not finish.
std::vector<ResidualSeries> residual_series(const Job& job, const FitResult& result);

/// Number of fitted samples.
double samples_of(const std::vector<ResidualSeries>& list);

/// Finds the allowances of all series that were not fitted: another motion may show more of what
/// the fit leaves open. Likewise finds what noise of their inputs adds, where it is given.
void allow_for_parameters(const Job& job, const FitResult& result,
                          std::vector<ResidualSeries>& list);

/// Whether a series shows no more than its noise: a mean square within 5 % of one, or within four
/// standard errors of that of white noise, the allowance four times, what events at readings add,
/// and noise of the input where its size is given. The colour of the residual does not widen these
/// limits, for what a model lacks is coloured, too; the colour that a filter of the measurement
/// gives its noise does. Where the noise was estimated from the series itself, its size carries no
/// information: the series is then explained if it is hardly more coloured than that.
bool is_explained(const ResidualSeries& series, const GradeOptions& options = {});

/// Whether every fitted series shows no more than its noise. What only those to validate lack shows
/// with the roles exchanged.
bool is_fitted_to_noise(const std::vector<ResidualSeries>& list);

}  // namespace axisfit
