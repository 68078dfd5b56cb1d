// Equations (1) to (6) of the paper, in one given mode, and the guards that end the mode.
//
// y' = f(y, U) is affine in the state, the command and the coupling's target, except for the slot
// arm_force of the effects. The integrator relies on that.
#pragma once

#include <cmath>

#include "sim/coupling.h"
#include "sim/mode.h"
#include "sim/model.h"
#include "sim/scalar.h"

namespace axisfit {

/// What acts on the axis from outside, at one instant.
template <class T>
struct Input {
  T command{0.0};  ///< U, V
  TargetOf<T> target;
};

/// Which terms of the right-hand side to include.
enum class Terms {
  affine,  ///< all that is affine in state and input
  all,     ///< with the state-dependent forces of effects
};

template <class T>
class Equations {
 public:
  explicit Equations(const Model<T>& model, const Coupling& coupling = {},
                     bool static_friction = false)
      : m_(model),
        coupling_(coupling),
        backlash_(model.structure.transmission == Transmission::backlash),
        dry_level_(slots::friction_level(model.effects, model.structure.effects)),
        constant_force_(slots::constant_force(model.effects, model.structure.effects)),
        static_friction_(static_friction || is_in_play(model.axis.F_s)),
        dry_friction_(static_friction_ || slots::have_friction(model.structure.effects)),
        smooth_forces_(slots::have_arm_force(model.structure.effects)) {}

  const Model<T>& model() const { return m_; }
  const Coupling& coupling() const { return coupling_; }
  bool has_static_friction() const { return static_friction_; }
  bool has_dry_friction() const { return dry_friction_; }
  bool has_smooth_forces() const { return smooth_forces_; }

  /// Preamplifier output before its limit, V; (2).
  T preamplifier(const State<T>& y) const { return y[4] + m_.axis.T_z * y[5]; }

  /// V_c, behind the limit, V; (2).
  T preamplifier_voltage(const Mode& mode, const State<T>& y) const {
    return mode.v_c == 0 ? preamplifier(y) : double(mode.v_c) * m_.axis.V_L;
  }

  /// Motor voltage before its limit, V; (3).
  T motor_demand(const Mode& mode, const State<T>& y) const {
    return m_.axis.K_v * (preamplifier_voltage(mode, y) - y[6] / m_.axis.K_i);
  }

  /// V_m, behind the limit, V; (3).
  T motor_voltage(const Mode& mode, const State<T>& y) const {
    return mode.v_m == 0 ? motor_demand(mode, y) : double(mode.v_m) * m_.axis.V_s;
  }

  /// Motor current, A.
  T current(const Mode& mode, const State<T>& y) const {
    return m_.structure.drive == Drive::current_source ? m_.axis.K_i * preamplifier_voltage(mode, y)
                                                       : y[6];
  }

  /// Motor torque as a force at the rack, N on the arm side.
  T drive_force(const Mode& mode, const State<T>& y, const Input<T>& input) const {
    return m_.structure.drive == Drive::force_source ? m_.axis.K_f * input.command
                                                     : m_.axis.K_m * current(mode, y) / m_.axis.r_g;
  }

  /// Position of the pinion relative to the rack, m; (4).
  T gear_position(const State<T>& y) const { return m_.axis.r_g * y[2] - y[0]; }

  /// Force of the gear on the arm, N; (5). Zero for a rigid transmission, which has none apart.
  T gear_force(const Mode& mode, const State<T>& y) const {
    if (mode.contact == 0) return T(0.0);
    return (gear_position(y) - double(mode.contact) * m_.axis.H) * m_.axis.k_g +
           (m_.axis.r_g * y[3] - y[1]) * m_.axis.b_g;
  }

  /// Largest dry friction at the arm's present velocity, N >= 0; (6) and effects.
  T friction_level(bool in_doublet) const {
    return in_doublet ? dry_level_ + m_.axis.F_s : dry_level_;
  }

  /// All forces on the moving mass but dry friction and coupling, N on the arm side.
  T applied_force(const Mode& mode, const State<T>& y, const Input<T>& input,
                  Terms terms = Terms::all) const {
    T force = constant_force_ - m_.axis.B_a * y[1];
    if (backlash_)
      force += gear_force(mode, y);
    else
      force += drive_force(mode, y, input) - m_.axis.B_m * y[1] / (m_.axis.r_g * m_.axis.r_g);
    if (smooth_forces_ && terms == Terms::all)
      force += slots::arm_force(m_.effects, m_.structure.effects, y);
    return force;
  }

  /// The mass that applied_force moves, kg.
  T moving_mass() const {
    return backlash_ ? m_.axis.M : m_.axis.M + m_.axis.J_m / (m_.axis.r_g * m_.axis.r_g);
  }

  /// y1' of the model itself, without coupling, m/s^2: what an accelerometer reads.
  T acceleration(const Mode& mode, const State<T>& y, const Input<T>& input) const {
    if (mode.sliding == 0) return T(0.0);
    return (applied_force(mode, y, input) - friction(mode)) / moving_mass();
  }

  /// Force that the coupling adds to the arm, N: what the model lacks, or noise.
  T coupling_force(const State<T>& y, const TargetOf<T>& target) const {
    return moving_mass() * coupling_acceleration(y, target);
  }

  /// The right-hand side of (1), with coupling.
  State<T> rate(const Mode& mode, const State<T>& y, const Input<T>& input,
                Terms terms = Terms::all) const {
    const Axis<T>& p = m_.axis;
    const auto& [y0, y1, y2, y3, y4, y5, y6] = y;
    State<T> d{};
    d[0] = y1;
    if (mode.sliding != 0)
      d[1] = (applied_force(mode, y, input, terms) - friction(mode)) / moving_mass();
    T follow(0.0), push(0.0);
    if (coupling_.active()) {
      follow = coupling_.position * position_error(y, input.target);
      push = coupling_.acceleration * position_error(y, input.target);
      d[0] += follow;
      if (mode.sliding != 0) d[1] += coupling_acceleration(y, input.target);
    }
    if (backlash_) {
      const T torque = p.r_g * drive_force(mode, y, input);
      d[2] = y3 + follow / p.r_g;
      d[3] = (torque - p.B_m * y3 - p.r_g * gear_force(mode, y)) / p.J_m + push / p.r_g;
    } else {
      d[2] = d[0] / p.r_g;
      d[3] = d[1] / p.r_g;
    }
    if (m_.structure.drive != Drive::force_source) {
      d[4] = y5;
      d[5] = (p.K_1 * input.command - p.K_2 * p.K_t * y3 - y4 - (p.T_p + p.T_r) * y5) /
             (p.T_p * p.T_r);
    }
    if (m_.structure.drive == Drive::velocity_loop)
      d[6] = (motor_voltage(mode, y) - p.R * y6 - p.K_e * y3) / p.L;
    return d;
  }

  /// y1' due to the state-dependent forces of effects alone, m/s^2: the part that is not affine.
  T smooth_acceleration(const Mode& mode, const State<T>& y) const {
    if (mode.sliding == 0) return T(0.0);
    return slots::arm_force(m_.effects, m_.structure.effects, y) / moving_mass();
  }

  /// Change of rate() per second because the target moves: the terms in `slope` alone.
  State<T> rate_of_target(const Mode& mode, const Target& rate) const {
    const TargetOf<T> slope{T(rate.velocity), T(rate.position)};
    const Model<T>& m = m_;
    State<T> d{};
    if (!coupling_.active()) return d;
    const State<T> origin{};
    // Linear in state and target: what the target alone contributes is the difference.
    const T e = position_error(origin, slope) - position_error(origin, TargetOf<T>{});
    const T a = coupling_acceleration(origin, slope) - coupling_acceleration(origin, TargetOf<T>{});
    d[0] = coupling_.position * e;
    if (mode.sliding != 0) d[1] = a;
    d[2] = coupling_.position * e / m.axis.r_g;
    d[3] = (backlash_ ? coupling_.acceleration * e : d[1]) / m.axis.r_g;
    return d;
  }

  /// Calls visit(guard, value, scale) for every surface that ends `mode`. The value is positive
  /// inside, affine in state and input; `scale` is its natural size, for tolerances.
  template <class Visitor>
  void visit_guards(const Mode& mode, const State<T>& y, const Input<T>& input,
                    Visitor&& visit) const {
    const Axis<T>& p = m_.axis;
    using enum Guard;
    if (backlash_) {
      const T x = gear_position(y);
      const double scale = 1e-3 + std::abs(value_of(y[0]));  // m; x is a small difference
      if (mode.contact != -1) visit(contact_positive, mode.contact == 0 ? p.H - x : x - p.H, scale);
      if (mode.contact != 1) visit(contact_negative, mode.contact == 0 ? x + p.H : -p.H - x, scale);
    }
    if (m_.structure.drive != Drive::force_source) {
      const T v = preamplifier(y);
      const double scale = value_of(p.V_L);
      if (mode.v_c != -1) visit(v_c_positive, mode.v_c == 0 ? p.V_L - v : v - p.V_L, scale);
      if (mode.v_c != 1) visit(v_c_negative, mode.v_c == 0 ? v + p.V_L : -p.V_L - v, scale);
    }
    if (m_.structure.drive == Drive::velocity_loop) {
      const T v = motor_demand(mode, y);
      const double scale = value_of(p.V_s) + value_of(p.K_v) * value_of(p.V_L) * 1e-3;
      if (mode.v_m != -1) visit(v_m_positive, mode.v_m == 0 ? p.V_s - v : v - p.V_s, scale);
      if (mode.v_m != 1) visit(v_m_negative, mode.v_m == 0 ? v + p.V_s : -p.V_s - v, scale);
    }
    if (dry_friction_) {
      if (mode.sliding == 0) {
        const T force = stick_force(mode, y, input);
        const T level = friction_level(static_friction_);
        const double scale = 1.0 + value_of(level);  // N
        visit(break_away_positive, level - force, scale);
        visit(break_away_negative, level + force, scale);
      } else {
        const T speed = double(mode.sliding) * y[1];
        const double scale = 1e-3;  // m/s
        if (!static_friction_ || mode.doublet) visit(stop, speed, scale);
        if (static_friction_)
          visit(Guard::doublet, mode.doublet ? p.w - speed : speed - p.w, scale);
      }
    }
  }

  /// The mode behind a guard that was reached at the state y. A stop sets the arm's velocity to
  /// exactly zero.
  Mode cross(Mode mode, Guard guard, State<T>& y, const Input<T>& input) const {
    switch (guard) {
      case Guard::contact_positive:
        mode.contact = mode.contact == 0 ? 1 : 0;
        break;
      case Guard::contact_negative:
        mode.contact = mode.contact == 0 ? -1 : 0;
        break;
      case Guard::v_c_positive:
        mode.v_c = mode.v_c == 0 ? 1 : 0;
        break;
      case Guard::v_c_negative:
        mode.v_c = mode.v_c == 0 ? -1 : 0;
        break;
      case Guard::v_m_positive:
        mode.v_m = mode.v_m == 0 ? 1 : 0;
        break;
      case Guard::v_m_negative:
        mode.v_m = mode.v_m == 0 ? -1 : 0;
        break;
      case Guard::doublet:
        mode.doublet = !mode.doublet;
        break;
      case Guard::break_away_positive:
        mode = slide(mode, 1);
        break;
      case Guard::break_away_negative:
        mode = slide(mode, -1);
        break;
      case Guard::stop:
        y[1] = T(0.0);
        if (!backlash_) y[3] = T(0.0);
        mode.sliding = 0;
        break;
    }
    return settle(mode, y, input);
  }

  /// An arm that sticks although the force exceeds the friction starts to slide: for whatever
  /// makes the force jump (teeth that meet, a command that switches a force source).
  Mode settle(const Mode& mode, const State<T>& y, const Input<T>& input) const {
    if (mode.sliding != 0) return mode;
    const double force = value_of(stick_force(mode, y, input));
    const double level = value_of(friction_level(static_friction_));
    if (std::abs(force) <= level) return mode;
    return slide(mode, force > 0.0 ? 1 : -1);
  }

  /// The mode that belongs to a state at the start.
  Mode mode_at(const State<T>& y, const Input<T>& input) const {
    const Axis<T>& p = m_.axis;
    const auto side = [](double value, double limit) {
      return static_cast<std::int8_t>(value > limit ? 1 : value < -limit ? -1 : 0);
    };
    Mode mode;
    if (backlash_) mode.contact = side(value_of(gear_position(y)), value_of(p.H));
    if (m_.structure.drive != Drive::force_source)
      mode.v_c = side(value_of(preamplifier(y)), value_of(p.V_L));
    if (m_.structure.drive == Drive::velocity_loop)
      mode.v_m = side(value_of(motor_demand(mode, y)), value_of(p.V_s));
    const double speed = value_of(y[1]);
    if (!dry_friction_) {
      mode.sliding = 1;
      return mode;
    }
    mode.sliding = side(speed, 0.0);
    mode.doublet = mode.sliding != 0 && static_friction_ && std::abs(speed) < value_of(p.w);
    return settle(mode, y, input);
  }

 private:
  T friction(const Mode& mode) const {
    return dry_friction_ ? double(mode.sliding) * friction_level(mode.doublet) : T(0.0);
  }

  Mode slide(Mode mode, int sign) const {
    mode.sliding = static_cast<std::int8_t>(sign);
    mode.doublet = static_friction_;
    return mode;
  }

  T stick_force(const Mode& mode, const State<T>& y, const Input<T>& input) const {
    T force = applied_force(mode, y, input);
    if (coupling_.active()) force += coupling_force(y, input.target);
    return force;
  }

  T position_error(const State<T>& y, const TargetOf<T>& target) const {
    const auto& [gain, bias] = m_.instruments[index_of(Signal::position)];
    return (target.position - bias) / gain - m_.axis.r_g * y[2];
  }

  T coupling_acceleration(const State<T>& y, const TargetOf<T>& target) const {
    const auto& [gain, bias] = m_.instruments[index_of(Signal::velocity)];
    T a(0.0);
    if (coupling_.velocity > 0.0)
      a += coupling_.velocity * ((target.velocity - bias) / gain - y[1]);
    if (coupling_.acceleration > 0.0) a += coupling_.acceleration * position_error(y, target);
    return a;
  }

  // A copy of the model is not needed: equations live as long as the simulation that owns it.
  const Model<T>& m_;
  Coupling coupling_;
  bool backlash_;
  T dry_level_;
  T constant_force_;
  bool static_friction_;
  bool dry_friction_;
  bool smooth_forces_;
};

/// What the instrument for `signal` reads, without noise, in the signal's unit.
template <class T>
T reading(const Equations<T>& equations, Signal signal, const Mode& mode, const State<T>& y,
          const Input<T>& input) {
  const Axis<T>& p = equations.model().axis;
  const auto& [gain, bias] = equations.model().instruments[index_of(signal)];
  const auto truth = [&]() -> T {
    switch (signal) {
      case Signal::position:
        return p.r_g * y[2];
      case Signal::velocity:
        return y[1];
      case Signal::acceleration:
        return equations.acceleration(mode, y, input);
      case Signal::tachometer:
        return p.K_t * y[3];
      case Signal::motor_current:
        return equations.current(mode, y);
      case Signal::preamplifier_voltage:
        return equations.preamplifier_voltage(mode, y);
      case Signal::motor_voltage:
        return equations.motor_voltage(mode, y);
      case Signal::drive_force:
        return equations.drive_force(mode, y, input);
    }
    return T(0.0);
  };
  return gain * truth() + bias;
}

}  // namespace axisfit
