// What the columns of a recording are: by their names, and by what their values say of each other.
// The rules are in init/columns, a file for each.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "init/columns/answers.h"
#include "init/columns/column_set.h"
#include "init/columns/names.h"
#include "io/recording/recording_file.h"

namespace axisfit {

/// How the reason of a column that is part of a rating begins.
inline constexpr std::string_view kInPercent = "in per cent of the rated";

/// A column beside the axis that may act on it.
struct GuessedChannel {
  std::string column;  ///< its name, or its number
  ChannelGuess guess;  ///< of several of one name each has a number
};

struct RecordingGuess {
  std::string path;
  GuessedColumn time;
  std::vector<GuessedColumn> columns;  ///< one at most of each kind, measured and wanted
  std::vector<std::string> unused;     ///< names of all others
  std::vector<std::string> constant;   ///< of these, names of what would be signals if they changed
  std::vector<GuessedChannel> channels{};
  double rate = 0.0;    ///< Hz, of samples without a column of times; zero: `time` has them
  std::string motor{};  ///< of several axes the one whose columns these are
  std::vector<std::string> notes{};  ///< what the user should look at beside the columns

  const GuessedColumn* find(Kind kind, bool is_setpoint = false) const;
  GuessedColumn* find(Kind kind, bool is_setpoint = false);
};

/// What is known of a recording before it is looked at.
struct GuessOptions {
  Answers answers{};
  Joint joint = Joint::prismatic;  ///< of the axis, as far as it is known
  /// How large columns are at most in other recordings of the job, as stored, by their names.
  std::map<std::string, double> ranges{};
};

/// Names first. Where they leave a unit open, the derivative of the position against the velocity,
/// and that of the velocity against the acceleration, tell the ratio of their units and their
/// signs; last the size of the values. What never changes measures nothing, but it may drive: the
/// command of a step. Where no column has a name, the values alone tell what moves, and what drives
/// it. An answer comes before all that. Columns with a clock of their own, or gaps, are compared at
/// the times of the recording. Where nothing tells the unit of a motion, it is the one that suits
/// the joint. Units are those that were recorded until write_units().
///
/// Throws RecordingError where nothing can be the time, where rows that differ have one time, where
/// the columns are of several axes and no answer names one, and where a column of an answer cannot
/// be used; one that is not there counts for other files.
RecordingGuess guess_recording(const RecordingFile& file, const std::string& path,
                               const GuessOptions& options = {});

/// Whether the motion was recorded in units of angles, and none of it in units of lengths.
bool is_of_angles(const RecordingGuess& recording);

/// Whether nothing tells if the motion is one of angles or of lengths.
bool has_motion_without_unit(const RecordingGuess& recording);

/// Writes the units as a job for an axis with that joint takes them. What a job cannot write, such
/// as counts, or radians of a load that slides, is a reason and a guess.
void write_units(RecordingGuess& recording, Vocabulary vocabulary);

}  // namespace axisfit
