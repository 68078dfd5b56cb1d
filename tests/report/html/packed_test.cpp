#include "report/html/packed.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstddef>
#include <string>
#include <string_view>

namespace axisfit {
namespace {

/// The bytes that a text in base64 stands for.
std::string bytes_of(std::string_view text) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned held = 0, bits = 0;
  for (const char c : text.substr(0, text.find('='))) {
    const std::size_t digit = kDigits.find(c);
    EXPECT_NE(digit, std::string_view::npos) << c;
    held = held << 6 | static_cast<unsigned>(digit);
    bits += 6;
    if (bits >= 8) bytes += static_cast<char>(held >> (bits -= 8) & 0xFFu);
  }
  return bytes;
}

std::string unpacked(const std::string& text, std::size_t size) {
  const std::string bytes = bytes_of(text);
  std::string result(size + 1, '\0');
  uLongf length = static_cast<uLongf>(result.size());
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(result.data()), &length,
                       reinterpret_cast<const Bytef*>(bytes.data()), uLong(bytes.size())),
            Z_OK);
  result.resize(length);
  return result;
}

TEST(Packed, ComesBackByteForByte) {
  std::string bytes;
  for (int i = 0; i < 300; ++i) {
    const std::string text = packed(bytes);
    EXPECT_EQ(text.size() % 4, 0u) << i;
    EXPECT_EQ(unpacked(text, bytes.size()), bytes) << i;
    bytes += static_cast<char>(i * 73 % 256);
  }
}

// A header, an empty block and the checksum of nothing, which is one (RFC 1950).
TEST(Packed, OfNothingIsAnEmptyStream) { EXPECT_EQ(packed(""), "eNoDAAAAAAE="); }

TEST(Packed, TakesLittleRoomForWhatRepeats) {
  EXPECT_LT(packed(std::string(100000, 'x')).size(), 300u);
}

}  // namespace
}  // namespace axisfit
