#include "fleet/trend.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "base/distributions.h"
#include "fleet/control_chart.h"

namespace axisfit {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double log_sum(const std::vector<double>& logs) {
  const double most = *std::ranges::max_element(logs);
  double sum = 0.0;
  for (const double l : logs) sum += std::exp(l - most);
  return most + std::log(sum);
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace

const std::vector<double>& scatter_grid() {
  static const std::vector<double> grid = [] {
    std::vector<double> g{0.0};
    // Of a motion without noise the standard errors are tiny: a factor of a hundred thousand.
    for (int j = -1; j <= 17; ++j) g.push_back(std::pow(2.0, j));
    return g;
  }();
  return grid;
}

/// The night between `from` and `to` that begins a new level, with which the squares about two
/// levels are smallest; at(k) gives value and weight. The level before is that of all nights since
/// `learnt`.
template <class At>
std::size_t first_of_two_levels(std::size_t from, std::size_t to, const At& at,
                                std::size_t learnt) {
  const auto squares = [&](std::size_t begin, std::size_t end) {
    double sum = 0.0, weight = 0.0, square = 0.0;
    for (std::size_t k = begin; k < end; ++k) {
      const auto [y, w] = at(k);
      sum += w * y;
      weight += w;
      square += w * y * y;
    }
    return weight > 0.0 ? square - sum * sum / weight : 0.0;
  };
  std::size_t best = from;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = std::max(from, learnt + 1); k <= to; ++k)
    if (const double sum = squares(learnt, k) + squares(k, to + 1); sum < least) {
      least = sum;
      best = k;
    }
  return best;
}

ScatterPrior flat_prior() {
  return ScatterPrior(scatter_grid().size(), -std::log(static_cast<double>(scatter_grid().size())));
}

/// What is learnt with each scatter of the grid.
struct Trend::Filter {
  explicit Filter(const Trend& trend, ScatterPrior prior)
      : trend_(&trend), weights(std::move(prior)) {
    // A channel has an influence of a tenth of the value within its usual range.
    const auto n = static_cast<Index>(1 + trend.channel_means_.size());
    constexpr double kPerChannel = 0.1;
    const double size = trend.is_logarithmic_ ? 1.0 : std::abs(trend.mean()),
                 per_channel = std::max(1.0, kPerChannel * size / trend.usual_error_);
    MatrixXd covariance = MatrixXd::Zero(n, n);
    for (Index j = 1; j < n; ++j) covariance(j, j) = per_channel * per_channel;
    for (std::size_t g = 0; g < scatter_grid().size(); ++g)
      states.push_back({VectorXd::Zero(n), covariance});
  }

  /// One, and the channels from where they were on the first night.
  VectorXd row(std::size_t night, const std::vector<double>& from) const {
    VectorXd h = VectorXd::Ones(static_cast<Index>(1 + from.size()));
    for (std::size_t j = 0; j < from.size(); ++j)
      h[static_cast<Index>(j) + 1] =
          (trend_->nights_[night].channels[j] - from[j]) / trend_->channel_scales_[j];
    return h;
  }

  /// Learns from a night; what share of its prediction was below it, as a normal number. Of the
  /// first there is no prediction.
  double add(std::size_t night) {
    const double error = trend_->errors_[night], y = trend_->y_[night];
    if (!started) {
      started = night;
      for (std::size_t g = 0; g < states.size(); ++g) {
        states[g].mean[0] = y;
        states[g].covariance(0, 0) = error * error + std::pow(scatter_grid()[g], 2);
      }
      return 0.0;
    }
    const VectorXd h = row(night, trend_->nights_[*started].channels);
    const double all = log_sum(weights);
    double below = 0.0;
    for (std::size_t g = 0; g < states.size(); ++g) {
      auto& [mean, covariance] = states[g];
      const VectorXd ph = covariance * h;
      const double own = scatter_grid()[g], variance = h.dot(ph) + error * error + own * own,
                   innovation = y - h.dot(mean);
      below += std::exp(weights[g] - all) * normal_cdf(innovation / std::sqrt(variance));
      weights[g] -= 0.5 * (std::log(variance) + innovation * innovation / variance);
      mean += ph * (innovation / variance);
      covariance -= ph * ph.transpose() / variance;
    }
    constexpr double kLeast = 1e-15;
    return normal_quantile(std::clamp(below, kLeast, 1.0 - kLeast));
  }

  /// What a night has by its channels, as far as that is learnt.
  double by_channels(std::size_t night) const {
    VectorXd h = row(night, trend_->channel_means_);
    h[0] = 0.0;
    const double all = log_sum(weights);
    double sum = 0.0;
    for (std::size_t g = 0; g < states.size(); ++g)
      sum += std::exp(weights[g] - all) * h.dot(states[g].mean);
    return sum;
  }

  /// Mean of tau^2.
  double own_variance() const {
    const double all = log_sum(weights);
    double sum = 0.0;
    for (std::size_t g = 0; g < weights.size(); ++g)
      sum += std::exp(weights[g] - all) * std::pow(scatter_grid()[g], 2);
    return sum;
  }

  struct State {
    VectorXd mean;
    MatrixXd covariance;
  };
  const Trend* trend_;
  std::vector<State> states;
  std::vector<double> weights;         // logarithms
  std::optional<std::size_t> started;  // the first night
};

Trend::Trend(std::vector<TrendNight> nights) : nights_(std::move(nights)) {
  // Where the logarithm has about the error of the value.
  is_logarithmic_ = std::ranges::all_of(
      nights_, [](const TrendNight& n) { return n.value > 5.0 * n.standard_error; });
  for (const TrendNight& n : nights_) {
    y_.push_back(is_logarithmic_ ? std::log(n.value) : n.value);
    errors_.push_back(is_logarithmic_ ? n.standard_error / n.value : n.standard_error);
  }
  if (nights_.empty()) return;
  // From the first night's, in usual standard errors.
  usual_error_ = median(errors_);
  first_ = y_.front();
  for (std::size_t i = 0; i < y_.size(); ++i) {
    y_[i] = (y_[i] - first_) / usual_error_;
    errors_[i] /= usual_error_;
  }
  for (std::size_t j = 0; j < nights_.front().channels.size(); ++j) {
    double sum = 0.0, square = 0.0;
    for (const TrendNight& n : nights_) sum += n.channels[j];
    const double mean = sum / static_cast<double>(nights_.size());
    for (const TrendNight& n : nights_) square += std::pow(n.channels[j] - mean, 2);
    channel_means_.push_back(mean);
    const double scale = std::sqrt(square / static_cast<double>(nights_.size()));
    channel_scales_.push_back(scale > 0.0 ? scale : 1.0);
  }
}

double Trend::mean() const {
  double sum = 0.0, weight = 0.0;
  for (const TrendNight& n : nights_) {
    const double w = 1.0 / (n.standard_error * n.standard_error);
    sum += w * n.value;
    weight += w;
  }
  return sum / weight;
}

std::vector<double> Trend::likelihoods() const {
  Filter filter(*this, ScatterPrior(scatter_grid().size(), 0.0));
  for (std::size_t i = 0; i < nights_.size(); ++i) filter.add(i);
  return filter.weights;
}

std::vector<double> Trend::standardised(const ScatterPrior& prior) const {
  Filter filter(*this, prior);
  std::vector<double> z;
  for (std::size_t i = 0; i < nights_.size(); ++i)
    if (const double next = filter.add(i); i > 0) z.push_back(next);
  return z;
}

std::vector<Change> Trend::changes(const ScatterPrior& prior, double threshold) const {
  std::vector<Change> found;
  Filter filter(*this, prior);
  Cusum chart(threshold);
  std::size_t learnt_from = 0;
  for (std::size_t i = 0; i < nights_.size(); ++i) {
    const double z = filter.add(i);
    if (i == learnt_from || !chart.add(z)) continue;
    Change change;
    change.night = i;
    change.since = i + 1 - std::min(chart.nights_since(), i - learnt_from);
    Filter unchanged(*this, prior);
    for (std::size_t k = learnt_from; k < change.since; ++k) unchanged.add(k);
    const double own = unchanged.own_variance();
    // The sum began to rise before or with the change: the night that divides its nights best.
    change.since = first_of_two_levels(
        change.since, i,
        [&](std::size_t k) {
          return std::pair(y_[k] - unchanged.by_channels(k), 1.0 / (errors_[k] * errors_[k] + own));
        },
        learnt_from);
    const auto mean_of = [&](std::size_t from, std::size_t to) {
      double sum = 0.0, weight = 0.0;
      for (std::size_t k = from; k < to; ++k) {
        const double w = 1.0 / (errors_[k] * errors_[k] + own);
        sum += w * (y_[k] - unchanged.by_channels(k));
        weight += w;
      }
      return std::pair(sum / weight, 1.0 / weight);
    };
    const auto [before, variance_before] = mean_of(learnt_from, change.since);
    const auto [after, variance_after] = mean_of(change.since, i + 1);
    const auto value = [&](double y) {
      const double on_scale = first_ + y * usual_error_;
      return is_logarithmic_ ? std::exp(on_scale) : on_scale;
    };
    change.before = value(before);
    change.after = value(after);
    change.errors = (after - before) / std::sqrt(variance_before + variance_after);
    found.push_back(change);
    // From its first night on the axis is another one.
    filter = Filter(*this, prior);
    for (std::size_t k = change.since; k <= i; ++k) filter.add(k);
    chart.restart();
    learnt_from = change.since;
  }
  for (std::size_t c = 0; c < found.size(); ++c) {
    const std::size_t end = c + 1 < found.size() ? found[c + 1].since : nights_.size();
    const std::size_t from = found[c].since, count = end - from;
    constexpr std::size_t kLeast = 4;
    if (count < kLeast) continue;
    double day = 0.0, level = 0.0, product = 0.0, square = 0.0, rest = 0.0;
    for (std::size_t k = from; k < end; ++k) {
      day += nights_[k].day / static_cast<double>(count);
      level += nights_[k].value / static_cast<double>(count);
    }
    for (std::size_t k = from; k < end; ++k) {
      product += (nights_[k].day - day) * (nights_[k].value - level);
      square += std::pow(nights_[k].day - day, 2);
    }
    if (!(square > 0.0)) continue;
    const double slope = product / square;
    for (std::size_t k = from; k < end; ++k)
      rest += std::pow(nights_[k].value - level - slope * (nights_[k].day - day), 2);
    const double error = std::sqrt(rest / static_cast<double>(count - 2) / square);
    if (std::abs(slope) > 3.0 * error) found[c].per_day = slope;
  }
  return found;
}

ScatterPrior prior_of(const std::vector<Trend>& trends) {
  ScatterPrior prior = flat_prior();
  std::vector<std::vector<double>> likelihoods;
  for (const Trend& trend : trends)
    if (trend.nights().size() > 2) likelihoods.push_back(trend.likelihoods());
  if (likelihoods.empty()) return prior;
  // A share of the flat one stays, so that nothing is excluded.
  constexpr int kSteps = 30;
  constexpr double kFlat = 2.0;
  const std::size_t n = prior.size();
  for (int step = 0; step < kSteps; ++step) {
    std::vector<double> sums(n, kFlat / static_cast<double>(n));
    for (const std::vector<double>& own : likelihoods) {
      std::vector<double> posterior(n);
      for (std::size_t g = 0; g < n; ++g) posterior[g] = prior[g] + own[g];
      const double all = log_sum(posterior);
      for (std::size_t g = 0; g < n; ++g) sums[g] += std::exp(posterior[g] - all);
    }
    const double total = std::accumulate(sums.begin(), sums.end(), 0.0);
    for (std::size_t g = 0; g < n; ++g) prior[g] = std::log(sums[g] / total);
  }
  return prior;
}

}  // namespace axisfit
