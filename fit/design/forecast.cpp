#include "fit/design/forecast.h"

#include <cmath>
#include <utility>

#include "fit/criterion/gains.h"
#include "fit/solve/solve.h"

namespace axisfit {

Forecast forecast(const Job& job, const std::vector<double>& values) {
  Forecast result;
  const ParameterSpace space(job);
  const Eigen::VectorXd u = space.internal(values);
  Linearization at = linearize(job, space, u, final_gain(job));
  result.finite = at.finite;
  if (!at.finite) return result;
  at.residuals.setZero();  // what the data are does not matter, only where they would be
  // The noise of a filtered signal is correlated.
  for (const SeriesRows& rows : at.series) {
    const Measurement& m = job.recordings[rows.recording].measurements[rows.measurement];
    at.jacobian.middleRows(rows.first, rows.count) /= std::sqrt(noise_correlation_time(m));
  }
  result.uncertainty = uncertainty(space, u, at);
  result.identifiability = identifiability(space, u, at, 1.0);
  result.series = std::move(at.series);
  result.sensitivity.resize(at.jacobian.cols(), static_cast<Eigen::Index>(result.series.size()));
  for (Eigen::Index s = 0; s < result.sensitivity.cols(); ++s) {
    const SeriesRows& rows = result.series[static_cast<std::size_t>(s)];
    result.sensitivity.col(s) = at.jacobian.middleRows(rows.first, rows.count).colwise().norm() /
                                std::sqrt(static_cast<double>(rows.count));
  }
  return result;
}

std::string_view excitation_needed(const QuantityEntry& quantity, Vocabulary vocabulary) {
  constexpr std::string_view kReversal =
      "the pinion to change flanks: commands of both signs, or strong braking";
  constexpr std::string_view kRinging =
      "the gear to ring: an abrupt command, recorded by an accelerometer or fast velocity sensor";
  constexpr std::string_view kVoltage =
      "the motor voltage to reach its limit: until then the current loop hides it";
  constexpr std::string_view kBreakaway =
      "the arm to come to rest and break away: slow motion with reversals";
  constexpr std::string_view kFastChanges =
      "fast changes of the command: a step, a chirp or a pseudo-random sequence";
  static constexpr std::pair<std::string_view, std::string_view> kNeeds[]{
      {"V_L", "the preamplifier to reach its limit: a larger step of the command"},
      {"V_s", "the motor voltage to reach its limit: full speed with strong acceleration"},
      {"R", kVoltage},
      {"L", kVoltage},
      {"K_e", kVoltage},
      {"H", kReversal},
      {"b_g", kRinging},
      {"k_g", kRinging},
      {"B_a", motions::kBothWays},
      {"F_s", kBreakaway},
      {"w", kBreakaway},
      {"M", motions::kAcceleration},
      {"J_m", motions::kAcceleration},
      {"T_p", kFastChanges},
      {"T_z", kFastChanges},
      {"T_r", kFastChanges},
      {"T_d", motions::kSwitches}};
  for (const auto& [name, need] : kNeeds)
    if (name == quantity_list()[quantity.index].name) return words_on(vocabulary, need);
  return quantity.effect ? words_on(vocabulary, kEffectTable[*quantity.effect].excitation)
                         : std::string_view();
}

}  // namespace axisfit
