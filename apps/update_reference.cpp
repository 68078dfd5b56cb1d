// update-reference: writes anew what is made of the descriptions of keys, see reference.h. To be
// run after they have changed: scripts/update-reference

#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "io/config/reference.h"

int main(int argc, char** argv) {
  namespace fs = std::filesystem;
  if (argc != 2) {
    fmt::print(stderr, "usage: update-reference FOLDER_OF_THE_PROJECT\n");
    return 2;
  }
  try {
    for (const auto& [name, contents] : axisfit::reference_files(argv[1])) {
      const fs::path path = fs::path(argv[1]) / name;
      fs::create_directories(path.parent_path());
      std::ofstream out(path, std::ios::binary);
      out << contents;
      out.close();
      if (!out) throw std::runtime_error(fmt::format("cannot write {}", path.string()));
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "update-reference: {}\n", error.what());
    return 2;
  }
  return 0;
}
