#include "fit/first_look/job_look.h"

#include <vector>

namespace axisfit {

std::optional<FirstLook> look_at(const Job& job) {
  const Structure& structure = job.model.structure;
  if (!capabilities(structure).is_force_driven) return std::nullopt;
  std::vector<std::vector<double>> forces;
  for (const Recording& recording : job.recordings) {
    if (recording.command.meaning == Meaning::reference) return std::nullopt;
    std::vector<double>& force = forces.emplace_back();
    for (const double t : recording.times)
      force.push_back(job.model.axis.K_f * recording.command.value_at(t));
  }
  std::vector<DrivenMotion> motions;
  for (std::size_t r = 0; r < forces.size(); ++r) {
    const Recording& recording = job.recordings[r];
    const auto values = [&](Signal signal) -> std::span<const double> {
      const Measurement* m = recording.find(signal);
      return m != nullptr ? std::span<const double>(m->values) : std::span<const double>();
    };
    motions.push_back(
        {recording.times, values(Signal::position), values(Signal::velocity), forces[r]});
  }
  return first_look(motions, structure.joint);
}

}  // namespace axisfit
