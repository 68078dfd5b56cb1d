#include "fit/solve/journal.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <memory>
#include <type_traits>

namespace axisfit {
namespace {

/// What is hashed by its bytes.
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

void add_model(Hash& hash, const Model<double>& model) {
  hash << model.structure.drive << model.structure.transmission << model.structure.joint
       << model.structure.closed_loop;
  visit_timing(model.controller.timing, [&](const Quantity&, double value) { hash << value; });
  for (std::size_t i = 0; i < model.structure.effects.size(); ++i)
    hash << model.structure.effects[i];
  visit_quantities(model, [&](std::string_view, const Quantity&, double value) { hash << value; });
}

void add_recording(Hash& hash, const Recording& r) {
  hash << r.role;
  if (r.role != Role::fit) return;
  hash << r.times << r.command.times << r.command.values << r.command.hold << r.command.meaning
       << r.held_out << r.overrides.size();
  for (const auto& [quantity, value] : r.overrides) hash << quantity << value;
  hash << r.measurements.size();
  for (const Measurement& m : r.measurements)
    hash << m.signal << m.values << m.sigma << m.fitted << m.excluded << m.filter.kind
         << m.filter.length << m.filter.order << m.filter.cutoff << m.filter.zero_phase
         << m.uninformative;
}

void add_parameter(Hash& hash, const FreeParameter& p) {
  hash << p.quantity << p.recording.has_value() << p.recording.value_or(0) << p.initial << p.lower
       << p.upper << p.logarithmic << p.prior.has_value();
  if (p.prior) hash << p.prior->mean << p.prior->sigma;
}

}  // namespace

ProblemKey problem_key(const Job& job, const Eigen::VectorXd& u, double observer_gain,
                       const SolveOptions& options) {
  Hash hash;
  add_model(hash, job.model);
  hash << job.recordings.size();
  for (const Recording& r : job.recordings) add_recording(hash, r);
  hash << job.free.size();
  for (const FreeParameter& p : job.free) add_parameter(hash, p);
  hash << job.options.loss << job.options.huber_width << job.options.step << job.options.horizon;
  hash << u << observer_gain << options.max_iterations << options.function_tolerance
       << options.parameter_tolerance << options.penalize_distance_from_start << options.fixed;
  return hash.key();
}

}  // namespace axisfit
