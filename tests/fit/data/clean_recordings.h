// Recordings of axes that have nothing wrong, by a simulation that shares nothing with the
// project's: one mass with friction, weight and a pendulum's torque in steps of a fixed size.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "base/random.h"
#include "fit/data/job.h"
#include "fit/data/noise.h"

namespace axisfit::clean {

/// A mass (kg) on which a drive acts with a force (N).
struct Plant {
  double mass = 1.0;
  double viscous = 0.5;    ///< N s/m
  double coulomb = 0.2;    ///< N
  double breakaway = 0.2;  ///< N, from rest
  double weight = 0.0;     ///< N, in the negative direction
  double swing = 0.0;      ///< N, times the sine of the position: of a pendulum
  double stop = std::numeric_limits<double>::infinity();  ///< m, where a hard stop is
};

/// The motion at the sample times.
struct Course {
  double interval = 1e-3;  ///< s
  std::vector<double> force{}, position{}, velocity{}, acceleration{};

  std::size_t samples() const { return force.size(); }
};

/// Moves the plant for so many samples with `force(t, x, v)`, N, which holds for one sample.
template <class Force>
Course moved(const Plant& plant, double interval, std::size_t samples, Force force) {
  Course course{interval};
  const auto steps = static_cast<std::size_t>(std::ceil(interval / 2e-4));
  const double h = interval / static_cast<double>(steps);
  double x = 0.0, v = 0.0;
  for (std::size_t i = 0; i < samples; ++i) {
    const double u = force(interval * static_cast<double>(i), x, v);
    const auto net = [&] {  // without the dry friction
      return u - plant.viscous * v - plant.weight - plant.swing * std::sin(x);
    };
    const bool rests = v == 0.0 && std::abs(net()) <= plant.breakaway;
    const double direction = v != 0.0 ? v : net();
    course.force.push_back(u);
    course.position.push_back(x);
    course.velocity.push_back(v);
    course.acceleration.push_back(
        rests || x >= plant.stop ? 0.0
                                 : (net() - std::copysign(plant.coulomb, direction)) / plant.mass);
    for (std::size_t k = 0; k < steps; ++k) {
      const double f = net();
      if (v == 0.0 && std::abs(f) <= plant.breakaway) continue;
      const double before = v;
      v += h * (f - std::copysign(plant.coulomb, v != 0.0 ? v : f)) / plant.mass;
      if (before * v < 0.0) v = 0.0;  // it stops, and the next step decides whether it stays
      x += h * v;
      if (x >= plant.stop) std::tie(x, v) = std::pair(plant.stop, std::min(v, 0.0));
    }
  }
  return course;
}

/// Draws that are the same on every machine.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : generator_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * axisfit::uniform(generator_);
  }
  double logarithmic(double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  }
  double normal() { return axisfit::normal(generator_); }
  std::size_t index(std::size_t n) {
    return std::min(n - 1, static_cast<std::size_t>(uniform(0.0, static_cast<double>(n))));
  }
  bool chance(double p) { return axisfit::uniform(generator_) < p; }

 private:
  std::mt19937_64 generator_;
};

inline double size_of(const std::vector<double>& values) {
  const auto [low, high] = std::ranges::minmax(values);
  return high - low;
}

inline std::vector<double> rounded(std::vector<double> values, double step) {
  for (double& x : values) x = step * std::floor(x / step);
  return values;
}

inline std::vector<double> noisy(std::vector<double> values, double sigma, Dice& dice) {
  for (double& x : values) x += sigma * dice.normal();
  return values;
}

/// What a drive computes from its encoder.
inline std::vector<double> differences(const std::vector<double>& position, double interval) {
  std::vector<double> rate(position.size(), 0.0);
  for (std::size_t i = 1; i < position.size(); ++i)
    rate[i] = (position[i] - position[i - 1]) / interval;
  return rate;
}

inline void add(Recording& recording, Signal signal, std::vector<double> values) {
  Measurement& m = recording.measurements.emplace_back();
  m.signal = signal;
  m.values = std::move(values);
  m.sigma = std::max(1e-12, noise_from_differences(m));
}

/// The times and the command of a motion, without measurements.
inline Recording with_command(const Course& course, const std::vector<double>& command,
                              Hold hold = Hold::zero_order) {
  Recording recording;
  std::vector<double> times;
  for (std::size_t i = 0; i < course.samples(); ++i)
    times.push_back(course.interval * static_cast<double>(i));
  recording.command = schedule_from_samples(times, command, hold);
  recording.times = std::move(times);
  return recording;
}

/// What a seed stands for, for messages.
struct Clean {
  std::string name;
  Course course;
  Recording recording;
};

constexpr std::array kMotions{"steps", "ramps", "tone", "chirp", "PRBS", "moves", "stiction"};

/// A motion of a plant with a duration of several hundred to several thousand samples.
inline Course motion(std::size_t kind, Dice& dice) {
  Plant plant;
  plant.mass = dice.logarithmic(0.02, 200.0);
  const double scale = plant.mass * dice.logarithmic(0.5, 20.0);  // N, of the command
  plant.viscous = plant.mass * dice.logarithmic(0.2, 20.0);
  plant.coulomb = scale * dice.uniform(0.02, 0.25);
  plant.breakaway = plant.coulomb * dice.uniform(1.0, 1.6);
  if (dice.chance(0.25)) plant.weight = scale * dice.uniform(-0.15, 0.15);
  const bool pendulum = dice.chance(0.25);
  if (pendulum) plant.swing = plant.mass * 9.81 * dice.uniform(0.5, 1.5);
  const double interval = 1.0 / dice.logarithmic(100.0, 1e4);
  const auto samples =
      static_cast<std::size_t>(std::clamp(dice.logarithmic(2.0, 20.0) / interval, 700.0, 12000.0));
  const double duration = interval * static_cast<double>(samples);

  if (kind == 0) {  // levels with rests between them
    std::vector<double> levels;
    for (std::size_t k = 0; k < 6 + dice.index(10); ++k)
      levels.push_back(dice.chance(0.3) ? 0.0 : scale * dice.uniform(-1.0, 1.0));
    levels.back() = 0.0;
    return moved(plant, interval, samples, [&](double t, double, double) {
      return levels[static_cast<std::size_t>(t / duration * static_cast<double>(levels.size()))];
    });
  }
  if (kind == 1) {  // up and down
    const double period = duration / dice.uniform(1.0, 5.0), offset = dice.uniform(-0.3, 0.3);
    return moved(plant, interval, samples, [&](double t, double, double) {
      const double phase = std::fmod(t / period + 0.25, 1.0);
      return scale * (1.0 - 4.0 * std::abs(phase - 0.5) + offset);
    });
  }
  if (kind == 2) {
    const double rate = 2.0 * std::numbers::pi * dice.logarithmic(3.0 / duration, 0.02 / interval);
    return moved(plant, interval, samples,
                 [&](double t, double, double) { return scale * std::sin(rate * t); });
  }
  if (kind == 3) {
    const double first = 2.0 / duration, last = dice.logarithmic(10.0 / duration, 0.05 / interval);
    const double growth = std::log(last / first);
    return moved(plant, interval, samples, [&](double t, double, double) {
      return scale * std::sin(2.0 * std::numbers::pi * first * duration / growth *
                              (std::exp(growth * t / duration) - 1.0));
    });
  }
  if (kind == 4) {
    const auto hold = static_cast<std::size_t>(dice.logarithmic(5.0, 200.0));
    double u = scale;
    std::size_t i = 0;
    return moved(plant, interval, samples, [&](double, double, double) {
      if (i++ % hold == 0) u = dice.chance(0.5) ? scale : -scale;
      return u;
    });
  }
  if (kind == 5) {  // point to point under a controller, with rests
    const double lag = dice.logarithmic(0.02, 0.1), k_p = plant.mass / (lag * lag),
                 k_d = 1.5 * plant.mass / lag;
    const double period = dice.uniform(0.15, 0.5) * duration, way = dice.logarithmic(0.01, 3.0),
                 part = dice.uniform(0.5, 0.95);
    return moved(plant, interval, samples, [&](double t, double x, double v) {
      const double phase = std::fmod(t, 2.0 * period) / period;
      const double s = std::clamp(std::fmod(phase, 1.0) / part, 0.0, 1.0);
      // Constant acceleration, constant speed, constant deceleration.
      constexpr double kRamp = 0.25;
      const double top = 1.0 / (1.0 - kRamp);
      const double done = s < kRamp         ? 0.5 * top * s * s / kRamp
                          : s < 1.0 - kRamp ? top * (s - 0.5 * kRamp)
                                            : 1.0 - 0.5 * top * (1.0 - s) * (1.0 - s) / kRamp;
      const double target = way * (phase < 1.0 ? done : 1.0 - done);
      return std::clamp(k_p * (target - x) - k_d * v, -20.0 * scale, 20.0 * scale);
    });
  }
  // Slow pulls against a strong friction: it sticks and slips.
  plant.swing = plant.weight = 0.0;
  plant.coulomb = 0.5 * scale;
  plant.breakaway = scale * dice.uniform(0.6, 0.9);
  const double rate = 2.0 * std::numbers::pi * dice.uniform(2.0, 12.0) / duration;
  return moved(plant, interval, samples,
               [&](double t, double, double) { return scale * std::sin(rate * t); });
}

/// A recording of the motion by an encoder and what a drive has beside it.
inline Recording recorded(const Course& course, Dice& dice, std::string& name) {
  const std::size_t n = course.samples();
  const double way = std::max(1e-9, size_of(course.position)),
               speed = std::max(1e-9, size_of(course.velocity)),
               force = std::max(1e-9, size_of(course.force));
  std::vector<double> command = course.force;
  Hold hold = Hold::zero_order;
  if (dice.chance(0.3)) {  // measured
    command = rounded(noisy(std::move(command), force * dice.logarithmic(1e-4, 1e-2), dice),
                      force * dice.logarithmic(1e-5, 1e-2));
    hold = Hold::linear;
  }
  Recording recording = with_command(course, command, hold);
  const double step = way / dice.logarithmic(30.0, 1e6);
  const std::vector<double> counted = rounded(
      noisy(course.position, dice.chance(0.5) ? 0.0 : step * dice.logarithmic(0.03, 3.0), dice),
      step);
  name += " encoder of " + std::to_string(static_cast<int>(way / step)) + " steps";
  const std::size_t velocity = dice.index(5);
  const bool has_position = velocity == 0 || dice.chance(0.6);
  if (has_position) add(recording, Signal::position, counted);
  if (velocity == 1) {
    add(recording, Signal::velocity, differences(counted, course.interval));
    name += ", differences";
  } else if (velocity == 2) {
    add(recording, Signal::velocity,
        noisy(course.velocity, speed * dice.logarithmic(1e-4, 3e-2), dice));
    name += ", noisy velocity";
  } else if (velocity == 3) {  // as a drive that tells whole revolutions per minute
    add(recording, Signal::velocity,
        rounded(noisy(course.velocity, speed * dice.logarithmic(1e-5, 1e-2), dice),
                speed / dice.logarithmic(20.0, 2e4)));
    name += ", rounded velocity";
  } else if (velocity == 4) {  // exact where it rests
    std::vector<double> values = course.velocity;
    const double sigma = dice.logarithmic(1e-4, 3e-2);
    for (double& v : values) v *= 1.0 + sigma * dice.normal();
    add(recording, Signal::velocity, std::move(values));
    name += ", velocity with noise in motion";
  }
  if (dice.chance(0.3)) {
    const double size = std::max(1e-9, size_of(course.acceleration));
    std::vector<double> values = course.acceleration;
    const double ratio = dice.logarithmic(1e-3, 3e-2);
    // Machines shake while they move.
    for (std::size_t i = 0; i < n; ++i)
      values[i] += size * ratio * dice.normal() * (course.velocity[i] != 0.0 ? 1.0 : 0.1);
    add(recording, Signal::acceleration,
        rounded(std::move(values), size / dice.logarithmic(100.0, 1e4)));
    name += ", acceleration";
  }
  if (dice.chance(0.3)) {
    // The current as it was set, or as it was measured.
    const bool exact = dice.chance(0.3);
    std::vector<double> values = course.force;
    if (!exact)
      values = rounded(noisy(std::move(values), force * dice.logarithmic(3e-4, 2e-2), dice),
                       force / dice.logarithmic(100.0, 1e4));
    add(recording, Signal::motor_current, std::move(values));
    name += exact ? ", current as set" : ", current";
  }
  return recording;
}

/// The clean recording number so and so. Those in which next to nothing moves are drawn again.
inline Clean clean_recording(std::uint64_t seed) {
  Dice dice(seed);
  const std::size_t kind = seed % kMotions.size();
  Clean result;
  for (;;) {
    result.course = motion(kind, dice);
    std::size_t moving = 0;
    for (const double v : result.course.velocity) moving += v != 0.0 ? 1 : 0;
    if (10 * moving > result.course.samples()) break;
  }
  result.name = std::to_string(seed) + ": " + kMotions[kind] + ", " +
                std::to_string(result.course.samples()) + " samples at " +
                std::to_string(static_cast<int>(1.0 / result.course.interval)) + " Hz,";
  result.recording = recorded(result.course, dice, result.name);
  return result;
}

}  // namespace axisfit::clean
