#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sim/effects/slots.h"
#include "sim/scalar.h"

namespace axisfit {

/// The variable of a curve.
enum class CurveOver { velocity, position, motor_angle, time };

/// What a curve is: a force on the arm, or dry friction against its motion, with sticking.
enum class CurveOf { force, friction };

/// A curve: a force or friction that is a smooth function of one variable, for what no named effect
/// explains. That of friction over the velocity is one over its magnitude.
///
/// A cubic spline with the 16 coefficients c1 ... c16 on equally spaced knots: with u running from
/// 0 to 1 between `from` and `to`, F is the sum of c_k b(13 u - k + 4), b the uniform cubic
/// B-spline on 0 ... 4. Beyond the ends it stays constant. Over the motor angle the curve closes
/// after one turn, F = sum of c_k b(16 u - k + 4), and has no ends.
/// Source: C. de Boor, A Practical Guide to Splines (1978), chapter IX.
template <class T, CurveOver kVariable, CurveOf kOf = CurveOf::force>
struct Curve {
  static constexpr bool kIsFriction = kOf == CurveOf::friction;
  static constexpr bool kCloses = kVariable == CurveOver::motor_angle;
  static constexpr int kCoefficients = 16;
  static constexpr int kIntervals = kCloses ? kCoefficients : kCoefficients - 3;
  static constexpr std::array<std::string_view, kCoefficients> kNames{
      "c1", "c2",  "c3",  "c4",  "c5",  "c6",  "c7",  "c8",
      "c9", "c10", "c11", "c12", "c13", "c14", "c15", "c16"};
  static constexpr std::string_view name = [] {
    switch (kVariable) {
      case CurveOver::velocity:
        return kIsFriction ? "friction_over_velocity" : "force_over_velocity";
      case CurveOver::position:
        return kIsFriction ? "friction_over_position" : "force_over_position";
      case CurveOver::motor_angle:
        return "force_over_motor_angle";
      case CurveOver::time:
        return "force_over_time";
    }
  }();
  static constexpr std::string_view meaning = [] {
    switch (kVariable) {
      case CurveOver::velocity:
        return kIsFriction ? "friction as a curve over velocity" : "force as a curve over velocity";
      case CurveOver::position:
        return kIsFriction ? "friction as a curve over position" : "force as a curve over position";
      case CurveOver::motor_angle:
        return "force as a curve over the motor angle";
      case CurveOver::time:
        return "force as a curve over time";
    }
  }();
  static constexpr std::string_view unit = [] {
    switch (kVariable) {
      case CurveOver::velocity:
        return "m/s";
      case CurveOver::position:
        return "m";
      case CurveOver::motor_angle:
        return "rad";
      case CurveOver::time:
        return "s";
    }
  }();

  static constexpr ActsOn acts_on = kIsFriction ? ActsOn::friction : ActsOn::arm_force;
  static constexpr std::string_view excitation = [] {
    switch (kVariable) {
      case CurveOver::velocity:
        return motions::kBothWays;
      case CurveOver::position:
        return motions::kWholeStroke;
      case CurveOver::motor_angle:
        return motions::kManyTurns;
      case CurveOver::time:
        return std::string_view("motion throughout the recording");
    }
  }();
  /// The ends in a motion of typical strength: outside of it, because a curve has a kink there.
  static constexpr std::array<double, 2> kTypicalEnds = [] {
    switch (kVariable) {
      case CurveOver::velocity:
        return kIsFriction ? std::array{-0.1, 0.8} : std::array{-0.7, 0.5};
      case CurveOver::position:
        return std::array{-0.11, 0.17};
      case CurveOver::motor_angle:
        return std::array{0.0, 2.0 * std::numbers::pi};
      case CurveOver::time:
        return std::array{-0.05, 1.05};
    }
  }();

  std::array<T, kCoefficients> c;
  T from, to;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    constexpr UsedBy kUsedBy = kCloses ? UsedBy::motor : UsedBy::every_axis;
    for (std::size_t k = 0; k < kNames.size(); ++k)
      visit(Quantity{kNames[k], "N", "coefficient of the curve", -1e5, 1e5, 0.0, kUsedBy}.typically(
                10.0 * std::sin(2.0 * double(k + 1))),
            self.c[k]);
    if constexpr (!kCloses) {
      visit(Quantity{"from", unit, "start of the curve", -1e6, 1e6, kRequired, kUsedBy, true}
                .typically(kTypicalEnds[0]),
            self.from);
      visit(Quantity{"to", unit, "end of the curve", -1e6, 1e6, kRequired, kUsedBy, true}.typically(
                kTypicalEnds[1]),
            self.to);
    }
  }

  static std::vector<SearchEntry> search(const SearchScales& scales) {
    SearchEntry entry{.strengths = {}, .is_curve = true};
    // The constant part of a curve is another effect's, and the first and last coefficient hold it.
    entry.strengths.assign(kNames.begin() + 1, kNames.end() - (kCloses ? 0 : 1));
    if constexpr (!kCloses) entry.held = {"from", "to"};
    if constexpr (kVariable == CurveOver::velocity)
      entry.settings = {{kIsFriction ? 0.0 : scales.velocity_low,
                         kIsFriction ? scales.speed : scales.velocity_high}};
    if constexpr (kVariable == CurveOver::position)
      entry.settings = {{scales.position_low, scales.position_high}};
    if constexpr (kVariable == CurveOver::time) {
      entry.settings = {{scales.start, scales.end}};
      // Knots spread over a whole recording do not resolve a push.
      constexpr double kMargin = 0.4;  // of its length, before and after
      for (const auto& [start, end] : scales.pulses)
        entry.settings.push_back({start - kMargin * (end - start), end + kMargin * (end - start)});
    }
    return {entry};
  }

  T arm_force(const Instant<T>& at) const requires(!kIsFriction) { return value(variable(at)); }
  T friction_curve(const Instant<T>& at) const requires kIsFriction { return value(variable(at)); }

  static T variable(const Instant<T>& at) {
    if constexpr (kVariable == CurveOver::velocity)
      return kIsFriction ? double(at.direction) * at.velocity : at.velocity;
    if constexpr (kVariable == CurveOver::position) return at.position;
    if constexpr (kVariable == CurveOver::motor_angle) return at.motor_angle;
    if constexpr (kVariable == CurveOver::time) return at.time;
  }

  T value(const T& x) const {
    T s;  // in intervals
    if constexpr (kCloses) {
      s = x * (kIntervals / (2.0 * std::numbers::pi));
      s -= kIntervals * std::floor(value_of(s) / kIntervals);
    } else {
      s = (x - from) / (to - from) * double(kIntervals);
      if (value_of(s) <= 0.0) s = T(0.0);
      if (value_of(s) >= kIntervals) s = T(double(kIntervals));
    }
    const int first = std::clamp(static_cast<int>(value_of(s)), 0, kIntervals - 1);
    const T t = s - double(first);
    const T t2 = t * t, t3 = t2 * t;
    const auto k = [&](int i) -> const T& {
      return c[static_cast<std::size_t>((first + i) % kCoefficients)];
    };
    return (k(0) * (1.0 - 3.0 * t + 3.0 * t2 - t3) + k(1) * (4.0 - 6.0 * t2 + 3.0 * t3) +
            k(2) * (1.0 + 3.0 * t + 3.0 * t2 - 3.0 * t3) + k(3) * t3) /
           6.0;
  }
};

template <class T>
using ForceOverVelocity = Curve<T, CurveOver::velocity>;
template <class T>
using ForceOverPosition = Curve<T, CurveOver::position>;
template <class T>
using ForceOverMotorAngle = Curve<T, CurveOver::motor_angle>;
template <class T>
using ForceOverTime = Curve<T, CurveOver::time>;
template <class T>
using FrictionOverVelocity = Curve<T, CurveOver::velocity, CurveOf::friction>;
template <class T>
using FrictionOverPosition = Curve<T, CurveOver::position, CurveOf::friction>;

}  // namespace axisfit
