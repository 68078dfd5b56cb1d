// A job file in the making: what is known of the recordings and their axis, and what follows from
// it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fit/data/job.h"
#include "init/init_request.h"
#include "init/recording_guess.h"
#include "init/starter_axis.h"
#include "io/results/output_folder.h"

namespace axisfit {

inline constexpr const char* kJobName = "job.yaml";
inline constexpr const char* kAxisName = "axis.yaml";

/// What drives a recording: the key in the job, and the column.
struct InputColumn {
  const char* key = "command";
  Kind kind = Kind::command;
  bool is_setpoint = false;
  double gain = 1.0;  ///< by which the column's values are multiplied besides
};

struct DraftRecording {
  std::string name, file;  ///< as the job has them
  RecordingGuess guess;
  std::optional<InputColumn> input;
  std::string input_file = {};  ///< of what drives the axis, where it is not `file`
  double input_offset = 0.0;    ///< s, added to the times of that
  /// What tells whether each value of the input holds until the next; empty: its kind does.
  std::string hold_reason = {};
  bool is_held = false;  ///< by that
  /// s, recorded times from and up to which it is used.
  std::optional<double> trim_from = {}, trim_to = {};

  /// Once the input is known.
  const GuessedColumn& input_column() const;
  GuessedColumn& input_column();
  /// Its values, times the gain.
  std::vector<double> driving() const;
  /// Whether what drives the axis was measured, not commanded.
  bool has_measured_input() const;
  /// Whether each of its values holds until the next, as those of a command do.
  bool holds_input() const { return hold_reason.empty() ? !has_measured_input() : is_held; }
  bool drives_in_newtons() const;
  /// Leaves so many samples from the first on; trim_from and trim_to are the caller's.
  void keep_samples(std::size_t first, std::size_t count);
};

/// A quantity that the job may free.
struct DraftParameter {
  std::string name, entry;
  std::string reason_not_free = {};  ///< why it is not free; empty where it is
};

struct JobDraft {
  InitRequest request;
  std::string axis_text = {};  ///< of the axis file to write; empty: that of the user
  bool joined = false;         ///< of two files: their clocks may differ
  std::vector<DraftRecording> recordings = {};
  Structure structure = {};
  std::optional<FirstLook> look = {};       ///< at what a force drives, see first_look.h
  bool goes_one_way = false;                ///< which does not tell friction from a constant force
  std::optional<StarterAxis> starter = {};  ///< none where an axis file is given
  std::vector<DraftParameter> parameters = {};
  std::vector<std::string> guesses = {};  ///< what the user should look at

  Vocabulary vocabulary() const { return vocabulary_of(structure); }
  /// As the job calls it.
  const QuantityEntry& quantity(std::string_view name) const;
  std::string say(std::string_view text) const;
  std::string_view command_unit() const { return unit_on(vocabulary(), kCommandUnit); }
  bool is_force_driven() const { return capabilities(structure).is_force_driven; }
  bool is_direct() const { return capabilities(structure).is_direct(); }

  /// A path from the folder of the job, unless that climbs through half of the disk.
  std::string relative(const std::string& path) const;
  /// Whether the job compares the model with the column, unless it drives it.
  bool is_measured(const GuessedColumn& column) const;
  /// Whether the noise of a position is below the steps of its encoder, while a velocity tells of
  /// the same motion. Steps are no noise: at rest they are an offset. A direct drive needs the
  /// position all the same, for what the velocity says little of: slow friction.
  bool is_rounded_away(const GuessedColumn& position, const RecordingGuess& recording) const;
};

/// The signal that a kind is measured as.
std::optional<Signal> signal_of(Kind kind);

}  // namespace axisfit
