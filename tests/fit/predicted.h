// A prediction of a machine whose parameters scatter.
#pragma once

#include <cstdint>
#include <utility>

#include "fit/run.h"
#include "tests/fit/scattering.h"

namespace axisfit {

/// The last of the recordings is to be predicted.
inline RunResult predicted(double scatter, std::uint64_t seed) {
  Job job = scattering_machine(6, scatter, seed);
  job.recordings.back().role = Role::validate;
  return run(std::move(job), {.predict = true});
}

}  // namespace axisfit
