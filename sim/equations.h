// Equations (1) to (6) of the paper, in one given mode, and the guards that end the mode.
//
// y' = f(y, U) is affine in the state, the command and the observer's target, except for the slot
// arm_force of the effects. The integrator relies on that.
#pragma once

#include <cmath>
#include <utility>

#include "sim/mode.h"
#include "sim/model.h"
#include "sim/observer.h"
#include "sim/scalar.h"

namespace axisfit {

/// Small accelerations that are added to the axis. Zero in value: what counts is their derivatives,
/// which tell what a force would do that the model lacks.
template <class T>
struct Disturbance {
  T arm{0.0};    ///< m/s^2, of the arm while it moves; with a rigid transmission the motor follows
  T motor{0.0};  ///< rad/s^2, of a motor behind backlash
};

/// What acts on the axis at one instant besides its state.
template <class T>
struct Input {
  T command{0.0};  ///< U, in the unit of the drive
  TargetOf<T> target;
  T time{0.0};  ///< s, of the recording
  RestMemory<T> memory;
  Disturbance<T> disturbance = {};
  ChannelCourse channels = {};
};

/// Which terms of the right-hand side to include.
enum class Terms {
  affine,  ///< all that is affine in state and input
  all,     ///< with the other forces of effects
};

/// What of the model is in play: the same for all scalar types of one simulation.
struct ActiveTerms {
  Capabilities has;
  EffectSet effects;
  slots::Needs needs;
  bool static_friction, directions, spring, asymmetric, slope, load, driven_load, elastic, lagging,
      lag_active, soft_supply, soft_encoder;
};

template <class T>
class Equations {
 public:
  explicit Equations(const Model<T>& model, const Observer& observer = {})
      : Equations(
            model, observer,
            active_terms_of(model, slots::active_effects(model.effects, model.structure.effects))) {
  }

  /// With what is in play given: from a model in another scalar type, which may show more of it.
  Equations(const Model<T>& model, const Observer& observer, const ActiveTerms& parts)
      : m_(model),
        observer_(observer),
        slots_(slots::affine(model.effects, parts.effects)),
        is_(parts),
        r_g_(motor_radius(model)) {}

  const Model<T>& model() const { return m_; }
  const Observer& observer() const { return observer_; }
  /// r_g, m
  const T& radius() const { return r_g_; }
  const ActiveTerms& parts() const { return is_; }
  bool has_smooth_forces() const { return is_.needs.is_smooth(); }
  /// Whether the signs of contact, motion and load change more than constants.
  bool signs_matter() const { return is_.asymmetric || is_.slope || is_.load; }
  /// What a drive lag of zero adds to the dead time of a command that drives the motor itself:
  /// nothing, but its derivative.
  T lag_of_switching() const {
    const bool adds = is_.lag_active && is_.has.is_direct();
    return adds ? slots_.drive_lag : T(0.0);
  }
  /// Number of states in use, from the first on.
  std::size_t states() const { return is_.elastic ? 10 : is_.lagging ? 8 : 7; }

  /// Preamplifier output before its limit, V; (2).
  T preamplifier(const State<T>& y) const { return y[4] + m_.axis.T_z * y[5]; }

  /// V_c, behind the limit, V; (2).
  T preamplifier_voltage(const Mode& mode, const State<T>& y) const {
    return mode.v_c == 0 ? preamplifier(y) : double(mode.v_c) * m_.axis.V_L;
  }

  /// What the power stage follows, V: V_c, late by the drive's lag.
  T power_stage_input(const Mode& mode, const State<T>& y, const Input<T>& input) const {
    if (is_.lagging) return y[7];
    T v = preamplifier_voltage(mode, y);
    // The derivative at zero lag: v(t - T_l) = v - T_l v'.
    if (is_.lag_active && mode.v_c == 0)
      v -= slots_.drive_lag * (y[5] + m_.axis.T_z * preamplifier_curvature(y, input));
    return v;
  }

  /// Motor voltage before its limit, V; (3).
  T motor_demand(const Mode& mode, const State<T>& y, const Input<T>& input) const {
    return m_.axis.K_v * (power_stage_input(mode, y, input) - y[6] / m_.axis.K_i);
  }

  /// V_m, behind the limit, V; (3).
  T motor_voltage(const Mode& mode, const State<T>& y, const Input<T>& input) const {
    if (mode.v_m == 0) return motor_demand(mode, y, input);
    T v = double(mode.v_m) * m_.axis.V_s;
    if (is_.soft_supply) v -= slots_.supply_resistance * y[6];
    return v;
  }

  /// Motor current, A.
  T current(const Mode& mode, const State<T>& y, const Input<T>& input) const {
    if (is_.has.has_voltage_loop) return y[6];
    if (is_.has.is_electric) return m_.axis.K_i * power_stage_input(mode, y, input);
    if (is_.has.has_back_emf) return (followed_command(y, input) - m_.axis.K_m * y[3]) / m_.axis.R;
    return T(0.0);
  }

  /// U with the drive's offset, in the unit of the command.
  T command(const Input<T>& input) const { return input.command + slots_.command_offset; }

  /// The same, late by the drive's lag.
  T followed_command(const State<T>& y, const Input<T>& input) const {
    return is_.lagging ? y[7] : command(input);
  }

  /// Force at the rack of the motor's current alone, N on the arm side.
  T current_force(const Mode& mode, const State<T>& y, const Input<T>& input) const {
    return is_.has.is_force_driven ? m_.axis.K_f * followed_command(y, input)
                                   : m_.axis.K_m * current(mode, y, input) / r_g_;
  }

  /// Motor torque as a force at the rack, N on the arm side.
  T drive_force(const Mode& mode, const State<T>& y, const Input<T>& input,
                Terms terms = Terms::all) const {
    T force = current_force(mode, y, input);
    if (is_.needs.motor_torque && terms == Terms::all) force += motor_torque(mode, y, input) / r_g_;
    return force;
  }

  /// Position of the pinion relative to the rack, m; (4).
  T gear_position(const State<T>& y) const { return r_g_ * y[2] - y[0]; }

  /// Force of the gear on the arm, N; (5). Zero for a rigid transmission, which has none apart.
  T gear_force(const Mode& mode, const State<T>& y) const {
    if (mode.contact == 0) return T(0.0);
    return (gear_position(y) - double(mode.contact) * m_.axis.H) * m_.axis.k_g +
           (r_g_ * y[3] - y[1]) * m_.axis.b_g;
  }

  /// What the encoder on the motor reads, m at the rack: ahead of a rigid arm by what the
  /// transmission gives way under the force that it carries.
  T encoder_position(const Mode& mode, const State<T>& y, const Input<T>& input) const {
    const Axis<T>& p = m_.axis;
    const T position = r_g_ * y[2];
    if (!is_.soft_encoder) return position;
    const T of_motor = (p.J_m * acceleration(mode, y, input) + p.B_m * y[1]) / (r_g_ * r_g_);
    const T force = drive_force(mode, y, input) - of_motor;
    const double side = value_of(force) > 0.0 ? 1.0 : value_of(force) < 0.0 ? -1.0 : 0.0;
    return position + slots_.compliance * force + side * slots_.play;
  }

  /// All forces on the moving mass but dry friction and observer, N on the arm side.
  T applied_force(const Mode& mode, const State<T>& y, const Input<T>& input,
                  Terms terms = Terms::all) const {
    T force = slots_.constant_force - m_.axis.B_a * y[1];
    if (is_.spring) force -= slots_.stiffness * y[0];
    if (is_.asymmetric) force -= double(mode.sliding) * slots_.viscous_asymmetry * y[1];
    if (is_.elastic) force += slots_.elastic_mass * elastic_rate(y);
    if (is_.has.has_backlash)
      force += gear_force(mode, y);
    else
      force += drive_force(mode, y, input, terms) - m_.axis.B_m * y[1] / (r_g_ * r_g_);
    if (is_.needs.arm_force && terms == Terms::all)
      force += slots::arm_force(m_.effects, is_.effects, instant(mode, y, input), input.memory);
    return force;
  }

  /// The mass that applied_force moves, kg, without what changes.
  T moving_mass() const {
    T mass = m_.axis.M + slots_.added_mass;
    if (is_.elastic) mass -= slots_.elastic_mass;
    return is_.has.has_backlash ? mass : mass + m_.axis.J_m / (r_g_ * r_g_);
  }

  /// y1' of the model itself, without observer, m/s^2: what an accelerometer reads.
  T acceleration(const Mode& mode, const State<T>& y, const Input<T>& input,
                 Terms terms = Terms::all) const {
    if (mode.sliding == 0) return T(0.0);
    return undisturbed_acceleration(mode, y, input, terms) + input.disturbance.arm;
  }

  /// Force that the observer adds to the arm, N: what the model lacks, or noise. For the target of
  /// the input, or another one.
  T observer_force(const Mode& mode, const State<T>& y, const Input<T>& input) const {
    return observer_force(mode, y, input, input.target);
  }
  T observer_force(const Mode& mode, const State<T>& y, const Input<T>& input,
                   const TargetOf<T>& target) const {
    T mass = moving_mass();
    if (is_.needs.mass) mass += changing_mass(mode, y, input).first;
    return mass * observer_acceleration(y, target);
  }

  /// The right-hand side of (1), with observer.
  State<T> rate(const Mode& mode, const State<T>& y, const Input<T>& input,
                Terms terms = Terms::all) const {
    const Axis<T>& p = m_.axis;
    State<T> d{};
    d[0] = y[1];
    d[1] = acceleration(mode, y, input, terms);
    const T model_acceleration = d[1];
    T position_correction(0.0), acceleration_correction(0.0);
    if (observer_.active()) {
      position_correction = observer_.position * position_error(y, input.target);
      acceleration_correction = observer_.acceleration * position_error(y, input.target);
      d[0] += position_correction;
      if (mode.sliding != 0) d[1] += observer_acceleration(y, input.target);
    }
    if (is_.has.has_backlash) {
      const T torque = r_g_ * drive_force(mode, y, input, terms);
      d[2] = y[3] + position_correction / r_g_;
      d[3] = (torque - p.B_m * y[3] - r_g_ * gear_force(mode, y)) / p.J_m +
             acceleration_correction / r_g_ + input.disturbance.motor;
    } else {
      d[2] = d[0] / r_g_;
      d[3] = d[1] / r_g_;
    }
    if (is_.has.is_electric) {
      d[4] = y[5];
      d[5] = preamplifier_curvature(y, input);
    }
    if (is_.has.has_voltage_loop)
      d[6] = (motor_voltage(mode, y, input) - p.R * y[6] - p.K_e * y[3]) / p.L;
    if (is_.lagging) d[7] = (undelayed_input(mode, y, input) - y[7]) / slots_.drive_lag;
    if (is_.elastic) {
      d[8] = y[9];
      d[9] = -elastic_rate(y) - model_acceleration;
    }
    return d;
  }

  /// What the disturbance adds to rate().
  State<T> disturbance_rate(const Mode& mode, const Disturbance<T>& disturbance) const {
    State<T> d{};
    if (mode.sliding != 0) d[1] = disturbance.arm;
    d[3] = is_.has.has_backlash ? disturbance.motor : d[1] / r_g_;
    if (is_.elastic) d[9] = -d[1];
    return d;
  }

  /// The part of rate() that is not affine.
  State<T> smooth_rate(const Mode& mode, const State<T>& y, const Input<T>& input) const {
    const Axis<T>& p = m_.axis;
    State<T> d{};
    T arm(0.0), motor(0.0);
    if (is_.needs.motor_torque) motor = motor_torque(mode, y, input) / r_g_;
    if (mode.sliding != 0) {
      Instant<T> at = instant(mode, y, input);
      if (is_.needs.friction_curve)
        arm -=
            double(mode.sliding) * slots::friction_curve(m_.effects, is_.effects, at, input.memory);
      if (is_.needs.arm_force)
        arm += slots::arm_force(m_.effects, is_.effects, std::move(at), input.memory);
      if (!is_.has.has_backlash) arm += motor;
      T mass = moving_mass();
      if (is_.needs.mass) {  // the affine part moves with the mass that stays
        const auto [more, rate] = changing_mass(mode, y, input);
        mass += more;
        arm -= rate * y[1] + more * undisturbed_acceleration(mode, y, input, Terms::affine);
      }
      d[1] = arm / mass;
      if (is_.elastic) d[9] = -d[1];
    }
    d[3] = is_.has.has_backlash ? r_g_ * motor / p.J_m : d[1] / r_g_;
    return d;
  }

  /// Calls visit(guard, value, scale) for every surface that ends `mode`. The value is positive
  /// inside; it is affine in state and input but where an arm sticks under forces that are not.
  /// `scale` is its natural size, for tolerances.
  template <class Visitor>
  void visit_guards(const Mode& mode, const State<T>& y, const Input<T>& input,
                    Visitor&& visit) const {
    const Axis<T>& p = m_.axis;
    using enum Guard;
    // A value x between -limit and limit, or held (`side`) beyond one of them.
    const auto between = [&](Guard positive, Guard negative, int side, const T& x, const T& limit,
                             double scale) {
      if (side != -1) visit(positive, side == 0 ? limit - x : x - limit, scale);
      if (side != 1) visit(negative, side == 0 ? x + limit : -limit - x, scale);
    };
    if (is_.has.has_backlash)  // x is a small difference of positions
      between(contact_positive, contact_negative, mode.contact, gear_position(y), p.H,
              1e-3 + std::abs(value_of(y[0])));
    if (is_.has.is_electric)
      between(v_c_positive, v_c_negative, mode.v_c, preamplifier(y), p.V_L, value_of(p.V_L));
    if (is_.has.has_voltage_loop)
      between(v_m_positive, v_m_negative, mode.v_m, supply_demand(mode, y, input), p.V_s,
              value_of(p.V_s) + value_of(p.K_v) * value_of(p.V_L) * 1e-3);
    if (is_.driven_load) {
      const T force = current_force(mode, y, input);
      visit(Guard::load, double(mode.load) * force, 1.0 + std::abs(value_of(force)));
    }
    if (is_.directions) {
      if (mode.sliding == 0) {
        const T force = stick_force(mode, y, input);
        const T forward = holding_force(mode, 1, y, input);
        const T backward = holding_force(mode, -1, y, input);
        const double scale = 1.0 + std::abs(value_of(forward)) + std::abs(value_of(backward));  // N
        visit(break_away_positive, forward - force, scale);
        visit(break_away_negative, backward + force, scale);
      } else {
        const T speed = double(mode.sliding) * y[1];
        const double scale = 1e-3;  // m/s
        if (!is_.static_friction || mode.doublet) visit(stop, speed, scale);
        if (is_.static_friction)
          visit(Guard::doublet, mode.doublet ? p.w - speed : speed - p.w, scale);
      }
    }
  }

  /// The mode behind a guard that was reached at the state y. A stop sets the arm's velocity to
  /// exactly zero, and is remembered in the input.
  Mode cross(Mode mode, Guard guard, State<T>& y, Input<T>& input) const {
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
      case Guard::load:
        mode.load = static_cast<std::int8_t>(-mode.load);
        break;
      case Guard::break_away_positive:
        mode = slide(mode, 1);
        break;
      case Guard::break_away_negative:
        mode = slide(mode, -1);
        break;
      case Guard::stop:
        if (is_.needs.hysteresis)
          input.memory =
              slots::memory_of(m_.effects, is_.effects, instant(mode, y, input), input.memory);
        y[1] = T(0.0);
        if (!is_.has.has_backlash) y[3] = T(0.0);
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
    if (force > value_of(holding_force(mode, 1, y, input))) return slide(mode, 1);
    if (-force > value_of(holding_force(mode, -1, y, input))) return slide(mode, -1);
    return mode;
  }

  /// The mode after the command was switched. What a force source drives with jumps then.
  Mode switched(Mode mode, const State<T>& y, const Input<T>& input) const {
    if (is_.driven_load && is_.has.is_direct() && !is_.lagging)
      mode.load = sign_of_load(mode, y, input);
    return settle(mode, y, input);
  }

  /// The mode that belongs to a state at the start.
  Mode mode_at(const State<T>& y, const Input<T>& input) const {
    const Axis<T>& p = m_.axis;
    const auto side = [](double value, double limit) {
      return static_cast<std::int8_t>(value > limit ? 1 : value < -limit ? -1 : 0);
    };
    Mode mode;
    // Teeth without play always touch: at rest, on one of the sides that are the same.
    if (is_.has.has_backlash)
      mode.contact = value_of(p.H) == 0.0 ? value_of(gear_position(y)) < 0.0 ? -1 : 1
                                          : side(value_of(gear_position(y)), value_of(p.H));
    if (is_.has.is_electric) mode.v_c = side(value_of(preamplifier(y)), value_of(p.V_L));
    if (is_.has.has_voltage_loop)
      mode.v_m = side(value_of(supply_demand(mode, y, input)), value_of(p.V_s));
    if (is_.driven_load) mode.load = sign_of_load(mode, y, input);
    const double speed = value_of(y[1]);
    if (!is_.directions) {
      mode.sliding = 1;
      return mode;
    }
    mode.sliding = side(speed, 0.0);
    mode.doublet = mode.sliding != 0 && is_.static_friction && std::abs(speed) < value_of(p.w);
    return settle(mode, y, input);
  }

  /// Completes a state and an input at the start: a lag has passed, a hysteresis is relaxed.
  void begin(State<T>& y, Input<T>& input) const {
    if (is_.lagging) y[7] = undelayed_input(mode_at(y, input), y, input);
    input.memory = {y[0], {}};
  }

 private:
  /// What the power stage would follow without lag, V.
  T undelayed_input(const Mode& mode, const State<T>& y, const Input<T>& input) const {
    return is_.has.is_direct() ? command(input) : preamplifier_voltage(mode, y);
  }

  static ActiveTerms active_terms_of(const Model<T>& model, const EffectSet& effects) {
    const Slots<T> slots = slots::affine(model.effects, effects);
    ActiveTerms is{};
    is.has = capabilities(model.structure);
    is.effects = effects;
    is.needs = slots::needs(effects);
    is.static_friction = is_active(model.axis.F_s);
    is.spring = is_active(slots.stiffness);
    is.asymmetric = is_active(slots.viscous_asymmetry);
    is.slope = is_active(slots.friction_slope);
    is.load = is_active(slots.load_friction) || is_active(slots.load_curve);
    is.driven_load = is.load && !is.has.has_backlash;
    is.directions = is.static_friction || is.asymmetric || is.slope || is.load ||
                    is_active(slots.friction_level) || is_active(slots.friction_asymmetry) ||
                    is.needs.friction_curve || is.needs.hysteresis;
    is.elastic = is_active(slots.elastic_mass);
    is.soft_supply = is_active(slots.supply_resistance);
    is.soft_encoder =
        !is.has.has_backlash && (is_active(slots.compliance) || is_active(slots.play));
    is.lagging = value_of(slots.drive_lag) > 0.0;
    is.lag_active = !is.lagging && is_active(slots.drive_lag);
    return is;
  }

  /// What the motor's demand takes of the supply that is limited to V_s, V: more by its drop.
  T supply_demand(const Mode& mode, const State<T>& y, const Input<T>& input) const {
    T v = motor_demand(mode, y, input);
    if (is_.soft_supply) v += slots_.supply_resistance * y[6];
    return v;
  }

  /// y5', V/s^2; (1).
  T preamplifier_curvature(const State<T>& y, const Input<T>& input) const {
    const Axis<T>& p = m_.axis;
    return (p.K_1 * command(input) - p.K_2 * p.K_t * y[3] - y[4] - (p.T_p + p.T_r) * y[5]) /
           (p.T_p * p.T_r);
  }

  /// Mass that effects add as the axis moves, kg, and its rate, kg/s.
  std::pair<T, T> changing_mass(const Mode& mode, const State<T>& y, const Input<T>& input) const {
    return slots::mass(m_.effects, is_.effects, instant(mode, y, input), input.memory);
  }

  /// y1' of an arm that slides, without disturbance, m/s^2.
  T undisturbed_acceleration(const Mode& mode, const State<T>& y, const Input<T>& input,
                             Terms terms) const {
    T force = applied_force(mode, y, input, terms), mass = moving_mass();
    if (is_.directions)
      force -=
          double(mode.sliding) * dry_friction(mode.doublet, mode.sliding, mode, y, input, terms);
    if (is_.needs.mass && terms == Terms::all) {
      const auto [more, rate] = changing_mass(mode, y, input);
      mass += more;
      force -= rate * y[1];
    }
    return force / mass;
  }

  /// w^2 q + 2 zeta w q' of the elastic mode, m/s^2.
  T elastic_rate(const State<T>& y) const {
    const T& w = slots_.elastic_frequency;
    return w * (w * y[8] + 2.0 * slots_.elastic_damping * y[9]);
  }

  Instant<T> instant(const Mode& mode, const State<T>& y, const Input<T>& input) const {
    const T force = current_force(mode, y, input);
    return {input.time,   y[0],           y[1],
            mode.sliding, y[2],           current(mode, y, input),
            force,        r_g_ * force,   load(mode, y, force),
            {},           &input.channels};
  }

  T motor_torque(const Mode& mode, const State<T>& y, const Input<T>& input) const {
    return slots::motor_torque(m_.effects, is_.effects, instant(mode, y, input), input.memory);
  }

  /// Force that the transmission carries, N: of the teeth on the side of their contact, or of the
  /// motor where there are none.
  T load(const Mode& mode, const State<T>& y, const T& drive) const {
    return is_.has.has_backlash ? double(mode.contact) * gear_force(mode, y)
                                : double(mode.load) * drive;
  }

  std::int8_t sign_of_load(const Mode& mode, const State<T>& y, const Input<T>& input) const {
    return value_of(current_force(mode, y, input)) < 0.0 ? -1 : 1;
  }

  /// Dry friction against a motion in `direction`, N, (6) and effects. Below zero it drives.
  T dry_friction(bool in_doublet, int direction, const Mode& mode, const State<T>& y,
                 const Input<T>& input, Terms terms) const {
    T level = slots_.friction_level;
    if (in_doublet) level += m_.axis.F_s;
    if (is_.directions) level += double(direction) * slots_.friction_asymmetry;
    if (is_.slope) level += slots_.friction_slope * y[0];
    if (is_.load) level += slots_.load_friction * load(mode, y, current_force(mode, y, input));
    if (is_.needs.friction_curve && terms == Terms::all)
      level +=
          slots::friction_curve(m_.effects, is_.effects, instant(mode, y, input), input.memory);
    return level;
  }

  /// Dry friction that has to be overcome to set off in `direction`, N.
  T holding_force(const Mode& mode, int direction, const State<T>& y, const Input<T>& input) const {
    return dry_friction(is_.static_friction, direction, mode, y, input, Terms::all);
  }

  Mode slide(Mode mode, int sign) const {
    mode.sliding = static_cast<std::int8_t>(sign);
    mode.doublet = is_.static_friction;
    return mode;
  }

  T stick_force(const Mode& mode, const State<T>& y, const Input<T>& input) const {
    T force = applied_force(mode, y, input);
    if (observer_.active()) force += observer_force(mode, y, input);
    return force;
  }

  T position_error(const State<T>& y, const TargetOf<T>& target) const {
    const Instrument<T>& encoder = m_.instruments[index_of(Signal::position)];
    return (target.position - encoder.bias) / encoder.gain - r_g_ * y[2];
  }

  T observer_acceleration(const State<T>& y, const TargetOf<T>& target) const {
    const Instrument<T>& meter = m_.instruments[index_of(Signal::velocity)];
    T a(0.0);
    if (observer_.velocity > 0.0)
      a += observer_.velocity * ((target.velocity - meter.bias) / meter.gain - y[1]);
    if (observer_.acceleration > 0.0) a += observer_.acceleration * position_error(y, target);
    return a;
  }

  // A copy of the model is not needed: equations live as long as the simulation that owns it.
  const Model<T>& m_;
  Observer observer_;
  Slots<T> slots_;
  ActiveTerms is_;
  T r_g_;
};

/// What an instrument without lag and delay reads of `signal`, without noise, in its unit.
template <class T>
T reading(const Equations<T>& equations, Signal signal, const Mode& mode, const State<T>& y,
          const Input<T>& input) {
  const Axis<T>& p = equations.model().axis;
  const Instrument<T>& instrument = equations.model().instruments[index_of(signal)];
  const auto truth = [&]() -> T {
    switch (signal) {
      case Signal::position:
        return equations.encoder_position(mode, y, input);
      case Signal::velocity:
        return y[1];
      case Signal::acceleration:
        return equations.acceleration(mode, y, input);
      case Signal::tachometer:
        return p.K_t * y[3];
      case Signal::motor_current:
        return equations.current(mode, y, input);
      case Signal::preamplifier_voltage:
        return equations.preamplifier_voltage(mode, y);
      case Signal::motor_voltage:
        return equations.motor_voltage(mode, y, input);
      case Signal::drive_force:
        return equations.drive_force(mode, y, input);
      case Signal::load_position:
        return y[0];
    }
    return T(0.0);
  };
  return instrument.gain * truth() + instrument.bias;
}

}  // namespace axisfit
