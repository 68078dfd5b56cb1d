// The free parameters as one vector, on the scales on which they are estimated.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "fit/job.h"

namespace axisfit {

/// Maps a job's free parameters to the vector u that the solver works on: the logarithm of a
/// logarithmic parameter, and a linear one divided by its magnitude.
class ParameterSpace {
 public:
  /// The job must outlive the space.
  explicit ParameterSpace(const Job& job);

  std::size_t size() const { return free_.size(); }
  const FreeParameter& operator[](std::size_t i) const { return free_[i]; }
  /// Name of the i-th parameter; with "@recording" when it belongs to one recording only.
  std::string name(std::size_t i) const;

  double value(std::size_t i, double u) const;
  /// d value / d u
  double slope(std::size_t i, double u) const;
  double internal(std::size_t i, double value) const;

  Eigen::VectorXd internal(std::span<const double> values) const;
  std::vector<double> values(const Eigen::VectorXd& u) const;

  /// Whether the i-th parameter acts on the recording.
  bool applies(std::size_t i, std::size_t recording) const {
    return !free_[i].recording || *free_[i].recording == recording;
  }

  /// The model of one recording at u, with the recording's overrides and initial state.
  Model<double> model_at(const double* u, std::size_t recording) const;

 private:
  const Job& job_;
  std::span<const FreeParameter> free_;
  std::vector<double> magnitude_;
};

}  // namespace axisfit
