#include "fit/parameters.h"

#include <algorithm>
#include <cmath>

namespace axisfit {

ParameterSpace::ParameterSpace(const Job& job) : job_(job), free_(job.free) {
  for (const FreeParameter& p : free_) {
    // Any size of the parameter's order will do; a zero start takes it from the bounds.
    double magnitude = std::abs(p.initial);
    if (magnitude == 0.0 && std::isfinite(p.upper - p.lower))
      magnitude = 0.01 * (p.upper - p.lower);
    magnitude_.push_back(magnitude > 0.0 ? magnitude : 1.0);
  }
}

std::string ParameterSpace::name(std::size_t i) const {
  std::string name = quantity_list()[free_[i].quantity].name;
  if (free_[i].recording) name += "@" + job_.recordings[*free_[i].recording].name;
  return name;
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

Model<double> ParameterSpace::model_at(const double* u, std::size_t recording) const {
  Model<double> model = job_.model;
  const std::vector<double*> member = members(model);
  for (const auto& [quantity, value] : job_.recordings[recording].overrides)
    *member[quantity] = value;
  for (std::size_t i = 0; i < size(); ++i)
    if (applies(i, recording)) *member[free_[i].quantity] = value(i, u[i]);
  return model;
}

}  // namespace axisfit
