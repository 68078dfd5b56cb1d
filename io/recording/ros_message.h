// Messages of ROS 2, as their definitions in text describe them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace axisfit {

/// The numbers of a message, in its order.
struct MessageNumbers {
  std::vector<double> values;
  std::vector<std::size_t> shape;    ///< the lengths of its sequences; equal ones have equal fields
  std::vector<std::string> names;    ///< what a sequence of strings called "name" holds
  std::vector<std::string> paths{};  ///< "position[0]", of each value, where they are wanted
};

/// A message definition (ros2msg: that of the message, and behind lines of '=' those of the
/// messages it is made of) and the decoding of CDR by it.
class MessageDefinition {
 public:
  /// Throws std::runtime_error, which says what cannot be understood.
  MessageDefinition(const std::string& name, std::string_view text);
  ~MessageDefinition();
  MessageDefinition(MessageDefinition&&) noexcept;
  MessageDefinition& operator=(MessageDefinition&&) noexcept;

  /// Takes the numbers (true is 1) off a message in CDR, of either byte order. Texts are passed
  /// over, and so are sequences of more than 64 numbers, or more than 16 messages, as images and
  /// clouds are. Throws std::runtime_error where the bytes are not those of such a message.
  void decode(std::span<const std::uint8_t> bytes, MessageNumbers& numbers, bool with_paths) const;

 private:
  struct Type;
  struct Field;
  class Decoder;

  std::map<std::string, std::unique_ptr<Type>> types_;
  const Type* root_ = nullptr;
};

/// Numbers and messages of one sequence that become columns.
inline constexpr std::size_t kMostNumbers = 64, kMostMessages = 16;

}  // namespace axisfit
