// Results are written whole or not at all.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace axisfit {

/// Puts files (name, contents) into a folder, which is created if need be. All of them are first
/// written next to it; if that fails nothing in the folder has changed, the remains are removed,
/// and std::runtime_error says why. Files of the same names are replaced, others stay.
void write_folder(const std::string& folder,
                  const std::vector<std::pair<std::string, std::string>>& files);

/// Throws as write_folder would if these files cannot be put into the folder. Leaves nothing
/// behind. For programs that work for long before they have anything to write.
void check_folder(const std::string& folder, const std::vector<std::string>& names);

/// As write_folder, for a single file.
void write_file(const std::string& path, const std::string& contents);

}  // namespace axisfit
