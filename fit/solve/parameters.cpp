#include "fit/solve/parameters.h"

#include <algorithm>
#include <cmath>

namespace axisfit {

ParameterSpace::ParameterSpace(std::span<const FreeParameter> free) : free_(free) {
  for (const FreeParameter& p : free_) {
    // Any size of the parameter's order will do; a zero start takes it from the bounds.
    double magnitude = std::abs(p.initial);
    if (magnitude == 0.0 && std::isfinite(p.upper - p.lower))
      magnitude = 0.01 * (p.upper - p.lower);
    magnitude_.push_back(magnitude > 0.0 ? magnitude : 1.0);
  }
}

double ParameterSpace::value(std::size_t i, double u) const {
  return free_[i].logarithmic ? std::exp(u) : u * magnitude_[i];
}

double ParameterSpace::slope(std::size_t i, double u) const {
  return free_[i].logarithmic ? std::exp(u) : magnitude_[i];
}

double ParameterSpace::internal(std::size_t i, double value) const {
  return free_[i].logarithmic ? std::log(value) : value / magnitude_[i];
}

Eigen::VectorXd ParameterSpace::internal(std::span<const double> values) const {
  Eigen::VectorXd u(static_cast<Eigen::Index>(size()));
  for (std::size_t i = 0; i < size(); ++i) u[static_cast<Eigen::Index>(i)] = internal(i, values[i]);
  return u;
}

std::vector<double> ParameterSpace::values(const Eigen::VectorXd& u) const {
  std::vector<double> values(size());
  for (std::size_t i = 0; i < size(); ++i) values[i] = value(i, u[static_cast<Eigen::Index>(i)]);
  return values;
}

std::vector<double> initial_values(const Job& job) {
  std::vector<double> values;
  for (const FreeParameter& p : job.free) values.push_back(p.initial);
  return values;
}

void set_initial_values(Job& job, std::span<const double> values) {
  for (std::size_t i = 0; i < values.size(); ++i)
    job.free[i].initial = std::clamp(values[i], job.free[i].lower, job.free[i].upper);
}

Job fixed_at(const Job& job, std::span<const double> values) {
  Job fixed = job;
  fixed.free.clear();
  const auto member = members(fixed.model);
  for (std::size_t i = 0; i < job.free.size(); ++i) {
    const FreeParameter& p = job.free[i];
    if (p.recording) {
      fixed.recordings[*p.recording].overrides.emplace_back(p.quantity, values[i]);
      continue;
    }
    *member[p.quantity] = values[i];
    // An estimate goes before an initial state from the data, as in model_at().
    for (Recording& r : fixed.recordings)
      std::erase_if(r.overrides, [&](const auto& own) { return own.first == p.quantity; });
  }
  return fixed;
}

Model<double> model_at(const Job& job, const ParameterSpace& space, const double* u,
                       std::size_t recording) {
  Model<double> model = job.model;
  const std::vector<double*> member = members(model);
  for (const auto& [quantity, value] : job.recordings[recording].overrides)
    *member[quantity] = value;
  for (std::size_t i = 0; i < space.size(); ++i)
    if (space.applies(i, recording)) *member[space[i].quantity] = space.value(i, u[i]);
  return model;
}

}  // namespace axisfit
