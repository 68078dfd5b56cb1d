#include "fit/design/discrimination.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "base/parallel.h"
#include "sim/recorder.h"
#include "sim/simulate.h"

namespace axisfit {
namespace {

struct Trial {
  const Recording* recorded = nullptr;
  const Experiment* experiment = nullptr;
  Schedule command;
  std::vector<double> times;
};

struct SimulatedSignals {
  bool feasible = false;  ///< finished, and within the limits
  std::vector<std::vector<double>> readings;
};

SimulatedSignals simulated(const Model<double>& model, const Trial& trial,
                           std::span<const Signal> signals, const MachineLimits& limits) {
  Recorder<double> recorder(model.instruments, signals, trial.times);
  SimulatedSignals course;
  bool within = true;
  const auto simulation_result = simulate(
      model, trial.command, recorder.instants(), [&](std::size_t, const Integrator<double>& axis) {
        recorder.read(axis);
        within = within && is_within(limits, axis.state()[0], axis.state()[1]);
      });
  course.feasible = simulation_result.finished && (within || trial.recorded != nullptr);
  for (std::size_t s = 0; s < signals.size() && course.feasible; ++s)
    course.readings.push_back(recorder.readings(s));
  return course;
}

double noise_of(const Job& job, Signal signal, const std::vector<double>& values) {
  for (const Recording& r : job.recordings)
    if (const Measurement* m = r.find(signal)) return m->sigma;
  const auto [low, high] = std::ranges::minmax(values);
  return 1e-3 * (high - low);
}

}  // namespace

Discrimination discriminate(const EffectSelection& selection, const Substitution& rivals,
                            bool new_motions, const RunContext& context) {
  const Job& job = selection.result.job;
  const MachineLimits within = complete_limits(job, selection.result.fit);
  std::vector<Signal> signals;
  for (const SignalInfo& signal : kSignalTable)
    if (has_signal(signal.signal, job.model.structure)) signals.push_back(signal.signal);

  std::vector<Trial> trials;
  for (const Recording& r : job.recordings) trials.push_back({&r, nullptr, r.command, r.times});
  const std::vector<double> times = next_sampling_times(job);
  std::vector<Experiment> candidates;
  if (new_motions) candidates = candidate_motions(job.model.structure, within, times.back());
  for (const Experiment& experiment : candidates)
    trials.push_back(
        {nullptr, &experiment, commands_of(experiment, rivals.with_chosen, times), times});

  const ThreadPool pool(job.options.threads);
  std::vector<Discrimination> found(trials.size());
  parallel_for(trials.size(), [&](std::size_t i) {
    context.check_stop();
    const Trial& trial = trials[i];
    const SimulatedSignals a = simulated(rivals.with_chosen, trial, signals, within),
                           b = simulated(rivals.with_rival, trial, signals, within);
    if (!a.feasible || !b.feasible) return;
    for (std::size_t s = 0; s < signals.size(); ++s) {
      if (trial.recorded != nullptr && trial.recorded->find(signals[s]) != nullptr) continue;
      double sum = 0.0;
      for (std::size_t k = 0; k < a.readings[s].size(); ++k)
        sum += std::pow(a.readings[s][k] - b.readings[s][k], 2);
      const double noise = noise_of(job, signals[s], a.readings[s]);
      const double size = std::sqrt(sum / static_cast<double>(a.readings[s].size())) / noise;
      if (!(noise > 0.0) || !(size > found[i].size)) continue;
      found[i].size = size;
      found[i].signal = signals[s];
    }
  });
  std::vector<std::size_t> order(trials.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, std::greater{}, [&](std::size_t i) { return found[i].size; });
  Discrimination result{.chosen = rivals.chosen, .rival = rivals.rival};
  constexpr double kVisible = 0.1;
  for (const std::size_t i : order) {
    context.check_stop();
    const Trial& trial = trials[i];
    const bool visible = found[i].signal && found[i].size >= kVisible;
    if (visible && trial.experiment != nullptr &&
        !reach_of(*trial.experiment, job, selection.result.fit, within))
      continue;
    result.size = found[i].size;
    if (!visible) break;
    result.signal = found[i].signal;
    if (trial.experiment != nullptr)
      result.experiment = *trial.experiment;
    else
      result.recording = trial.recorded->name;
    break;
  }
  return result;
}

}  // namespace axisfit
