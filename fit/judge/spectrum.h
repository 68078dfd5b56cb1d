// Autocorrelation and spectra of a residual: over lag, frequency, and the wave number along the
// stroke.
#pragma once

#include <span>
#include <vector>

namespace axisfit {

/// Autocorrelation of values about zero at the lags 0 to `lags`, of which there must be fewer than
/// values; one at lag zero. That of white noise lies within 1.96 / sqrt(values) in 95 of 100 lags.
std::vector<double> autocorrelation(std::span<const double> values, std::size_t lags);

struct Spectrum {
  std::vector<double> wave;  ///< 1/s or 1/m, increasing, without zero
  std::vector<double> size;
};

/// Power over frequency (Hz) of values that are `interval` s apart: one everywhere for white noise
/// of unit variance. Means over half overlapping segments under a Hann window, some eight of them.
/// Empty below 32 values.
///
/// Literature: P. D. Welch, IEEE Transactions on Audio and Electroacoustics 15 (1967) 70-73.
Spectrum power_spectrum(std::span<const double> values, double interval);

/// The same of all values at once: as fine as they allow, and as noisy.
Spectrum periodogram(std::span<const double> values, double interval);

/// Amplitude over the wave number (cycles per m) of values at positions (m) that may be passed at
/// any speed and repeatedly: of the sine that fits best, beside a constant, up to `cycles` of it
/// over the stroke in quarters. Empty without a stroke, or below 32 values.
Spectrum spatial_spectrum(std::span<const double> values, std::span<const double> positions,
                          int cycles = 100);

}  // namespace axisfit
