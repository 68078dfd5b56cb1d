#include "fit/first_look/first_look.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "base/linear_algebra.h"
#include "fit/first_look/force_balance.h"
#include "fit/first_look/noisy_regression.h"

namespace axisfit {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kShortestWindow = 8, kLongestWindow = 4096;  // samples
/// Logarithm of the likelihood ratio, beyond which a delay is one.
constexpr double kClearlyMore = 10.0;
constexpr std::size_t kMostDelays = 120;  // of the first search
/// s, by which the log of an input may come after the motion, and the part of a range that is its
/// edge.
constexpr double kLatestLog = -0.25, kEdge = 0.9;

/// The delay at which least of the input remains.
double best_delay(const Balance& balance, const NoisyRegression& regression,
                  const std::vector<Grid>& grids, const FirstLookOptions& options) {
  double interval = 0.0, shortest = INFINITY;
  std::size_t samples = 0;
  for (const Balance::Rows& part : balance.parts) {
    interval = std::max(interval, grids[part.grid].interval());
    shortest = std::min(shortest, grids[part.grid].duration());
    samples = part.window.value.size() - 1;
  }
  const auto left = [&](double delay) {
    const VectorXd inputs = balance.inputs(grids, delay);
    return regression.remaining(inputs).squaredNorm() / inputs.squaredNorm();
  };
  const double at_once = left(0.0);
  struct Found {
    double delay, left;
  };
  const auto best_within = [&](double lowest, double highest) {
    double step = std::max({0.125 * interval * static_cast<double>(samples),
                            (highest - lowest) / static_cast<double>(kMostDelays), 0.5 * interval});
    Found best{0.0, at_once};
    const auto look_at = [&](double delay) {
      if (delay < lowest || delay > highest) return;
      if (const double here = left(delay); here < best.left) best = {delay, here};
    };
    for (double delay = step; delay <= highest; delay += step) look_at(delay);
    for (double delay = -step; delay >= lowest; delay -= step) look_at(delay);
    for (; step > 0.02 * interval; step *= 0.5) {
      const double middle = best.delay;
      look_at(middle - 0.5 * step);
      look_at(middle + 0.5 * step);
    }
    return best;
  };
  const double most = 0.5 * shortest, earliest = std::max(options.least_delay, -most),
               latest_log = std::max(kLatestLog, -most);
  Found best = best_within(earliest, std::min(options.longest_delay, most));
  // A log may come later still. What the model lacks prefers as late a one as there may be.
  if (best.delay < kEdge * earliest) {
    const Found late = best_within(latest_log, 0.0);
    if (late.delay > kEdge * latest_log) best = late;
  }
  // A delay that explains hardly more than none does is none: what the model lacks may prefer any.
  const double independent = static_cast<double>(balance.terms.rows()) / (2.0 * kOverlap);
  return independent * std::log(at_once / best.left) > kClearlyMore ? best.delay : 0.0;
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

/// What windows of one length tell.
struct Look {
  FirstLook found;
  double information = 0.0;
  /// Of what friction and constant forces leave of the input, the part that a mass leaves, too.
  double left_by_mass = 1.0;
};

/// None where they tell nothing.
std::optional<Look> look_through(const std::vector<Grid>& grids, std::size_t samples,
                                 bool of_position, const FirstLookOptions& options) {
  Balance balance = balance_in(grids, samples, of_position, options, 0.0);
  leave_out_what_is_alike(balance, grids);
  Look result;
  FirstLook& look = result.found;
  const double interval = grids.front().interval();
  for (double near = 0.0;; near = look.delay.value) {
    if (balance.parts.empty()) return std::nullopt;
    const NoisyRegression regression(balance.terms, balance.noise);
    if (!regression.is_possible()) return std::nullopt;
    look.delay.value = best_delay(balance, regression, grids, options);
    if (std::abs(look.delay.value - near) < interval || near != 0.0) break;
    balance = balance_in(grids, samples, of_position, options, look.delay.value);
    leave_out_what_is_alike(balance, grids);
  }
  look.only_way = only_way_of(balance);
  look.presliding = options.presliding;
  const double delay = look.delay.value, h = 0.5 * interval;
  const VectorXd inputs = balance.inputs(grids, delay);
  const VectorXd left = NoisyRegression(balance.terms, balance.noise).remaining(inputs);
  // Neighbours share most of their samples: a row is worth less than an independent one.
  const double scatter =
      left.norm() / std::sqrt(static_cast<double>(left.size())) * std::sqrt(2.0 * kOverlap);
  const WithDelay all(
      balance, (balance.inputs(grids, delay - h) - balance.inputs(grids, delay + h)) / (2 * h),
      scatter, std::abs(delay) + interval);
  const NoisyRegression regression(all.terms, all.noise);
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
    result.information =
        -static_cast<double>(left.size()) * std::log(std::max(1e-6, look.unexplained));
    return result;
  }
  MatrixXd without_mass = balance.noise;
  without_mass(kMass, kMass) = std::numeric_limits<double>::max();
  result.left_by_mass =
      left.norm() / NoisyRegression(balance.terms, without_mass).remaining(inputs).norm();
  // What the balance does not have may explain all of the input.
  for (Index place = 0; place < 4; ++place) {
    const double most = inputs.norm() / std::max(1e-300, balance.terms.col(place).norm());
    result.information -= std::log(
        regression.has(place) ? std::min(most, std::sqrt(covariance(place, place))) : most);
  }
  return result;
}

bool changes(std::span<const double> values) {
  return std::ranges::adjacent_find(values, std::not_equal_to<>()) != values.end();
}

/// The same look with dry friction that builds up over a travel, where that leaves far less of the
/// input: what else a model lacks makes it a little less.
std::optional<FirstLook> look_at_presliding(std::span<const DrivenMotion> motions,
                                            const std::optional<FirstLook>& at_once,
                                            bool with_gravity) {
  constexpr double kMuch = 0.1, kFarLess = 0.5;
  if (!at_once || at_once->unexplained < kMuch || at_once->only_way != 0.0) return std::nullopt;
  double stroke = 0.0;
  for (const DrivenMotion& motion : motions)
    stroke = std::max(stroke, Grid(motion, !motion.position.empty()).stroke());
  FirstLookOptions options{.with_gravity = with_gravity, .window = at_once->window};
  double travel = 0.0, least = at_once->unexplained;
  const auto try_travel = [&](double tried) {
    options.presliding = tried;
    const auto look = first_look(motions, options);
    if (!look || look->unexplained >= least) return;
    least = look->unexplained;
    travel = tried;
  };
  constexpr int kHalvings = 10;  // to a thousandth of the stroke
  for (int k = 2; k <= kHalvings; ++k) try_travel(stroke * std::exp2(-k));
  if (travel == 0.0) return std::nullopt;
  for (const double step : {0.5, 0.25, 0.125, 0.0625}) {
    const double middle = travel;
    try_travel(middle * std::exp2(step));
    try_travel(middle * std::exp2(-step));
  }
  if (!(least < kFarLess * at_once->unexplained)) return std::nullopt;
  return first_look(motions, {.with_gravity = with_gravity, .presliding = travel});
}

}  // namespace

std::optional<FirstLook> first_look(std::span<const DrivenMotion> motions,
                                    const FirstLookOptions& options) {
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
      const double length = static_cast<double>(samples) * grids.front().interval();
      if (options.window > 0.0 && std::abs(length / options.window - 1.0) > 0.1) continue;
      if (const auto look = look_through(grids, samples, of_position, options))
        looks.push_back(*look);
    }
  }
  // Where short windows, or the other signal, leave clearly more, they show what a mass is not.
  // Unless a mass explains most of what they show: at a speed that hardly changes on the whole,
  // long windows leave little because friction takes all of their input.
  constexpr double kClearly = 1.15, kHardlyAnything = 0.02, kMostOfIt = 0.5;
  double least = INFINITY, least_by_mass = kMostOfIt, most = -INFINITY;
  for (const Look& look : looks) {
    least = std::min(least, look.found.unexplained);
    least_by_mass = std::min(least_by_mass, look.left_by_mass);
  }
  std::optional<FirstLook> best;
  for (const Look& look : looks) {
    const auto is_worse = [](double left, double least_left) {
      return left > kClearly * least_left + kHardlyAnything;
    };
    const bool is_clearly_worse =
        is_worse(look.found.unexplained, least) && is_worse(look.left_by_mass, least_by_mass);
    if ((is_clearly_worse && !options.by_evidence) || !(look.information > most)) continue;
    most = look.information;
    best = look.found;
  }
  return best;
}

std::optional<FirstLook> first_look(std::span<const DrivenMotion> motions, Joint joint) {
  const auto plain = first_look(motions);
  const auto with_presliding = [&](const std::optional<FirstLook>& at_once, bool with_gravity) {
    const auto building_up = look_at_presliding(motions, at_once, with_gravity);
    return building_up ? building_up : at_once;
  };
  if (joint != Joint::revolute) return with_presliding(plain, false);
  const auto with_gravity = first_look(motions, {.with_gravity = true});
  constexpr double kClearlyLess = 0.8;
  const bool hangs =
      with_gravity && (!plain || with_gravity->unexplained < kClearlyLess * plain->unexplained);
  // What hangs free may be what bends before it slips.
  const auto bends = with_presliding(plain, false);
  if (hangs && bends && bends->presliding > 0.0 && bends->unexplained < with_gravity->unexplained)
    return bends;
  return hangs ? with_presliding(with_gravity, true) : bends;
}

}  // namespace axisfit
