// Where scores start from, and what one step of least squares from there makes of hypotheses.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "base/linear_algebra.h"
#include "fit/search/effect_columns.h"
#include "fit/search/options.h"
#include "fit/solve/linearization.h"
#include "fit/solve/solve.h"

namespace axisfit {

/// The job with longer steps of the integrator: smooth effects are 1e-4 off, and four times as
/// quick.
Job with_coarse_steps(Job job);

/// The fit at an observer gain (1/s) that a score starts from. Not usable: nothing finite.
SolveResult tracking_fit(const Job& job, const ParameterSpace& space,
                         const std::vector<double>& values, double observer_gain,
                         const SearchContext& context);

/// The simulation that tracks the data, its free parameters fitted there.
struct ScorePoint {
  Eigen::VectorXd u;           ///< the free parameters, see ParameterSpace
  std::vector<double> values;  ///< the same in their units
  Linearization base;
  Eigen::MatrixXd basis;      ///< orthonormal, spans what the free parameters can do
  Eigen::VectorXd residuals;  ///< without that

  double mean_square() const {
    return residuals.squaredNorm() / static_cast<double>(residuals.size());
  }
};

/// From a fit with the given values; none where no residuals are finite there.
std::optional<ScorePoint> score_point(const Job& job, const std::vector<double>& values,
                                      double observer_gain, const SearchContext& context);

/// What a step of least squares makes of hypotheses.
struct ScoreStep {
  std::vector<HypothesisValues> own;  ///< of each
  std::vector<double> others;  ///< of the job's free parameters, no further than is to be trusted
  Eigen::VectorXd change;      ///< of ScorePoint::residuals
  double gain = 0.0;           ///< fall of their sum of squares
};

class Scorer {
 public:
  /// All must outlive it.
  Scorer(const Job& job, const ScorePoint& point, const SearchOptions::Scoring& options)
      : options_(options), job_(job), point_(point), space_(job), solver_(point.base.jacobian) {}

  /// Of these together, with their derivatives (EffectColumns); none where they gain no more than
  /// so much, a simulation does not finish, or a single strength would leave its range.
  std::optional<ScoreStep> step(std::span<const EffectSetting> settings,
                                std::span<const Eigen::MatrixXd> derivatives,
                                double least_gain) const;

  /// The step of the shapes, from a score and the derivatives with respect to strengths and shapes
  /// there; none where they say nothing.
  std::optional<Eigen::VectorXd> step_of_shapes(const EffectSetting& setting,
                                                const Eigen::MatrixXd& derivatives) const;

  /// Orthonormal columns that span what the derivatives do and the free parameters cannot do; empty
  /// where nothing but rounding is left of one.
  Eigen::MatrixXd own_basis(const Eigen::MatrixXd& derivatives) const;

 private:
  Eigen::MatrixXd projected(const Eigen::MatrixXd& derivatives) const;
  std::vector<double> others_after(const Eigen::VectorXd& change) const;

  const SearchOptions::Scoring& options_;
  const Job& job_;
  const ScorePoint& point_;
  const ParameterSpace space_;
  const LeastSquaresSolver solver_;
};

}  // namespace axisfit
