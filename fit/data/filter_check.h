// Whether samples were filtered or repeated before they were recorded, by the samples alone.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace axisfit {

/// How often each value is recorded: the usual distance between two changes of the value, where
/// almost all others are multiples of it. 1 where there is no such pattern, or rounding may be the
/// cause because the changes are hardly more than the step between values.
std::size_t repetition_of(std::span<const double> values);

/// Whether values change often enough to tell, and then almost only where others do: those of one
/// message on a bus, however even their steps.
bool changes_with(std::span<const double> values, std::span<const double> others);

/// A low-pass filter of evenly sampled values.
struct SuspectedFilter {
  double corner = 0.0;  ///< cycles per sample, within a factor of two: it lets the noise below pass
  std::size_t average = 0;  ///< samples of a moving average; zero where it is none or another
};

/// The filter that the noise of evenly sampled values shows, if any. White noise is as strong in
/// the highest octave of the spectrum as in those below, and that of rounding is, too. Motion of
/// the axis at such frequencies is short or a tone, and smooth motion is much stronger in every
/// lower octave: neither looks like noise that is missing from the highest octave throughout. At
/// least 500 values are needed. A command may have such a spectrum for as long as it lasts, such as
/// a random sequence or a staircase, and so has the motion that it causes: `command` has the value
/// in force at every sample, and what goes along with it is no noise. Empty: unknown.
std::optional<SuspectedFilter> suspected_filter(std::span<const double> values,
                                                std::span<const double> command = {});

}  // namespace axisfit
