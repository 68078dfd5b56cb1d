// A test rig: an axis, its controller, and instruments with sampling, errors and noise.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/column.h"
#include "sim/axis_uncertainty.h"
#include "sim/model.h"
#include "sim/motion.h"

namespace axisfit {

/// An axis as an axis file describes it.
struct Rig {
  std::string name;
  Model<double> model;
  std::array<double, kSignals> noise{};  ///< standard deviation of white noise, signal's unit
  std::vector<std::size_t> guessed{};    ///< quantities whose values nobody knows, in the list
  std::optional<AxisUncertainty> uncertainty{};  ///< of what was estimated
};

struct RecordingOptions {
  double duration = 2.5;        ///< s
  double rate = 1000.0;         ///< Hz, of all signals
  std::uint64_t seed = 1;       ///< of the noise; every signal has a stream of its own
  bool noise = true;            ///< false: exact readings, the encoder not quantised either
  double step = 0.5e-3;         ///< s, of the integrator
  std::vector<Signal> signals;  ///< which to record, in this order
};

/// Channels of an axis while it moves.
struct ChannelsOverTime {
  /// s: the samples of the recording, each interval between them divided into the same number of
  /// parts, a multiple of four. None: the channels are at their zero.
  std::span<const double> instants = {};
  std::span<const ChannelSeries> series = {};
};

/// Runs a rig through a motion and records it: columns time_s, command_v (or _a), then one per
/// signal, named by column_name(). The model's instruments give gain and bias, the rig noise, and
/// the controller's encoder the position's resolution. Throws std::runtime_error when the motion
/// cannot be simulated to its end.
std::vector<Column> record(const Rig& rig, const Motion& motion, const RecordingOptions& options,
                           const ChannelsOverTime& channels = {});

/// The same without noise, as far as the rig's uncertainty lets it be known: each signal is
/// followed by the half widths of its 95 % bands, at any one instant and for the whole curve, of
/// readings with their noise unless the options leave it out. Throws std::runtime_error, too, where
/// the rig has no uncertainty, or one with which hardly any motion can be simulated.
std::vector<Column> record_with_bands(const Rig& rig, const Motion& motion,
                                      const RecordingOptions& options);

/// A name and a unit in plain letters: "velocity_mps".
std::string column_name(std::string_view name, std::string_view unit);
/// Of a signal on the joint.
std::string column_name(Signal signal, Vocabulary vocabulary);

}  // namespace axisfit
