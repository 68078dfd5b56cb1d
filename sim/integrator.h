// Integration of the axis through its modes, with located events that carry derivatives.
//
// Method. Within a mode the system is affine except for the smooth forces of effects. The affine
// part is propagated exactly (propagator.h), the smooth forces by the classical Runge-Kutta method
// in the moving frame of the affine part. Their value at the start of the step belongs to the
// affine part, so that constant forces are exact too. Stiffness of the current loop or the gear
// does not limit the step.
//
// Events. Every step is first tried on plain values, and all guards of the mode are evaluated: at
// instants that are close compared with the period of the mode's fastest oscillation, by a cubic
// through values and rates between them, and halfway where the cubic is strongly curved. A step in
// which a guard changes sign is halved until it is short enough for the Taylor series, on which
// Newton's method ends the search. Then the step is taken in T, and the crossing time is corrected
// by -g / g' in T: the event time carries its derivatives, and so does every length that is
// measured from it. After each event, and after each switch of the command, steps grow again from a
// short one, so that fast transients and the events that they cause are resolved. Where everything
// is affine, guards are evaluated as linear forms (guards.h) within steps that grow to the interval
// of the readings.
//
// Limits. Derivatives are those of a fixed sequence of transversal events; where two events
// coincide or a guard is touched without crossing, they are one-sided. The smooth forces must not
// be stiff (rate * step < 1). A guard that is left and entered again within a step, without the
// cubic showing it, is missed.
#pragma once

#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/interrupt.h"
#include "sim/controller.h"
#include "sim/equations.h"
#include "sim/guards.h"
#include "sim/propagator.h"

namespace axisfit {

struct IntegratorOptions {
  /// s. Longest step of the Runge-Kutta method, for smooth effects, and the longest time between
  /// looks at the guards. What is affine is exact at any step.
  double step = 0.5e-3;
  /// s. Between the instants to which the integration will be advanced, if they are even; else
  /// about. Steps are a fraction of it. Zero: not known, steps are `step`.
  double interval = 0.0;
  /// Whether the command runs linearly between its switches.
  bool has_command_ramp = false;
  /// Whether there are disturbances.
  bool has_disturbance = false;
  /// Whether event times carry derivatives. Off only to show what that is worth.
  bool event_derivatives = true;
  /// Events within one step length before the simulation is given up as chattering.
  int event_limit = 1000;
  /// Events altogether before it is given up as too slow.
  long event_budget = 100'000'000;
  /// Steps altogether before it is given up, since it swings too fast to be followed.
  long step_budget = 200'000'000;
  /// When this is set, from another thread or by a signal, a simulation ends unfinished.
  const StopFlag* stop = nullptr;
  /// Where the modes passed through are noted, the first included; null: nowhere.
  std::vector<ModeChange>* modes = nullptr;
};

template <class T>
class Integrator {
 public:
  Integrator(const Model<T>& model, const Observer& observer, const IntegratorOptions& options)
      : options_(options),
        model_(model),
        plain_model_(convert<double>(model)),
        equations_(model_, observer),
        plain_(plain_model_, observer, equations_.parts()),
        step_(longest_step()),
        bounded_(level_of(step_ / options.step - 1e-9)) {}

  Integrator(const Integrator&) = delete;
  Integrator& operator=(const Integrator&) = delete;

  /// Begins at `time` with the model's initial state and the given command (V).
  void start(double time, const T& command, const Target& target) {
    y_ = initial_state(model_);
    input_ = {command, {T(target.velocity), T(target.position)}, T(time), {}, {}, input_.channels};
    slope_ = {};
    command_slope_ = 0.0;
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

  /// From now on the command goes on from where it is, within rounding, with the rate `slope` per
  /// second. Needs IntegratorOptions::has_command_ramp.
  void set_command_ramp(const T& command, double slope) {
    input_.command = command;
    command_slope_ = slope;
    copy_plain_input();
    here_.reset();
  }

  /// From now on this disturbs the axis. Needs IntegratorOptions::has_disturbance.
  void set_disturbance(const Disturbance<T>& disturbance) { input_.disturbance = disturbance; }

  /// From now on the channels run like this. To be called before start(), too, where there are any.
  void set_channels(const ChannelCourse& channels) {
    input_.channels = channels;
    copy_plain_input();
    here_.reset();
  }

  /// From now on the observer's target is `target` and moves with the rate `slope` per second.
  void set_target(const Target& target, const Target& slope) {
    input_.target = {T(target.velocity), T(target.position)};
    copy_plain_input();
    slope_ = slope;
    here_.reset();
  }

  /// Puts the arm there, m and m/s, with all that moves along with it: the gear keeps its stretch,
  /// and presliding friction its deflection.
  void move_arm(const T& position, const T& velocity) {
    const T along = position - y_[0], faster = velocity - y_[1];
    y_[0] = position;
    y_[1] = velocity;
    y_[2] += along / equations_.radius();
    y_[3] += faster / equations_.radius();
    input_.memory.position += along;
    copy_plain_input();
    switch_mode(equations_.mode_at(y_, input_));
  }

  /// Goes on to the instant `end` (s), not before the present time.
  /// Returns false when the motion chatters, swings too fast to be followed, or is not finite any
  /// more; the state is then useless.
  bool advance_to(const T& end);

  /// s. How much later than written a command acts: the dead time, and the derivative of a force
  /// source's lag at zero, which delays like it.
  T command_delay() const { return model_.axis.T_d + equations_.lag_of_switching(); }

  /// What the axis' controller remembers, where it has one.
  ControllerMemory<T>& controller_memory() { return controller_memory_; }

  /// Lets `change(state, input, memory of the controller)` give new derivatives to the state, the
  /// command and what is remembered: with those of the disturbance all that the future depends on.
  /// Values must stay.
  template <class Change>
  void differentiate(Change&& change) {
    change(y_, input_, controller_memory_);
  }

  /// What the future depends on besides the model, the options and the disturbance.
  struct Snapshot {
    State<T> state;
    Mode mode;
    Input<T> input;
    Target target_slope;
    double command_slope;
    ControllerMemory<T> controller;
    double switched;
    int level;
  };
  Snapshot snapshot() const {
    return {y_, mode_, input_, slope_, command_slope_, controller_memory_, switched_, level_};
  }
  /// Goes on from there, within rounding.
  void restore(const Snapshot& snapshot) {
    resume(snapshot, snapshot.mode);
    switched_ = snapshot.switched;
    level_ = snapshot.level;
  }
  /// Goes on from there with a model of the same structure but other numbers.
  void resume(const Snapshot& snapshot) {
    resume(snapshot, equations_.mode_at(snapshot.state, snapshot.input));
  }

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
    std::vector<std::pair<Oscillation, int>> oscillations;  // with the level that follows each
  };
  /// Everything that one mode needs.
  struct Flow {
    System& system;
    SparseMatrix<T> driven;  // B, by states and inputs
    std::optional<LinearGuards> guards;
    std::map<std::pair<int, int>, GuardForms> forms;  // by level and halvings
  };

  struct Hit {
    Guard guard;
    double delay;  ///< s after the start of the trial step; before it by rounding, at most
  };

  template <class S>
  struct View {  // one of the two scalar types
    const Equations<S>& equations;
    Propagator<S>& propagator;
    const Input<S>& input;
  };
  /// Of a state, and how much of it the smooth forces of effects make.
  template <class S>
  struct Rate {
    State<S> total, smooth{};
  };
  /// What is known at one instant.
  struct Seen {
    GuardValues guards;
    std::optional<Rate<double>> rate{};  ///< where guards need it
  };
  View<T> exact() const { return {equations_, flow_->system.exact, input_}; }
  View<double> plain() const { return {plain_, flow_->system.plain, plain_input_}; }

  State<double> plain_state() const {
    State<double> y;
    for (std::size_t i = 0; i < kStates; ++i) y[i] = value_of(y_[i]);
    return y;
  }
  bool has_observer() const { return equations_.observer().active(); }
  bool affine() const { return !equations_.has_smooth_forces(); }
  /// Whether nothing but switches and events sets a fast swing off. Smooth forces on the arm are
  /// slow; those of the motor are as fast as its current.
  bool is_undisturbed() const { return !equations_.parts().needs.motor_torque && !has_ramps(); }
  bool has_ramps() const { return has_observer() || options_.has_command_ramp; }
  RampList ramps() const {
    RampList list;
    if (options_.has_command_ramp) list.push_back(0);
    if (has_observer()) list.insert(list.end(), {1, 2});
    return list;
  }
  const StepLevels& step_levels() const { return flow_->system.plain.step_levels(); }

  void copy_plain_input() {
    plain_input_ = {value_of(input_.command),
                    {value_of(input_.target.velocity), value_of(input_.target.position)},
                    value_of(input_.time),
                    value_of(input_.memory),
                    {},
                    input_.channels};
  }
  /// Level of the longest step that is at most 1 / ratio of level 0.
  static int level_of(double ratio, int most = 60) {
    return ratio > 1.0 ? static_cast<int>(std::min(double(most), std::ceil(std::log2(ratio)))) : 0;
  }
  /// The input after `length` seconds.
  template <class S, class U>
  Input<S> moved(Input<S> input, const U& length) const {
    input.time += length;
    input.target.move(slope_, length);
    if (options_.has_command_ramp) input.command += command_slope_ * length;
    return input;
  }

  /// Readings that fall on steps are cheapest. Runge-Kutta steps are bounded besides.
  double longest_step() const {
    if (!(options_.interval > 0.0)) return options_.step;
    if (affine()) return options_.interval;
    return options_.interval / std::ceil(options_.interval / options_.step - 1e-9);
  }

  /// Level at which a cubic follows the fastest oscillation that guards may show. Where nothing but
  /// switches and events sets any off, one is forgotten when it has died away to what a cubic does
  /// not follow either.
  int resolving_level() const {
    constexpr double kForgotten = 9.0;  // e^-9 = 1e-4
    const double since = is_undisturbed() ? value_of(input_.time) - switched_ : 0.0;
    for (const auto& [oscillation, level] : flow_->system.oscillations)
      if (oscillation.damping * since < kForgotten) return level;
    return 0;
  }
  /// Level of the longest stretch between two looks at the guards: one radian to either side of its
  /// middle, where they are looked at too. A longer one than options_.step would see what passes
  /// within it, or not, as the readings fall.
  int check_level() const { return std::max(bounded_, resolving_level() - 2); }
  /// Level of the longest step: of few stretches where these are parts of a step, else of one.
  int step_level() const {
    return affine() ? std::max(0, check_level() - kMaxStretches) : check_level();
  }

  void resume(const Snapshot& snapshot, const Mode& mode) {
    y_ = snapshot.state;
    input_ = snapshot.input;
    slope_ = snapshot.target_slope;
    command_slope_ = snapshot.command_slope;
    controller_memory_ = snapshot.controller;
    copy_plain_input();
    switch_mode(mode);
  }
  void switch_mode(const Mode& mode);
  /// With B, exact and plain.
  System& system_of(const Mode& mode, const PerInput<State<T>>& exact_b,
                    const PerInput<State<double>>& plain_b);
  Flow& flow_of(const Mode& mode);

  /// f(y), with smooth forces.
  template <class S>
  Rate<S> rate(const View<S>& view, const State<S>& y) const {
    Rate<S> f;
    // Values by the equations, which rounds least; with derivatives the matrices are cheaper.
    if constexpr (std::is_same_v<S, double>) {
      f.total = view.equations.rate(mode_, y, view.input, Terms::affine);
    } else {
      const auto& [command, target, time, memory, disturbance, channels] = view.input;
      f.total = view.propagator.a_times(y);
      flow_->driven.add_product({S(1.0), command, target.velocity, target.position}, f.total);
      if (options_.has_disturbance) {
        const State<S> disturbed = view.equations.disturbance_rate(mode_, disturbance);
        for (std::size_t i = 0; i < kStates; ++i) f.total[i] += disturbed[i];
      }
    }
    if (affine()) return f;
    f.smooth = view.equations.smooth_rate(mode_, y, view.input);
    for (std::size_t i = 0; i < kStates; ++i) f.total[i] += f.smooth[i];
    return f;
  }
  Slopes slopes() const { return {command_slope_, slope_.velocity, slope_.position}; }

  /// From the state y with the rate f.
  template <class S>
  State<S> step(const View<S>& view, const State<S>& y, const Rate<S>& f, int level) const;
  /// The same of any length that is resolved.
  template <class S>
  State<S> step_by_series(const View<S>& view, const State<S>& y, const Rate<S>& f,
                          double length) const;
  /// The classical method, or that of the midpoint where the step `is_short`. `start` is what the
  /// smooth forces do there; `middle` and `end` are where the affine part leads after h / 2 and h;
  /// exponential(v) is exp(A h / 2) v.
  template <class S, class Exponential>
  State<S> runge_kutta(const View<S>& view, const State<S>& start, double h, const State<S>& middle,
                       const State<S>& end, bool is_short, Exponential&& exponential) const;
  /// Of the affine part, with the smooth forces frozen.
  template <class S>
  Series<S> series(const View<S>& view, const State<S>& y, const State<S>& f, double length) const {
    return view.propagator.series(y, f, slopes(), length);
  }
  template <class S>
  Series<S> series(const View<S>& view, const State<S>& y, double length) const {
    return series(view, y, rate(view, y).total, length);
  }

  /// With tolerances. `f` is the rate of y.
  GuardValues guard_values(const View<double>& view, const State<double>& y,
                           const State<double>& f) const {
    GuardValues seen;
    visit_guards_and_rates(view, y, f, [&](Guard, double g, double rate, double scale) {
      seen.push_back({g, rate, 1e-12 * scale});
    });
    return seen;
  }
  GuardValues guard_values(const View<double>& view, const State<double>& y) const {
    return guard_values(view, y, rate(view, y).total);
  }
  /// The guards as linear forms, without tolerances, where all is affine.
  Seen look(const View<double>& view, const State<double>& y) const {
    if (affine()) return {flow_->guards->guard_values(y, view.input, slopes())};
    const Rate<double> f = rate(view, y);
    return {guard_values(view, y, f.total), f};
  }
  /// Tries a step of `length` on plain values; `level` is its place in the ladder, or past its end
  /// for a step by the series. Leaves the end in `to` and unless a guard is met the guards there.
  Crossing try_step(const State<double>& from, int level, double length, State<double>& to);
  std::optional<Hit> locate(const State<double>& from, const State<double>& to,
                            double length) const;
  void move_time(double length);
  void pass_event(const Hit& hit);

  /// Rate of a guard's value: where it is affine, a unit step along the rates `f` of y gives it
  /// exactly.
  template <class S, class Visitor>
  void visit_guards_and_rates(const View<S>& view, const State<S>& y, const State<S>& f,
                              Visitor&& visit) const {
    std::array<std::pair<S, S>, kGuards> values;
    std::size_t n = 0;
    view.equations.visit_guards(mode_, y, view.input, [&](Guard, const S& g, double) {
      values[guard_place(n++)].first = g;
    });
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

  static constexpr int kMaxStretches = 4;  // of a step, as a power of two

  const IntegratorOptions options_;
  const Model<T> model_;
  const Model<double> plain_model_;
  const Equations<T> equations_;
  const Equations<double> plain_;
  const double step_;               // s, at level 0
  const int bounded_;               // level of the longest stretch that options_ allow
  double switched_ = 0.0;           // s, time of the latest switch
  std::map<Mode, System> systems_;  // by one mode of those that share it
  std::map<Mode, Flow> flows_;

  State<T> y_{};
  Mode mode_;
  Input<T> input_;
  Input<double> plain_input_;
  Target slope_;
  double command_slope_ = 0.0;  // per second
  ControllerMemory<T> controller_memory_{};
  Flow* flow_ = nullptr;
  int level_ = 0;  // of the longest step now allowed; falls to 0 as steps grow after an event
  std::optional<Seen> here_;  // at the present state, while it is known
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
  level_ = step_levels().resolved;  // a switch may set off the fastest motions
  switched_ = value_of(input_.time);
}

template <class T>
typename Integrator<T>::System& Integrator<T>::system_of(const Mode& mode,
                                                         const PerInput<State<T>>& exact_b,
                                                         const PerInput<State<double>>& plain_b) {
  // The sign of a limit changes constants, not the matrix; those of contact, motion and load change
  // it where friction depends on them.
  Mode key = mode;
  key.doublet = false;
  key.v_c = mode.v_c != 0;
  key.v_m = mode.v_m != 0;
  if (!equations_.signs_matter()) {
    key.contact = mode.contact != 0;
    key.sliding = mode.sliding != 0;
  }
  if (const auto found = systems_.find(key); found != systems_.end()) return found->second;
  const Matrix<T> a = system_matrix(equations_, mode);
  // Below the shortest length smooth forces are frozen, and events are not told apart: even where
  // nothing is stiff it has to be short.
  const double shortest = std::ldexp(options_.step, -12);
  const Matrix<double> plain = axisfit::value_of(a);
  const StepLevels step_levels = step_levels_for(a, step_, level_of(step_ / shortest));
  const auto ramps_of = [&]<class S>(const PerInput<State<S>>& b) {
    std::vector<Ramp<S>> list;
    for (const std::size_t which : ramps()) list.push_back({which, b[kCommandInput + which]});
    return list;
  };
  std::vector<std::pair<Oscillation, int>> followed;
  constexpr double kFollowed = 0.5;  // rad
  for (const Oscillation& o : oscillations(plain))
    followed.emplace_back(o, level_of(o.frequency * step_ / kFollowed, step_levels.last));
  const std::size_t n = equations_.states();
  return systems_
      .emplace(key, System{plain, Propagator<T>(a, step_levels, ramps_of(exact_b), n),
                           Propagator<double>(plain, step_levels, ramps_of(plain_b), n), followed})
      .first->second;
}

template <class T>
typename Integrator<T>::Flow& Integrator<T>::flow_of(const Mode& mode) {
  if (const auto found = flows_.find(mode); found != flows_.end()) return found->second;
  const PerInput<State<T>> exact = input_matrix(equations_, mode);
  const PerInput<State<double>> plain = input_matrix(plain_, mode);
  System& system = system_of(mode, exact, plain);
  std::optional<LinearGuards> guards;
  if (affine()) guards.emplace(plain_, mode, system.a, plain, ramps());
  Matrix<T> driven{};
  for (std::size_t c = 0; c < kInputs; ++c)
    for (std::size_t i = 0; i < kStates; ++i) driven[i][c] = exact[c][i];
  return flows_.emplace(mode, Flow{system, SparseMatrix<T>(driven), guards, {}}).first->second;
}

template <class T>
template <class S>
State<S> Integrator<T>::step(const View<S>& view, const State<S>& y, const Rate<S>& f,
                             int level) const {
  Propagator<S>& p = view.propagator;
  const State<S> end = p.advance(y, f.total, slopes(), level);
  if (!view.equations.has_smooth_forces() || level == p.step_levels().last) return end;
  // Behind an event steps are so short that the midpoint rule is as good.
  constexpr int kShort = 4;
  return runge_kutta(view, f.smooth, p.step_levels().length(level),
                     p.advance(y, f.total, slopes(), level + 1), end,
                     level >= check_level() + kShort,
                     [&](const State<S>& v) { return p.exponential(v, level + 1); });
}

template <class T>
template <class S>
State<S> Integrator<T>::step_by_series(const View<S>& view, const State<S>& y, const Rate<S>& f,
                                       double length) const {
  Propagator<S>& p = view.propagator;
  const StepLevels& levels = p.step_levels();
  if (affine()) {
    const auto* known = p.repeated(length);
    if (known == nullptr) return series(view, y, f.total, length).at(length);
    State<S> end = p.advance(y, f.total, slopes(), *known);
    for (std::size_t i = 0; i < kStates; ++i) end[i] += (length - known->time) * f.total[i];
    return end;
  }
  if (length <= levels.length(levels.last)) return series(view, y, f.total, length).at(length);
  const double half = 0.5 * length;
  // Where readings and switches of the command are even, pieces of few lengths recur.
  std::optional<State<S>> end;
  if (const auto* known = p.repeated(length)) end = p.advance(y, f.total, slopes(), *known);
  if (const auto* known = p.repeated(half); known && end)
    return runge_kutta(view, f.smooth, length, p.advance(y, f.total, slopes(), *known), *end, false,
                       [&](const State<S>& v) { return p.exponential(v, *known); });
  const Series<S> path = series(view, y, f.total, length);
  return runge_kutta(
      view, f.smooth, length, path.at(half), path.at(length), false,
      [&](const State<S>& v) { return p.series(v, p.a_times(v), {}, half).at(half); });
}

template <class T>
template <class S, class Exponential>
State<S> Integrator<T>::runge_kutta(const View<S>& view, const State<S>& start, double h,
                                    const State<S>& middle, const State<S>& end, bool is_short,
                                    Exponential&& exponential) const {
  // Of n(y) = N(y) - N(y at the start), in the frame that moves with the affine flow.
  const auto n = [&](const State<S>& at, double delay) {
    State<S> remainder = view.equations.smooth_rate(mode_, at, moved(view.input, delay));
    for (std::size_t i = 0; i < kStates; ++i) remainder[i] -= start[i];
    return remainder;
  };
  const auto plus = [](State<S> a, double factor, const State<S>& b) {
    for (std::size_t i = 0; i < kStates; ++i) a[i] += factor * b[i];
    return a;
  };
  const State<S> k2 = n(middle, 0.5 * h);  // k1 = 0
  if (is_short) return plus(end, h, exponential(k2));
  const State<S> k3 = n(plus(middle, 0.5 * h, k2), 0.5 * h);
  const State<S> k4 = n(plus(end, h, exponential(k3)), h);
  return plus(plus(end, h / 3.0, exponential(plus(k2, 1.0, k3))), h / 6.0, k4);
}

template <class T>
Crossing Integrator<T>::try_step(const State<double>& from, int level, double length,
                                 State<double>& to) {
  ++steps_;  // also one that meets a guard: a search without end has to end
  const View<double> now = plain();
  const bool by_series = level > step_levels().last;
  if (!here_) here_ = look(now, from);
  const Rate<double> f = here_->rate ? *here_->rate : rate(now, from);
  to = by_series ? step_by_series(now, from, f, length) : step(now, from, f, level);
  for (const double x : to)
    if (!std::isfinite(x)) return Crossing::none;  // to nowhere, which the caller sees

  const int fine = by_series ? level : std::max(level, check_level());
  const bool doubted = !by_series && fine < std::min(resolving_level(), step_levels().last);
  const int halvings = fine - level + doubted;
  const Input<double> input = moved(now.input, length);
  const View<double> then{now.equations, now.propagator, input};
  const Seen end = look(then, to);
  GuardCourse course(here_->guards, end.guards, std::size_t{1} << halvings, length);
  std::array<double, kGuards> tolerance{};
  const auto with_tolerances = [&](const GuardValues& seen) {
    for (std::size_t i = 0; i < seen.count; ++i)
      tolerance[i] = std::max(tolerance[i], seen.nodes[i].tolerance);
  };
  if (affine()) {
    if (halvings > 0) {
      auto forms = flow_->forms.find({level, halvings});
      if (forms == flow_->forms.end())
        forms = flow_->forms
                    .emplace(std::pair(level, halvings),
                             GuardForms(*flow_->guards, now.propagator, level, halvings))
                    .first;
      forms->second.follow(here_->guards, f.total, slopes(), course);
    }
    if (course.review(doubted, tolerance) == Crossing::none) {
      here_ = end;
      return Crossing::none;
    }
    // Nearly, at least: it may be within the tolerances.
    for (const auto& [seen, instant] :
         {std::pair(guard_values(now, from), std::size_t{0}),
          std::pair(guard_values(then, to), std::size_t{1} << halvings)}) {
      course.set(instant, seen);
      with_tolerances(seen);
    }
  } else {
    if (doubted) {
      const Input<double> halfway = moved(now.input, 0.5 * length);
      course.set(
          1, guard_values({now.equations, now.propagator, halfway}, step(now, from, f, level + 1)));
    }
    with_tolerances(end.guards);
  }
  const Crossing seen = course.review(doubted, tolerance);
  if (seen == Crossing::none) here_ = end;
  return seen;
}

template <class T>
std::optional<typename Integrator<T>::Hit> Integrator<T>::locate(const State<double>& from,
                                                                 const State<double>& to,
                                                                 double length) const {
  std::optional<Hit> first;
  const View<double> view = plain();
  const Series<double> path = series(view, from, length);
  std::size_t n = 0;
  view.equations.visit_guards(
      mode_, to, moved(view.input, length), [&](Guard guard, double g, double scale) {
        const std::size_t index = n++;
        if (g >= -1e-12 * scale) return;
        const auto node_at = [&](double t) {
          const Input<double> input = moved(view.input, t);
          return guard_values({view.equations, view.propagator, input}, t > 0.0 ? path.at(t) : from)
              .nodes[index];
        };
        double low = 0.0, high = length, t = 0.0, newton = 0.0;
        for (int i = 0; i < 60 && high - low > 1e-15 * length; ++i) {
          const GuardValues::Node node = node_at(t);
          // A guard that rises from zero, as that of an arm which has just broken away, was not met
          // there. Within a step it may fall again: that is looked for. From rest, as of teeth that
          // have just met, it rises with the square of the time.
          constexpr double kSoon = 1.0 / 64.0;  // of the step
          const bool rises =
              t == 0.0 && node.rate == 0.0 ? node_at(kSoon * length).value > 0.0 : node.rate > 0.0;
          if (node.value <= 0.0 && !(rises && (t == 0.0 || node.value > -1e-12 * scale)))
            high = t;
          else
            low = t;
          newton = t - node.value / node.rate;
          if (high <= 0.0 || (node.value == 0.0 && t > 0.0 && !rises)) break;
          const double next = !rises && newton > low && newton < high ? newton : 0.5 * (low + high);
          if (next == t) break;
          t = next;
        }
        // It may have been passed by less than the tolerance: back then.
        const double shortest = step_levels().length(step_levels().last);
        const double delay = high > 0.0 ? t : newton < 0.0 && newton > -shortest ? newton : 0.0;
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
  if (hit.delay != 0.0) y_ = series(exact(), y_, std::abs(hit.delay)).at(hit.delay);
  move_time(hit.delay);
  // One Newton step on the guard in T. Its value is rounding; its derivatives are those of the
  // event time.
  T correction(0.0);
  const State<T> f = equations_.rate(mode_, y_, input_);
  visit_guards_and_rates(exact(), y_, f, [&](Guard guard, const T& g, const T& rate, double) {
    if (guard == hit.guard && value_of(rate) != 0.0)
      correction = -derivative_part(g) / value_of(rate);
  });
  if (!options_.event_derivatives) correction = T(0.0);
  for (std::size_t i = 0; i < kStates; ++i) y_[i] += f[i] * correction;
  input_ = moved(input_, correction);
  ++events_;
  const Mode next = equations_.cross(mode_, hit.guard, y_, input_);
  copy_plain_input();
  switch_mode(next);
  if (!affine()) level_ = step_levels().last;  // another event may follow closely
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
    const StepLevels& step_levels = this->step_levels();
    int level = std::max({level_, search, step_level()});
    // The last piece of an interval, of whatever length, is for the series, where that holds: a
    // step and no more, if the readings are not quite even.
    constexpr double kUneven = 1.001;
    const double resolved = kUneven * step_levels.length(step_levels.resolved);
    const double whole = step_levels.length(level);
    const bool is_step = std::abs(remaining - whole) <= negligible;
    const bool piece =
        !is_step && remaining <= kUneven * whole && search == 0 && remaining <= resolved;
    while (level <= step_levels.last && step_levels.length(level) > remaining + negligible) ++level;
    const bool shortest = level >= step_levels.last;
    const bool by_series = piece || level > step_levels.last;
    const double length =
        piece ? remaining
              : std::min(remaining, step_levels.length(std::min(level, step_levels.last)));

    const State<double> from = plain_state();
    State<double> to;
    const Crossing course = try_step(from, by_series ? step_levels.last + 1 : level, length, to);
    if (steps_ > options_.step_budget || is_set(options_.stop)) return false;
    if (course != Crossing::none) {
      if (!shortest && !(affine() && course == Crossing::passed && length <= resolved)) {
        search = std::max(1, piece ? level : level + 1);
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
    if constexpr (std::is_same_v<T, double>) {
      y_ = to;
    } else {
      const View<T> view = exact();
      const Rate<T> f = rate(view, y_);
      y_ = by_series ? step_by_series(view, y_, f, length) : step(view, y_, f, level);
    }
    move_time(length);
    level_ = std::max(0, level_ - 1);
    if (search > 0 && ++search > step_levels.last + 1) search = 0;
  }
  // What is left is the derivatives of the two instants, and rounding.
  const T remainder = end - input_.time;
  const double rounding = 4.0 * std::numeric_limits<double>::epsilon() * std::abs(last);
  if (ScalarTraits<T>::has_derivative(remainder) || std::abs(value_of(remainder)) > rounding) {
    const State<T> f = equations_.rate(mode_, y_, input_);
    for (std::size_t i = 0; i < kStates; ++i) y_[i] += f[i] * remainder;
    input_ = moved(input_, remainder);
    here_.reset();
  }
  input_.time = end;
  return true;
}

}  // namespace axisfit
