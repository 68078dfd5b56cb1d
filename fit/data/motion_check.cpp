#include "fit/data/motion_check.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "fit/data/noise.h"
#include "fit/data/recording_check.h"

namespace axisfit {
namespace {

/// The position, or the integral of the velocity; empty without either.
std::vector<double> way_of(const Recording& recording) {
  if (const Measurement* position = recording.find(Signal::position)) return position->values;
  const Measurement* velocity = recording.find(Signal::velocity);
  if (velocity == nullptr) return {};
  std::vector<double> way(recording.times.size(), 0.0);
  for (std::size_t i = 1; i < way.size(); ++i)
    way[i] = way[i - 1] + 0.5 * (velocity->values[i] + velocity->values[i - 1]) *
                              (recording.times[i] - recording.times[i - 1]);
  return way;
}

double mean_of(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double correlation_of(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  const Eigen::VectorXd x = a.array() - a.mean(), y = b.array() - b.mean();
  const double size = x.norm() * y.norm();
  return size > 0.0 ? x.dot(y) / size : 0.0;
}

/// Means over stretches of a recording: of the command, the way, its rate, and the rate of that.
struct Stretches {
  Eigen::VectorXd command, way, speed, acceleration;
  Eigen::VectorXd moves;  ///< one or zero

  Stretches(const Recording& recording, const std::vector<double>& way_there,
            const std::vector<double>& commands) {
    // As many as tell the parts of a motion apart, and long enough for noise not to count.
    constexpr std::size_t kMost = 400, kShortest = 4;
    const std::size_t n = way_there.size(), length = std::max(kShortest, n / kMost);
    const auto count = static_cast<Eigen::Index>((n - 1) / length);
    command.resize(count);
    way.resize(count);
    speed.resize(count);
    acceleration.setZero(count);
    Eigen::VectorXd middle(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const std::size_t from = static_cast<std::size_t>(k) * length, to = from + length;
      command[k] = mean_of(std::span(commands).subspan(from, length));
      way[k] = 0.5 * (way_there[from] + way_there[to]);
      speed[k] = (way_there[to] - way_there[from]) / (recording.times[to] - recording.times[from]);
      middle[k] = 0.5 * (recording.times[from] + recording.times[to]);
    }
    // Rests stay out of the balance: what sticks takes any force.
    constexpr double kRests = 0.01;  // of the largest speed
    moves = (speed.array().abs() > kRests * speed.cwiseAbs().maxCoeff()).cast<double>();
    for (Eigen::Index k = 1; k + 1 < count; ++k) {
      moves[k] *= speed[k - 1] * speed[k + 1] != 0.0 ? 1.0 : 0.0;
      acceleration[k] = (speed[k + 1] - speed[k - 1]) / (middle[k + 1] - middle[k - 1]);
    }
    acceleration = acceleration.cwiseProduct(moves).eval();
  }

  /// What a force in proportion to the command, friction, a weight and a spring or pendulum leave
  /// of the acceleration, and how the command acts.
  struct Balance {
    Eigen::VectorXd rest;
    double gain = 0.0;
  };
  Balance balance(const Eigen::VectorXd& acting) const {
    const Eigen::VectorXd direction = speed.array().sign();
    Eigen::MatrixXd columns(speed.size(), 7);
    columns << acting, direction, speed, Eigen::VectorXd::Ones(speed.size()), way,
        way.array().sin(), way.array().cos();
    columns = moves.asDiagonal() * columns;
    Eigen::VectorXd factors = columns.colPivHouseholderQr().solve(acceleration);
    if (factors[1] > 0.0) {  // it would be no friction
      columns.col(1).setZero();
      factors = columns.colPivHouseholderQr().solve(acceleration);
    }
    return {acceleration - columns * factors, factors[0]};
  }
};

}  // namespace

std::optional<HardStop> hard_stop(const Recording& recording, const std::vector<double>& command) {
  constexpr std::size_t kLeastRest = 25, kWithin = 2;
  constexpr double kEnd = 0.02;         // of the way: stops give
  constexpr double kFast = 0.2;         // of the largest speed
  constexpr double kSudden = 4.0;       // as large as any other change
  constexpr double kRebound = 0.5;      // of the speed
  constexpr double kStillPushes = 0.5;  // of the command before
  const std::vector<double> way = way_of(recording);
  const std::vector<double>& times = recording.times;
  const std::size_t n = way.size();
  if (n < 4 * kLeastRest) return std::nullopt;
  // Long enough for noise not to count, and no longer than the least rest.
  const std::size_t beside = std::clamp<std::size_t>(n / 500, 4, kLeastRest - kWithin - 1);
  const auto [low, high] = std::ranges::minmax(way);
  const double end = way.back();
  // Where noise is more than that, next to nothing moves.
  const double near = kEnd * (high - low);
  if (!(near > 0.0) || (end < high - near && end > low + near)) return std::nullopt;
  const double side = end >= high - near ? 1.0 : -1.0;
  std::size_t arrival = n;
  while (arrival > 0 && std::abs(way[arrival - 1] - end) <= near) --arrival;
  if (n - arrival < kLeastRest || arrival < 2 * beside) return std::nullopt;

  // The speed over some samples before and after a short time.
  const auto rate = [&](std::size_t from) {
    return (way[from + beside] - way[from]) / (times[from + beside] - times[from]);
  };
  const auto drop = [&](std::size_t sample) {
    return side * (rate(sample - beside) - rate(sample + kWithin));
  };
  const std::size_t last = n - beside - kWithin - 1;
  std::size_t stop = arrival - beside;
  for (std::size_t i = stop; i <= last; ++i)
    if (drop(i) > drop(stop)) stop = i;
  double largest_other = 0.0, largest_speed = 0.0;
  for (std::size_t i = beside; i <= last; ++i) {
    largest_speed = std::max(largest_speed, std::abs(rate(i - beside)));
    // A rebound belongs to the stop.
    if (i + 2 * beside < stop) largest_other = std::max(largest_other, std::abs(drop(i)));
  }
  const double before = side * rate(stop - beside), after = side * rate(stop + kWithin);
  if (!(before > kFast * largest_speed) || !(drop(stop) > kSudden * largest_other) ||
      after > 0.25 * before || after < -kRebound * before)
    return std::nullopt;

  if (recording.command.meaning == Meaning::reference) {
    if (side * (command.back() - end) <= near) return std::nullopt;
  } else {
    const std::size_t length = std::min(kLeastRest, stop);
    const double pushed = mean_of(std::span(command).subspan(stop - length, length)),
                 pushes = mean_of(std::span(command).subspan(stop + kWithin, kLeastRest - kWithin));
    // A controller that was braking pushes the other way.
    if (!(std::abs(pushes) > kStillPushes * std::abs(pushed))) return std::nullopt;
  }
  return HardStop{times[stop + 1], times[stop - 1]};
}

bool is_magnitude(const Recording& recording, const std::vector<double>& command) {
  constexpr double kNoSign = 0.01;    // of the largest size: noise about zero
  constexpr double kBothWays = 0.2;   // of the one way, the other
  constexpr double kExplains = 0.5;   // what is left of the acceleration, to what is left otherwise
  constexpr double kLikeSpeed = 0.9;  // correlation of a speed and what commands it
  const std::vector<double> way = way_of(recording);
  if (way.size() < 100 || recording.command.meaning == Meaning::reference) return false;
  const auto [low, high] = std::ranges::minmax(command);
  const double size = std::max(std::abs(low), std::abs(high));
  if (!(high > low) || std::min(std::abs(std::min(low, 0.0)), std::max(high, 0.0)) > kNoSign * size)
    return false;
  const Stretches stretches(recording, way, command);
  const double forth = stretches.speed.cwiseMax(0.0).sum(),
               back = -stretches.speed.cwiseMin(0.0).sum();
  if (std::min(forth, back) < kBothWays * std::max(forth, back)) return false;
  // Where the command is a speed.
  const Eigen::VectorXd sizes = stretches.command.cwiseAbs();
  if (correlation_of(stretches.speed.cwiseAbs(), sizes) > kLikeSpeed &&
      std::abs(correlation_of(stretches.speed, stretches.command)) < 0.5 * kLikeSpeed)
    return true;
  // Where it is a force, in the direction of the motion ...
  const double left = stretches.balance(stretches.command).rest.norm();
  const Eigen::VectorXd directions = stretches.speed.array().sign();
  Eigen::VectorXd acting = sizes.cwiseProduct(directions);
  Stretches::Balance found = stretches.balance(acting);
  if (found.gain > 0.0 && found.rest.norm() < kExplains * left) return true;
  // ... or in one that changes where its size is next to nothing, or jumps.
  constexpr double kSmall = 0.15, kJump = 0.25;  // of the largest size
  const Eigen::Index count = sizes.size();
  std::vector<Eigen::Index> begins{0};
  for (Eigen::Index k = 1; k < count; ++k)
    if (std::min(sizes[k - 1], sizes[k]) < kSmall * size ||
        std::abs(sizes[k] - sizes[k - 1]) > kJump * size)
      begins.push_back(k);
  begins.push_back(count);
  constexpr std::size_t kFewer = 3;  // else there is a direction for whatever happens
  if (kFewer * begins.size() > static_cast<std::size_t>(count)) return false;
  constexpr int kRounds = 10;
  for (int round = 0; round < kRounds; ++round) {
    found = stretches.balance(acting);
    const Eigen::VectorXd unexplained =
        found.rest + found.gain * stretches.moves.cwiseProduct(acting);  // by all but the command
    const Eigen::VectorXd before = acting;
    for (std::size_t s = 0; s + 1 < begins.size(); ++s) {
      const Eigen::Index from = begins[s], length = begins[s + 1] - from;
      const double along =
          (found.gain * sizes.segment(from, length)).dot(unexplained.segment(from, length));
      acting.segment(from, length) = sizes.segment(from, length) * (along < 0.0 ? -1.0 : 1.0);
    }
    if (acting == before) break;
  }
  const double forwards = acting.cwiseMax(0.0).sum(), backwards = -acting.cwiseMin(0.0).sum();
  return std::min(forwards, backwards) > kBothWays * std::max(forwards, backwards) &&
         found.rest.norm() < kExplains * left;
}

}  // namespace axisfit
