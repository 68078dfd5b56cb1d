// Axes that nobody would build: every quantity anywhere in its allowed range, driven at random.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "base/random.h"
#include "sim/recorder.h"
#include "sim/rig.h"
#include "sim/simulate.h"

namespace axisfit {

/// Anywhere in the range: on a logarithmic scale, over at most twelve decades, either sign where
/// both are allowed; at zero or at an end of the range in one of eight.
inline double anywhere(std::mt19937_64& g, double lower, double upper) {
  if (uniform(g) < 0.125) {
    const double choice = uniform(g);
    return choice < 0.4 ? lower : choice < 0.6 ? upper : std::clamp(0.0, lower, upper);
  }
  const bool negative = lower < 0.0 && (upper <= 0.0 || uniform(g) < 0.5);
  const double largest = negative ? -lower : upper;
  const double smallest = std::max(negative ? -upper : lower, 1e-12 * largest);
  const double size = smallest * std::pow(largest / smallest, uniform(g));
  return negative ? -size : size;
}

inline Model<double> any_model(std::mt19937_64& g) {
  Model<double> model;
  model.structure.drive = static_cast<Drive>(static_cast<int>(3.0 * uniform(g)));
  model.structure.transmission = static_cast<Transmission>(static_cast<int>(2.0 * uniform(g)));
  for (std::size_t i = 0; i < model.structure.effects.size(); ++i)
    model.structure.effects.set(i, uniform(g) < 0.1);
  const std::vector<double*> member = members(model);
  for (const QuantityEntry& entry : quantity_list()) {
    // Instruments and initial states mostly at their standard value.
    const bool custom = !std::isnan(entry.quantity.default_value) && uniform(g) < 0.7;
    const bool used = is_used(entry, model.structure);
    *member[entry.index] = used && !custom ? anywhere(g, entry.quantity.lower, entry.quantity.upper)
                           : std::isnan(entry.quantity.default_value)
                               ? 0.0
                               : entry.quantity.default_value;
    if (!used && entry.name == "r_g") *member[entry.index] = 1.0;
  }
  return model;
}

inline Motion any_motion(std::mt19937_64& g) {
  const double amplitude = anywhere(g, 1e-3, 100.0);
  switch (static_cast<int>(4.0 * uniform(g))) {
    case 0:
      return StepMotion{amplitude, 0.01};
    case 1:
      return LevelsMotion{{amplitude, -amplitude, 0.0, 0.5 * amplitude}, 0.05};
    case 2:
      return SineMotion{amplitude, 1.0, anywhere(g, 1.0, 400.0)};
    default:
      return PrbsMotion{amplitude, 0.004};
  }
}

struct Ordeal {
  std::string refused;  ///< why the model is no model; empty: it was simulated
  IntegratorOptions options;
  SimulationResult simulation_result;
  bool finite = true;  ///< all that was read
};

/// Draw number `draw`, simulated over 0.2 s at 1 kHz.
inline Ordeal ordeal(std::uint64_t draw) {
  std::mt19937_64 g(draw);
  const Model<double> model = any_model(g);
  const Motion motion = any_motion(g);
  Ordeal result;
  result.refused = model_error(model);
  if (!result.refused.empty()) return result;
  std::vector<double> times;
  for (int i = 0; i < 200; ++i) times.push_back(1e-3 * i);
  std::vector<Signal> signals;
  for (const SignalInfo& s : kSignalTable)
    if (has_signal(s.signal, model.structure)) signals.push_back(s.signal);
  Recorder<double> recorder(model.instruments, signals, times);
  const Schedule command = schedule_of(motion, 0.2, 5e-3);
  result.options = recording_options(times, static_cast<double>(command.times.size()), 0.5e-3);
  result.simulation_result = simulate<double>(
      model, command, recorder.instants(),
      [&](std::size_t, const Integrator<double>& axis) { recorder.read(axis); }, {}, {},
      result.options);
  for (std::size_t s = 0; s < signals.size(); ++s)
    if (result.simulation_result.reached > 0)
      for (const double v : recorder.readings(s)) result.finite = result.finite && std::isfinite(v);
  return result;
}

/// A simulation ends in finite readings or is given up, within its budgets; or there is a reason
/// why it cannot begin.
inline void expect_endured(std::uint64_t first, std::uint64_t end) {
  for (std::uint64_t draw = first; draw < end; ++draw) {
    SCOPED_TRACE(draw);
    const Ordeal o = ordeal(draw);
    if (!o.refused.empty()) continue;
    if (o.simulation_result.finished) {
      EXPECT_TRUE(o.finite);
    }
    EXPECT_LE(o.simulation_result.steps, o.options.step_budget + 1);
    EXPECT_LE(o.simulation_result.events, o.options.event_budget);
  }
}

}  // namespace axisfit
