// Outliers: isolated bad samples of a residual, spikes and dropouts of a sensor or its
// transmission.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace axisfit {

/// Which samples of a series stand alone: far from the median of their ten neighbours on either
/// side, by the scatter of the whole series and by that of the fifty samples before and after,
/// farther than Gaussian noise, white or coloured, goes in 99 % of all series, however long. Up to
/// three in a row may be bad.
///
/// The residual of a wrong model is no outlier. In steps, slow errors and oscillations the
/// neighbours deviate, too, to the same side or the other; a sample is an outlier only where its
/// own neighbours stay within a third of its deviation. An event shorter than three samples cannot
/// be distinguished from bad ones.
///
/// Values are finite and evenly spaced in time. The series has its own scale: nothing is found in
/// fewer than 30 samples, nor among the first two and the last two, where a spike is not seen to
/// return, nor in a series that is constant but for single steps of a grid.
///
/// Literature: F. R. Hampel, Journal of the American Statistical Association 69 (1974) 383-393
/// (median and median absolute deviation); R. K. Pearson, Outliers in process modeling and
/// identification, IEEE Transactions on Control Systems Technology 10 (2002) 55-63 (moving over a
/// signal).
std::vector<std::size_t> outliers(std::span<const double> residuals);

}  // namespace axisfit
