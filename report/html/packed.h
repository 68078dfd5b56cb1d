// Bytes as a page holds them, for its script to inflate.
#pragma once

#include <string>

namespace axisfit {

/// Compressed (zlib) and in base64.
std::string packed(const std::string& bytes);

}  // namespace axisfit
