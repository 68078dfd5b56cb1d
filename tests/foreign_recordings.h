// Recordings of others, which tests read where they are: the project may not pass them on.
#pragma once

#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <initializer_list>
#include <string>

namespace axisfit {

struct ForeignRecordings {
  std::filesystem::path folder;
  std::string missing;  ///< what a test that is skipped says; empty: all files are there
};

/// Those in the folder that AXISFIT_<NAME> names, or else in the one beside a checkout.
inline ForeignRecordings foreign_recordings(const std::string& name,
                                            std::initializer_list<const char*> files) {
  namespace fs = std::filesystem;
  std::string variable = "AXISFIT_" + name;
  for (char& c : variable) c = static_cast<char>(std::toupper(c));
  const char* given = std::getenv(variable.c_str());
  ForeignRecordings found{
      given != nullptr && *given != '\0'
          ? fs::path(given)
          : (fs::path(AXISFIT_CONFIGS) / "../../shared/data" / name).lexically_normal(),
      {}};
  for (const char* file : files)
    if (!fs::exists(found.folder / file))
      found.missing = "There is no " + std::string(file) + " in " + found.folder.string() +
                      ". To run this test, name its folder in the environment variable " +
                      variable + ".";
  return found;
}

}  // namespace axisfit
