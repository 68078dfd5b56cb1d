// The rules that a job keeps, whether it was read from files or made in memory.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "fit/data/job.h"

namespace axisfit {

/// Of a recording.
inline constexpr std::size_t kLeastSamples = 10;
/// Least standard deviation of a noise, in any unit: below it, squares of residuals overflow.
inline constexpr double kMinSigma = 1e-40;

/// A rule that a job breaks, and what it is about.
struct JobFault {
  enum class Rule {
    // Of the job.
    options,             ///< numbers of the fit are finite and large enough
    limits,              ///< the lowest position is below the highest; speed and command above zero
    guessed,             ///< are quantities
    model,               ///< can be simulated, also with what a recording sets (model_error())
    value,               ///< is finite, and of what every axis must have within its range
    fitted_recording,    ///< there is one
    free_quantity,       ///< there is one
    degrees_of_freedom,  ///< more values are fitted than parameters
    // Of a recording.
    name,             ///< is no other recording's
    times,            ///< are enough, finite, and increase
    command,          ///< has finite values at times that increase, and a sigma of zero or more
    reference,        ///< needs the controller as part of the model
    channels,         ///< none, or a value of each of the model's for each sample
    held_out,         ///< says nothing, or something of each sample
    set_quantity,     ///< is one of the axis, with a finite value within its range
    gap,              ///< takes no more steps than can be simulated
    duration,         ///< likewise
    same_samples,     ///< as those of another recording: it counts once
    measured,         ///< something is
    fitted_signal,    ///< a recording to fit has one
    unscored,         ///< leaves samples to score
    initial_state,    ///< from the samples needs a position or velocity
    tracked_signal,   ///< an observer that lasts has a position or velocity to track, ...
    late_filter,      ///< ... which no filter delays, ...
    late_instrument,  ///< ... and no instrument; not even one whose lag or delay is fitted
    horizon,          ///< windows begin from a recorded motion that is free to leave it
    // Of a measurement.
    signal,         ///< is one of the axis
    second_signal,  ///< of the same kind there is not
    values,         ///< are finite, one for each sample
    flags,          ///< say nothing, or something of each sample
    filter,         ///< and hold are possible
    sigma,          ///< is finite and above zero; of a prior, too
    // Of a free parameter.
    quantity,      ///< is one of the axis
    recording,     ///< is one of the job's
    second_free,   ///< of the same quantity and recording there is not
    scale,         ///< a logarithmic one is above zero, one from zero not below
    initial,       ///< lies within the bounds
    bounds,        ///< are apart and within the range of the quantity
    prior_mean,    ///< is finite
    free_and_set,  ///< in a recording a quantity is not
  };
  Rule rule;
  std::string message;  ///< for the user: what is wrong, and what to do
  std::optional<std::size_t> recording{}, measurement{};  ///< of that recording
  std::optional<std::size_t> parameter{};                 ///< in Job::free
};

/// All rules that the job breaks, whatever it holds: first those of its recordings and parameters,
/// last its own. A rule that depends on a broken one is not checked.
std::vector<JobFault> faults(const Job& job);

/// Throws std::invalid_argument with a line for each of faults(), which names the recording, signal
/// or parameter.
void validate(const Job& job);

}  // namespace axisfit
