#include "fit/errors/error_budget.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/distributions.h"

namespace axisfit {
namespace {

/// A standard error and half of its interval, in the quantity's unit.
struct Spread {
  double error = 0.0, half = 0.0;

  /// With a further independent error.
  Spread and_also(double further) const {
    if (!(error > 0.0)) return *this;
    const double factor = std::hypot(1.0, further / error);
    return {error * factor, half * factor};
  }
};

Spread spread_of(double error, double degrees_of_freedom) {
  return {error, student_95(degrees_of_freedom) * error};
}

Spread of_noise(const ErrorBudget& budget) {
  const SamplingError& sampling = budget.sampling;
  const auto& input = budget.input_noise;
  return input && input->standard_error > sampling.standard_error
             ? spread_of(input->standard_error, input->degrees_of_freedom)
             : spread_of(sampling.standard_error, sampling.degrees_of_freedom);
}

/// How far another value of an estimate is from it.
template <class Shift>
double move_of(const std::optional<Shift>& shift, double value) {
  return shift ? std::abs(shift->value - value) : 0.0;
}

Spread of_all_but_rivals(const ErrorBudget& budget, double value) {
  if (!budget.scatter) return of_noise(budget).and_also(move_of(budget.gain, value));
  const double between = std::pow(budget.scatter->between, 2);
  const double all = std::pow(error_within_groups(budget, value), 2) + between;
  // The part inside groups is known well, so the sum has more degrees of freedom than the part
  // between them.
  return spread_of(std::sqrt(all), budget.scatter->degrees_of_freedom * std::pow(all / between, 2));
}

/// A parameter's scale, on which its interval is symmetric.
class ParameterScale {
 public:
  ParameterScale(double value, const FreeParameter& free) : value_(value), free_(free) {}

  double length(double in_unit) const { return is_logarithmic() ? in_unit / value_ : in_unit; }
  /// The value that is so far away, within the bounds.
  double value_at(double distance) const {
    return std::clamp(is_logarithmic() ? std::exp(std::log(value_) + distance) : value_ + distance,
                      free_.lower, free_.upper);
  }
  bool is_lower_bound_nearer() const {
    return is_logarithmic() ? value_ / free_.lower < free_.upper / value_
                            : value_ - free_.lower < free_.upper - value_;
  }
  /// How large an error is: a part of the value, or of half the range of a linear scale.
  double size_of(const Spread& spread) const {
    return free_.scale == Scale::linear ? spread.half / (0.5 * (free_.upper - free_.lower))
                                        : spread.error / value_;
  }
  /// Whether a value of at most so much is known to be small: beside what it was taken to be.
  bool is_small(double most) const {
    return free_.scale == Scale::from_zero && most < std::numbers::e * free_.initial;
  }

 private:
  /// From zero, an interval is symmetric in the value: it must reach zero.
  bool is_logarithmic() const { return free_.scale == Scale::logarithmic; }

  double value_;
  const FreeParameter& free_;
};

/// The interval of an estimate at a bound, as far inwards as the likelihood ratio is not
/// significant.
void set_one_sided(const SamplingError& sampling, double half, const ParameterScale& scale,
                   const FreeParameter& free, ParameterUncertainty& found) {
  const bool at_lower = scale.is_lower_bound_nearer();
  const double inwards = at_lower ? 1.0 : -1.0;
  const double beyond = std::max(0.0, -inwards * scale.length(sampling.step));
  const double variance = std::pow(scale.length(half), 2);
  if (!std::isfinite(variance)) return;
  // sqrt(variance + beyond^2) - beyond, without its cancellation and overflow
  const double whole = std::hypot(std::sqrt(variance), beyond) + beyond;
  const double other = scale.value_at(inwards * (whole > 0.0 ? variance / whole : 0.0));
  found.lower = at_lower ? free.lower : other;
  found.upper = at_lower ? other : free.upper;
  // What has no zero in its range is as good as zero far below what it was taken to be.
  constexpr double kAsGoodAsZero = 1e-4;
  found.reaches_zero = at_lower && free.lower >= 0.0 && free.lower <= kAsGoodAsZero * free.initial;
}

}  // namespace

double student_95(double degrees_of_freedom) {
  return student_quantile(0.975, std::max(1.0, degrees_of_freedom));
}

ErrorBudget without_rival(ErrorBudget budget) {
  budget.rival.reset();
  return budget;
}

double error_within_groups(const ErrorBudget& budget, double value) {
  const double gain = move_of(budget.gain, value);
  const double one = of_noise(budget).and_also(gain).error;
  return budget.scatter ? std::min(one, std::hypot(budget.scatter->inside, gain)) : one;
}

ParameterUncertainty combined(const ErrorBudget& budget, double value, const FreeParameter& free,
                              const ErrorOptions& options) {
  const SamplingError& sampling = budget.sampling;
  const ParameterScale scale(value, free);
  const Spread noise = of_noise(budget);
  ParameterUncertainty found{.at_bound = sampling.at_bound, .inflation = sampling.inflation};
  if (!std::isfinite(noise.error)) return found;
  const auto inflate = [&](double error) {
    if (sampling.standard_error > 0.0) found.inflation *= error / sampling.standard_error;
  };
  if (sampling.at_bound) {
    inflate(noise.error);
    set_one_sided(sampling, noise.half, scale, free, found);
    return found;
  }
  const Spread total = of_all_but_rivals(budget, value).and_also(move_of(budget.rival, value));
  inflate(total.error);
  const double size = scale.size_of(total);
  const double largest =
      free.scale == Scale::logarithmic ? options.largest_log_error : options.largest_error;
  found.determined = size < largest || scale.is_small(value + total.half);
  if (!found.determined) return found;
  found.weak = size > options.weak_error;
  found.standard_error = total.error;
  const double half = scale.length(total.half);
  found.lower = scale.value_at(-half);
  found.upper = scale.value_at(half);
  found.reaches_zero = free.lower == 0.0 && found.lower == 0.0;
  return found;
}

}  // namespace axisfit
