#include "sim/ensemble.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>

#include "base/random.h"

namespace axisfit {
namespace {

/// A stream of its own for every draw and use.
std::mt19937_64 generator(std::uint64_t seed, std::size_t k, std::uint32_t use) {
  std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                         static_cast<std::uint32_t>(k), use};
  return std::mt19937_64(sequence);
}

/// Student's t, scaled so that it has the quantiles of a normal variable whose variance was
/// estimated with so many degrees of freedom.
double student(std::mt19937_64& random, double freedom) {
  const double numerator = normal(random);
  double square = 0.0;
  const auto whole = static_cast<int>(std::max(1.0, std::round(std::min(freedom, 1e3))));
  for (int i = 0; i < whole; ++i) square += std::pow(normal(random), 2);
  return numerator / std::sqrt(square / whole);
}

/// How many of them make this part.
std::size_t count_of(double part, std::size_t values) {
  return std::max<std::size_t>(
      1, static_cast<std::size_t>(std::ceil(part * static_cast<double>(values))));
}

/// Puts the smallest of the values, so many, first; returns the largest of those.
double smallest_first(std::vector<double>& values, std::size_t count) {
  const auto last = values.begin() + static_cast<std::ptrdiff_t>(count - 1);
  std::ranges::nth_element(values, last);
  return *last;
}

/// The value that this part of the values do not exceed; the values are put in another order.
double quantile(std::vector<double>& values, double part) {
  return smallest_first(values, count_of(part, values.size()));
}

/// The mean without the largest tenth, which heavy tails would rule.
double usual_size(std::vector<double> values) {
  constexpr double kUsual = 0.9;
  const std::size_t count = count_of(kUsual, values.size());
  smallest_first(values, count);
  return std::accumulate(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count), 0.0) /
         static_cast<double>(count);
}

}  // namespace

AxisEnsemble::AxisEnsemble(const AxisUncertainty& uncertainty, const Structure& structure,
                           std::uint64_t seed)
    : uncertainty_(uncertainty), seed_(seed) {
  const auto n = static_cast<Eigen::Index>(uncertainty.quantities.size());
  if (n > 0) {
    const Eigen::Map<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>> correlation(
        uncertainty.correlation.data(), n, n);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solved(correlation);
    const Eigen::Matrix<double, -1, -1, Eigen::RowMajor> root =
        solved.eigenvectors() * solved.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
    root_.assign(root.data(), root.data() + root.size());
  }
  if (!has_missing_force()) return;
  ChannelList channels = structure.channels ? *structure.channels : ChannelList{};
  if (channels.size() == kChannels)
    throw std::runtime_error(
        "the axis has all the channels that it can have, so that none is left for the force that "
        "the model lacks: a band needs an axis with one channel less");
  channels.push_back({"missing_force", "N", 0.0});
  channels_ = kept(channels);
}

Model<double> AxisEnsemble::axis(const Model<double>& model, std::size_t k) const {
  Model<double> drawn = model;
  std::mt19937_64 random = generator(seed_, k, 0);
  const std::size_t n = uncertainty_.quantities.size();
  std::vector<double> numbers(n);
  for (double& x : numbers) x = normal(random);
  const std::vector<double*> values = members(drawn);
  const std::vector<QuantityEntry>& list = quantity_list(vocabulary_of(model.structure));
  for (std::size_t i = 0; i < n; ++i) {
    const UncertainQuantity& q = uncertainty_.quantities[i];
    double step = q.scatter > 0.0 ? q.scatter * student(random, q.freedom) : 0.0;
    for (std::size_t j = 0; j < n; ++j) step += q.error * root_[i * n + j] * numbers[j];
    const double value = *values[q.quantity];
    const Quantity& range = list[q.quantity].quantity;
    *values[q.quantity] = std::clamp(q.logarithmic ? value * std::exp(step) : value + step,
                                     std::min(value, range.lower), std::max(value, range.upper));
  }
  if (has_missing_force()) {
    drawn.structure.channels = channels_;
    drawn.structure.effects[*effect_named(ChannelForce<double>::name)] = true;
    const std::size_t place = channels_->size() - 1;
    visit_effects(drawn.effects, [&]<class Effect>(std::size_t, Effect& effect) {
      if constexpr (std::is_same_v<Effect, ChannelForce<double>>) effect.k[place] = 1.0;
    });
  }
  return drawn;
}

std::vector<double> AxisEnsemble::missing_force(std::size_t k,
                                                std::span<const double> instants) const {
  std::vector<double> force;
  if (!has_missing_force() || instants.empty()) return force;
  const MissingForceProcess& process = *uncertainty_.missing_force;
  std::mt19937_64 random = generator(seed_, k, 1);
  // It has been acting for a long time.
  constexpr std::size_t kBefore = 2000;
  const double start = instants.front();
  const auto count =
      static_cast<std::size_t>(std::ceil((instants.back() - start) / process.interval)) + 2;
  std::vector<double> course(kBefore + count);
  for (std::size_t i = 0; i < course.size(); ++i) {
    course[i] = process.innovation * normal(random);
    for (std::size_t j = 0; j < std::min(i, process.coefficients.size()); ++j)
      course[i] += process.coefficients[j] * course[i - 1 - j];
  }
  force.reserve(instants.size());
  for (const double t : instants) {
    const double at = (t - start) / process.interval;
    const auto i = std::min(static_cast<std::size_t>(at), count - 2);
    const double part = at - static_cast<double>(i);
    force.push_back((1.0 - part) * course[kBefore + i] + part * course[kBefore + i + 1]);
  }
  return force;
}

std::size_t Band::reach(double tolerance) const {
  return static_cast<std::size_t>(
      std::ranges::find_if(half_width, [&](double w) { return w > tolerance; }) -
      half_width.begin());
}

double Band::median() const {
  std::vector<double> widths = half_width;
  return quantile(widths, 0.5);
}
double Band::largest() const { return std::ranges::max(half_width); }

Band band_of(std::span<const double> prediction, const std::vector<std::vector<double>>& drawn) {
  constexpr double kInside = 0.95;
  const std::size_t samples = prediction.size();
  Band band{std::vector<double>(samples, 0.0), 1.0};
  if (drawn.empty()) return band;
  std::vector<double> distances(drawn.size()), all, largest(drawn.size(), 0.0);
  all.reserve(drawn.size() * samples);
  for (std::size_t i = 0; i < samples; ++i) {
    for (std::size_t k = 0; k < drawn.size(); ++k)
      distances[k] = std::abs(drawn[k][i] - prediction[i]);
    const double usual = usual_size(distances);
    band.half_width[i] = usual;
    if (!(usual > 0.0)) continue;
    for (std::size_t k = 0; k < drawn.size(); ++k) {
      const double relative = distances[k] / usual;
      all.push_back(relative);
      largest[k] = std::max(largest[k], relative);
    }
  }
  if (all.empty()) return band;
  const double factor = quantile(all, kInside);
  for (double& w : band.half_width) w *= factor;
  band.whole = std::max(1.0, quantile(largest, kInside) / factor);
  return band;
}

}  // namespace axisfit
