// Recordings in text: what is read is a table that says of every column what it has, or why it
// cannot be used.
#include "io/recording/csv.h"

#include <cmath>

#include "fuzz/check.h"

namespace axisfit::fuzz {
namespace {

void check_table(const Table& table) {
  require(table.rows() > 0, "a table without values was read");
  require(table.lines.size() == table.rows(), "not every row has a line");
  for (const Column& column : table.columns) {
    require(column.values.size() == table.rows(), "columns differ in length", column.name);
    require(!column.clock || *column.clock < table.columns.size(), "a clock is no column");
    for (const double x : column.values) require(!std::isinf(x), "a number is not finite");
    if (!column.obstacle.empty()) require_message(sanitized(column.obstacle));
  }
}

}  // namespace

void check_input(const Folder& folder, std::string_view input) {
  const std::string path = folder.write("data.csv", input);
  std::optional<Table> table;
  refusable([&] { table = read_csv(path); });
  if (!table) return;
  check_table(*table);
}

}  // namespace axisfit::fuzz
