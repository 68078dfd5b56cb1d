#include "exports/scratch_file.h"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>

namespace axisfit {

namespace fs = std::filesystem;

ScratchFile::ScratchFile() {
  std::string pattern = (fs::temp_directory_path() / "axisfit-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr)
    throw std::runtime_error("no folder for temporary files can be made in " +
                             fs::temp_directory_path().string());
  folder_ = pattern;
}

ScratchFile::~ScratchFile() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

void ScratchFile::write(std::string_view contents) const {
  std::ofstream out(path(), std::ios::binary);
  out << contents;
  if (!out.flush()) throw std::runtime_error(path() + " cannot be written");
}

std::string ScratchFile::read() const {
  std::ifstream in(path(), std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace axisfit
