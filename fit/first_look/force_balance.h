// The balance of forces of recordings in its weak form: the regressors of a first look.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "fit/first_look/first_look.h"

namespace axisfit {

/// Places of the regressors.
enum Place : Eigen::Index { kMass, kViscous, kCoulomb, kConstant, kSine, kCosine };

/// A window (1 - s^2)^4 on s from -1 to 1, and its derivatives by the time, at even samples.
struct Window {
  Window(std::size_t samples, double interval);
  std::vector<double> value, slope, bend;  ///< times the interval, so that sums are integrals
};

/// One recording on an even grid, of which the position or the velocity is taken.
class Grid {
 public:
  Grid(const DrivenMotion& motion, bool of_position);

  double interval() const { return interval_; }
  std::size_t count() const { return count_; }
  double duration() const { return interval_ * static_cast<double>(count_ - 1); }

  /// The speed about each sample, and the standard deviation of its noise.
  std::vector<double> speeds(std::size_t samples, double& noise) const;
  /// What drives it, so much earlier.
  std::vector<double> input(double delay) const;
  const std::vector<double>& values() const { return values_; }
  const std::vector<double>& positions() const { return positions_; }
  /// What takes the place of the direction where dry friction builds up over a travel, from -1
  /// to 1.
  std::vector<double> presliding(double travel) const;
  /// How far it gets, m or rad.
  double stroke() const;
  double noise() const { return noise_; }

 private:
  std::vector<double> travels() const;  ///< from sample to sample

  DrivenMotion motion_;
  bool of_position_;
  std::size_t count_ = 0;
  double interval_ = 0.0, noise_ = 0.0;
  std::vector<double> values_, positions_;
};

/// The balance in windows of one length: its regressors, and the input in the same windows.
struct Balance {
  Eigen::MatrixXd terms;
  Eigen::MatrixXd noise;  ///< what noise of the readings adds to terms' terms, on average
  struct Rows {
    std::size_t grid = 0;
    std::vector<std::size_t> first;  ///< samples with which the windows begin
    Eigen::Index row = 0;
    Window window;
    Eigen::Index lags = 0;  ///< neighbours that share samples with a window
  };
  std::vector<Rows> parts;
  double mean_square_speed = 0.0, mean_speed = 0.0;

  /// What drives the recordings, so much earlier, in these windows.
  Eigen::VectorXd inputs(const std::vector<Grid>& grids, double delay) const;
};

/// Windows of so many samples, of the terms that the options ask for. Those whose input, so much
/// earlier, was not recorded are left out.
Balance balance_in(const std::vector<Grid>& grids, std::size_t samples, bool of_position,
                   const FirstLookOptions& options, double delay);

inline constexpr std::size_t kWindowsPerMotion = 8;  ///< at least
inline constexpr std::size_t kOverlap = 4;           ///< windows over each sample

}  // namespace axisfit
