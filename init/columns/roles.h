// Which of several columns is which signal: those of one axis go together, a reference is told from
// what was measured, and of several that tell the same the best is taken.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "init/columns/names.h"

namespace axisfit {

/// A column that may be a signal.
struct Candidate {
  std::size_t place = 0;  ///< in the file
  std::string shown;      ///< what messages call it
  ColumnGuess name;
  std::vector<double> values;  ///< at the times of the recording, as stored
  bool is_answered = false;    ///< by the user
};

/// One of several axes whose columns are in one file.
struct AxisColumns {
  std::string name;                  ///< what their names have in common: "0", "x", "elbow"
  std::vector<std::size_t> columns;  ///< indices of candidates
  bool moves = false;  ///< an encoder of an axis that idles shows its noise and some steps alone
};

/// The axes of which there are both a motion and what may drive it, where there are several, by
/// what the names of their columns have in common.
std::vector<AxisColumns> axes_in(const std::vector<Candidate>& candidates);

/// Leaves the columns of one axis, and those of none: that of the name `motor`, or the one that
/// moves. Answered columns stay. Of one axis alone among others that lack a motion or a drive, what
/// the others have ranks behind its own. Throws std::runtime_error, which names the axes, where
/// several move and none is named, and where none has the name. What it leaves out goes to
/// `others`, as messages call it.
///
/// The name of the axis that was chosen among several; empty where there was no choice.
std::string keep_one_axis(std::vector<Candidate>& candidates, const std::string& motor,
                          std::vector<std::string>& others);

/// Of two columns of one kind that no name tells apart, the one without noise that leads is the
/// reference of the other: marks it as a set value.
void tell_references(std::vector<Candidate>& candidates);

/// Whether `reference` is what `measured` follows: the same motion, without its noise, and earlier.
bool is_reference_of(const std::vector<double>& reference, const std::vector<double>& measured);

/// Where encoders of motor and load were recorded: the load's is the position where the torque is
/// the joint's, and else it is the load_position beside the motor's.
void tell_sides(std::vector<Candidate>& candidates);

/// Ranks a column of whole numbers behind one of fractions that tells the same.
void rank_raw_last(std::vector<Candidate>& candidates);

}  // namespace axisfit
