// What the user says of the columns of recordings.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "init/columns/units.h"

namespace axisfit {

/// What the user says of a column.
struct ColumnAnswer {
  Kind kind = Kind::command;
  bool is_setpoint = false;
  bool is_duty = false;
  std::string column{};  ///< its name, or its number from 1
  std::string unit{};    ///< of stored_unit(); empty: not said
  double factor = 1.0;   ///< beside it
};

/// What the user says of recordings.
struct Answers {
  std::vector<ColumnAnswer> columns{};
  std::optional<double> rate{};  ///< Hz, of samples without a column of times
  std::string motor{};           ///< which of several axes is meant; empty: not said
};

/// Reads "position=Geber [Ink]:um/8", "current=3:A*0.5" or "position=3": signal, column and
/// perhaps unit, factor or divisor. Throws std::runtime_error, which says what is wrong.
ColumnAnswer read_answer(const std::string& text);

/// Reads "1 kHz", in Hz. Throws std::runtime_error likewise.
double read_rate(const std::string& text);

/// What --column calls the signals.
std::vector<std::string_view> answerable_signals();

}  // namespace axisfit
