// CSV files: what is read is a table of finite numbers that can be written and read again.
#include <cmath>
#include <sstream>

#include "fuzz/check.h"

namespace axisfit::fuzz {
namespace {

void check_table(const Table& table) {
  require(!table.columns.empty() && table.rows() > 0, "a table without values was read");
  require(table.lines.size() == table.rows(), "not every row has a line");
  for (const Column& column : table.columns) {
    require(!column.name.empty(), "a column without a name was read");
    require(table.find(column.name) == &column, "two columns have one name", column.name);
    require(column.values.size() == table.rows(), "columns differ in length", column.name);
    for (const double x : column.values) require(std::isfinite(x), "a number is not finite");
  }
}

void check_written(const Folder& folder, const Table& table) {
  std::ostringstream text;
  write_csv(text, table.columns);
  const Table again = read_csv(folder.write("again.csv", text.str()));
  require(again.columns.size() == table.columns.size(), "written columns are not read again");
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    require(again.columns[c].name == table.columns[c].name, "a name is not read again");
    require(again.columns[c].values == table.columns[c].values, "a number is not read again");
  }
}

}  // namespace

void check_input(const Folder& folder, std::string_view input) {
  const std::string path = folder.write("data.csv", input);
  std::optional<Table> table;
  refusable([&] { table = read_csv(path); });
  if (!table) return;
  check_table(*table);
  check_written(folder, *table);
}

}  // namespace axisfit::fuzz
