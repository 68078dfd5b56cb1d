// MATLAB files: what is read has values, and a table can be chosen of it.
#include <cmath>

#include "fuzz/check.h"
#include "io/recording/mat_file.h"

namespace axisfit::fuzz {

void check_input(const Folder& folder, std::string_view input) {
  if (is_hdf5(input)) return;
  const std::string path = folder.write("data.mat", input);
  refusable([&] {
    const MatFile mat = read_mat(path);
    for (const Column& column : mat.columns) {
      require(!column.name.empty(), "a column without a name was read");
      require(column.values.size() > 1, "a column without values was read", column.name);
      refusable([&] {
        const Table table = select(mat, std::vector{column.name});
        for (const double x : table.columns.front().values)
          require(std::isfinite(x), "a number is not finite");
      });
    }
    select(mat, std::vector<std::string>{"none"});
  });
}

}  // namespace axisfit::fuzz
