// Motion files: what to run an axis through, in YAML. docs/motion-file.md tells of every
// key.
#pragma once

#include <string>
#include <vector>

#include "io/config/key.h"
#include "sim/rig.h"

namespace axisfit {

struct MotionFile {
  Motion motion;
  double duration = 0.0;    ///< s
  std::string recording{};  ///< the file of a recorded motion, as found
};

/// The keys of a motion file that every type has.
const Section& motion_keys();

/// Those that a type has besides.
const Section& motion_keys(const std::string& type, Vocabulary vocabulary);

/// Reads a motion file for a rig. Throws ConfigError with everything that is wrong, among it a
/// voltage beyond the rig's limit and a move for an axis without a controller.
MotionFile read_motion_file(const std::string& path, const Rig& rig);

/// A motion file that reads back as the same motion, digit for digit. A recorded motion has a file
/// of its own and cannot be written: std::logic_error. `comment` becomes its first lines.
std::string format_motion_file(const MotionFile& file, const std::string& comment,
                               Vocabulary vocabulary);

}  // namespace axisfit
