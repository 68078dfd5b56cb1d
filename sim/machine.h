// Several axes of one machine that move together and act on each other.
//
// What an axis does to another one is an effect of the other: a neighbour's motion is a channel,
// and a force, a friction, a gain or a mass goes with it (effects/channel_effect.h). Inertia that
// two axes share acts both ways: with the kinetic energy m y1 z1, m is the force per acceleration
// of the other, -m, on each.
//
// The axes are simulated one after the other, each with the motions of the others as they were
// last, until no motion changes any more: waveform relaxation. It keeps the events and the exact
// propagation of the simulation of one axis, and it converges where couplings are weak: with shared
// inertia the error of a sweep is m^2 / (M_y M_z) of that before.
// Source: E. Lelarasmee, A. Ruehli and A. Sangiovanni-Vincentelli, The waveform relaxation method,
// IEEE Trans. CAD 1982.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/rig.h"

namespace axisfit {

/// What of an arm's motion is a channel of another axis. Of a mass that turns with a joint, at the
/// angle q, the sine and the cosine tell where it is, and their second derivatives how it pushes.
struct Motional {
  enum class Of { position, sine, cosine } of = Of::position;
  int derivative = 0;  ///< by time: 0, 1 or 2
};

/// Where a channel of an axis comes from.
struct ChannelSource {
  std::optional<std::size_t> axis;  ///< of the machine; none: the channel is at its zero
  Motional what;
  double per_si = 1.0;  ///< the channel's unit per that of the source in SI
};

struct CoupledAxis {
  std::string name;
  Rig rig;
  Motion motion;
  std::vector<ChannelSource> sources;  ///< one for each channel of the rig
};

struct Relaxation {
  double tolerance = 1e-9;  ///< largest change of a position or speed at the end, of its range
  int most_sweeps = 50;
  double interval = 1e-4;  ///< s, longest between the instants at which axes see each other
};

struct MachineRecording {
  /// Of each axis as record() makes them, and behind them its channels in their units.
  std::vector<std::vector<Column>> axes;
  int sweeps = 0;
  double change = 0.0;  ///< in the last one, as Relaxation::tolerance
};

/// Runs all axes from time zero and records them, each with a seed of its own. Throws
/// std::runtime_error where one cannot be simulated, and where the motions still change after
/// most_sweeps: the couplings are too strong. Of each axis these signals; those of the options do
/// not count.
MachineRecording record_machine(const std::vector<CoupledAxis>& axes,
                                const std::vector<std::vector<Signal>>& signals,
                                const RecordingOptions& options, const Relaxation& relaxation = {});

}  // namespace axisfit
