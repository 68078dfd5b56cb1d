// Work that may end its process.
#pragma once

#include <functional>
#include <optional>
#include <string>

namespace axisfit {

/// What `work` returns, done in a process of its own; nothing if that process dies. Other threads
/// do not exist there: the work must need nothing that they might hold. Throws std::system_error
/// where there can be no other process.
std::optional<std::string> run_in_subprocess(const std::function<std::string()>& work);

}  // namespace axisfit
