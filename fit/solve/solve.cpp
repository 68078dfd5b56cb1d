#include "fit/solve/solve.h"

#include "fit/criterion/gains.h"
#include "fit/solve/journal.h"
#include "fit/solve/residual.h"

namespace axisfit {
namespace {

Costs recording_costs(const Job& job, const ParameterSpace& space, double observer_gain,
                      const StopFlag* stop) {
  Costs list;
  for (std::size_t r = 0; r < job.recordings.size(); ++r)
    if (job.recordings[r].role == Role::fit)
      list.push_back(std::make_unique<RecordingCost>(
          job, space, r, observer_for(job.recordings[r], observer_gain), stop));
  return list;
}

/// The series of the residuals as RecordingCost has them: recording by recording, measurement by
/// measurement.
std::vector<SeriesRows> series_of(const Job& job) {
  std::vector<SeriesRows> series;
  Eigen::Index row = 0;
  for (std::size_t r = 0; r < job.recordings.size(); ++r) {
    const Recording& recording = job.recordings[r];
    for (std::size_t m = 0; m < recording.measurements.size(); ++m) {
      Eigen::Index n = 0;
      for (std::size_t i = 0; i < recording.times.size(); ++i)
        n += recording.fits(recording.measurements[m], i) ? 1 : 0;
      if (n > 0) series.push_back({r, m, row, n});
      row += n;
    }
  }
  return series;
}

}  // namespace

SolveResult solve(const Job& job, const ParameterSpace& space, const Eigen::VectorXd& u,
                  double observer_gain, SolveOptions options, const RunContext& context) {
  context.check_stop();
  options.stop = context.stop;
  options.jumps = true;
  Journal* const journal = context.journal;
  const ProblemKey key =
      journal != nullptr ? problem_key(job, u, observer_gain, options) : ProblemKey{};
  if (journal != nullptr) {
    // A file may be forged, and nothing is defined beyond a vector's end.
    std::optional<SolveResult> known = journal->find(key);
    if (known && known->u.size() == u.size()) return *std::move(known);
  }
  SolveResult result =
      minimize(space, recording_costs(job, space, observer_gain, options.stop), u, options);
  context.check_stop();
  if (journal != nullptr) journal->store(key, result);
  return result;
}

Linearization linearize(const Job& job, const ParameterSpace& space, const Eigen::VectorXd& u,
                        double observer_gain) {
  // To its end, for a result that was found before a stop needs it.
  Linearization result = linearize(space, recording_costs(job, space, observer_gain, nullptr), u);
  result.series = series_of(job);
  return result;
}

Linearization linearize(const Job& job, const ParameterSpace& space, const SolveResult& solved,
                        double observer_gain) {
  if (!solved.at_solution) return linearize(job, space, solved.u, observer_gain);
  Linearization result = *solved.at_solution;
  result.series = series_of(job);
  return result;
}

Eigen::VectorXd residuals_at(const Job& job, const ParameterSpace& space, const Eigen::VectorXd& u,
                             double observer_gain) {
  return residuals_at(space, recording_costs(job, space, observer_gain, nullptr), u);
}

}  // namespace axisfit
