// Motions of an axis.
#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include "sim/command.h"
#include "sim/controller_settings.h"

namespace axisfit {

/// U = level from `start` on.
struct StepMotion {
  double level = 10.0;  ///< V
  double start = 0.0;   ///< s
};

/// One level after the other, each held for `hold`.
struct LevelsMotion {
  std::vector<double> levels;  ///< V
  double hold = 0.6;           ///< s
};

/// U = offset + amplitude sin(2 pi f t), f from `from` to `to` linearly over the motion (a chirp; a
/// plain sine where both are the same).
struct SineMotion {
  double amplitude = 1.0;  ///< V
  double from = 1.0;       ///< Hz
  double to = 1.0;         ///< Hz
  double offset = 0.0;     ///< V
};

/// A pseudo-random binary sequence: +-amplitude, a new seeded choice every `bit`.
struct PrbsMotion {
  double amplitude = 1.0;  ///< V
  double bit = 0.05;       ///< s
  double offset = 0.0;     ///< V
  std::uint64_t seed = 1;
};

/// A move of the position by the slave control unit: trapezoidal speed, or triangular where the
/// distance is too short to reach the speed.
struct MoveMotion {
  double distance = 1.0;      ///< m, of either sign
  double speed = 0.9;         ///< m/s, > 0
  double acceleration = 2.0;  ///< m/s^2, > 0
};

/// A command that was recorded.
struct RecordedMotion {
  Schedule schedule;
};

using Motion =
    std::variant<StepMotion, LevelsMotion, SineMotion, PrbsMotion, MoveMotion, RecordedMotion>;

/// The voltage commands of a motion over `duration` (s), from time zero. Sine and chirp are held
/// for `period` (s). A move has none of its own: see reference_of.
Schedule schedule_of(const Motion& motion, double duration, double period);

/// The reference of a move.
Reference reference_of(const MoveMotion& move);

}  // namespace axisfit
