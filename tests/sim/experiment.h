// Derivatives of recorded signals against differences of the simulation itself: what the tests of
// the derivatives, of the effects and of the instruments share.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <span>
#include <string>
#include <vector>

#include "fit/solve/jet.h"
#include "sim/recorder.h"
#include "tests/sim/axes.h"

namespace axisfit {

inline constexpr std::array kRecorded{Signal::velocity, Signal::acceleration, Signal::position,
                                      Signal::motor_current};

/// The recorded signals of a run, and how many events came before each sample.
template <class T>
struct Traces {
  std::array<std::vector<T>, kRecorded.size()> signals;
  std::vector<int> events;
};

/// A run: everything but the values of the quantities.
struct Experiment {
  Model<double> model;
  Schedule command;
  std::vector<double> times;
  Observer observer;
  std::vector<double> velocity, position;  // what a tracking run is held to
  std::vector<ChannelSeries> channels = {};

  template <class T>
  Traces<T> traces(const Model<T>& at, const IntegratorOptions& options = {}) const {
    Traces<T> result;
    Recorder<T> recorder(at.instruments, kRecorded, times);
    const std::vector<double> v = recorder.refined(velocity), p = recorder.refined(position);
    std::vector<ChannelSeries> c;
    for (const auto& channel : channels) c.push_back({recorder.refined(channel.values)});
    const auto simulation_result = simulate(
        at, command, recorder.instants(),
        [&](std::size_t i, const Integrator<T>& axis) {
          recorder.read(axis);
          if (recorder.is_sample(i)) result.events.push_back(axis.events());
        },
        observer, MeasuredSeries{v, p, c}, options);
    EXPECT_TRUE(simulation_result.finished);
    for (std::size_t s = 0; s < kRecorded.size(); ++s) result.signals[s] = recorder.readings(s);
    return result;
  }
};

/// The quantities that can move the recorded signals. Where F_s is zero there is no doublet. The
/// lags and delays of instruments are left to those who set them: recorder_test.cpp.
inline std::vector<QuantityEntry> quantities_in_play(const Model<double>& model) {
  std::vector<QuantityEntry> entries;
  for (const QuantityEntry& entry : quantity_list()) {
    if (!is_used(entry, model.structure)) continue;
    if (model.axis.F_s == 0.0 && (entry.name == "F_s" || entry.name == "w")) continue;
    if (const auto signal = signal_by_name(entry.group, kSourceVocabulary)) {
      if (std::ranges::find(kRecorded, *signal) == kRecorded.end()) continue;
      if (entry.quantity.symbol == "lag" || entry.quantity.symbol == "delay" ||
          entry.quantity.symbol == "drift")
        continue;
    }
    entries.push_back(entry);
  }
  return entries;
}

/// Derivatives of all traces by one quantity.
using Derivative = std::array<std::vector<double>, kRecorded.size()>;

/// By dual numbers, `kWidth` quantities at a time.
template <int kWidth = 8>
std::vector<Derivative> by_jets(const Experiment& experiment,
                                const std::vector<QuantityEntry>& entries,
                                const IntegratorOptions& options = {}) {
  using J = ceres::Jet<double, kWidth>;
  std::vector<Derivative> derivatives(entries.size());
  for (std::size_t first = 0; first < entries.size(); first += kWidth) {
    const std::size_t n = std::min<std::size_t>(kWidth, entries.size() - first);
    Model<J> model = convert<J>(experiment.model);
    const auto pointers = members(model);
    for (std::size_t i = 0; i < n; ++i)
      pointers[entries[first + i].index]->v[static_cast<int>(i)] = 1.0;
    const Traces<J> traces = experiment.traces(model, options);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t s = 0; s < kRecorded.size(); ++s)
        for (const J& value : traces.signals[s])
          derivatives[first + i][s].push_back(value.v[static_cast<int>(i)]);
  }
  return derivatives;
}

/// How the simulation is differenced by a quantity.
enum class Sides {
  both,   ///< central difference
  above,  ///< at the lower end of its range: from one, two and three steps above it
};

struct Difference {
  double step;
  Derivative values;
  std::vector<bool> usable;
};

/// A difference whose error falls with the square of the step. A sample is unusable when an event
/// lies before it in one of the runs and after it in another: there the difference measures the
/// jump of the signal, or of its derivative, and not the derivative on either side.
inline Difference difference(const Experiment& experiment, std::size_t quantity, double step,
                             Sides sides = Sides::both) {
  // The run at the end of the range itself is not used: a strength of zero leaves out the events of
  // its effect, and the samples near them could not be told.
  struct Term {
    double place, weight;
  };
  const std::vector<Term> terms = sides == Sides::both
                                      ? std::vector<Term>{{-1.0, -0.5}, {1.0, 0.5}}
                                      : std::vector<Term>{{1.0, -2.5}, {2.0, 4.0}, {3.0, -1.5}};
  Difference result{step, {}, std::vector<bool>(experiment.times.size(), true)};
  for (auto& values : result.values) values.assign(experiment.times.size(), 0.0);
  std::vector<int> events;
  for (const Term& term : terms) {
    Model<double> model = experiment.model;
    *members(model)[quantity] += term.place * step;
    const Traces<double> run = experiment.traces(model);
    if (events.empty()) events = run.events;
    for (std::size_t k = 0; k < experiment.times.size(); ++k) {
      result.usable[k] = result.usable[k] && run.events[k] == events[k];
      for (std::size_t s = 0; s < kRecorded.size(); ++s)
        result.values[s][k] += term.weight / step * run.signals[s][k];
    }
  }
  return result;
}

/// What an ordinary change of the quantity is, for those whose value may be zero.
inline double natural_size(const QuantityEntry& entry, double value) {
  if (entry.group == "initial") {
    constexpr std::array<double, kPaperStates> kSizes{0.1, 0.1, 1e-3, 0.01, 100.0, 1e4, 1.0};
    return kSizes[entry.index - quantity_index("initial.y0")];
  }
  if (entry.name == "T_d") return 0.01;
  // Of filters within a period.
  if (entry.name == "controller.T_v" || entry.name == "controller.T_u") return 1e-3;
  return value != 0.0 ? std::abs(value) : 1.0;
}

struct Comparison {
  std::string name;
  double error = 0.0;        ///< rms of derivative - difference, by the rms of the derivative
  double convergence = 0.0;  ///< rms of the change from one step of the difference to the next
  double excluded = 0.0;     ///< part of the samples left out
};

inline double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double x : values) sum += x * x;
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

using Judge = std::function<void(std::size_t candidate, const Comparison&)>;
using Size = std::function<double(const QuantityEntry&, double value)>;

/// Compares the derivatives with differences at several steps, each a fourth of the one before and
/// extrapolated to zero (Romberg) from three in a row, of which those are believed whose
/// extrapolations from two agree best: too long a step is not linear, too short a one is rounding.
/// Calls judge(candidate, comparison) for every quantity and signal. `candidates` are sets of
/// derivatives; they share the differences.
inline void compare(const Experiment& experiment, const std::vector<QuantityEntry>& entries,
                    const std::vector<std::vector<Derivative>>& candidates, const Judge& judge,
                    const Size& size_of = natural_size, Sides sides = Sides::both) {
  // The error that is left after the first extrapolation falls with this power of the step.
  const double next_order = sides == Sides::both ? 255.0 : 63.0;
  constexpr std::size_t kSignalCount = kRecorded.size();
  const Traces<double> signals = experiment.traces(experiment.model);
  std::array<double, kSignalCount> signal_sizes;
  for (std::size_t s = 0; s < kSignalCount; ++s) signal_sizes[s] = rms(signals.signals[s]);
  Model<double> model = experiment.model;
  const auto values = members(model);
  for (std::size_t q = 0; q < entries.size(); ++q) {
    const double size = size_of(entries[q], *values[entries[q].index]);
    std::array<double, kSignalCount> least;
    least.fill(INFINITY);
    std::array<std::vector<Comparison>, kSignalCount> best;  // by candidate
    std::vector<Difference> steps;
    bool improving = true;
    for (double step = 0.064; step > 0.9e-6 && improving; step *= 0.25) {
      steps.push_back(difference(experiment, entries[q].index, step * size, sides));
      if (steps.size() < 3) continue;
      const std::span<const Difference, 3> last(steps.end() - 3, 3);
      improving = false;
      for (std::size_t s = 0; s < kSignalCount; ++s) {
        std::vector<double> limits, change;
        std::vector<std::vector<double>> off(candidates.size());
        for (std::size_t k = 0; k < experiment.times.size(); ++k) {
          if (!last[0].usable[k] || !last[1].usable[k] || !last[2].usable[k]) continue;
          const auto at = [&](std::size_t i) { return last[i].values[s][k]; };
          const double longer = at(1) + (at(1) - at(0)) / 15.0;
          const double shorter = at(2) + (at(2) - at(1)) / 15.0;
          change.push_back(shorter - longer);
          limits.push_back(shorter + (shorter - longer) / next_order);
          for (std::size_t c = 0; c < candidates.size(); ++c)
            off[c].push_back(candidates[c][q][s][k] - limits.back());
        }
        const double excluded =
            1.0 - static_cast<double>(limits.size()) / static_cast<double>(experiment.times.size());
        const double converged = rms(change);
        // Over the best by far, and on the side of rounding: shorter steps are no use.
        if (excluded > 0.05 || converged < 2.0 * least[s]) improving = true;
        // A step that excludes much is so long that it changes what happens.
        if (excluded > 0.05 || !(converged < least[s])) continue;
        least[s] = converged;
        double scale = rms(limits);
        // A derivative of zero has to be zero in both: the difference but for rounding.
        if (rms(candidates[0][q][s]) * size < 1e-7 * signal_sizes[s]) {
          EXPECT_LT(rms(limits) * last[2].step, 1e-9 * signal_sizes[s]) << entries[q].name;
          scale = INFINITY;
        }
        const auto relative = [&](double x) { return x == 0.0 ? 0.0 : x / scale; };
        best[s].clear();
        for (std::size_t c = 0; c < candidates.size(); ++c)
          best[s].push_back({entries[q].name + " -> " + std::string(info(kRecorded[s]).name),
                             relative(rms(off[c])), relative(converged), excluded});
      }
      // Far below what is asked for, there is no need to know better.
      if (std::ranges::all_of(best, [](const auto& found) {
            return !found.empty() && found.front().convergence < 1e-6;
          }))
        improving = false;
    }
    for (std::size_t s = 0; s < kSignalCount; ++s) {
      EXPECT_EQ(best[s].size(), candidates.size()) << entries[q].name << ": no usable difference";
      for (std::size_t c = 0; c < best[s].size(); ++c) judge(c, best[s][c]);
    }
  }
}

/// The worst of many comparisons, for a line of the log.
struct Worst {
  Comparison error, convergence, excluded;

  void add(const Comparison& c) {
    if (c.error >= error.error) error = c;
    if (c.convergence >= convergence.convergence) convergence = c;
    if (c.excluded >= excluded.excluded) excluded = c;
  }
  friend std::ostream& operator<<(std::ostream& out, const Worst& w) {
    return out << "worst error " << w.error.error << " (" << w.error.name
               << "), least converged difference " << w.convergence.convergence << " ("
               << w.convergence.name << "), most excluded " << w.excluded.excluded << " ("
               << w.excluded.name << ")";
  }
};

/// All derivatives of the experiment within 1e-4, as far as the differences themselves are known:
/// of quantities with hardly any influence they are rounding to nearly that level.
inline void expect_derivatives(const Experiment& experiment,
                               const std::vector<QuantityEntry>& entries) {
  Worst worst;
  compare(experiment, entries, {by_jets(experiment, entries)},
          [&](std::size_t, const Comparison& c) {
            EXPECT_LT(c.convergence, 1e-4) << c.name;
            EXPECT_LT(c.error, 1e-4 + c.convergence) << c.name;
            worst.add(c);
          });
  std::cout << entries.size() << " quantities, "
            << experiment.traces(experiment.model).events.back() << " events; " << worst << "\n";
}

inline void expect_derivatives(const Experiment& experiment) {
  expect_derivatives(experiment, quantities_in_play(experiment.model));
}

}  // namespace axisfit
