// Recordings in MCAP, as ROS 2 (rosbag2) and other recorders write them.
#pragma once

#include <string>

#include "io/recording/table.h"

namespace axisfit {

/// Reads every number of every topic as a column: messages in CDR by their definitions (ros2msg),
/// and in JSON. Chunks may be compressed with lz4 or zstd. A file whose end is missing, since its
/// recorder was stopped, is read as far as it goes.
///
/// A column is called by its topic and its path in the message: "/joint_states.position[0]", or
/// where the message names its joints, "/joint_states.position.elbow": by name, in whatever order
/// the joints come. A value that a message lacks is NaN. Sequences of more than 64 numbers or 16
/// messages are left out, and so is text. Where messages of one topic come on several channels with
/// other definitions, "(2)" follows the topic.
///
/// Each topic has a clock, in s since the first message of the file: "/joint_states.header.stamp"
/// where the messages have that and it goes with the time of recording (within a day), or else
/// "/joint_states log time".
///
/// A topic of another encoding is a column with an obstacle, which says what converts it. Throws
/// RecordingError where the file is none of this kind, is damaged, or holds no numbers.
Table read_mcap(const std::string& path);

}  // namespace axisfit
