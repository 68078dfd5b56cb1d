#include "fit/first_look/first_look.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "base/linear_algebra.h"
#include "fit/data/derivative.h"
#include "fit/data/noise.h"
#include "sim/sampling.h"

namespace axisfit {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Places of the regressors.
enum Place : Index { kMass, kViscous, kCoulomb, kConstant, kSine, kCosine };

constexpr std::size_t kShortestWindow = 8, kLongestWindow = 4096;  // samples
constexpr std::size_t kWindowsPerMotion = 8;                       // at least
constexpr std::size_t kMostWindows = 4000;  // of a recording, which bounds the time
constexpr std::size_t kOverlap = 4;         // windows over each sample
/// Logarithm of the likelihood ratio, beyond which a delay is one.
constexpr double kClearlyMore = 10.0;
constexpr std::size_t kMostDelays = 120;  // of the first search
/// Part of a window that may be at rest, where friction has any value.
constexpr double kMostRest = 0.3;
/// Of the highest speed, that counts as rest.
constexpr double kRest = 0.005;
/// Standard deviations of its noise below which a speed has no sign.
constexpr double kSpeedErrors = 3.0;

/// A window (1 - s^2)^4 on s from -1 to 1, and its derivatives by the time, at even samples.
struct Window {
  explicit Window(std::size_t samples, double interval) {
    const double half = 0.5 * interval * static_cast<double>(samples);
    for (std::size_t i = 0; i <= samples; ++i) {
      const double s = 2.0 * static_cast<double>(i) / static_cast<double>(samples) - 1.0;
      const double r = 1.0 - s * s;
      value.push_back(std::pow(r, 4) * interval);
      slope.push_back(-8.0 * s * std::pow(r, 3) / half * interval);
      bend.push_back((-8.0 * std::pow(r, 3) + 48.0 * s * s * r * r) / (half * half) * interval);
    }
    // Sums over few samples are no integrals: a constant speed and a constant acceleration must
    // come out as they are.
    double area = 0.0, ramp = 0.0, parabola = 0.0, mean = 0.0;
    for (const double x : bend) mean += x / static_cast<double>(bend.size());
    for (std::size_t i = 0; i <= samples; ++i) {
      const double t = half * (2.0 * static_cast<double>(i) / static_cast<double>(samples) - 1.0);
      bend[i] -= mean;
      area += value[i];
      ramp -= slope[i] * t;
      parabola += 0.5 * bend[i] * t * t;
    }
    for (double& x : slope) x *= area / ramp;
    for (double& x : bend) x *= area / parabola;
  }
  std::vector<double> value, slope, bend;  ///< times the interval, so that sums are integrals
};

/// One recording on an even grid.
class Grid {
 public:
  Grid(const DrivenMotion& motion, bool of_position) : motion_(motion), of_position_(of_position) {
    count_ = motion.times.size();
    interval_ = mean_interval(motion.times);
    const std::span<const double> readings = of_position ? motion.position : motion.velocity;
    values_ = on_even_grid(motion.times, readings);
    // What a column says of a motion that it was rounded to is no better than its steps.
    noise_ = std::max(noise_from_differences(readings), resolution_of(readings) / std::sqrt(12.0));
    if (!motion.position.empty()) positions_ = on_even_grid(motion.times, motion.position);
  }

  double interval() const { return interval_; }
  std::size_t count() const { return count_; }
  double duration() const { return interval_ * static_cast<double>(count_ - 1); }

  /// The speed about each sample, and the standard deviation of its noise.
  std::vector<double> speeds(std::size_t samples, double& noise) const {
    const auto reach = std::max<std::size_t>(1, samples / 8);
    std::vector<double> speed(count_, 0.0);
    const double width = 2.0 * static_cast<double>(reach) + (of_position_ ? 0.0 : 1.0);
    double sum = 0.0;
    if (of_position_) {
      for (std::size_t i = 0; i < count_; ++i) {
        const std::size_t a = i - std::min(i, reach), b = std::min(count_ - 1, i + reach);
        speed[i] = (values_[b] - values_[a]) / (static_cast<double>(b - a) * interval_);
      }
      noise = std::sqrt(2.0) * noise_ / (width * interval_);
      return speed;
    }
    for (std::size_t i = 0; i < count_ + reach; ++i) {
      if (i < count_) sum += values_[i];
      if (i > 2 * reach) sum -= values_[i - 2 * reach - 1];
      if (i >= reach)
        speed[i - reach] =
            sum / static_cast<double>(std::min(i, count_ - 1) - (i - std::min(i, 2 * reach)) + 1);
    }
    noise = noise_ / std::sqrt(width);
    return speed;
  }

  std::vector<double> input(double delay) const {
    return on_even_grid(motion_.times, motion_.input, delay);
  }
  const std::vector<double>& values() const { return values_; }
  const std::vector<double>& positions() const { return positions_; }
  double noise() const { return noise_; }

 private:
  DrivenMotion motion_;
  bool of_position_;
  std::size_t count_ = 0;
  double interval_ = 0.0, noise_ = 0.0;
  std::vector<double> values_, positions_;
};

/// The balance in windows of one length: its regressors, and the input in the same windows.
struct Balance {
  MatrixXd terms;
  MatrixXd noise;  ///< what noise of the readings adds to terms' terms, on average
  struct Rows {
    std::size_t grid = 0;
    std::vector<std::size_t> first;  ///< samples with which the windows begin
    Index row = 0;
    Window window;
    Index lags = 0;  ///< neighbours that share samples with a window
  };
  std::vector<Rows> parts;
  double mean_square_speed = 0.0, mean_speed = 0.0;

  VectorXd inputs(const std::vector<Grid>& grids, double delay) const {
    VectorXd result(terms.rows());
    for (const Rows& part : parts) {
      const std::vector<double> input = grids[part.grid].input(delay);
      for (std::size_t k = 0; k < part.first.size(); ++k) {
        double sum = 0.0;
        for (std::size_t i = 0; i < part.window.value.size(); ++i)
          sum += part.window.value[i] * input[part.first[k] + i];
        result[part.row + static_cast<Index>(k)] = sum;
      }
    }
    return result;
  }
};

/// Windows whose input, so much earlier, was not recorded are left out.
Balance balance_in(const std::vector<Grid>& grids, std::size_t samples, bool of_position,
                   bool with_gravity, double delay) {
  Balance balance;
  const Index terms = with_gravity ? 6 : 4;
  balance.noise = MatrixXd::Zero(terms, terms);
  std::vector<double> rows;  // one after the other
  double speed_samples = 0.0;
  for (std::size_t g = 0; g < grids.size(); ++g) {
    const Grid& grid = grids[g];
    if (grid.count() < kWindowsPerMotion / 2 * samples) continue;
    Balance::Rows part{
        g, {}, static_cast<Index>(rows.size()) / terms, Window(samples, grid.interval()), 0};
    const std::size_t step =
        std::max({std::size_t{1}, samples / kOverlap, (grid.count() - samples) / kMostWindows});
    part.lags = static_cast<Index>(samples / step) * 2;
    double speed_noise = 0.0;
    const std::vector<double> speed = grid.speeds(samples, speed_noise);
    double fastest = 0.0;
    for (const double v : speed) fastest = std::max(fastest, std::abs(v));
    const double least = std::max({kSpeedErrors * speed_noise, kRest * fastest, 1e-300});
    std::vector<double> sign(speed.size());
    for (std::size_t i = 0; i < speed.size(); ++i)
      sign[i] = std::clamp(speed[i] / least, -1.0, 1.0);
    double bend_square = 0.0, slope_square = 0.0, value_square = 0.0;
    const Window& w = part.window;
    for (std::size_t i = 0; i <= samples; ++i) {
      bend_square += w.bend[i] * w.bend[i];
      slope_square += w.slope[i] * w.slope[i];
      value_square += w.value[i] * w.value[i];
    }
    const double variance = grid.noise() * grid.noise();
    for (std::size_t first = 0; first + samples < grid.count(); first += step) {
      if (static_cast<double>(first) * grid.interval() < delay ||
          static_cast<double>(first + samples) * grid.interval() > grid.duration() + delay)
        continue;
      std::size_t at_rest = 0;
      double mass = 0.0, viscous = 0.0, coulomb = 0.0, constant = 0.0, sine = 0.0, cosine = 0.0;
      const double middle = of_position ? grid.values()[first + samples / 2] : 0.0;
      for (std::size_t i = 0; i <= samples; ++i) {
        const std::size_t at = first + i;
        const double x = grid.values()[at] - middle;
        if (of_position) {
          mass += w.bend[i] * x;
          viscous -= w.slope[i] * x;
        } else {
          mass -= w.slope[i] * x;
          viscous += w.value[i] * x;
        }
        coulomb += w.value[i] * sign[at];
        constant += w.value[i];
        if (with_gravity) {
          sine += w.value[i] * std::sin(grid.positions()[at]);
          cosine += w.value[i] * std::cos(grid.positions()[at]);
        }
        at_rest += std::abs(speed[at]) < least ? 1 : 0;
      }
      if (static_cast<double>(at_rest) > kMostRest * static_cast<double>(samples)) continue;
      part.first.push_back(first);
      for (const double x : {mass, viscous, coulomb, constant}) rows.push_back(x);
      if (with_gravity)
        for (const double x : {sine, cosine}) rows.push_back(x);
      balance.noise(kMass, kMass) += variance * (of_position ? bend_square : slope_square);
      balance.noise(kViscous, kViscous) += variance * (of_position ? slope_square : value_square);
    }
    for (const double v : speed) {
      balance.mean_square_speed += v * v;
      balance.mean_speed += std::abs(v);
    }
    speed_samples += static_cast<double>(speed.size());
    if (!part.first.empty()) balance.parts.push_back(std::move(part));
  }
  balance.mean_square_speed /= std::max(1.0, speed_samples);
  balance.mean_speed /= std::max(1.0, speed_samples);
  balance.terms = Eigen::Map<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>(
      rows.data(), static_cast<Index>(rows.size()) / terms, terms);
  return balance;
}

/// A regression with the noise of the regressors subtracted. A regressor that is mostly noise, or
/// that others make, is left out.
class Regression {
 public:
  Regression(const MatrixXd& terms, const MatrixXd& noise) : terms_(terms), noise_(noise) {
    const MatrixXd& a = terms;
    const VectorXd scale = a.colwise().norm();
    if (a.rows() < 4 * a.cols()) return;
    std::vector<Index> kept;
    for (Index i = 0; i < a.cols(); ++i)
      if (scale[i] > 0.0 && noise(i, i) < kMostNoise * scale[i] * scale[i]) kept.push_back(i);
    while (!kept.empty() && !invert(kept, scale)) std::erase(kept, most_dependent(kept, scale));
    is_possible_ = !kept.empty();
  }

  bool is_possible() const { return is_possible_; }
  bool has(Index place) const { return inverse_(place, place) > 0.0; }
  VectorXd solve(const VectorXd& inputs) const { return inverse_ * (terms_.transpose() * inputs); }
  VectorXd remaining(const VectorXd& inputs) const { return inputs - terms_ * solve(inputs); }

  /// The covariance of a solution, which allows for the autocorrelation of what remains: windows
  /// share samples (W. K. Newey and K. D. West, Econometrica 55, 1987).
  MatrixXd covariance(const VectorXd& remaining, const VectorXd& inputs,
                      const std::vector<Balance::Rows>& parts) const {
    const MatrixXd& a = terms_;
    // No recording is that of one mass to more digits than these.
    MatrixXd middle = std::pow(kLeastLeft, 2) * inputs.squaredNorm() /
                      static_cast<double>(inputs.size()) * (a.transpose() * a);
    for (const Balance::Rows& part : parts) {
      const auto n = static_cast<Index>(part.first.size());
      MatrixXd weighted = a.middleRows(part.row, n);
      weighted.array().colwise() *= remaining.segment(part.row, n).array();
      for (Index lag = 0; lag <= std::min(part.lags, n - 1); ++lag) {
        const double weight = 1.0 - static_cast<double>(lag) / static_cast<double>(part.lags + 1);
        const MatrixXd product =
            weighted.bottomRows(n - lag).transpose() * weighted.topRows(n - lag);
        middle += (lag == 0 ? 0.5 : 1.0) * weight * (product + product.transpose());
      }
    }
    return inverse_ * middle * inverse_;
  }

 private:
  static constexpr double kMostNoise = 0.5;  ///< of a regressor's sum of squares
  static constexpr double kLeastOwn = 1e-6;  ///< of a regressor's, that others do not make
  static constexpr double kLeastLeft = 1e-3;

  MatrixXd normal(const std::vector<Index>& kept, const VectorXd& scale) const {
    const VectorXd inverse = scale(kept).cwiseInverse();
    const MatrixXd a = terms_(Eigen::all, kept) * inverse.asDiagonal();
    return a.transpose() * a -
           MatrixXd(inverse.asDiagonal() * noise_(kept, kept) * inverse.asDiagonal());
  }

  /// False: these regressors depend on each other.
  bool invert(const std::vector<Index>& kept, const VectorXd& scale) {
    const auto n = static_cast<Index>(kept.size());
    const Eigen::LDLT<MatrixXd> solver(normal(kept, scale));
    if (solver.info() != Eigen::Success || !solver.isPositive() ||
        solver.vectorD().minCoeff() < kLeastOwn)
      return false;
    const VectorXd inverse = scale(kept).cwiseInverse();
    inverse_ = MatrixXd::Zero(scale.size(), scale.size());
    inverse_(kept, kept) =
        inverse.asDiagonal() * solver.solve(MatrixXd::Identity(n, n)) * inverse.asDiagonal();
    return true;
  }

  /// The one of these of which the others leave the least.
  Index most_dependent(const std::vector<Index>& kept, const VectorXd& scale) const {
    const MatrixXd squares = normal(kept, scale);
    Index worst = kept.front();
    double least = INFINITY;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      std::vector<Index> others;
      for (std::size_t k = 0; k < kept.size(); ++k)
        if (k != i) others.push_back(static_cast<Index>(k));
      const auto at = static_cast<Index>(i);
      const VectorXd with = squares(others, at);
      const double own =
          others.empty() ? squares(at, at)
                         : squares(at, at) - with.dot(squares(others, others).ldlt().solve(with));
      if (own < least) {
        least = own;
        worst = kept[i];
      }
    }
    return worst;
  }

  const MatrixXd& terms_;
  const MatrixXd& noise_;
  MatrixXd inverse_;
  bool is_possible_ = false;
};

/// The delay at which least of the input remains.
double best_delay(const Balance& balance, const Regression& regression,
                  const std::vector<Grid>& grids, const FirstLookOptions& options) {
  double interval = 0.0, shortest = INFINITY;
  std::size_t samples = 0;
  for (const Balance::Rows& part : balance.parts) {
    interval = std::max(interval, grids[part.grid].interval());
    shortest = std::min(shortest, grids[part.grid].duration());
    samples = part.window.value.size() - 1;
  }
  const double lowest = std::max(options.least_delay, -0.5 * shortest),
               highest = std::min(options.longest_delay, 0.5 * shortest);
  const auto left = [&](double delay) {
    const VectorXd inputs = balance.inputs(grids, delay);
    return regression.remaining(inputs).squaredNorm() / inputs.squaredNorm();
  };
  double step = std::max({0.125 * interval * static_cast<double>(samples),
                          (highest - lowest) / static_cast<double>(kMostDelays), 0.5 * interval});
  double best = 0.0, least = left(0.0);
  const auto look_at = [&](double delay) {
    if (delay < lowest || delay > highest) return;
    if (const double here = left(delay); here < least) {
      least = here;
      best = delay;
    }
  };
  const double at_once = least;
  for (double delay = step; delay <= highest; delay += step) look_at(delay);
  for (double delay = -step; delay >= lowest; delay -= step) look_at(delay);
  for (; step > 0.02 * interval; step *= 0.5) {
    const double middle = best;
    look_at(middle - 0.5 * step);
    look_at(middle + 0.5 * step);
  }
  // A delay that explains hardly more than none does is none: what the model lacks may prefer any.
  const double independent = static_cast<double>(balance.terms.rows()) / (2.0 * kOverlap);
  return independent * std::log(at_once / least) > kClearlyMore ? best : 0.0;
}

FirstLook::Direction direction_of(const FirstLook& look) {
  using enum FirstLook::Direction;
  constexpr double kSure = FirstLook::kSure;
  constexpr double kDoubt = 0.1;  // of the one's distance from zero, at which the other counts
  const double friction = look.dissipation.distance(), mass = look.mass.distance();
  if (friction > kSure) return along;
  if (friction < -kSure && look.only_way != 0.0) return mass > kSure ? along : open;
  if (friction < -kSure) return mass > std::max(kSure, -kDoubt * friction) ? open : turned;
  if (std::abs(mass) > kSure && look.is_mass_noticeable()) return mass > 0.0 ? along : turned;
  return open;
}

/// The balance with the delay as one more unknown, so that errors allow for it.
struct WithDelay {
  MatrixXd terms, noise;

  /// One more row says that a log is rarely late by more than a sample, or than it was found to be.
  WithDelay(const Balance& balance, const VectorXd& slope, double left, double usual)
      : terms(balance.terms.rows() + 1, balance.terms.cols() + 1),
        noise(MatrixXd::Zero(terms.cols(), terms.cols())) {
    const Index rows = balance.terms.rows(), columns = balance.terms.cols();
    terms.topLeftCorner(rows, columns) = balance.terms;
    terms.topRightCorner(rows, 1) = slope;
    terms.bottomRows(1).setZero();
    terms(rows, columns) = left / usual;
    noise.topLeftCorner(columns, columns) = balance.noise;
  }
};

/// Steps of one size, each in its direction, are as good as dry friction and nothing else: then it
/// cannot be told from what makes the motion, and is left out.
void leave_out_dry_friction(Balance& balance, const std::vector<Grid>& grids) {
  constexpr double kAllOfIt = 0.05;
  const MatrixXd dry = balance.terms(Eigen::all, std::vector<Index>{kCoulomb, kConstant});
  const VectorXd inputs = balance.inputs(grids, 0.0);
  const VectorXd left = inputs - dry * LeastSquaresSolver(dry).solve(inputs);
  if (left.norm() < kAllOfIt * inputs.norm())
    balance.noise(kCoulomb, kCoulomb) = std::numeric_limits<double>::max();
}

/// 1 or -1 where all motions go that way only, otherwise zero.
double only_way_of(const Balance& balance) {
  constexpr double kPart = 0.02;  // less than that is noise, or where an axis comes to rest
  bool any_forward = false, any_back = false;
  for (const Balance::Rows& part : balance.parts) {
    const auto speeds =
        balance.terms.col(kViscous).segment(part.row, static_cast<Index>(part.first.size()));
    const double forward = speeds.cwiseMax(0.0).sum(), back = -speeds.cwiseMin(0.0).sum();
    any_forward = any_forward || forward > kPart * back;
    any_back = any_back || back > kPart * forward;
  }
  return any_forward && any_back ? 0.0 : any_forward ? 1.0 : any_back ? -1.0 : 0.0;
}

/// What of friction and constant force cannot be told from the others.
void leave_out_what_is_alike(Balance& balance, const std::vector<Grid>& grids) {
  if (balance.parts.empty()) return;
  leave_out_dry_friction(balance, grids);
  if (only_way_of(balance) != 0.0)
    balance.noise(kConstant, kConstant) = std::numeric_limits<double>::max();
}

/// What windows of one length tell; none where they tell nothing.
std::optional<FirstLook> look_through(const std::vector<Grid>& grids, std::size_t samples,
                                      bool of_position, const FirstLookOptions& options,
                                      double& information) {
  Balance balance = balance_in(grids, samples, of_position, options.with_gravity, 0.0);
  leave_out_what_is_alike(balance, grids);
  FirstLook look;
  const double interval = grids.front().interval();
  for (double near = 0.0;; near = look.delay.value) {
    if (balance.parts.empty()) return std::nullopt;
    const Regression regression(balance.terms, balance.noise);
    if (!regression.is_possible()) return std::nullopt;
    look.delay.value = best_delay(balance, regression, grids, options);
    if (std::abs(look.delay.value - near) < interval || near != 0.0) break;
    balance = balance_in(grids, samples, of_position, options.with_gravity, look.delay.value);
    leave_out_what_is_alike(balance, grids);
  }
  look.only_way = only_way_of(balance);
  const double delay = look.delay.value, h = 0.5 * interval;
  const VectorXd inputs = balance.inputs(grids, delay);
  const VectorXd left = Regression(balance.terms, balance.noise).remaining(inputs);
  // Neighbours share most of their samples: a row is worth less than an independent one.
  const double scatter =
      left.norm() / std::sqrt(static_cast<double>(left.size())) * std::sqrt(2.0 * kOverlap);
  const WithDelay all(
      balance, (balance.inputs(grids, delay - h) - balance.inputs(grids, delay + h)) / (2 * h),
      scatter, std::abs(delay) + interval);
  const Regression regression(all.terms, all.noise);
  if (!regression.is_possible()) return std::nullopt;
  VectorXd inputs_and_prior(inputs.size() + 1), left_and_prior(inputs.size() + 1);
  inputs_and_prior << inputs, 0.0;
  const VectorXd found = regression.solve(inputs_and_prior);
  left_and_prior << left, scatter;
  std::vector<Balance::Rows> parts = balance.parts;
  Balance::Rows& prior = parts.emplace_back(parts.front());
  prior.row = inputs.size();
  prior.first = {0};
  const MatrixXd covariance = regression.covariance(left_and_prior, inputs_and_prior, parts);
  const auto estimated = [&](Index place) {
    return regression.has(place)
               ? FirstLook::Term{found[place], std::sqrt(covariance(place, place))}
               : FirstLook::Term{};
  };
  look.mass = estimated(kMass);
  look.viscous = estimated(kViscous);
  look.coulomb = estimated(kCoulomb);
  look.constant = estimated(kConstant);
  if (options.with_gravity) {
    look.gravity_sine = estimated(kSine);
    look.gravity_cosine = estimated(kCosine);
  }
  const Index last = found.size() - 1;
  look.delay.error = regression.has(last) ? std::sqrt(covariance(last, last)) : INFINITY;
  VectorXd power = VectorXd::Zero(found.size());
  power[kViscous] = balance.mean_square_speed;
  power[kCoulomb] = balance.mean_speed;
  look.dissipation = {power.dot(found), std::sqrt(power.dot(covariance * power))};
  look.largest_mass = inputs.norm() / std::max(1e-300, balance.terms.col(kMass).norm());
  look.unexplained = left.norm() / inputs.norm();
  look.window = static_cast<double>(samples) * interval;
  look.direction = direction_of(look);
  if (options.by_evidence) {
    information = -static_cast<double>(left.size()) * std::log(std::max(1e-6, look.unexplained));
    return look;
  }
  // What the balance does not have may explain all of the input.
  information = 0.0;
  for (Index place = 0; place < 4; ++place) {
    const double most = inputs.norm() / std::max(1e-300, balance.terms.col(place).norm());
    information -= std::log(
        regression.has(place) ? std::min(most, std::sqrt(covariance(place, place))) : most);
  }
  return look;
}

bool changes(std::span<const double> values) {
  return std::ranges::adjacent_find(values, std::not_equal_to<>()) != values.end();
}

}  // namespace

std::optional<FirstLook> first_look(std::span<const DrivenMotion> motions,
                                    const FirstLookOptions& options) {
  struct Look {
    FirstLook found;
    double information;
  };
  std::vector<Look> looks;
  for (const bool of_position : {true, false}) {
    std::vector<Grid> grids;
    std::size_t longest = 0;
    for (const DrivenMotion& motion : motions) {
      const std::span<const double> readings = of_position ? motion.position : motion.velocity;
      if (readings.empty() || (options.with_gravity && motion.position.empty()) ||
          !changes(readings) || !changes(motion.input))
        continue;
      grids.emplace_back(motion, of_position);
      longest = std::max(longest, motion.times.size());
    }
    for (std::size_t samples = kShortestWindow;
         samples <= std::min(kLongestWindow, longest / kWindowsPerMotion); samples *= 2) {
      double information = 0.0;
      if (const auto look = look_through(grids, samples, of_position, options, information))
        looks.push_back({*look, information});
    }
  }
  // Where short windows, or the other signal, leave clearly more, they show what a mass is not.
  constexpr double kClearly = 1.15, kHardlyAnything = 0.02;
  double least = INFINITY, most = -INFINITY;
  for (const Look& look : looks) least = std::min(least, look.found.unexplained);
  std::optional<FirstLook> best;
  for (const Look& look : looks) {
    const bool is_clearly_worse = look.found.unexplained > kClearly * least + kHardlyAnything;
    if ((is_clearly_worse && !options.by_evidence) || !(look.information > most)) continue;
    most = look.information;
    best = look.found;
  }
  return best;
}

std::optional<FirstLook> first_look(std::span<const DrivenMotion> motions, Joint joint) {
  const auto plain = first_look(motions);
  if (joint != Joint::revolute) return plain;
  const auto with_gravity = first_look(motions, {.with_gravity = true});
  constexpr double kClearlyLess = 0.8;
  return with_gravity && (!plain || with_gravity->unexplained < kClearlyLess * plain->unexplained)
             ? with_gravity
             : plain;
}

}  // namespace axisfit
