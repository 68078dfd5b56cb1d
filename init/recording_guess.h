// What the columns of a recording are: by their names, and by what their values say of each other.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "init/column_guess.h"
#include "init/overflow.h"
#include "io/recording/recording_file.h"

namespace axisfit {

/// How the remark on a column that is part of a rating begins.
inline constexpr std::string_view kInPercent = "in per cent of the rated";

/// A column with what a job would say of it.
struct GuessedColumn {
  std::string column;  ///< its name, or its number
  Kind kind = Kind::command;
  bool is_setpoint = false;  ///< see ColumnGuess
  std::string stored;        ///< the unit, where it is one of stored_units(); else empty
  std::string unit;          ///< as written in the job, see write_units()
  double factor = 1.0;
  bool of_rating = false;            ///< in per cent of a rating, whatever `unit` says
  Overflow overflow;                 ///< of the stored values
  bool negative = false;             ///< its sign is to be turned
  std::vector<std::string> reasons;  ///< what was measured, sentences without a full stop
  bool idle = false;                 ///< told by another one, and more precisely
  bool guessed = false;              ///< something of it neither name nor measurement says
  bool sized_by_range = false;       ///< its unit was guessed, by how large its values are
  std::string remark;                ///< on a unit that a job cannot write, as a reason; a guess
  std::vector<double> values;        ///< in the SI unit of its kind, at the times of the recording
  std::string clock;                 ///< column of times of its own; empty: those of the recording
  std::string clock_unit;
  std::string answer;  ///< the column as the user called it; empty: nobody asked

  bool is_constant() const;
};

/// What the user says of a column.
struct ColumnAnswer {
  Kind kind = Kind::command;
  std::string column;  ///< its name, or its number from 1
  std::string stored;  ///< its unit, as of GuessedColumn
  std::string unit;    ///< as a job takes it
  double factor = 1.0;
  bool of_rating = false;
};

/// Reads "position=Geber [Ink]:um/8" or "current=3:A*0.5": signal, column, unit and perhaps a
/// factor or divisor. Throws std::runtime_error, which says what is wrong.
ColumnAnswer read_answer(const std::string& text);

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

  const GuessedColumn* find(Kind kind, bool is_setpoint = false) const;
  GuessedColumn* find(Kind kind, bool is_setpoint = false);
};

/// Names first. Where they leave a unit open, the derivative of the position against the velocity,
/// and that of the velocity against the acceleration, tell the ratio of their units and their
/// signs; last the size of the values. What never changes measures nothing, but it may drive: the
/// command of a step. Where no column has a name, the values alone tell what moves, and what drives
/// it. An answer comes before all that. Columns with a clock of their own, or gaps, are compared at
/// the times of the recording. Where nothing tells the unit of a motion, it is the one that suits
/// the `joint`. Other units are those of a job for a prismatic joint, and what it cannot write of
/// them is in the remarks.
///
/// Throws RecordingError where nothing can be the time, and where a column of an answer cannot be
/// used; one that is not there counts for other files.
RecordingGuess guess_recording(const RecordingFile& file, const std::string& path,
                               const std::vector<ColumnAnswer>& answers = {},
                               Joint joint = Joint::prismatic);

/// Whether the motion was recorded in units of angles, and none of it in units of lengths.
bool is_of_angles(const RecordingGuess& recording);

/// Whether nothing tells if the motion is one of angles or of lengths.
bool has_motion_without_unit(const RecordingGuess& recording);

/// Writes the units as a job for an axis with that joint takes them, and makes reasons of the
/// remarks that remain.
void write_units(RecordingGuess& recording, Vocabulary vocabulary);

}  // namespace axisfit
