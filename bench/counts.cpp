// counts [none|step|held]: what one evaluation costs, counted, not timed: steps, events and
// allocations of the paper's step with five parameters, of the same held to its data, and of a
// whole fit; of a force with a dead time; and of a search for a missing effect. With a name that
// work alone is done once, for a profiler; "none" of them.
#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "bench/allocations.h"
#include "bench/speed/evaluation.h"
#include "fit/estimate/estimate.h"
#include "fit/search/select_effects.h"

namespace {

using namespace axisfit;
using namespace axisfit::speed;

constexpr std::size_t kFree = 5;
constexpr double kDuration = 2.5;  // s

/// Steps and events of the simulation, as the cost runs it. In plain numbers: in dual ones this
/// program would bring its own code for them, and that would be measured, not the library's.
SimulationResult simulated_once(const Evaluation& evaluation, double rate) {
  const Recording& recording = evaluation.job().recordings[0];
  const Measurement* velocity = recording.find(Signal::velocity);
  const std::vector<double> target = target_corners(recording.times, velocity->values);
  return simulate<double>(
      evaluation.job().model, recording.command, recording.times,
      [](std::size_t, const Integrator<double>&) {}, observer_for(recording, rate), {target, {}},
      recording_options(recording.times, static_cast<double>(recording.command.times.size()),
                        FitOptions{}.step));
}

void count(const Rig& rig, const std::string& name, double rate) {
  Evaluation evaluation(rig, kFree, kDuration, rate);
  const SimulationResult outcome = simulated_once(evaluation, rate);
  const long before = allocations();
  if (!evaluation.run()) throw std::runtime_error("a simulation does not finish");
  fmt::print("{}.allocations {}\n{}.events {}\n{}.steps {}\n", name, allocations() - before, name,
             outcome.events, name, outcome.steps);
}

/// From a factor of three off, one way and the other.
FitResult fit(const Rig& rig) {
  Job job = Evaluation(rig, kFree, kDuration).job();
  for (std::size_t i = 0; i < job.free.size(); ++i)
    job.free[i] = free_parameter(job.model, kParameters[i], i % 2 == 0 ? 3.0 : 1.0 / 3.0);
  return estimate(job);
}

/// A mass that a force drives, 20 kg, with friction that falls with speed.
Rig rubbing_mass() {
  Rig rig;
  rig.model.structure.drive = Drive::force_source;
  rig.model.structure.transmission = Transmission::rigid;
  rig.model.axis.r_g = 1.0;
  rig.model.axis.K_f = 40.0;
  rig.model.axis.M = 20.0;
  rig.model.axis.B_a = 30.0;
  rig.noise[index_of(Signal::velocity)] = 1e-3;
  rig.model.structure.effects.set(*effect_named("stribeck_friction"));
  *members(rig.model)[quantity_index("stribeck_friction.F_st")] = 8.0;
  *members(rig.model)[quantity_index("stribeck_friction.v_st")] = 0.05;
  return rig;
}

Job job_of(const Rig& rig) {
  Job job;
  job.model = rig.model;
  job.options.threads = 1;
  RecordingOptions options;
  options.duration = kDuration;
  options.signals = {Signal::velocity};
  job.recordings.push_back(
      simulated(rig, LevelsMotion{{6.0, -6.0, -4.0, 6.0, 2.0, -3.0}, 0.2}, options));
  for (const char* name : {"M", "B_a"}) job.free.push_back(free_parameter(job.model, name));
  return job;
}

/// A force that is smooth, on readings and switches of a command that a dead time keeps apart.
void count_late() {
  Job job = job_of(rubbing_mass());
  job.model.axis.T_d = 0.3e-3;
  const Recording& recording = job.recordings[0];
  Schedule command;  // that switches at every sample
  for (const double t : recording.times) command.append(t, 6.0 * std::sin(10.0 * t));
  const SimulationResult outcome = simulate<double>(
      job.model, command, recording.times, [](std::size_t, const Integrator<double>&) {}, {}, {},
      recording_options(recording.times, static_cast<double>(recording.command.times.size()),
                        FitOptions{}.step));
  fmt::print("late.steps {}\n", outcome.steps);
}

/// The whole search for the friction.
void count_loop() {
  Job job = job_of(rubbing_mass());
  job.model.structure.effects.reset();
  const FitResult first = estimate(job);
  const long before = allocations();
  const EffectSelection selection = select_effects(job, first);
  fmt::print("loop.allocations {}\nloop.effects {}\n", allocations() - before,
             selection.effects.size());
}

}  // namespace

int main(int argc, char** argv) {
  const std::string only = argc > 1 ? argv[1] : "";
  const Rig rig = x_axis();
  constexpr double kHeld = 1000.0;  // 1/s
  if (only == "step" || only == "held") {
    Evaluation(rig, kFree, kDuration, only == "held" ? kHeld : 0.0).run();
  } else if (only == "none") {
    const Evaluation made(rig, kFree, kDuration);
  } else {
    count(rig, "step", 0.0);
    count(rig, "held", kHeld);
    const long before = allocations();
    const FitResult result = fit(rig);
    fmt::print("fit.allocations {}\nfit.iterations {}\n", allocations() - before,
               result.iterations);
    count_late();
    count_loop();
  }
  return 0;
}
