#include "io/recording/table.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include "base/plain_text.h"

namespace axisfit {
namespace {

std::string place(const std::string& file, std::size_t line) {
  return line == 0 ? file : file + ":" + std::to_string(line);
}

}  // namespace

RecordingError::RecordingError(const std::string& file, std::size_t line,
                               const std::string& message)
    : std::runtime_error(sanitized(place(file, line) + ": " + message)) {}

void check_readable(const std::string& path) {
  std::error_code ignored;  // what stands in the way of looking stands in the way of opening, too
  if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored)) {
    const bool folder = std::filesystem::is_directory(path, ignored);
    throw RecordingError(path, 0,
                         std::string(folder ? "is a directory" : "is not a file") +
                             "; give the path of a recording");
  }
  errno = 0;
  if (!std::ifstream(path, std::ios::binary)) {
    throw RecordingError(path, 0,
                         "cannot be opened (" + std::generic_category().message(errno) +
                             "); check the path and the permissions");
  }
}

std::size_t Table::rows() const {
  std::size_t rows = 0;
  for (const Column& column : columns) rows = std::max(rows, column.values.size());
  return rows;
}

const Column* Table::find(std::string_view name) const {
  const auto found = std::find_if(columns.begin(), columns.end(),
                                  [name](const Column& column) { return column.name == name; });
  return found == columns.end() ? nullptr : &*found;
}

std::string Table::where(std::size_t row) const {
  return row < lines.size() ? place(file, lines[row]) : file + ": row " + std::to_string(row + 1);
}

void add_series(Table& table, Column times, Column values) {
  if (!table.columns.empty()) values.clock = table.columns.back().clock;
  if (!values.clock || table.columns[*values.clock].values != times.values) {
    values.clock = table.columns.size();
    table.columns.push_back(std::move(times));
  }
  table.columns.push_back(std::move(values));
}

}  // namespace axisfit
