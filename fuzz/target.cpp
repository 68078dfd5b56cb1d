// Where libFuzzer, or replay.cpp, hands an input to a target.
#include <cstdint>

#include "fuzz/check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const axisfit::fuzz::Folder folder;
  axisfit::fuzz::check_input(folder, {reinterpret_cast<const char*>(data), size});
  return 0;
}
