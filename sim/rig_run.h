// A rig in motion: what record() and record_machine() share.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "sim/rig.h"
#include "sim/simulate.h"

namespace axisfit {

/// s, of all samples.
std::vector<double> sampling_times(const RecordingOptions& options);
/// The same with each interval between them divided into so many parts.
std::vector<double> sampling_times(const RecordingOptions& options, double parts);

/// Simulates a rig through a motion, with these channels at the instants (s, from zero on), and
/// calls read(i, axis) at each; returns the commands. Throws std::runtime_error when it cannot be
/// simulated to the end.
Schedule run_rig(const Rig& rig, const Motion& motion, const RecordingOptions& options,
                 std::span<const double> instants, std::span<const ChannelSeries> channels,
                 const std::function<void(std::size_t, const Integrator<double>&)>& read);

}  // namespace axisfit
