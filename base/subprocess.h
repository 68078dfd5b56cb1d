// Work that may crash its process.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

namespace axisfit {

/// What `work` returns, run in a separate process; nothing if that process dies. It may take
/// `memory` bytes more than this process has; beyond that, allocating fails. Other threads do not
/// exist there: the work must not need locks that they might own. Throws std::system_error where
/// there can be no other process.
std::optional<std::string> run_in_subprocess(const std::function<std::string()>& work,
                                             std::size_t memory);

}  // namespace axisfit
