// The free parameters as one vector, on the scales on which they are estimated.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "fit/data/job.h"

namespace axisfit {

/// Maps free parameters to the vector u that the solver works on: the logarithm of a logarithmic
/// parameter, a linear one divided by its magnitude, and one from zero by the area hyperbolic sine
/// of value / magnitude.
class ParameterSpace {
 public:
  /// The parameters must outlive the space.
  explicit ParameterSpace(std::span<const FreeParameter> free);
  /// The parameters of a job, which must outlive the space.
  explicit ParameterSpace(const Job& job) : ParameterSpace(job.free) {}

  std::size_t size() const { return free_.size(); }
  const FreeParameter& operator[](std::size_t i) const { return free_[i]; }

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

 private:
  std::span<const FreeParameter> free_;
  std::vector<double> magnitude_;
};

/// The initial values of a job's free parameters, in the quantities' units.
std::vector<double> initial_values(const Job& job);
/// Sets the initial values of the first so many parameters, each moved to its nearest bound if it
/// lies outside.
void set_initial_values(Job& job, std::span<const double> values);

/// The job with its free parameters fixed at these values.
Job fixed_at(const Job& job, std::span<const double> values);

/// The model of one recording of a job at u, with the recording's overrides and initial state.
Model<double> model_at(const Job& job, const ParameterSpace& space, const double* u,
                       std::size_t recording);

}  // namespace axisfit
