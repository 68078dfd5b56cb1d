// The course of one parameter of one axis over the nights.
//
// Of an axis that stays as it is, a night's estimate is
//
//   x = mu + sum of beta_j (channel_j - mean) + N(0, s^2 + tau^2)
//
// with the standard error s of the night and the axis' own scatter tau, on the scale of the
// logarithm where the parameter is positive. mu and beta are learnt from the nights before; tau has
// a prior on a grid, which the whole fleet gives, and weights by how well it has predicted them.
// The prediction of the next night is thus a mixture of normal distributions, and the share of it
// below what is measured, as a standard normal number z, is free of all of that: as long as nothing
// changes, z is independent and standard normal from the second night on.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace axisfit {

/// One night of a parameter.
struct TrendNight {
  std::string night;
  double day = 0.0;
  double value = 0.0, standard_error = 0.0;  ///< in the parameter's unit
  std::vector<double> channels{};
};

/// The logarithms of weights of the own scatter, in multiples of the usual standard error.
using ScatterPrior = std::vector<double>;
/// The multiples themselves.
const std::vector<double>& scatter_grid();
/// Equal ones.
ScatterPrior flat_prior();

/// A parameter that jumped or drifts, told on one night.
struct Change {
  std::size_t night = 0;             ///< that on which it was told
  std::size_t since = 0;             ///< the first night of the change, as far as it can be told
  double before = 0.0, after = 0.0;  ///< means at usual channels, in the parameter's unit
  double errors = 0.0;               ///< their difference in standard errors
  double per_day = 0.0;  ///< slope since then in units of the parameter; zero: not known
};

class Trend {
 public:
  /// Of nights in their order.
  explicit Trend(std::vector<TrendNight> nights);

  /// Log-likelihood of all nights for each scatter of the grid.
  std::vector<double> likelihoods() const;
  /// Changes, found with a threshold of Cusum. After one the axis is learnt anew, from its first
  /// night on.
  std::vector<Change> changes(const ScatterPrior& prior, double threshold) const;
  /// Standard normal numbers, from the second night on; for tests.
  std::vector<double> standardised(const ScatterPrior& prior) const;
  /// Weighted mean and its standard error, in the parameter's unit.
  double mean() const;

  const std::vector<TrendNight>& nights() const { return nights_; }

 private:
  struct Filter;

  std::vector<TrendNight> nights_;
  bool is_logarithmic_ = false;
  std::vector<double> y_, errors_;  // from the first night's, in usual standard errors
  double first_ = 0.0;
  std::vector<double> channel_means_, channel_scales_;
  double usual_error_ = 0.0;
};

/// The prior that many axes give: that under which their nights are likeliest.
ScatterPrior prior_of(const std::vector<Trend>& trends);

}  // namespace axisfit
