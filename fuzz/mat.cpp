// MATLAB files: what is read has values, or a reason why not.
#include "fuzz/check.h"
#include "io/recording/mat_file.h"

namespace axisfit::fuzz {

void check_input(const Folder& folder, std::string_view input) {
  if (is_hdf5(input)) return;
  const std::string path = folder.write("data.mat", input);
  refusable([&] {
    for (const Column& column : read_mat(path).columns) {
      require(!column.name.empty() || !column.obstacle.empty(), "a column without a name was read");
      require(column.values.size() > 1 || !column.obstacle.empty(),
              "a column without values was read", column.name);
    }
  });
}

}  // namespace axisfit::fuzz
