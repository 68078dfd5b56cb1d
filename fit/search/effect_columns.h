// What hypotheses would do to the residuals of a job, to first order, many of them at once.
//
// The derivative of the state with respect to a strength obeys the equations of the state,
// linearised, driven by the derivative of the rates. So one simulation without the effects carries
// the derivatives of many: those that the affine part of the equations holds exactly, and smooth
// forces as disturbances that are read off the trajectory (Equations::smooth_rate at strength
// zero). A hundred settings take the time of a few simulations.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <vector>

#include "fit/search/hypothesis.h"
#include "fit/solve/residual.h"
#include "fit/solve/run_context.h"

namespace axisfit {

/// A hypothesis, which must outlive what is asked of it, at one setting.
struct EffectSetting {
  const Hypothesis* hypothesis = nullptr;
  HypothesisValues own;
  bool with_shapes = false;  ///< whether the derivatives with respect to the shapes are wanted, too
};

class EffectColumns {
 public:
  /// The job has no free parameters, is tracked with this observer gain (1/s), and must outlive it.
  EffectColumns(const Job& job, double observer_gain, const RunContext& context);

  /// For each setting the derivatives of the whitened residuals (rows as RecordingCost has them,
  /// recording by recording) with respect to the strengths and then, if wanted, the shapes: per
  /// unit, or of what is estimated on a logarithmic scale, to its logarithm. Empty where the
  /// simulation does not finish. Strengths may differ from neutral ones only with shapes.
  std::vector<Eigen::MatrixXd> derivatives(const std::vector<EffectSetting>& settings) const;

 private:
  struct Column {
    std::size_t setting = 0, index = 0;  ///< which of whose derivatives
    std::size_t quantity = 0;
  };
  Eigen::MatrixXd exact(const EffectSetting& setting) const;
  void add_batch(const std::vector<EffectSetting>& settings, const std::vector<Column>& columns,
                 std::vector<Eigen::MatrixXd>& result) const;
  void add_forces(const std::vector<EffectSetting>& settings, const std::vector<Column>& columns,
                  std::vector<Eigen::MatrixXd>& result) const;
  Disturbances disturbances(std::size_t place, const std::vector<EffectSetting>& settings,
                            const std::vector<Column>& columns) const;

  const Job& job_;
  const ParameterSpace space_;
  double observer_gain_;
  const RunContext& context_;
  std::vector<std::size_t> recordings_;  ///< that are fitted
  std::deque<RecordingCost> costs_;      ///< of these
  std::vector<std::vector<AxisInstant>> trajectories_;
  std::vector<Eigen::Index> first_rows_;  ///< of each of them among all
  Eigen::Index rows_ = 0;
  double interval_ = 0.0;  ///< s, the longest mean interval of samples
};

}  // namespace axisfit
