// Integration of the axis through its modes, with located events that carry derivatives.
//
// Method. Within a mode the system is affine but for the smooth forces of effects, so the affine
// part is propagated exactly (propagator.h) and the rest by the classical Runge-Kutta method in the
// moving frame of the affine part, with its value at the start of the step frozen into that part:
// a constant rest is exact too. Stiffness of the current loop or the gear does not limit the step.
//
// Events. Every step is first tried on plain values, in pieces that are short against the mode's
// fastest oscillation, and all guards of the mode are looked at: at the ends of the pieces, by a
// cubic through values and rates within, and in the middle where that turns much. A step that meets
// one is cut in halves down to the shortest length of the ladder, where Newton's method on the
// guard ends the search. Then the step is taken in T, and the crossing time is corrected by -g / g'
// in T: the event time carries its derivatives, and so does every length that is measured from it.
// After each event, and after each switch of the command, steps grow again from the shortest, so
// that fast transients are resolved and what they set off is seen.
//
// Limits. Derivatives are those of a fixed sequence of transversal events; where two events
// coincide or a guard is touched without crossing, they are one-sided. The smooth forces must not
// be stiff (rate * step < 1). A guard that is left and entered again within a step, without the
// cubic showing it, is missed.
#pragma once

#include <atomic>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "sim/equations.h"
#include "sim/propagator.h"

namespace axisfit {

struct IntegratorOptions {
  /// s. Longest step. The affine part is exact at any step: it is how often guards are looked at,
  /// and the Runge-Kutta step of smooth effects.
  double step = 0.5e-3;
  /// Whether event times carry derivatives. Off only to show what that is worth.
  bool event_derivatives = true;
  /// Events within one step length before the simulation is given up as chattering.
  int event_limit = 1000;
  /// Events altogether before it is given up as too slow.
  long event_budget = 100'000'000;
  /// Steps altogether before it is given up, since it swings too fast to be followed.
  long step_budget = 200'000'000;
  /// When this is set, from another thread or by a signal, a simulation ends unfinished.
  const std::atomic<bool>* stop = nullptr;
  /// Where the modes passed through are noted, the first included; null: nowhere.
  std::vector<ModeChange>* modes = nullptr;
};

template <class T>
class Integrator {
 public:
  Integrator(const Model<T>& model, const Coupling& coupling, const IntegratorOptions& options)
      : options_(options),
        model_(model),
        plain_model_(convert<double>(model)),
        equations_(model_, coupling),
        plain_(plain_model_, coupling, equations_.parts()) {}

  Integrator(const Integrator&) = delete;
  Integrator& operator=(const Integrator&) = delete;

  /// Begins at `time` with the model's initial state and the given command (V).
  void start(double time, const T& command, const Target& target) {
    y_ = initial_state(model_);
    input_ = {command, {T(target.velocity), T(target.position)}, T(time), {}};
    slope_ = {};
    equations_.begin(y_, input_);
    copy_plain_input();
    switch_mode(equations_.mode_at(y_, input_));
  }

  /// Switches the command, now.
  void set_command(const T& command) {
    input_.command = command;
    copy_plain_input();
    switch_mode(equations_.switched(mode_, y_, input_));
  }

  /// From now on the coupling's target is `target` and moves with the rate `slope` per second.
  void set_target(const Target& target, const Target& slope) {
    input_.target = {T(target.velocity), T(target.position)};
    copy_plain_input();
    slope_ = slope;
    here_.reset();
    if (equations_.coupling().active()) {
      target_rate_ = equations_.rate_of_target(mode_, slope_);
      plain_target_rate_ = plain_.rate_of_target(mode_, slope_);
    }
  }

  /// Goes on to the instant `end` (s), not before the present time.
  /// Returns false when the motion chatters, swings too fast to be followed, or is not finite any
  /// more; the state is then useless.
  bool advance_to(const T& end);

  /// s. How much later than written a command acts: the dead time, and the derivative of a force
  /// source's lag at zero, which delays like it.
  T command_delay() const { return model_.axis.T_d + equations_.lag_of_switching(); }

  const T& time() const { return input_.time; }
  const State<T>& state() const { return y_; }
  const Mode& mode() const { return mode_; }
  const Input<T>& input() const { return input_; }
  const Equations<T>& equations() const { return equations_; }
  /// Number of events so far.
  int events() const { return events_; }
  /// Number of steps so far, those of the search for events included.
  long steps() const { return steps_; }

 private:
  /// Everything that one linear system needs, in T and on plain values.
  struct Flow {
    Propagator<T> exact;
    Propagator<double> plain;
    double oscillation;  ///< rad/s, the fastest of the mode
    int longest;         ///< level of the longest step that shows it
  };

  struct Hit {
    Guard guard;
    double delay;  ///< s after the start of the trial step
  };

  template <class S>
  struct View {  // one of the two scalar types
    const Equations<S>& equations;
    const Propagator<S>& propagator;
    const Input<S>& input;
    const State<S>* target_rate;  // null when uncoupled
  };
  View<T> exact() const {
    return {equations_, flow_->exact, input_, coupled() ? &target_rate_ : nullptr};
  }
  View<double> plain() const {
    return {plain_, flow_->plain, plain_input_, coupled() ? &plain_target_rate_ : nullptr};
  }

  State<double> plain_state() const {
    State<double> y;
    for (std::size_t i = 0; i < kStates; ++i) y[i] = value_of(y_[i]);
    return y;
  }
  bool coupled() const { return equations_.coupling().active(); }

  void copy_plain_input() {
    plain_input_ = {value_of(input_.command),
                    {value_of(input_.target.velocity), value_of(input_.target.position)},
                    value_of(input_.time),
                    {value_of(input_.memory.position), value_of(input_.memory.hysteresis)}};
  }
  /// The input after `length` seconds.
  template <class S, class U>
  Input<S> moved(Input<S> input, const U& length) const {
    input.time += length;
    input.target.move(slope_, length);
    return input;
  }

  void switch_mode(const Mode& mode);
  const Flow& flow_of(const Mode& mode);

  template <class S>
  State<S> step(const View<S>& view, const State<S>& y, int level) const;
  template <class S>
  State<S> step_by(const View<S>& view, const State<S>& y, double length) const {
    return view.propagator.advance_by(y, view.equations.rate(mode_, y, view.input),
                                      view.target_rate, length);
  }

  /// Values, rates and tolerances of all guards of the mode at one instant.
  struct Look {
    struct Node {
      double value, rate, tolerance;
    };
    std::array<Node, 8> nodes;
    std::size_t count = 0;
  };
  Look look(const View<double>& view, const State<double>& y) const {
    Look seen;
    visit_guards_and_rates(view, y, [&](Guard, double g, double rate, double scale) {
      seen.nodes[seen.count++] = {g, rate, 1e-12 * scale};
    });
    return seen;
  }
  static bool met_between(const Look& start, const Look* middle, const Look& end, double length);
  /// Tries a step of `length` on plain values, in pieces that are short enough to see every
  /// oscillation; `level` is its place in the ladder, or past its end for a step by the series.
  /// Returns whether a guard is met on the way, otherwise the end in `to` and the guards there.
  bool meets_guard(const State<double>& from, int level, double length, State<double>& to);
  std::optional<Hit> locate(const State<double>& from, const State<double>& to,
                            double length) const;
  void move_time(double length);
  void pass_event(const Hit& hit);

  /// Rate of a guard's value: where it is affine, a unit step along the rates gives it exactly.
  template <class S, class Visitor>
  void visit_guards_and_rates(const View<S>& view, const State<S>& y, Visitor&& visit) const {
    const State<S> f = view.equations.rate(mode_, y, view.input);
    std::array<std::pair<S, S>, 8> values;
    std::size_t n = 0;
    view.equations.visit_guards(mode_, y, view.input,
                                [&](Guard, const S& g, double) { values[n++].first = g; });
    // Else a short one does, to a few digits: enough for a search, and for the slope of an event.
    const double ahead = mode_.sliding == 0 && equations_.has_smooth_forces() ? 1e-7 : 1.0;  // s
    State<S> y_ahead = y;
    for (std::size_t i = 0; i < kStates; ++i) y_ahead[i] += ahead * f[i];
    n = 0;
    view.equations.visit_guards(
        mode_, y_ahead, moved(view.input, ahead), [&](Guard guard, const S& g, double scale) {
          visit(guard, values[n].first, (g - values[n].first) / ahead, scale);
          ++n;
        });
  }

  const IntegratorOptions options_;
  const Model<T> model_;
  const Model<double> plain_model_;
  const Equations<T> equations_;
  const Equations<double> plain_;
  std::map<int, std::unique_ptr<Flow>> flows_;

  State<T> y_{};
  Mode mode_;
  Input<T> input_;
  Input<double> plain_input_;
  Target slope_;
  State<T> target_rate_{};
  State<double> plain_target_rate_{};
  const Flow* flow_ = nullptr;
  int level_ = 0;  // of the longest step now allowed; falls to 0 as steps grow after an event
  std::optional<Look> here_;  // the guards at the present state, while they are known
  int events_ = 0;
  long steps_ = 0;
};

template <class T>
void Integrator<T>::switch_mode(const Mode& mode) {
  if (options_.modes != nullptr && (options_.modes->empty() || mode != mode_))
    options_.modes->push_back({value_of(input_.time), mode});
  mode_ = mode;
  here_.reset();
  flow_ = &flow_of(mode);
  level_ = flow_->exact.ladder().resolved;  // a switch may set off the fastest motions
  if (coupled()) {
    target_rate_ = equations_.rate_of_target(mode_, slope_);
    plain_target_rate_ = plain_.rate_of_target(mode_, slope_);
  }
}

template <class T>
const typename Integrator<T>::Flow& Integrator<T>::flow_of(const Mode& mode) {
  // The sign of a limit changes constants, not the matrix; those of contact, motion and load change
  // it where friction depends on them.
  const int contact = mode.contact == 0 ? 0 : equations_.signs_matter() ? mode.contact : 1;
  const int sliding = mode.sliding == 0 ? 0 : equations_.signs_matter() ? mode.sliding : 1;
  const int key = (mode.v_c != 0) | (mode.v_m != 0) << 1 | (contact + 1) << 2 | (sliding + 1) << 4 |
                  (mode.load + 1) << 6;
  std::unique_ptr<Flow>& flow = flows_[key];
  if (flow == nullptr) {
    Matrix<T> a;
    const Input<T> none{};
    const State<T> origin{};
    const State<T> offset = equations_.rate(mode, origin, none, Terms::affine);
    for (std::size_t j = 0; j < kStates; ++j) {
      State<T> unit{};
      unit[j] = T(1.0);
      const State<T> column = equations_.rate(mode, unit, none, Terms::affine);
      for (std::size_t i = 0; i < kStates; ++i) a[i][j] = column[i] - offset[i];
    }
    // Below the shortest length smooth forces are frozen, and events are not told apart: even where
    // nothing is stiff it has to be short.
    constexpr int kLeastHalvings = 12;
    const Ladder ladder = ladder_for(a, options_.step, kLeastHalvings);
    // One radian to either side of the middle of a step, where guards are looked at too.
    const double oscillation = fastest_oscillation(axisfit::value_of(a));
    const double radians = oscillation * options_.step;
    const int longest = std::clamp(
        static_cast<int>(std::ceil(std::log2(std::max(1e-9, radians / 2.0)))), 0, ladder.last);
    const std::size_t n = equations_.states();
    flow = std::make_unique<Flow>(
        Flow{Propagator<T>(a, ladder, coupled(), n),
             Propagator<double>(axisfit::value_of(a), ladder, coupled(), n), oscillation, longest});
  }
  return *flow;
}

template <class T>
template <class S>
State<S> Integrator<T>::step(const View<S>& view, const State<S>& y, int level) const {
  const Propagator<S>& p = view.propagator;
  const State<S> f = view.equations.rate(mode_, y, view.input);
  const State<S> end = p.advance(y, f, view.target_rate, level);
  if (!view.equations.has_smooth_forces() || level == p.ladder().last) return end;
  // Classical Runge-Kutta for n(y) = N(y) - N(y at the start) in the frame that moves with the
  // affine flow.
  const double h = p.ladder().length(level);
  const State<S> start = view.equations.smooth_rate(mode_, y, view.input);
  const auto n = [&](const State<S>& at, double delay) {
    State<S> rest = view.equations.smooth_rate(mode_, at, moved(view.input, delay));
    for (std::size_t i = 0; i < kStates; ++i) rest[i] -= start[i];
    return rest;
  };
  const auto plus = [](State<S> a, double factor, const State<S>& b) {
    for (std::size_t i = 0; i < kStates; ++i) a[i] += factor * b[i];
    return a;
  };
  const State<S> middle = p.advance(y, f, view.target_rate, level + 1);
  const State<S> k2 = n(middle, 0.5 * h);  // k1 = 0
  // Behind an event steps are so short that the midpoint rule is as good.
  constexpr int kShort = 4;
  if (level >= flow_->longest + kShort) return plus(end, h, p.exponential(k2, level + 1));
  const State<S> k3 = n(plus(middle, 0.5 * h, k2), 0.5 * h);
  const State<S> k4 = n(plus(end, h, p.exponential(k3, level + 1)), h);
  const State<S> inner = p.exponential(plus(k2, 1.0, k3), level + 1);
  return plus(plus(end, h / 3.0, inner), h / 6.0, k4);
}

template <class T>
bool Integrator<T>::met_between(const Look& start, const Look* middle, const Look& end,
                                double length) {
  using Node = typename Look::Node;
  // Whether the cubic through values and rates dips below the margin between its ends.
  const auto dips = [](const Node& p, const Node& q, double h, double margin) {
    if (!(p.rate < 0.0 && q.rate > 0.0) || p.value <= 0.0) return false;
    const double d = q.value - p.value, b = 3.0 * d - (2.0 * p.rate + q.rate) * h,
                 a = (p.rate + q.rate) * h - 2.0 * d,
                 c = p.rate * h;  // a s^3 + b s^2 + c s + value
    const double root = b * b - 3.0 * a * c;
    if (root < 0.0) return false;
    const double s = -c / (b + std::sqrt(root));
    return s > 0.0 && s < 1.0 && ((a * s + b) * s + c) * s + p.value < margin;
  };
  for (std::size_t n = 0; n < end.count; ++n) {
    const Node &p = start.nodes[n], &q = end.nodes[n];
    if (q.value < -q.tolerance) return true;
    if (middle == nullptr) {
      if (dips(p, q, length, -q.tolerance)) return true;
      continue;
    }
    const Node& half = middle->nodes[n];
    if (half.value < -half.tolerance) return true;
    // What the cubic over the whole step gets wrong in the middle tells how far to trust the
    // halves.
    const double error =
        std::abs(half.value - 0.5 * (p.value + q.value) - 0.125 * length * (p.rate - q.rate));
    const double margin = 0.25 * error - q.tolerance;
    if (dips(p, half, 0.5 * length, margin) || dips(half, q, 0.5 * length, margin)) return true;
  }
  return false;
}

template <class T>
bool Integrator<T>::meets_guard(const State<double>& from, int level, double length,
                                State<double>& to) {
  const Ladder& ladder = flow_->plain.ladder();
  const View<double> now = plain();
  if (!here_) here_ = look(now, from);
  Look start = *here_;
  const bool by_series = level > ladder.last;
  const int fine = by_series ? level : std::max(level, flow_->longest);
  const long pieces = by_series ? 1 : 1L << (fine - level);
  const double piece = length / static_cast<double>(pieces);
  Input<double> input = now.input;
  const View<double> view{now.equations, now.propagator, input, now.target_rate};
  const auto move = [&](double t) { input = moved(input, t); };
  // A cubic does without the middle where the fastest oscillation turns by less than this.
  constexpr double kSmooth = 0.5;  // rad
  const bool halved = !by_series && fine < ladder.last && flow_->oscillation * piece > kSmooth;
  to = from;
  for (long i = 0; i < pieces && steps_ <= options_.step_budget; ++i) {
    ++steps_;  // also one that meets a guard: a search without end has to end
    State<double> middle;
    if (halved) middle = step(view, to, fine + 1);
    to = by_series ? step_by(view, to, piece) : step(view, to, fine);
    for (const double x : to)
      if (!std::isfinite(x)) return false;
    Look half;
    if (halved) {
      move(0.5 * piece);
      half = look(view, middle);
    }
    move(halved ? 0.5 * piece : piece);
    const Look end = look(view, to);
    if (met_between(start, halved ? &half : nullptr, end, piece)) return true;
    start = end;
  }
  here_ = start;
  return false;
}

template <class T>
std::optional<typename Integrator<T>::Hit> Integrator<T>::locate(const State<double>& from,
                                                                 const State<double>& to,
                                                                 double length) const {
  std::optional<Hit> first;
  const View<double> view = plain();
  view.equations.visit_guards(
      mode_, to, moved(view.input, length), [&](Guard guard, double g, double scale) {
        if (g >= -1e-12 * scale) return;
        double low = 0.0, high = length, t = 0.0;
        for (int i = 0; i < 60 && high - low > 1e-15 * length; ++i) {
          const Input<double> input = moved(view.input, t);
          const State<double> y = t > 0.0 ? step_by(view, from, t) : from;
          double value = 0.0, rate = 0.0;
          visit_guards_and_rates({view.equations, view.propagator, input, view.target_rate}, y,
                                 [&](Guard other, double g_t, double rate_t, double) {
                                   if (other == guard) value = g_t, rate = rate_t;
                                 });
          // A guard that starts at zero and rises, as that of an arm which has just broken away,
          // was not met there.
          if (value <= 0.0 && !(t == 0.0 && rate > 0.0))
            high = t;
          else
            low = t;
          if (high <= 0.0 || (value == 0.0 && t > 0.0)) break;
          const double newton = t - value / rate;
          const double next = newton > low && newton < high ? newton : 0.5 * (low + high);
          if (next == t) break;
          t = next;
        }
        const double delay = high <= 0.0 ? 0.0 : t;
        if (!first || delay < first->delay) first = Hit{guard, delay};
      });
  return first;
}

template <class T>
void Integrator<T>::move_time(double length) {
  input_ = moved(input_, length);
  copy_plain_input();
}

template <class T>
void Integrator<T>::pass_event(const Hit& hit) {
  if (hit.delay > 0.0) y_ = step_by(exact(), y_, hit.delay);
  move_time(hit.delay);
  // One Newton step on the guard in T. Its value is rounding; its derivatives are those of the
  // event time.
  T correction(0.0);
  visit_guards_and_rates(exact(), y_, [&](Guard guard, const T& g, const T& rate, double) {
    if (guard == hit.guard && value_of(rate) != 0.0)
      correction = -derivative_part(g) / value_of(rate);
  });
  if (!options_.event_derivatives) correction = T(0.0);
  const State<T> f = equations_.rate(mode_, y_, input_);
  for (std::size_t i = 0; i < kStates; ++i) y_[i] += f[i] * correction;
  input_ = moved(input_, correction);
  ++events_;
  const Mode next = equations_.cross(mode_, hit.guard, y_, input_);
  copy_plain_input();
  switch_mode(next);
  level_ = flow_->exact.ladder().last;  // another event may follow closely
}

template <class T>
bool Integrator<T>::advance_to(const T& end) {
  const double last = value_of(end);
  const double negligible = 1e-9 * options_.step;
  // As a floating-point number: an interval of days has more than an int can count.
  const double event_limit =
      events_ +
      options_.event_limit * (1.0 + std::floor((last - value_of(input_.time)) / options_.step));
  int search = 0;  // level of the search for an event; 0: no search under way
  while (true) {
    const double remaining = last - value_of(input_.time);
    if (!(remaining > negligible)) break;
    const Ladder& ladder = flow_->exact.ladder();
    int level = std::max(level_, search);
    // The last piece of an interval, of whatever length, is for the series, where that holds.
    const bool piece = ladder.length(level) > remaining + negligible && search == 0 &&
                       !equations_.has_smooth_forces() &&
                       remaining <= ladder.length(ladder.resolved);
    while (level <= ladder.last && ladder.length(level) > remaining + negligible) ++level;
    const bool shortest = level >= ladder.last;
    const bool by_series = piece || level > ladder.last;
    const double length =
        piece ? remaining : std::min(remaining, ladder.length(std::min(level, ladder.last)));

    const State<double> from = plain_state();
    State<double> to;
    const bool met = meets_guard(from, by_series ? ladder.last + 1 : level, length, to);
    if (steps_ > options_.step_budget ||
        (options_.stop != nullptr && options_.stop->load(std::memory_order_relaxed)))
      return false;
    if (met) {
      if (!shortest) {
        search = piece ? level : std::max(level, flow_->longest - 1) + 1;
        continue;
      }
      if (const std::optional<Hit> hit = locate(from, to, length)) {
        if (events_ >= event_limit || events_ >= options_.event_budget) return false;
        pass_event(*hit);
        search = 0;
        continue;
      }
      here_.reset();
    }
    for (const double x : to)
      if (!std::isfinite(x)) return false;
    if constexpr (std::is_same_v<T, double>)
      y_ = to;
    else
      y_ = by_series ? step_by(exact(), y_, length) : step(exact(), y_, level);
    move_time(length);
    // Pieces are as exact as the whole only where there is nothing but the affine part.
    level_ = std::max(equations_.has_smooth_forces() ? flow_->longest : 0, level_ - 1);
    if (search > 0 && ++search > ladder.last + 1) search = 0;
  }
  // What is left is rounding, and the derivatives of the two instants.
  const T rest = end - input_.time;
  const State<T> f = equations_.rate(mode_, y_, input_);
  for (std::size_t i = 0; i < kStates; ++i) y_[i] += f[i] * rest;
  input_ = moved(input_, rest);
  input_.time = end;
  return true;
}

}  // namespace axisfit
