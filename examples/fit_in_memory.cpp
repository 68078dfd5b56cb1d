// A slide with dry friction, fitted by a model that has none, and the search for what it lacks.
#include <axisfit/axisfit.h>

#include <cmath>
#include <cstdio>
#include <random>

int main() {
  axisfit::Job job;  // of a mass that a force moves: M y'' + B_a y' = K_f U
  job.model.structure = {axisfit::Drive::force_source, axisfit::Transmission::rigid, {}};
  job.model.axis.K_f = 1.0;  // N/V
  axisfit::normalize(job.model);
  job.free = {axisfit::free_parameter("M", 10.0), axisfit::free_parameter("B_a", 10.0)};
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 1e-3);  // m/s
  for (const auto role : {axisfit::Role::fit, axisfit::Role::validate}) {
    std::vector<double> times, force, velocity;  // your recording; here 20 kg, 30 N s/m, 12 N
    for (double v = 0.0; times.size() < 2000; v = std::copysign(std::fdim(std::abs(v), 6e-4), v)) {
      times.push_back(1e-3 * times.size()), velocity.push_back(v + noise(random));
      force.push_back(60.0 * std::sin((role == axisfit::Role::fit ? 6.0 : 11.0) * times.back()));
      v += 1e-3 * (force.back() - 30.0 * v) / 20.0;
    }
    job.recordings.push_back({.name = role == axisfit::Role::fit ? "fit" : "check",
                              .role = role,
                              .times = times,
                              .command = axisfit::schedule_from_samples(times, force),
                              .measurements = {{axisfit::Signal::velocity, velocity, 1e-3}}});
  }
  const axisfit::RunResult result = axisfit::run(job, {.select_effects = true});
  std::fputs(axisfit::report_text(result).c_str(), stdout);
}
