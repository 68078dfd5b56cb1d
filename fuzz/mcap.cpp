// MCAP files: what is read is a table that says of every column what it has, or why it cannot be
// used.
#include "fuzz/check.h"
#include "io/recording/mcap_file.h"

namespace axisfit::fuzz {

void check_input(const Folder& folder, std::string_view input) {
  const std::string path = folder.write("data.mcap", input);
  refusable([&] {
    const Table table = read_mcap(path);
    for (const Column& column : table.columns) {
      if (!column.obstacle.empty()) {
        require_message(sanitized(column.obstacle));
        continue;
      }
      const std::size_t rows =
          column.clock ? table.columns.at(*column.clock).values.size() : column.values.size();
      require(column.values.size() == rows, "a column is not as long as its clock", column.name);
    }
  });
}

}  // namespace axisfit::fuzz
