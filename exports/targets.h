// What makes the files of each target; see export.h.
#pragma once

#include <string>

#include "exports/export.h"

namespace axisfit {

Export mjcf(const Rig& rig, const std::string& name, const std::string& origin);
Export urdf(const Rig& rig, const std::string& name, const std::string& origin);
Export matlab(const Rig& rig, const std::string& of_file, const std::string& origin);
Export frc(const Rig& rig, const std::string& name, const std::string& origin);
Export c_code(const Rig& rig, const std::string& of_file, const std::string& origin);

enum class FmiVersion { v2, v3 };
Export fmu(const Rig& rig, FmiVersion version, const std::string& name, const std::string& origin);

/// Said of all targets but those for data.
inline constexpr const char* kUncertaintyIsLost =
    "The standard errors, correlations and scatter of its parameters are left out.";

/// The axis as targets have it that move it step by step, with no files yet.
Export stepped(const Rig& rig);

/// What a programming language takes for a name.
std::string identifier(std::string name);

}  // namespace axisfit
