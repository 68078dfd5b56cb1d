#include "fit/solve/parameters.h"

#include <algorithm>
#include <cmath>

namespace axisfit {
namespace {

/// The bound that a value lies at but for the rounding of its scale, or else the value.
double at_bound_or(double value, const FreeParameter& p) {
  constexpr double kRounding = 1e-14;
  for (const double bound : {p.lower, p.upper})
    if (std::abs(value - bound) < kRounding * std::abs(bound)) return bound;
  return value;
}

}  // namespace

ParameterSpace::ParameterSpace(std::span<const FreeParameter> free) : free_(free) {
  // Where a scale from zero becomes linear: of the initial value, and of the upper bound at least,
  // so that no value is out of its reach.
  constexpr double kPartFromZero = 0.01, kLeastPart = 1e-20;
  for (const FreeParameter& p : free_) {
    if (p.scale == Scale::from_zero) {
      magnitude_.push_back(std::max(kPartFromZero * p.initial, kLeastPart * p.upper));
      continue;
    }
    // Any size of the parameter's order will do; a zero start takes it from the bounds.
    double magnitude = std::abs(p.initial);
    if (magnitude == 0.0 && std::isfinite(p.upper - p.lower))
      magnitude = 0.01 * (p.upper - p.lower);
    magnitude_.push_back(magnitude > 0.0 ? magnitude : 1.0);
  }
}

double ParameterSpace::value(std::size_t i, double u) const {
  switch (free_[i].scale) {
    case Scale::logarithmic:
      return at_bound_or(std::exp(u), free_[i]);
    case Scale::from_zero:
      return at_bound_or(magnitude_[i] * std::sinh(u), free_[i]);
    case Scale::linear:
      break;
  }
  return magnitude_[i] * u;
}

double ParameterSpace::slope(std::size_t i, double u) const {
  switch (free_[i].scale) {
    case Scale::logarithmic:
      return std::exp(u);
    case Scale::from_zero:
      return magnitude_[i] * std::cosh(u);
    case Scale::linear:
      break;
  }
  return magnitude_[i];
}

double ParameterSpace::internal(std::size_t i, double value) const {
  switch (free_[i].scale) {
    case Scale::logarithmic:
      return std::log(value);
    case Scale::from_zero:
      return std::asinh(value / magnitude_[i]);
    case Scale::linear:
      break;
  }
  return value / magnitude_[i];
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
