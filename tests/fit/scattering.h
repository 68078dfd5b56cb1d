// A machine that is not quite the same from recording to recording.
#pragma once

#include <random>
#include <string>
#include <utility>

#include "base/random.h"
#include "tests/fit/example.h"

namespace axisfit {

inline constexpr double kScatteringMass = 12.0, kScatteringDamping = 40.0;

/// Recordings of a driven mass whose viscous friction has the relative scatter, in fits with a
/// fixed observer.
inline Job scattering_machine(int recordings, double scatter, std::uint64_t seed,
                              double duration = 2.0) {
  Job job;
  job.model = driven_mass(kScatteringMass);
  job.model.axis.B_a = kScatteringDamping;
  std::mt19937_64 generator(seed);
  for (int i = 0; i < recordings; ++i) {
    Model<double> truth = job.model;
    truth.axis.B_a *= 1.0 + scatter * normal(generator);
    Recording recording = recorded(truth, SineMotion{60.0, 0.5, 6.0, 0.0}, duration,
                                   100 * seed + std::uint64_t(i), {Signal::velocity});
    recording.name = "run-" + std::to_string(i + 1);
    job.recordings.push_back(std::move(recording));
  }
  job.free = {free_parameter("M", 10.0), free_parameter("B_a", 30.0)};
  job.options.criterion = Tracking{5.0};
  job.options.step = 2e-3;
  return job;
}

}  // namespace axisfit
