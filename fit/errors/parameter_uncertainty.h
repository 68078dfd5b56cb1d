// What is known of one parameter beyond its value.
#pragma once

namespace axisfit {

enum class ParameterVerdict {
  determined,
  weakly_determined,  ///< to no more than its order of magnitude
  not_determined,     ///< the data leave it open, alone or together with others
  at_zero,            ///< not distinguishable from zero, where the quantity ends
  at_bound,           ///< the estimate is at another bound; it has no standard error
  error_not_known,    ///< the run was stopped before it was found; no standard error
  of_wrong_model,     ///< the model does not describe the machine: the value means nothing
};

struct ParameterUncertainty {
  bool at_bound = false;         ///< at a bound; it has no standard error
  bool determined = false;       ///< false: the data leave it open, alone or together with others
  bool weak = false;             ///< determined, but to no more than its order of magnitude
  bool error_not_known = false;  ///< the run was stopped first; no standard error
  bool of_wrong_model = false;   ///< the model does not describe the machine; no standard error
  double standard_error = 0.0;   ///< in the quantity's unit; 0 unless determined
  /// Standard error over that of white noise of the stated size; where there is no standard error,
  /// the most that this could be.
  double inflation = 1.0;
  /// 95 % interval, in the quantity's unit: on a logarithmic scale not symmetric; at a bound
  /// one-sided. Both zero where there is none.
  double lower = 0.0, upper = 0.0;

  bool reaches_zero = false;  ///< the interval begins at zero, the natural end of the quantity

  bool has_interval() const { return lower != 0.0 || upper != 0.0; }
  /// The estimate is as good as zero: the recordings show that it is small, or that it is none.
  bool is_at_zero() const { return reaches_zero && (determined || at_bound); }

  ParameterVerdict verdict() const {
    if (of_wrong_model) return ParameterVerdict::of_wrong_model;
    if (error_not_known) return ParameterVerdict::error_not_known;
    if (is_at_zero()) return ParameterVerdict::at_zero;
    if (at_bound) return ParameterVerdict::at_bound;
    if (!determined) return ParameterVerdict::not_determined;
    return weak ? ParameterVerdict::weakly_determined : ParameterVerdict::determined;
  }
};

}  // namespace axisfit
