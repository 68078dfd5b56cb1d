#include "fit/search/trajectory_forces.h"

#include <ceres/jet.h>

#include <cmath>
#include <numbers>

#include "fit/solve/jet.h"
#include "sim/equations.h"

namespace axisfit {
namespace {

using T = ceres::Jet<double, kMostQuantities>;

/// The effect that a quantity belongs to, if it does.
std::optional<std::size_t> effect_of(std::size_t quantity) {
  return quantity_list()[quantity].effect;
}

EffectSet only(std::size_t effect) {
  EffectSet set;
  set.set(effect);
  return set;
}

/// A model whose dual parts are the derivatives with respect to these quantities.
Model<T> seeded(const Model<double>& model, std::span<const std::size_t> quantities) {
  Model<T> with = convert<T>(model);
  const std::vector<T*> member = members(with);
  for (std::size_t k = 0; k < quantities.size(); ++k)
    member[quantities[k]]->v[static_cast<Eigen::Index>(k)] = 1.0;
  return with;
}

/// The smooth accelerations along a trajectory.
class SmoothForce {
 public:
  SmoothForce(const Model<T>& model, bool sticks)
      : model_(model), equations_(model_), sticks_(sticks) {}

  /// Calls write(instant, y1', y3').
  template <class Write>
  void along(const std::vector<AxisInstant>& trajectory, Write&& write) const {
    RestMemory<T> memory{T(trajectory.front().state[0]), {}};
    Mode before;
    before.sliding = 0;
    for (std::size_t i = 0; i < trajectory.size(); ++i) {
      const AxisInstant& at = trajectory[i];
      Mode mode = at.mode;
      if (!sticks_ || mode.sliding != 0) mode.sliding = direction(at.state[1]);
      if (equations_.parts().driven_load)
        mode.load = direction(equations_.current_force(mode, state(at), input(at, memory)).a);
      if (mode.sliding != before.sliding && before.sliding != 0 && needs_memory())
        memory = memory_after(before, trajectory[i - 1], memory);
      before = mode;
      const State<T> rate = equations_.smooth_rate(mode, state(at), input(at, memory));
      write(i, rate[1], rate[3]);
    }
  }

 private:
  static std::int8_t direction(double x) {
    return static_cast<std::int8_t>(x > 0.0 ? 1 : x < 0.0 ? -1 : 0);
  }
  static State<T> state(const AxisInstant& at) {
    State<T> y;
    for (std::size_t i = 0; i < kStates; ++i) y[i] = T(at.state[i]);
    return y;
  }
  static Input<T> input(const AxisInstant& at, const RestMemory<T>& memory) {
    Input<T> input;
    input.command = T(at.input.command);
    input.time = T(at.input.time);
    input.memory = memory;
    input.channels = at.input.channels;
    return input;
  }
  bool needs_memory() const { return equations_.parts().needs.hysteresis; }
  /// The memory at the place where the motion turned: between two instants, nearly at the first.
  RestMemory<T> memory_after(const Mode& mode, const AxisInstant& at,
                             const RestMemory<T>& memory) const {
    State<T> y = state(at);
    Input<T> there = input(at, memory);
    equations_.cross(mode, Guard::stop, y, there);
    return there.memory;
  }

  const Model<T> model_;
  const Equations<T> equations_;
  const bool sticks_;
};

/// What an elastic mode does to an arm that moves as if it had none: with q its displacement, which
/// the arm's acceleration drives, the rest of the arm is moved by the force -m_e q''. Between two
/// instants the acceleration is taken as its mean.
class ModeForce {
 public:
  ModeForce(const Slots<T>& slots, const Model<double>& without, const Observer& observer)
      : mass_(slots.elastic_mass),
        frequency_(slots.elastic_frequency),
        damping_(slots.elastic_damping),
        model_(without),
        equations_(model_, observer) {}

  /// Calls write(instant, y1', mean y1' since the instant before).
  template <class Write>
  void along(const std::vector<AxisInstant>& trajectory, Write&& write) const {
    const T part = mass_ / equations_.moving_mass();
    T q(0.0), rate(0.0), mean(0.0);
    double duration = 0.0;
    Swing swing;
    for (std::size_t i = 0; i < trajectory.size(); ++i) {
      const AxisInstant& at = trajectory[i];
      if (i > 0) {
        const double step = at.input.time - trajectory[i - 1].input.time;
        if (std::abs(step - duration) > 1e-9 * step) swing = swing_of(duration = step);
        const T rest = -mean_acceleration(trajectory[i - 1], at) / (frequency_ * frequency_);
        const T away = q - rest, before = rate;
        q = rest + swing.cosine * away + swing.sine * (before + damping_ * frequency_ * away);
        rate = swing.cosine * before -
               swing.sine * frequency_ * (frequency_ * away + damping_ * before);
        mean = (before - rate) / step;
      }
      const T swinging = acceleration(at) + frequency_ * (frequency_ * q + 2.0 * damping_ * rate);
      write(i, part * swinging, part * mean);
    }
  }

 private:
  /// exp(-zeta w t) cos(w' t), and with sin(w' t) / w', w' = w sqrt(1 - zeta^2).
  struct Swing {
    T cosine{0.0}, sine{0.0};
  };
  double acceleration(const AxisInstant& at) const {
    return equations_.acceleration(at.mode, at.state, at.input);
  }
  /// Of an impact between the two, the speed tells: but for what the observer makes of it.
  double mean_acceleration(const AxisInstant& from, const AxisInstant& to) const {
    if (to.is_moved) return 0.5 * (acceleration(from) + acceleration(to));
    const double step = to.input.time - from.input.time;
    return (to.state[1] - from.state[1]) / step - 0.5 * (correction(from) + correction(to));
  }
  double correction(const AxisInstant& at) const {
    if (at.mode.sliding == 0) return 0.0;
    return equations_.observer_force(at.mode, at.state, at.input) / equations_.moving_mass();
  }
  Swing swing_of(double duration) const {
    const T damped = frequency_ * sqrt(1.0 - damping_ * damping_);
    const T decay = exp(-damping_ * frequency_ * duration);
    return {decay * cos(damped * duration), decay * sin(damped * duration) / damped};
  }

  const T mass_, frequency_, damping_;  // rad/s
  const Model<double> model_;
  const Equations<double> equations_;
};

bool is_elastic_mode(std::size_t quantity) {
  static const std::size_t kMode = *effect_named(ElasticMode<double>::name);
  return effect_of(quantity) == kMode;
}

}  // namespace

bool is_smooth_force(std::size_t quantity) {
  const auto effect = effect_of(quantity);
  if (!effect) return false;
  const EffectSet alone = only(*effect);
  if (!slots::needs(alone).is_smooth()) return false;
  Model<double> with{};
  const Slots<double> without = slots::affine(with.effects, alone);
  *members(with)[quantity] = 1.0;
  Slots<double> affine = slots::affine(with.effects, alone);
  affine.load_curve = without.load_curve;  // asks for a guard, and adds nothing
  return affine == without;
}

bool is_read_off(const Hypothesis& hypothesis, const std::vector<double>& shapes, double interval) {
  const auto acts_as_disturbance = [&](std::size_t quantity) {
    if (!is_elastic_mode(quantity)) return is_smooth_force(quantity);
    constexpr double kFollowed = 0.12;  // cycles between two instants
    return shapes[0] * interval < kFollowed && shapes[1] < 1.0;
  };
  return hypothesis.probes.empty() &&
         std::ranges::all_of(hypothesis.strengths, acts_as_disturbance);
}

Disturbances disturbances_of(const Model<double>& model, const Model<double>& without,
                             std::span<const std::size_t> quantities, const Observer& observer,
                             const std::vector<AxisInstant>& trajectory) {
  const auto columns = static_cast<Eigen::Index>(quantities.size());
  Disturbances d;
  d.arm.resize(static_cast<Eigen::Index>(trajectory.size()), columns);
  d.arm_mean.resizeLike(d.arm);
  d.motor.setZero(d.arm.rows(), columns);
  const Model<T> with = seeded(model, quantities);
  const std::size_t first = quantities.front();
  if (is_elastic_mode(first)) {
    ModeForce(slots::affine(with.effects, only(*effect_of(first))), without, observer)
        .along(trajectory, [&](std::size_t i, const T& arm, const T& mean) {
          d.arm.row(static_cast<Eigen::Index>(i)) = arm.v.head(columns);
          d.arm_mean.row(static_cast<Eigen::Index>(i)) = mean.v.head(columns);
        });
  } else {
    SmoothForce(with, Equations<double>(without).parts().directions)
        .along(trajectory, [&](std::size_t i, const T& arm, const T& motor) {
          d.arm.row(static_cast<Eigen::Index>(i)) = arm.v.head(columns);
          d.motor.row(static_cast<Eigen::Index>(i)) = motor.v.head(columns);
        });
    const Eigen::Index rest = d.arm.rows() - 1;
    d.arm_mean.topRows(1) = d.arm.topRows(1);
    d.arm_mean.bottomRows(rest) = 0.5 * (d.arm.topRows(rest) + d.arm.bottomRows(rest));
  }
  return d;
}

}  // namespace axisfit
