// Recordings of others, which tests read where they are: the project may not pass them on.
#pragma once

#include <gtest/gtest.h>

#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <string>

namespace axisfit {

/// The folder that AXISFIT_<NAME> names, or else the one beside a checkout.
inline std::filesystem::path foreign_recordings(const std::string& name) {
  std::string variable = "AXISFIT_" + name;
  for (char& c : variable) c = static_cast<char>(std::toupper(c));
  const char* given = std::getenv(variable.c_str());
  if (given != nullptr && *given != '\0') return given;
  return (std::filesystem::path(AXISFIT_CONFIGS) / "../../shared/data" / name).lexically_normal();
}

}  // namespace axisfit

/// Skips the test, and says so, unless `folder`, that of these recordings, has the file.
#define AXISFIT_SKIP_WITHOUT(folder, file)                                                   \
  if (!std::filesystem::exists((folder) / (file)))                                           \
  GTEST_SKIP() << "There is no " << (file) << " in " << (folder)                             \
               << ". To run this test, name its folder in the environment variable AXISFIT_" \
                  "EMPS, AXISFIT_BAM or AXISFIT_LAAS."
