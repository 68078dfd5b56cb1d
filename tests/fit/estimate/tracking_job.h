// A job that tracks its recording, and may lack an effect.
#pragma once

#include "tests/fit/search/selection.h"

namespace axisfit {

/// So many seconds of a slide's position, with or without dry friction that the job does not have,
/// tracked at 9 1/s.
inline Job tracking_job(bool has_friction, double duration = 30.0) {
  HiddenEffect friction = hidden_effect_named("coulomb_friction");
  if (!has_friction) friction.strengths[0].second = 0.0;
  Job job = two_recordings(slide(), slide(), {"M", "B_a"});
  job.recordings = {recorded(friction.truth(), fit_motion(), duration, 3, {Signal::position})};
  job.options.criterion = Tracking{9.0};
  return job;
}

}  // namespace axisfit
