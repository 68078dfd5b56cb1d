// What the user says of the columns of recordings.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "init/columns/units.h"

namespace axisfit {

/// One answer: of a column, or of all of a recording.
struct ColumnAnswer {
  Kind kind = Kind::command;
  bool is_setpoint = false;
  bool is_duty = false;
  std::string column{};  ///< its name, or its number from 1; empty: it is not of a column
  std::string unit{};    ///< of stored_unit(); empty: not said
  double factor = 1.0;   ///< beside it
  double rate = 0.0;     ///< Hz, at which all of the recording was sampled; zero: not said
  std::string motor{};   ///< which of several axes is meant; empty: not said

  bool is_of_column() const { return !column.empty(); }
};

/// Reads "position=Geber [Ink]:um/8", "current=3:A*0.5" or "position=3": signal, column and
/// perhaps unit, factor or divisor. Throws std::runtime_error, which says what is wrong.
ColumnAnswer read_answer(const std::string& text);

/// Reads "1 kHz": samples without a column of times. Throws std::runtime_error likewise.
ColumnAnswer read_rate(const std::string& text);

/// "0": which of the axes of a recording is meant.
ColumnAnswer motor_answer(const std::string& name);

/// Hz; none where no answer says it.
std::optional<double> rate_in(const std::vector<ColumnAnswer>& answers);

/// Empty where no answer says it.
std::string motor_in(const std::vector<ColumnAnswer>& answers);

/// What --column calls the signals.
std::vector<std::string_view> answerable_signals();

}  // namespace axisfit
