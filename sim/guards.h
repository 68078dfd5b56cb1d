// The guards of one mode during a step, and whether one crosses zero.
//
// Without smooth forces a guard is affine in the state y and the inputs w, G y + H w, and so it is
// at any instant within a step in what the step begins with:
//
//   g(t) = g(0) + G Psi(t) f + (G Xi(t) r + H t) s
//
// (propagator.h; f = y', r and s the ramps and slopes of the observer's target). So the guards of a
// step of any length are evaluated as densely as its fastest oscillation requires, at the cost of
// one product with a matrix.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "sim/affine.h"

namespace axisfit {

/// Values, rates and tolerances of all guards of a mode at one instant.
struct GuardValues {
  struct Node {
    double value, rate, tolerance;
  };
  std::array<Node, kGuards> nodes;
  std::size_t count = 0;

  void push_back(const Node& node) { nodes[guard_place(count++)] = node; }
};

/// All guards of a mode without smooth forces, and their rates.
class LinearGuards {
 public:
  /// Values, then rates, of `count` guards.
  using Form = std::array<double, 2 * kGuards>;

  /// `a`, `b`: A and B of the mode.
  LinearGuards(const Equations<double>& equations, const Mode& mode, const Matrix<double>& a,
               const PerInput<State<double>>& b, const RampList& ramps)
      : states_used_(equations.states()),
        has_observer_(equations.observer().active()),
        ramps_(ramps) {
    const auto read = [&](const State<double>& y, const Input<double>& input, Form& form) {
      count_ = 0;
      equations.visit_guards(mode, y, input,
                             [&](Guard, double g, double) { form[guard_place(count_++)] = g; });
    };
    for (std::size_t c = 0; c < kInputs; ++c)
      read(State<double>{}, large_input<double>(c), inputs_[c]);
    for (std::size_t j = 0; j < kStates; ++j) {
      State<double> large{};
      large[j] = kLarge;
      read(large, {}, states_[j]);
    }
    for (std::size_t i = 0; i < count_; ++i) {
      const double constant = inputs_[kConstantInput][i];
      for (std::size_t c = kConstantInput + 1; c < kInputs; ++c)
        inputs_[c][i] = (inputs_[c][i] - constant) / kLarge;
      for (Form& form : states_) form[i] = (form[i] - constant) / kLarge;
      // Rates behind the values: G A and G B.
      for (std::size_t k = 0; k < kStates; ++k) {
        for (std::size_t j = 0; j < kStates; ++j) states_[j][count_ + i] += states_[k][i] * a[k][j];
        for (std::size_t c = 0; c < kInputs; ++c) inputs_[c][count_ + i] += states_[k][i] * b[c][k];
      }
    }
  }

  std::size_t count() const { return count_; }
  std::size_t states() const { return states_used_; }
  const RampList& ramps() const { return ramps_; }

  /// Without tolerances. `slope`: of the ramps, per second.
  GuardValues guard_values(const State<double>& y, const Input<double>& input,
                           const Slopes& slope) const {
    Form sum = inputs_[kConstantInput];
    add(sum, input.command, inputs_[kCommandInput]);
    for (std::size_t j = 0; j < states_used_; ++j) add(sum, y[j], states_[j]);
    if (has_observer_) {
      add(sum, input.target.velocity, inputs_[kTargetVelocityInput]);
      add(sum, input.target.position, inputs_[kTargetPositionInput]);
    }
    for (const std::size_t ramp : ramps_) add_ramp(sum, slope[ramp], ramp, 0.0);
    GuardValues seen;
    seen.count = count_;
    for (std::size_t i = 0; i < count_; ++i) seen.nodes[i] = {sum[i], sum[count_ + i], 0.0};
    return seen;
  }

  /// What a change d of the state does: G d and G A d.
  Form change(const State<double>& d) const {
    Form sum{};
    for (std::size_t j = 0; j < states_used_; ++j) add(sum, d[j], states_[j]);
    return sum;
  }
  /// What a ramp that has risen for t seconds does to sum, at `factor` per second.
  void add_ramp(Form& sum, double factor, std::size_t ramp, double t) const {
    const Form& form = inputs_[kCommandInput + ramp];
    add(sum, factor * t, form);
    for (std::size_t i = 0; i < count_; ++i) sum[count_ + i] += factor * form[i];
  }

 private:
  void add(Form& sum, double factor, const Form& form) const {
    for (std::size_t i = 0; i < 2 * count_; ++i) sum[i] += factor * form[i];
  }

  std::size_t states_used_;
  bool has_observer_;
  RampList ramps_;
  std::size_t count_ = 0;
  std::array<Form, kStates> states_{};
  PerInput<Form> inputs_{};
};

/// What a guard does in a step.
enum class Crossing {
  none,     ///< stays positive
  touched,  ///< may not, but is positive at the end
  passed,   ///< is negative at the end, and met no sooner than once
};

/// Whether the cubic through values and rates dips below the margin between its ends, where it
/// falls at the first and rises at the last. It may begin at zero: so do the teeth on the far side
/// of a gap of no width.
inline bool dips(double p, double p_rate, double q, double q_rate, double h, double margin) {
  const double d = q - p, b = 3.0 * d - (2.0 * p_rate + q_rate) * h,
               a = (p_rate + q_rate) * h - 2.0 * d,
               c = p_rate * h;  // a s^3 + b s^2 + c s + p
  const double root = b * b - 3.0 * a * c;
  if (root < 0.0) return false;
  const double s = -c / (b + std::sqrt(root));
  return s > 0.0 && s < 1.0 && ((a * s + b) * s + c) * s + p < margin;
}

/// The guards at instants that divide a step evenly.
class GuardCourse {
 public:
  /// The most parts of a step.
  static constexpr std::size_t kMaxParts = 32;

  GuardCourse(const GuardValues& start, const GuardValues& end, std::size_t parts, double length)
      : parts_(parts), part_(length / static_cast<double>(parts)), count_(end.count) {
    set(0, start);
    set(parts, end);
  }

  void set(std::size_t instant, const GuardValues& seen) {
    for (std::size_t i = 0; i < count_; ++i) {
      value(instant, i) = seen.nodes[i].value;
      rate(instant, i) = seen.nodes[i].rate;
    }
  }
  /// Of all instants but the first and the last: values, then rates, of each.
  double* inner() { return &value(1, 0); }

  /// `doubted`: every other instant is there to tell how far a cubic is to be trusted.
  Crossing review(bool doubted, const std::array<double, kGuards>& tolerance) const {
    Crossing course = Crossing::none;
    for (std::size_t i = 0; i < count_; ++i)
      if (value(parts_, i) < -tolerance[i]) course = Crossing::passed;
    for (std::size_t k = 1; k < parts_; ++k)
      for (std::size_t i = 0; i < count_; ++i)
        if (value(k, i) < -tolerance[i]) return Crossing::touched;
    for (std::size_t k = 0; k < parts_; ++k)
      for (std::size_t i = 0; i < count_; ++i) {
        if (!(rate(k, i) < 0.0 && rate(k + 1, i) > 0.0)) continue;  // as nearly always
        double margin = -tolerance[i];
        if (doubted) {
          // What a cubic over both parts gets wrong between them.
          const std::size_t first = k & ~std::size_t{1};
          const double error =
              std::abs(value(first + 1, i) - 0.5 * (value(first, i) + value(first + 2, i)) -
                       0.25 * part_ * (rate(first, i) - rate(first + 2, i)));
          margin += 0.25 * error;
        }
        if (dips(value(k, i), rate(k, i), value(k + 1, i), rate(k + 1, i), part_, margin))
          return Crossing::touched;
      }
    return course;
  }

 private:
  double& value(std::size_t instant, std::size_t guard) {
    return nodes_[2 * count_ * instant + guard];
  }
  double& rate(std::size_t instant, std::size_t guard) { return value(instant, count_ + guard); }
  double value(std::size_t instant, std::size_t guard) const {
    return nodes_[2 * count_ * instant + guard];
  }
  double rate(std::size_t instant, std::size_t guard) const {
    return value(instant, count_ + guard);
  }

  std::size_t parts_;
  double part_;  // s
  std::size_t count_;
  std::array<double, 2 * kGuards*(kMaxParts + 1)> nodes_;
};

/// The linear forms of all guards at the instants that divide a step into 2^halvings parts.
class GuardForms {
 public:
  GuardForms(const LinearGuards& guards, Propagator<double>& propagator, int level, int halvings)
      : guards_(guards.count()),
        states_(guards.states()),
        inner_((1U << halvings) - 1U),
        ramps_(guards.ramps()) {
    const double part = propagator.step_levels().length(level + halvings);
    columns_.reserve((states_ + ramps_.size()) * inner_ * 2 * guards_);
    const auto keep = [&](const LinearGuards::Form& form) {
      columns_.insert(columns_.end(), form.begin(),
                      form.begin() + static_cast<std::ptrdiff_t>(2 * guards_));
    };
    for (std::size_t j = 0; j < states_; ++j) {  // the effect of f_j = 1
      State<double> d{}, unit{};
      unit[j] = 1.0;
      const LinearGuards::Form by_unit = guards.change(unit);
      for (std::size_t k = 1; k <= inner_; ++k) {
        State<double> f = propagator.a_times(d);
        f[j] += 1.0;
        d = propagator.advance(d, f, {}, level + halvings);
        LinearGuards::Form form = guards.change(d);
        for (std::size_t i = 0; i < guards_; ++i) form[guards_ + i] += by_unit[i];
        keep(form);
      }
    }
    for (const std::size_t ramp : ramps_) {
      State<double> d{};
      Slopes slope{};
      slope[ramp] = 1.0;
      for (std::size_t k = 1; k <= inner_; ++k) {
        State<double> f = propagator.a_times(d);
        propagator.add_ramps(f, slope, part * static_cast<double>(k - 1));
        d = propagator.advance(d, f, slope, level + halvings);
        LinearGuards::Form form = guards.change(d);
        guards.add_ramp(form, 1.0, ramp, part * static_cast<double>(k));
        keep(form);
      }
    }
  }

  /// Puts values and rates at the inner instants into the course of a step that begins with
  /// `start`, with the rate of change f.
  void follow(const GuardValues& start, const State<double>& f, const Slopes& slope,
              GuardCourse& course) const {
    const std::size_t size = inner_ * 2 * guards_;
    if (size == 0) return;
    double* const sum = course.inner();
    for (std::size_t k = 0; k < inner_; ++k)
      for (std::size_t i = 0; i < guards_; ++i) {
        sum[2 * guards_ * k + i] = start.nodes[i].value;
        sum[2 * guards_ * k + guards_ + i] = 0.0;
      }
    const double* column = columns_.data();
    const auto add = [&](double factor) {
      for (std::size_t i = 0; i < size; ++i) sum[i] += factor * column[i];
      column += size;
    };
    for (std::size_t j = 0; j < states_; ++j) add(f[j]);
    for (const std::size_t ramp : ramps_) add(slope[ramp]);
  }

 private:
  std::size_t guards_, states_, inner_;
  RampList ramps_;
  std::vector<double> columns_;  // by components of f, then by ramps
};

}  // namespace axisfit
