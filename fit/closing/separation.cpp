#include "fit/closing/separation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "sim/motion.h"
#include "sim/recorder.h"
#include "sim/simulate.h"

namespace axisfit {
namespace {

struct Trial {
  std::string motion;  ///< as it follows "in"
  const Recording* recorded = nullptr;
  Schedule command;
  std::vector<double> times;
};

std::vector<Trial> trials(const Job& job) {
  std::vector<Trial> list;
  double volts = 0.0, interval = 1e-3;
  for (const Recording& r : job.recordings) {
    list.push_back({"the motion of " + r.name, &r, r.command, r.times});
    for (const double u : r.command.values) volts = std::max(volts, std::abs(u));
    interval = (r.times.back() - r.times.front()) / static_cast<double>(r.times.size() - 1);
  }
  constexpr double kDuration = 4.0;  // s
  std::vector<double> times;
  for (int i = 0; i * interval <= kDuration; ++i) times.push_back(i * interval);
  const double half = 0.5 * volts, tenth = 0.1 * volts;
  const std::vector<std::pair<std::string, Motion>> motions{
      {fmt::format("a step of {:.3g} V", volts), StepMotion{volts, 0.0}},
      {fmt::format("levels between {:.3g} and -{:.3g} V", volts, volts),
       LevelsMotion{{volts, 0.0, -volts, half, -half, 0.0}, 0.6}},
      {fmt::format("a slow sine of {:.3g} V and 0.5 Hz", tenth), SineMotion{tenth, 0.5, 0.5}},
      {fmt::format("a chirp of {:.3g} V from 0.5 to 20 Hz", half), SineMotion{half, 0.5, 20.0}},
      {fmt::format("a pseudo-random sequence of {:.3g} V", half), PrbsMotion{half, 0.1, 0.0, 1}},
  };
  for (const auto& [name, motion] : motions)
    list.push_back({name, nullptr, schedule_of(motion, kDuration, 5.0 * interval), times});
  return list;
}

std::optional<std::vector<std::vector<double>>> simulated(const Model<double>& model,
                                                          const Trial& trial,
                                                          std::span<const Signal> signals) {
  Recorder<double> recorder(model.instruments, signals, trial.times);
  const auto outcome =
      simulate(model, trial.command, recorder.instants(),
               [&](std::size_t, const Integrator<double>& axis) { recorder.read(axis); });
  if (!outcome.finished) return std::nullopt;
  std::vector<std::vector<double>> readings;
  for (std::size_t s = 0; s < signals.size(); ++s) readings.push_back(recorder.readings(s));
  return readings;
}

double noise_of(const Job& job, Signal signal, const std::vector<double>& values) {
  for (const Recording& r : job.recordings)
    if (const Measurement* m = r.find(signal)) return m->sigma;
  const auto [low, high] = std::ranges::minmax(values);
  return 1e-3 * (high - low);
}

}  // namespace

std::string what_separates(const Job& job, const Model<double>& a, const Model<double>& b) {
  std::vector<Signal> signals;
  for (const SignalInfo& signal : kSignalTable)
    if (has_signal(signal.signal, job.model.structure)) signals.push_back(signal.signal);
  double best = 0.0;
  std::string text;
  for (const Trial& trial : trials(job)) {
    const auto of_a = simulated(a, trial, signals), of_b = simulated(b, trial, signals);
    if (!of_a || !of_b) continue;
    for (std::size_t s = 0; s < signals.size(); ++s) {
      const auto& ya = (*of_a)[s];
      const auto& yb = (*of_b)[s];
      double sum = 0.0;
      for (std::size_t i = 0; i < ya.size(); ++i) sum += (ya[i] - yb[i]) * (ya[i] - yb[i]);
      const double noise = noise_of(job, signals[s], ya);
      const double size = std::sqrt(sum / static_cast<double>(ya.size())) / noise;
      if (!(noise > 0.0) || !(size > best)) continue;
      if (trial.recorded != nullptr && trial.recorded->find(signals[s]) != nullptr) continue;
      best = size;
      text = fmt::format("they differ most in the {} during {}: by {:.2g} times its noise",
                         info(signals[s]).name, trial.motion, size);
    }
  }
  return best > 0.1 ? text : "no motion that was tried tells them apart";
}

}  // namespace axisfit
