// Derivatives through events against central differences of the simulation itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <span>
#include <string>

#include "fit/jet.h"
#include "tests/sim/axes.h"

namespace axisfit {
namespace {

constexpr std::array kRecorded{Signal::velocity, Signal::acceleration, Signal::position,
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
  Coupling coupling;
  std::vector<double> velocity, position;  // what a coupled run is held to

  template <class T>
  Traces<T> traces(const Model<T>& at, const IntegratorOptions& options = {}) const {
    Traces<T> result;
    const auto outcome = simulate(
        at, command, times,
        [&](std::size_t, const Integrator<T>& axis) {
          for (std::size_t s = 0; s < kRecorded.size(); ++s)
            result.signals[s].push_back(
                reading(axis.equations(), kRecorded[s], axis.mode(), axis.state(), axis.input()));
          result.events.push_back(axis.events());
        },
        coupling, Measured{velocity, position}, options);
    EXPECT_TRUE(outcome.finished);
    return result;
  }
};

/// The quantities that can move the recorded signals. Where F_s is zero there is no doublet.
std::vector<QuantityEntry> quantities_in_play(const Model<double>& model) {
  std::vector<QuantityEntry> entries;
  for (const QuantityEntry& entry : quantity_list()) {
    if (!is_used(entry, model.structure)) continue;
    if (model.axis.F_s == 0.0 && (entry.name == "F_s" || entry.name == "w")) continue;
    if (const auto signal = signal_by_name(entry.group);
        signal && std::ranges::find(kRecorded, *signal) == kRecorded.end())
      continue;
    entries.push_back(entry);
  }
  return entries;
}

/// Derivatives of all traces by one quantity.
using Derivative = std::array<std::vector<double>, kRecorded.size()>;

std::vector<Derivative> by_jets(const Experiment& experiment,
                                const std::vector<QuantityEntry>& entries,
                                const IntegratorOptions& options = {}) {
  constexpr int kWidth = 8;
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

struct Difference {
  double step;
  Derivative values;
  std::vector<bool> usable;
};

/// Central difference. A sample is unusable when an event lies before it in one of the two runs and
/// after it in the other: there the difference measures the jump of the signal, or of its
/// derivative, and not the derivative on either side.
Difference difference(const Experiment& experiment, std::size_t quantity, double step) {
  const auto at = [&](double change) {
    Model<double> model = experiment.model;
    *members(model)[quantity] += change;
    return experiment.traces(model);
  };
  const auto low = at(-step), high = at(step);
  Difference result{step, {}, {}};
  for (std::size_t s = 0; s < kRecorded.size(); ++s)
    for (std::size_t k = 0; k < experiment.times.size(); ++k)
      result.values[s].push_back((high.signals[s][k] - low.signals[s][k]) / (2.0 * step));
  for (std::size_t k = 0; k < experiment.times.size(); ++k)
    result.usable.push_back(low.events[k] == high.events[k]);
  return result;
}

/// What an ordinary change of the quantity is, for those whose value may be zero.
double natural_size(const QuantityEntry& entry, double value) {
  if (entry.group == "initial") {
    constexpr std::array<double, kStates> kSizes{0.1, 0.1, 1e-3, 0.01, 100.0, 1e4, 1.0};
    return kSizes[entry.index - find_quantity("initial.y0")->index];
  }
  if (entry.name == "T_d") return 0.01;
  return value != 0.0 ? std::abs(value) : 1.0;
}

struct Comparison {
  std::string name;
  double error = 0.0;        ///< rms of derivative - difference, by the rms of the derivative
  double convergence = 0.0;  ///< rms of the change from one step of the difference to the next
  double excluded = 0.0;     ///< part of the samples left out
};

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double x : values) sum += x * x;
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

/// Compares the derivatives with differences at several steps, each a fourth of the one before and
/// extrapolated to zero (Romberg) from three in a row, of which those are believed whose
/// extrapolations from two agree best: too long a step is not linear, too short a one is rounding.
/// Calls judge(candidate, comparison) for every quantity and signal. `candidates` are sets of
/// derivatives; they share the differences.
void compare(const Experiment& experiment, const std::vector<QuantityEntry>& entries,
             const std::vector<std::vector<Derivative>>& candidates,
             const std::function<void(std::size_t, const Comparison&)>& judge) {
  constexpr std::size_t kSignalCount = kRecorded.size();
  const Traces<double> signals = experiment.traces(experiment.model);
  std::array<double, kSignalCount> signal_sizes;
  for (std::size_t s = 0; s < kSignalCount; ++s) signal_sizes[s] = rms(signals.signals[s]);
  Model<double> model = experiment.model;
  const auto values = members(model);
  for (std::size_t q = 0; q < entries.size(); ++q) {
    const double size = natural_size(entries[q], *values[entries[q].index]);
    std::array<double, kSignalCount> least;
    least.fill(INFINITY);
    std::array<std::vector<Comparison>, kSignalCount> best;  // by candidate
    std::vector<Difference> steps;
    bool improving = true;
    for (double step = 0.064; step > 0.9e-6 && improving; step *= 0.25) {
      steps.push_back(difference(experiment, entries[q].index, step * size));
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
          limits.push_back(shorter + (shorter - longer) / 255.0);
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
    }
    for (std::size_t s = 0; s < kSignalCount; ++s) {
      EXPECT_EQ(best[s].size(), candidates.size()) << entries[q].name << ": no usable difference";
      for (std::size_t c = 0; c < best[s].size(); ++c) judge(c, best[s][c]);
    }
  }
}

/// All derivatives of the experiment within 1e-4, as far as the differences themselves are known:
/// of quantities with hardly any influence they are rounding to nearly that level.
void expect_derivatives(const Experiment& experiment) {
  const auto entries = quantities_in_play(experiment.model);
  Comparison worst, least_converged, most_excluded;
  compare(experiment, entries, {by_jets(experiment, entries)},
          [&](std::size_t, const Comparison& c) {
            EXPECT_LT(c.convergence, 1e-4) << c.name;
            EXPECT_LT(c.error, 1e-4 + c.convergence) << c.name;
            if (c.error > worst.error) worst = c;
            if (c.convergence > least_converged.convergence) least_converged = c;
            if (c.excluded > most_excluded.excluded) most_excluded = c;
          });
  std::cout << entries.size() << " quantities, "
            << experiment.traces(experiment.model).events.back() << " events; worst error "
            << worst.error << " (" << worst.name << "), least converged difference "
            << least_converged.convergence << " (" << least_converged.name << "), most excluded "
            << most_excluded.excluded << " (" << most_excluded.name << ")\n";
}

/// As in testdata/clean-fit.csv, in which the teeth part and meet again, but from a start in motion
/// and with a delay and instruments that are not trivial.
Experiment up_and_back() {
  Experiment experiment;
  Model<double>& m = experiment.model;
  m = paper_axis();
  m.axis.T_d = 0.00037;
  m.initial = {0.01, 0.02, 2e-6, 1e-3, 0.3, 2.0, 0.1};
  for (const Signal signal : kRecorded) m.instruments[index_of(signal)] = {1.1, 0.02};
  experiment.command = {{0.0, 1.5}, {10.0, 0.0}};
  experiment.times = instants(2500, 1e-3);
  return experiment;
}

TEST(Derivatives, EqualDifferencesWhereTheTeethPartAndMeet) { expect_derivatives(up_and_back()); }

TEST(Derivatives, EqualDifferencesWithFrictionAndEffects) {
  Experiment experiment = up_and_back();
  experiment.model.axis.F_s = 30.0;
  add_effect<CoulombFriction>(experiment.model).F_c = 15.0;
  add_effect<ConstantForce>(experiment.model).F_0 = -8.0;
  add_effect<QuadraticDrag>(experiment.model).c = 20.0;
  expect_derivatives(experiment);
}

TEST(Derivatives, EqualDifferencesInTheRigidVariants) {
  for (const Drive drive : {Drive::velocity_loop, Drive::current_source, Drive::force_source}) {
    SCOPED_TRACE(static_cast<int>(drive));
    Experiment experiment = up_and_back();
    Model<double>& m = experiment.model;
    m.structure.drive = drive;
    m.structure.transmission = Transmission::rigid;
    m.initial[2] = m.initial[3] = 0.0;
    m.axis.F_s = 30.0;
    m.axis.K_f = 20.0;
    add_effect<CoulombFriction>(m).F_c = 15.0;
    if (drive == Drive::force_source) experiment.command = {{0.0, 0.8, 1.6}, {10.0, 0.0, -7.0}};
    expect_derivatives(experiment);
  }
}

TEST(Derivatives, EqualDifferencesInACoupledRun) {
  for (const Coupling& coupling : {Coupling::to_velocity(30.0, true), Coupling::to_position(300.0),
                                   Coupling::to_velocity(3000.0, false)}) {
    SCOPED_TRACE(testing::Message()
                 << coupling.velocity << " " << coupling.position << " " << coupling.acceleration);
    Experiment experiment = up_and_back();
    experiment.command = {{0.0, 0.3}, {10.0, 0.0}};
    experiment.times = instants(600, 1e-3);
    // Held to an axis somewhat different.
    Model<double> other = experiment.model;
    other.axis.B_a *= 1.2;
    other.axis.k_g *= 0.8;
    const Traces<double> measured = experiment.traces(other);
    experiment.velocity = measured.signals[0];
    experiment.position = measured.signals[2];
    experiment.coupling = coupling;
    expect_derivatives(experiment);
  }
}

TEST(Derivatives, AreWrongWithoutThoseOfTheEvents) {
  const Experiment experiment = up_and_back();
  std::vector<QuantityEntry> entries;
  for (const char* name : {"V_L", "B_a", "b_g", "k_g", "T_p"})
    entries.push_back(*find_quantity(name));
  const IntegratorOptions without{.event_derivatives = false};
  double largest[2] = {0.0, 0.0};
  compare(experiment, entries,
          {by_jets(experiment, entries), by_jets(experiment, entries, without)},
          [&](std::size_t candidate, const Comparison& c) {
            largest[candidate] = std::max(largest[candidate], c.error);
          });
  std::cout << "largest error " << largest[0] << ", without event derivatives " << largest[1]
            << "\n";
  EXPECT_LT(largest[0], 1e-4);
  EXPECT_GT(largest[1], 1e-2);
}

}  // namespace
}  // namespace axisfit
