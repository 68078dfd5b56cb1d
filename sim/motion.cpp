#include "sim/motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace axisfit {
namespace {

struct ScheduleOf {
  double duration;
  double period;

  /// value(t) at t = 0, interval, 2 interval, ... before the end
  template <class Value>
  Schedule held(double interval, Value&& value) const {
    Schedule schedule;
    for (long n = 0;; ++n) {
      const double t = static_cast<double>(n) * interval;
      if (n > 0 && t >= duration * (1.0 - 1e-12)) return schedule;
      schedule.append(t, value(t));
    }
  }

  Schedule operator()(const StepMotion& m) const {
    if (m.start > 0.0) return {{0.0, m.start}, {0.0, m.level}};
    return {{0.0}, {m.level}};
  }
  Schedule operator()(const LevelsMotion& m) const {
    Schedule schedule;
    for (std::size_t i = 0; i < m.levels.size(); ++i)
      schedule.append(static_cast<double>(i) * m.hold, m.levels[i]);
    return schedule;
  }
  Schedule operator()(const SineMotion& m) const {
    return held(period, [&](double t) {
      const double cycles = m.from * t + 0.5 * (m.to - m.from) * t * t / duration;
      return m.offset + m.amplitude * std::sin(2.0 * std::numbers::pi * cycles);
    });
  }
  Schedule operator()(const PrbsMotion& m) const {
    std::mt19937_64 generator(m.seed);
    return held(m.bit, [&](double) {
      return m.offset + ((generator() >> 63) != 0 ? m.amplitude : -m.amplitude);
    });
  }
  Schedule operator()(const MoveMotion&) const { return {}; }
  Schedule operator()(const RecordedMotion& m) const { return m.schedule; }
};

}  // namespace

Schedule schedule_of(const Motion& motion, double duration, double period) {
  return std::visit(ScheduleOf{duration, period}, motion);
}

Reference reference_of(const MoveMotion& move) {
  const double distance = std::abs(move.distance);
  const double peak = std::min(move.speed, std::sqrt(distance * move.acceleration));
  const double ramp = peak / move.acceleration;           // s
  const double cruise = (distance - peak * ramp) / peak;  // s
  return [=, sign = move.distance < 0.0 ? -1.0 : 1.0, a = move.acceleration](double t) {
    if (distance == 0.0 || t <= 0.0) return 0.0;
    if (t < ramp) return sign * 0.5 * a * t * t;
    if (t < ramp + cruise) return sign * (0.5 * peak * ramp + peak * (t - ramp));
    const double left = std::max(0.0, 2.0 * ramp + cruise - t);
    return sign * (distance - 0.5 * a * left * left);
  };
}

}  // namespace axisfit
