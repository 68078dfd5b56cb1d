#include "fit/solve/journal.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <memory>
#include <string>
#include <type_traits>

namespace axisfit {
namespace {

/// A value that is hashed by its bytes.
template <class T>
concept Plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;

class Hash {
 public:
  Hash() { XXH3_128bits_reset(state_.get()); }

  template <Plain T>
  Hash& operator<<(T value) {
    return add(&value, 1);
  }
  Hash& operator<<(const Eigen::VectorXd& values) {
    return *this << values.size(), add(values.data(), static_cast<std::size_t>(values.size()));
  }
  template <Plain T>
  Hash& operator<<(const std::vector<T>& values) {
    *this << values.size();
    if constexpr (std::is_same_v<T, bool>)
      for (const bool value : values) *this << value;
    else
      add(values.data(), values.size());
    return *this;
  }

  Hash& operator<<(const Samples& samples) {
    return *this << static_cast<const std::vector<double>&>(samples);
  }

  ProblemKey key() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(state_.get());
    return {hash.high64, hash.low64};
  }

 private:
  template <class T>
  Hash& add(const T* values, std::size_t count) {
    XXH3_128bits_update(state_.get(), values, count * sizeof(T));
    return *this;
  }

  struct Free {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
  };
  std::unique_ptr<XXH3_state_t, Free> state_{XXH3_createState()};
};

// Structures are taken apart whole, member by member: a new one does not compile until somebody
// decides whether a solution depends on it.

Hash& operator<<(Hash& hash, const Channel& channel) {
  const auto& [name, unit, zero] = channel;
  hash << name.size() << unit.size() << zero;
  for (const std::string* text : {&name, &unit})
    for (const char letter : *text) hash << letter;
  return hash;
}

Hash& operator<<(Hash& hash, const Structure& structure) {
  const auto& [drive, transmission, effects, joint, closed_loop, channels, gearing] = structure;
  hash << drive << transmission << joint << closed_loop << gearing;
  for (std::size_t i = 0; i < effects.size(); ++i) hash << effects[i];
  hash << (channels == nullptr ? std::size_t{0} : channels->size());
  for (std::size_t i = 0; channels != nullptr && i < channels->size(); ++i) hash << (*channels)[i];
  return hash;
}

Hash& operator<<(Hash& hash, const ControllerTiming& timing) {
  const auto& [period, track_period, counts_per_revolution, velocity_samples] = timing;
  return hash << period << track_period << counts_per_revolution << velocity_samples;
}

Hash& operator<<(Hash& hash, const Model<double>& model) {
  // All others consist of quantities, which are visited below.
  const auto& [structure, axis, effects, instruments, controller, initial] = model;
  hash << structure << controller.timing;
  visit_quantities(model, [&](std::string_view, const Quantity&, double value) { hash << value; });
  return hash;
}

Hash& operator<<(Hash& hash, const Schedule& schedule) {
  const auto& [times, values, hold, meaning] = schedule;
  return hash << times << values << hold << meaning;
}

Hash& operator<<(Hash& hash, const Filter& filter) {
  const auto& [kind, length, order, cutoff, zero_phase] = filter;
  return hash << kind << length << order << cutoff << zero_phase;
}

Hash& operator<<(Hash& hash, const Measurement& measurement) {
  // Where sigma comes from, and how the samples came to be uninformative, does not matter.
  const auto& [signal, values, sigma, noise, fitted, excluded, filter, hold, uninformative,
               missing] = measurement;
  return hash << signal << values << sigma << fitted << excluded << filter << uninformative;
}

Hash& operator<<(Hash& hash, const Recording& recording) {
  // Not hashed: what it is called; the noise of the command, which only widens errors; how errors
  // are reported; and the standstill, which is in the excluded samples.
  const auto& [name, file, role, times, command, command_sigma, command_noise, measurements,
               channels, initial_state, knows_position, knows_velocity, initial_samples,
               score_initial_samples, acceleration_at_standstill, held_out, overrides] = recording;
  hash << role;
  if (role != Role::fit) return hash;
  hash << times << command << initial_state << knows_position << knows_velocity << initial_samples
       << held_out << measurements.size();
  for (const Measurement& m : measurements) hash << m;
  hash << channels.size();
  for (const Samples& values : channels) hash << values;
  hash << overrides.size();
  for (const auto& [quantity, value] : overrides) hash << quantity << value;
  return hash;
}

Hash& operator<<(Hash& hash, const FreeParameter& parameter) {
  const auto& [quantity, recording, initial, lower, upper, scale, prior] = parameter;
  hash << quantity << recording.has_value() << recording.value_or(0) << initial << lower << upper
       << static_cast<int>(scale) << prior.has_value();
  if (!prior) return hash;
  const auto& [mean, sigma] = *prior;
  return hash << mean << sigma;
}

Hash& operator<<(Hash& hash, const FitOptions& options) {
  // How the fit goes about it is in the start and the options of each problem.
  const auto& [criterion, continuation, loss, huber_width, max_iterations, tolerance, attempts,
               starts, spread, seed, threads, step, input_noise_draws, give_up_above] = options;
  return hash << window_length(criterion) << loss << huber_width << step;
}

Hash& operator<<(Hash& hash, const SolveOptions& options) {
  const auto& [max_iterations, function_tolerance, parameter_tolerance,
               penalize_distance_from_start, fixed, give_up_above, jumps, stop] = options;
  return hash << max_iterations << function_tolerance << parameter_tolerance
              << penalize_distance_from_start << fixed << give_up_above << jumps;
}

Hash& operator<<(Hash& hash, const Job& job) {
  // Names, limits of experiments, which values are guesses and who chose the criterion say nothing
  // of the problem.
  const auto& [axis, model, limits, recordings, free, guessed, options, choose_criterion] = job;
  hash << model << recordings.size();
  for (const Recording& r : recordings) hash << r;
  hash << free.size();
  for (const FreeParameter& p : free) hash << p;
  return hash << options;
}

}  // namespace

ProblemKey problem_key(const Job& job, const Eigen::VectorXd& u, double observer_gain,
                       const SolveOptions& options) {
  Hash hash;
  hash << job << u << observer_gain << options;
  return hash.key();
}

}  // namespace axisfit
