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
// that fast transients are resolved and what they set off is seen. Where all is affine, guards are
// looked at as linear forms (affine.h), and steps grow to the interval of the readings.
//
// Limits. Derivatives are those of a fixed sequence of transversal events; where two events
// coincide or a guard is touched without crossing, they are one-sided. The smooth forces must not
// be stiff (rate * step < 1). A guard that is left and entered again within a step, without the
// cubic showing it, is missed.
#pragma once

#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "sim/affine.h"
#include "sim/equations.h"
#include "sim/propagator.h"

namespace axisfit {

struct IntegratorOptions {
  /// s. Longest step of a coupled axis and of the Runge-Kutta method, for smooth effects. What is
  /// affine is exact at any step; guards are then looked at as often as the state is read.
  double step = 0.5e-3;
  /// s. Between the instants to which the integration will be advanced, if they are even; else
  /// about. Steps are a fraction of it. Zero: not known, steps are `step`.
  double interval = 0.0;
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
        plain_(plain_model_, coupling, equations_.parts()),
        step_(longest_step()) {}

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
    slopes_ = {slope.velocity, slope.position};
    here_.reset();
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
  /// What modes of one matrix share, in T and on plain values.
  struct System {
    Matrix<double> a;
    Propagator<T> exact;
    Propagator<double> plain;
    std::vector<Oscillation> oscillations;
  };
  /// Everything that one mode needs.
  struct Flow {
    System& system;
    Driven<State<T>> exact;
    Driven<State<double>> plain;
    std::optional<LinearGuards> guards;
  };

  struct Hit {
    Guard guard;
    double delay;  ///< s after the start of the trial step; before it by rounding, at most
  };

  template <class S>
  struct View {  // one of the two scalar types
    const Equations<S>& equations;
    Propagator<S>& propagator;
    const Driven<State<S>>& driven;
    const Input<S>& input;
  };
  View<T> exact() const { return {equations_, flow_->system.exact, flow_->exact, input_}; }
  View<double> plain() const { return {plain_, flow_->system.plain, flow_->plain, plain_input_}; }

  State<double> plain_state() const {
    State<double> y;
    for (std::size_t i = 0; i < kStates; ++i) y[i] = value_of(y_[i]);
    return y;
  }
  bool coupled() const { return equations_.coupling().active(); }
  const Ladder& ladder() const { return flow_->system.plain.ladder(); }

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

  /// Readings that fall on steps are cheapest. Runge-Kutta steps are bounded besides, and those of
  /// a coupled axis: its target turns at every sample and sets off what a long step does not see.
  double longest_step() const {
    if (!(options_.interval > 0.0)) return options_.step;
    if (!equations_.has_smooth_forces() && !coupled()) return options_.interval;
    return options_.interval / std::ceil(options_.interval / options_.step - 1e-9);
  }

  /// rad/s. The fastest oscillation that guards may show. Where nothing but switches sets any off,
  /// one is forgotten when it has died away to what a cubic does not follow either.
  double oscillation() const {
    constexpr double kForgotten = 9.0;  // e^-9 = 1e-4
    const bool at_rest = !coupled() && !equations_.has_smooth_forces();
    const double since = at_rest ? value_of(input_.time) - switched_ : 0.0;
    for (const Oscillation& o : flow_->system.oscillations)
      if (o.damping * since < kForgotten) return o.frequency;
    return 0.0;
  }
  /// Level of the longest step that shows it: one radian to either side of the middle, where guards
  /// are looked at too.
  int longest() const {
    const double radians = oscillation() * step_;
    if (radians <= 2.0) return 0;
    return std::min(static_cast<int>(std::ceil(std::log2(radians / 2.0))), ladder().last);
  }

  void switch_mode(const Mode& mode);
  System& system_of(const Mode& mode);
  Flow& flow_of(const Mode& mode);

  /// f(y), with smooth forces.
  template <class S>
  State<S> rate(const View<S>& view, const State<S>& y) const {
    // Values by the equations, which rounds least; with derivatives the matrix is cheaper.
    if constexpr (std::is_same_v<S, double>) return view.equations.rate(mode_, y, view.input);
    State<S> f = view.propagator.a_times(y);
    const auto add = [&](const S& factor, const State<S>& x) {
      for (std::size_t i = 0; i < equations_.states(); ++i) f[i] += factor * x[i];
    };
    for (std::size_t i = 0; i < equations_.states(); ++i) f[i] += view.driven[kByConstants][i];
    add(view.input.command, view.driven[kByCommand]);
    if (coupled()) {
      add(view.input.target.velocity, view.driven[kByTargetVelocity]);
      add(view.input.target.position, view.driven[kByTargetPosition]);
    }
    if (view.equations.has_smooth_forces()) {
      const State<S> smooth = view.equations.smooth_rate(mode_, y, view.input);
      for (std::size_t i = 0; i < kStates; ++i) f[i] += smooth[i];
    }
    return f;
  }
  /// Of the coupling's target, in the order of the propagator's ramps.
  std::span<const double> slopes() const {
    return coupled() ? std::span<const double>(slopes_) : std::span<const double>();
  }

  template <class S>
  State<S> step(const View<S>& view, const State<S>& y, int level) const;
  template <class S>
  State<S> step_by(const View<S>& view, const State<S>& y, double length) const {
    return view.propagator.advance_by(y, rate(view, y), slopes(), length);
  }

  /// With tolerances.
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
    std::array<std::pair<S, S>, kGuards> values;
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
  const double step_;      // s, at level 0
  double switched_ = 0.0;  // s, time of the latest switch
  std::map<int, System> systems_;
  std::map<int, Flow> flows_;

  State<T> y_{};
  Mode mode_;
  Input<T> input_;
  Input<double> plain_input_;
  Target slope_;
  std::array<double, 2> slopes_{};  // the same
  Flow* flow_ = nullptr;
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
  level_ = ladder().resolved;  // a switch may set off the fastest motions
  switched_ = value_of(input_.time);
}

template <class T>
typename Integrator<T>::System& Integrator<T>::system_of(const Mode& mode) {
  // The sign of a limit changes constants, not the matrix; those of contact, motion and load change
  // it where friction depends on them.
  const int contact = mode.contact == 0 ? 0 : equations_.signs_matter() ? mode.contact : 1;
  const int sliding = mode.sliding == 0 ? 0 : equations_.signs_matter() ? mode.sliding : 1;
  const int key = (mode.v_c != 0) | (mode.v_m != 0) << 1 | (contact + 1) << 2 | (sliding + 1) << 4 |
                  (mode.load + 1) << 6;
  if (const auto found = systems_.find(key); found != systems_.end()) return found->second;
  const Matrix<T> a = matrix_of(equations_, mode);
  // Below the shortest length smooth forces are frozen, and events are not told apart: even where
  // nothing is stiff it has to be short.
  const double shortest = std::ldexp(options_.step, -12);
  const Matrix<double> plain = axisfit::value_of(a);
  const Ladder ladder =
      ladder_for(a, step_, std::max(0, static_cast<int>(std::ceil(std::log2(step_ / shortest)))));
  const std::size_t n = equations_.states();
  const auto ramps = [&]<class S>(const Equations<S>& equations) -> std::vector<State<S>> {
    if (!coupled()) return {};
    const Driven<State<S>> b = driven_by(equations, mode);
    return {b[kByTargetVelocity], b[kByTargetPosition]};
  };
  return systems_
      .emplace(key,
               System{plain, Propagator<T>(a, ladder, ramps(equations_), n),
                      Propagator<double>(plain, ladder, ramps(plain_), n), oscillations(plain)})
      .first->second;
}

template <class T>
typename Integrator<T>::Flow& Integrator<T>::flow_of(const Mode& mode) {
  const int key = (mode.contact + 1) | (mode.v_c + 1) << 2 | (mode.v_m + 1) << 4 |
                  (mode.sliding + 1) << 6 | (mode.load + 1) << 8 | mode.doublet << 10;
  if (const auto found = flows_.find(key); found != flows_.end()) return found->second;
  System& system = system_of(mode);
  const Driven<State<double>> plain = driven_by(plain_, mode);
  std::optional<LinearGuards> guards;
  if (!equations_.has_smooth_forces()) guards.emplace(plain_, mode, system.a, plain);
  return flows_.emplace(key, Flow{system, driven_by(equations_, mode), plain, std::move(guards)})
      .first->second;
}

template <class T>
template <class S>
State<S> Integrator<T>::step(const View<S>& view, const State<S>& y, int level) const {
  Propagator<S>& p = view.propagator;
  const State<S> f = rate(view, y);
  const State<S> end = p.advance(y, f, slopes(), level);
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
  const State<S> middle = p.advance(y, f, slopes(), level + 1);
  const State<S> k2 = n(middle, 0.5 * h);  // k1 = 0
  // Behind an event steps are so short that the midpoint rule is as good.
  constexpr int kShort = 4;
  if (level >= longest() + kShort) return plus(end, h, p.exponential(k2, level + 1));
  const State<S> k3 = n(plus(middle, 0.5 * h, k2), 0.5 * h);
  const State<S> k4 = n(plus(end, h, p.exponential(k3, level + 1)), h);
  const State<S> inner = p.exponential(plus(k2, 1.0, k3), level + 1);
  return plus(plus(end, h / 3.0, inner), h / 6.0, k4);
}

template <class T>
bool Integrator<T>::met_between(const Look& start, const Look* middle, const Look& end,
                                double length) {
  using Node = Look::Node;
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
  const View<double> now = plain();
  const LinearGuards* guards = flow_->guards ? &*flow_->guards : nullptr;
  const bool by_series = level > ladder().last;
  const int fine = by_series ? level : std::max(level, longest());
  const long pieces = by_series ? 1 : 1L << (fine - level);
  const double piece = length / static_cast<double>(pieces);
  Input<double> input = now.input;
  const View<double> view{now.equations, now.propagator, now.driven, input};
  // A cubic does without the middle where the fastest oscillation turns by less than this.
  constexpr double kSmooth = 0.5;  // rad
  const bool halved = !by_series && fine < ladder().last && oscillation() * piece > kSmooth;
  const auto see = [&](const State<double>& y) {
    return guards != nullptr ? guards->look(y, input, slope_) : look(view, y);
  };
  if (!here_) here_ = see(from);
  Look start = *here_;
  to = from;
  for (long i = 0; i < pieces && steps_ <= options_.step_budget; ++i) {
    ++steps_;  // also one that meets a guard: a search without end has to end
    const State<double> begin = to;
    const Input<double> at_begin = input;
    State<double> middle;
    if (halved) middle = step(view, begin, fine + 1);
    to = by_series ? step_by(view, begin, piece) : step(view, begin, fine);
    for (const double x : to)
      if (!std::isfinite(x)) return false;
    Look end;
    const auto met = [&](const Look& first, auto&& seen) {
      Look half;
      if (halved) {
        input = moved(at_begin, 0.5 * piece);
        half = seen(middle);
      }
      input = moved(at_begin, piece);
      end = seen(to);
      return met_between(first, halved ? &half : nullptr, end, piece);
    };
    if (met(start, see)) {
      if (guards == nullptr) return true;
      // Nearly, at least: it may be within the tolerances.
      const auto closely = [&](const State<double>& y) { return look(view, y); };
      input = at_begin;
      if (met(closely(begin), closely)) return true;
    }
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
        double low = 0.0, high = length, t = 0.0, newton = 0.0;
        for (int i = 0; i < 60 && high - low > 1e-15 * length; ++i) {
          const Input<double> input = moved(view.input, t);
          const State<double> y = t > 0.0 ? step_by(view, from, t) : from;
          double value = 0.0, rate = 0.0;
          visit_guards_and_rates({view.equations, view.propagator, view.driven, input}, y,
                                 [&](Guard other, double g_t, double rate_t, double) {
                                   if (other == guard) value = g_t, rate = rate_t;
                                 });
          // A guard that starts at zero and rises, as that of an arm which has just broken away,
          // was not met there.
          if (value <= 0.0 && !(t == 0.0 && rate > 0.0))
            high = t;
          else
            low = t;
          newton = t - value / rate;
          if (high <= 0.0 || (value == 0.0 && t > 0.0)) break;
          const double next = newton > low && newton < high ? newton : 0.5 * (low + high);
          if (next == t) break;
          t = next;
        }
        // It may have been passed by less than the tolerance: back then.
        const double delay = high > 0.0 ? t : newton < 0.0 && newton > -length ? newton : 0.0;
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
  if (hit.delay != 0.0) y_ = step_by(exact(), y_, hit.delay);
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
  level_ = ladder().last;  // another event may follow closely
}

template <class T>
bool Integrator<T>::advance_to(const T& end) {
  const double last = value_of(end);
  const double negligible = 1e-9 * step_;
  // As a floating-point number: an interval of days has more than an int can count.
  const double event_limit =
      events_ +
      options_.event_limit * (1.0 + std::floor((last - value_of(input_.time)) / options_.step));
  int search = 0;  // level of the search for an event; 0: no search under way
  while (true) {
    const double remaining = last - value_of(input_.time);
    if (!(remaining > negligible)) break;
    const Ladder& ladder = this->ladder();
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
        search = piece ? level : std::max(level, longest() - 1) + 1;
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
    level_ = std::max(equations_.has_smooth_forces() ? longest() : 0, level_ - 1);
    if (search > 0 && ++search > ladder.last + 1) search = 0;
  }
  // What is left is the derivatives of the two instants, and rounding.
  const T rest = end - input_.time;
  const double rounding = 4.0 * std::numeric_limits<double>::epsilon() * std::abs(last);
  if (ScalarTraits<T>::has_derivative(rest) || std::abs(value_of(rest)) > rounding) {
    const State<T> f = equations_.rate(mode_, y_, input_);
    for (std::size_t i = 0; i < kStates; ++i) y_[i] += f[i] * rest;
    input_ = moved(input_, rest);
    here_.reset();
  }
  input_.time = end;
  return true;
}

}  // namespace axisfit
