// counts [none|step|held]: what one evaluation costs, counted, not timed: steps, events and
// allocations of the paper's step with five parameters, of the same held to its data, and of a
// whole fit. With a name that work alone is done once, for a profiler; "none" of them.
#include <fmt/format.h>

#include <stdexcept>
#include <string>

#include "bench/allocations.h"
#include "bench/speed/evaluation.h"
#include "fit/estimation/estimate.h"

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
      recording_options(recording.times, FitOptions{}.step));
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
  }
  return 0;
}
