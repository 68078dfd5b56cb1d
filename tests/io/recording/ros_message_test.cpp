#include "io/recording/ros_message.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace axisfit {
namespace {

std::string refusal(const std::string& definition) {
  try {
    MessageDefinition("a/msg/B", definition);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "none";
}

TEST(MessageDefinition, SaysWhatItCannotRead) {
  EXPECT_EQ(refusal("float64"), "its definition has 'float64', which is no field");
  EXPECT_EQ(refusal("C c"), "its definition lacks that of 'C'");
  EXPECT_EQ(refusal("wstring w"), "it has wide text (wstring)");
  EXPECT_EQ(refusal("C c\n====\nMSG: a/C\nB b\n"), "its definition holds itself");
  EXPECT_EQ(refusal("# nothing\n"), "none");
}

TEST(MessageDefinition, ReadsBothByteOrders) {
  const MessageDefinition definition("a/msg/B", "uint8 a\nint32 b\n");
  MessageNumbers numbers;
  const std::vector<std::uint8_t> big{0, 0, 0, 0, 7, 0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFE};
  definition.decode(big, numbers, true);
  EXPECT_EQ(numbers.values, (std::vector<double>{7, -2}));
  EXPECT_EQ(numbers.paths, (std::vector<std::string>{"a", "b"}));
  const std::vector<std::uint8_t> little{0, 1, 0, 0, 7, 0, 0, 0, 0xFE, 0xFF, 0xFF, 0xFF};
  definition.decode(little, numbers, false);
  EXPECT_EQ(numbers.values, (std::vector<double>{7, -2}));
  for (std::size_t size = 0; size < little.size(); ++size)
    EXPECT_THROW(definition.decode(std::span(little).first(size), numbers, false),
                 std::runtime_error);
}

TEST(MessageDefinition, ASequenceCannotPromiseMoreThanThereIs) {
  const MessageDefinition definition("a/msg/B", "C[] c\n====\nMSG: a/C\nD[] d\n====\nMSG: a/D\n");
  MessageNumbers numbers;
  const std::vector<std::uint8_t> hostile{0, 1, 0, 0, 0xFF, 0xFF, 0xFF, 0x7F};
  EXPECT_THROW(definition.decode(hostile, numbers, false), std::runtime_error);
}

}  // namespace
}  // namespace axisfit
