// What is known of the columns of a file before their values are compared.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "init/columns/answers.h"
#include "init/columns/names.h"
#include "init/overflow.h"
#include "io/recording/recording_file.h"

namespace axisfit {

struct Heading {
  std::string reference;  ///< what a job calls it
  std::string shown;      ///< what messages call it: with its number where a job needs that
  std::optional<ColumnGuess> guess;      ///< what the user says of it, or else its name
  const ColumnAnswer* answer = nullptr;  ///< among those given
  bool is_usable = false;                ///< it has finite values enough, and nothing infinite
  Overflow overflow{};
};

/// Rank of what the user says.
inline constexpr int kAnswered = 1000;

/// Of each column. `answers` must outlive them. Throws RecordingError where a column of an answer
/// cannot be used; `path` is for messages.
std::vector<Heading> headings_of(const RecordingFile& file, const std::string& path,
                                 const std::vector<ColumnAnswer>& answers);

/// The name of a column, with its unit as if the name held it.
std::string heading_text(const Column& column);

/// "time_s, pos_mm, column 3 (not a number in line 4)"
std::string described(const RecordingFile& file, const std::vector<Heading>& headings);

}  // namespace axisfit
