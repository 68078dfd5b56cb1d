// MATLAB files: what is read has values, and a table can be chosen of it.
#include <cmath>
#include <cstdint>

#include "apps/mat_file.h"
#include "fuzz/check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace axisfit;
  using namespace axisfit::fuzz;
  static const Folder folder;
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  if (is_hdf5(input)) return 0;
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
  return 0;
}
