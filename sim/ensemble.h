// An axis as it may be, given what is not known of it, and the band of what it may do.
//
// Parameters are drawn about their estimates: with their errors, which are correlated, and with
// their scatter from recording to recording, Student's t for as many degrees of freedom as the
// scatter has. A force that no effect explains acts besides, drawn as the process that it is. Each
// draw is simulated like the axis itself, so that stiction, limits and controllers count.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/axis_uncertainty.h"
#include "sim/channel.h"
#include "sim/model.h"

namespace axisfit {

class AxisEnsemble {
 public:
  /// How often to draw for a band, and whether so many that could be simulated make one.
  static constexpr std::size_t kDraws = 300;
  static constexpr bool are_enough(std::size_t draws) { return 2 * draws > kDraws; }

  /// Throws std::runtime_error where a force is missing and the model has no channel left for it.
  AxisEnsemble(const AxisUncertainty& uncertainty, const Structure& structure, std::uint64_t seed);

  /// The k-th axis about a model; the same one for a seed. Its last channel is missing_force().
  Model<double> axis(const Model<double>& model, std::size_t k) const;
  bool has_missing_force() const { return uncertainty_.missing_force.has_value(); }
  /// That which acts on it, N at these instants (s), beside the channels that the model has.
  std::vector<double> missing_force(std::size_t k, std::span<const double> instants) const;

 private:
  AxisUncertainty uncertainty_;
  std::vector<double> root_;  ///< of the correlation, by rows
  Channels channels_ = nullptr;
  std::uint64_t seed_;
};

/// Where a curve stays with a probability of 95 %.
struct Band {
  std::vector<double> half_width;  ///< about the prediction: at any one instant
  /// How many times as wide the band is in which the whole curve stays with that probability.
  double whole = 1.0;

  /// Index of the first instant at which it is wider than that; its size where it never is.
  std::size_t reach(double tolerance) const;
  double median() const;
  double largest() const;
};

/// From curves that were drawn, each as long as the prediction. Its shape is that of their usual
/// distance from it, so that few draws do not make it ragged.
Band band_of(std::span<const double> prediction, const std::vector<std::vector<double>>& drawn);

}  // namespace axisfit
