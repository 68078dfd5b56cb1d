// What a fit evaluates, as the benchmarks repeat it: residuals of velocity and acceleration of the
// paper's step of the x axis, read at 1 kHz, and their Jacobian.
#pragma once

#include <vector>

#include "bench/simulated.h"
#include "bench/speed/work.h"
#include "fit/criterion/gains.h"
#include "fit/solve/residual.h"
#include "io/config/axis_file.h"

namespace axisfit::speed {

/// As shipped.
inline Rig x_axis() {
  Diagnostics diagnostics;
  return *read_axis_file(AXISFIT_CONFIGS "/axes/x.yaml", diagnostics);
}

class Evaluation {
 public:
  /// With the first `parameters` of kParameters free. `rate`: 1/s, of the observer; 0: none.
  Evaluation(const Rig& rig, std::size_t parameters, double duration, double rate = 0.0)
      : job_(job_of(rig, parameters, duration)),
        space_(job_),
        cost_(job_, space_, 0, observer_for(job_.recordings[0], rate)),
        residuals_(static_cast<std::size_t>(cost_.num_residuals())),
        jacobian_(residuals_.size() * parameters) {
    for (std::size_t i = 0; i < parameters; ++i)
      u_.push_back(space_.internal(i, job_.free[i].initial));
  }
  Evaluation(const Evaluation&) = delete;
  Evaluation& operator=(const Evaluation&) = delete;

  const Job& job() const { return job_; }

  /// Whether the simulation finished.
  bool run() {
    const double* at = u_.data();
    double* columns = jacobian_.data();
    return cost_.Evaluate(&at, residuals_.data(), &columns);
  }

 private:
  static Job job_of(const Rig& rig, std::size_t parameters, double duration) {
    Job job;
    job.model = rig.model;
    RecordingOptions options;
    options.duration = duration;
    options.signals = {Signal::velocity, Signal::acceleration};
    job.recordings.push_back(simulated(rig, StepMotion{Work{}.command}, options));
    for (std::size_t k = 0; k < parameters; ++k)
      job.free.push_back(free_parameter(job.model, kParameters[k]));
    return job;
  }

  Job job_;
  ParameterSpace space_;
  RecordingCost cost_;
  std::vector<double> residuals_, jacobian_, u_;
};

}  // namespace axisfit::speed
