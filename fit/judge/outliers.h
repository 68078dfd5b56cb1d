// Outliers: isolated bad samples of a residual, spikes and dropouts of a sensor or its
// transmission.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "fit/judge/options.h"

namespace axisfit {

/// Which samples of a series stand alone: far from the median of their neighbours on either side,
/// by the scatter of the whole series and by that of the samples before and after, farther than
/// Gaussian noise, white or coloured, goes in all but a small part of series, however long. A burst
/// of a few in a row may be bad.
///
/// The residual of a wrong model is no outlier. In steps, slow errors and oscillations the
/// neighbours deviate, too, to the same side or the other; a sample is an outlier only where its
/// own neighbours stay within a part of its deviation. An event as short as a burst cannot be
/// distinguished from bad ones.
///
/// Values are finite and evenly spaced in time. The series has its own scale: nothing is found in
/// too few samples, nor among the first two and the last two, where a spike is not seen to
/// return, nor in a series that is constant but for single steps of a grid.
///
/// Literature: F. R. Hampel, Journal of the American Statistical Association 69 (1974) 383-393
/// (median and median absolute deviation); R. K. Pearson, Outliers in process modeling and
/// identification, IEEE Transactions on Control Systems Technology 10 (2002) 55-63 (moving over a
/// signal).
std::vector<std::size_t> outliers(std::span<const double> residuals,
                                  const OutlierOptions& options = {});

}  // namespace axisfit
