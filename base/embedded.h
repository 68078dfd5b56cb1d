// Files that are part of a program: those of axisfit_embed() in CMakeLists.txt.
#pragma once

#include <string_view>

// Declares std::string_view axisfit::embedded_NAME(), the contents.
#define AXISFIT_EMBEDDED(name)                                                                 \
  extern "C" const char axisfit_##name[], axisfit_##name##_end[];                              \
  namespace axisfit {                                                                          \
  inline std::string_view embedded_##name() { return {axisfit_##name, axisfit_##name##_end}; } \
  }
