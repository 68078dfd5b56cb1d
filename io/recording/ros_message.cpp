#include "io/recording/ros_message.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <utility>

#include "base/plain_text.h"

namespace axisfit {
namespace {

enum class Kind {
  boolean,
  int8,
  uint8,
  int16,
  uint16,
  int32,
  uint32,
  int64,
  uint64,
  float32,
  float64,
  text,
  message,
};

std::optional<Kind> primitive(std::string_view type) {
  static const std::map<std::string_view, Kind> kKinds{
      {"bool", Kind::boolean},    {"byte", Kind::uint8},    {"char", Kind::uint8},
      {"int8", Kind::int8},       {"uint8", Kind::uint8},   {"int16", Kind::int16},
      {"uint16", Kind::uint16},   {"int32", Kind::int32},   {"uint32", Kind::uint32},
      {"int64", Kind::int64},     {"uint64", Kind::uint64}, {"float32", Kind::float32},
      {"float64", Kind::float64}, {"string", Kind::text}};
  const auto found = kKinds.find(type);
  return found == kKinds.end() ? std::nullopt : std::optional(found->second);
}

std::size_t size_of(Kind kind) {
  switch (kind) {
    case Kind::boolean:
    case Kind::int8:
    case Kind::uint8:
      return 1;
    case Kind::int16:
    case Kind::uint16:
      return 2;
    case Kind::int64:
    case Kind::uint64:
    case Kind::float64:
      return 8;
    default:
      return 4;
  }
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r") + 1 - begin);
}

/// "sensor_msgs/JointState", whether written with "/msg/" or not.
std::string without_msg(std::string name) {
  if (const std::size_t at = name.find("/msg/"); at != std::string::npos) name.erase(at, 4);
  return name;
}

[[noreturn]] void refuse(const std::string& what) { throw std::runtime_error(what); }

}  // namespace

struct MessageDefinition::Field {
  std::string name;
  Kind kind = Kind::message;
  std::string type_name;       ///< of a message
  const Type* type = nullptr;  ///< of a message
  bool is_array = false;
  std::size_t length = 0;  ///< of an array; 0: its length stands before it
};

struct MessageDefinition::Type {
  std::vector<Field> fields;
  bool checked = false;  ///< that it does not hold itself
};

/// Reads one message.
class MessageDefinition::Decoder {
 public:
  Decoder(std::span<const std::uint8_t> bytes, MessageNumbers& numbers, bool with_paths)
      : bytes_(bytes), numbers_(numbers), with_paths_(with_paths) {
    if (bytes.size() < 4 || bytes[0] != 0 || bytes[1] > 1)
      refuse("its messages are not in plain CDR");
    swapped_ = (bytes[1] == 1) != (std::endian::native == std::endian::little);
    bytes_ = bytes.subspan(4);
  }

  void read(const Type& type) {
    // A structure without members has one in CDR.
    if (type.fields.empty()) number(Kind::uint8);
    for (const Field& field : type.fields) {
      const std::size_t length = path_.size();
      if (with_paths_) path_ += (path_.empty() ? "" : ".") + field.name;
      field.is_array ? read_array(field) : read_one(field);
      path_.resize(length);
    }
  }

 private:
  void read_one(const Field& field) {
    if (field.kind == Kind::text) {
      text();
    } else if (field.kind == Kind::message) {
      read(*field.type);
    } else {
      const double value = number(field.kind);
      if (!silent_) add(value);
    }
  }

  void read_array(const Field& field) {
    const std::size_t length =
        field.length > 0 ? field.length : static_cast<std::size_t>(number(Kind::uint32));
    const bool is_number = field.kind != Kind::message && field.kind != Kind::text;
    // Every element takes a byte at least, so that the length cannot promise more than there is.
    if (length > bytes_.size() - at_) refuse("a sequence is longer than its message");
    if (field.length == 0 && !silent_) numbers_.shape.push_back(length);
    const bool is_long = length > (is_number ? kMostNumbers : kMostMessages);
    if (is_number && is_long) {
      align(size_of(field.kind));
      take(length * size_of(field.kind));
      return;
    }
    if (field.kind == Kind::text) {
      const bool named = field.name == "name" && !silent_;
      for (std::size_t i = 0; i < length; ++i) {
        std::string_view name = text();
        if (named) numbers_.names.emplace_back(name);
      }
      return;
    }
    const bool was_silent = std::exchange(silent_, silent_ || is_long);
    for (std::size_t i = 0; i < length; ++i) {
      const std::size_t size = path_.size();
      if (with_paths_) path_ += fmt::format("[{}]", i);
      read_one(field);
      path_.resize(size);
    }
    silent_ = was_silent;
  }

  void add(double value) {
    numbers_.values.push_back(value);
    if (with_paths_) numbers_.paths.push_back(path_);
  }

  void align(std::size_t size) { at_ = std::min((at_ + size - 1) / size * size, bytes_.size()); }

  const std::uint8_t* take(std::size_t size) {
    if (size > bytes_.size() - at_) refuse("a message ends early");
    const std::uint8_t* const begin = bytes_.data() + at_;
    at_ += size;
    return begin;
  }

  template <class T>
  double value() {
    align(sizeof(T));
    std::array<std::uint8_t, sizeof(T)> raw;
    std::memcpy(raw.data(), take(sizeof(T)), sizeof(T));
    if (swapped_) std::ranges::reverse(raw);
    return static_cast<double>(std::bit_cast<T>(raw));
  }

  double number(Kind kind) {
    switch (kind) {
      case Kind::boolean:
        return *take(1) != 0 ? 1.0 : 0.0;
      case Kind::int8:
        return value<std::int8_t>();
      case Kind::uint8:
        return value<std::uint8_t>();
      case Kind::int16:
        return value<std::int16_t>();
      case Kind::uint16:
        return value<std::uint16_t>();
      case Kind::int32:
        return value<std::int32_t>();
      case Kind::uint32:
        return value<std::uint32_t>();
      case Kind::int64:
        return value<std::int64_t>();
      case Kind::uint64:
        return value<std::uint64_t>();
      case Kind::float32:
        return value<float>();
      default:
        return value<double>();
    }
  }

  std::string_view text() {
    const auto size = static_cast<std::size_t>(number(Kind::uint32));
    const auto* const begin = reinterpret_cast<const char*>(take(size));
    return {begin, size > 0 ? size - 1 : 0};  // without the zero at its end
  }

  std::span<const std::uint8_t> bytes_;
  MessageNumbers& numbers_;
  bool with_paths_;
  bool swapped_ = false, silent_ = false;
  std::size_t at_ = 0;
  std::string path_;
};

MessageDefinition::MessageDefinition(const std::string& name, std::string_view text) {
  const auto is_line_of = [](std::string_view line, char c) {
    return line.size() > 3 && line.find_first_not_of(c) == std::string_view::npos;
  };
  const std::string root = without_msg(name);
  // Some recorders leave these out.
  types_["builtin_interfaces/Time"] = std::make_unique<Type>(
      Type{{{"sec", Kind::int32, {}, nullptr}, {"nanosec", Kind::uint32, {}, nullptr}}, true});
  types_["builtin_interfaces/Duration"] =
      std::make_unique<Type>(*types_.at("builtin_interfaces/Time"));
  std::string current = root;
  types_[current] = std::make_unique<Type>();
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    line = trimmed(line.substr(0, line.find('#')));
    if (line.empty() || is_line_of(line, '=')) continue;
    if (line.starts_with("MSG:")) {
      current = without_msg(std::string(trimmed(line.substr(4))));
      types_[current] = std::make_unique<Type>();
      continue;
    }
    const std::size_t gap = line.find_first_of(" \t");
    if (gap == std::string_view::npos)
      refuse(fmt::format("its definition has {}, which is no field", in_quotes(line)));
    std::string_view type = line.substr(0, gap);
    const std::string_view rest = trimmed(line.substr(gap));
    const std::size_t name_end = std::min(rest.find_first_of(" \t="), rest.size());
    if (trimmed(rest.substr(name_end)).starts_with('=')) continue;  // a constant
    Field field;
    field.name = rest.substr(0, name_end);
    if (type.ends_with(']')) {
      const std::size_t open = type.rfind('[');
      if (open == std::string_view::npos)
        refuse(fmt::format("its definition has {}, which is no type", in_quotes(type)));
      field.is_array = true;
      const std::string_view length = type.substr(open + 1, type.size() - open - 2);
      std::from_chars(length.data(), length.data() + length.size(), field.length);
      type = type.substr(0, open);
    }
    type = type.substr(0, type.find("<="));
    if (type == "wstring") refuse("it has wide text (wstring)");
    if (const auto kind = primitive(type)) {
      field.kind = *kind;
    } else {
      field.type_name = type;
    }
    types_.at(current)->fields.push_back(std::move(field));
  }
  // Messages that it is made of, by name; those of its own package need not name that.
  for (auto& [own, type] : types_)
    for (Field& field : type->fields) {
      if (field.kind != Kind::message) continue;
      const std::string wanted = without_msg(field.type_name);
      const std::string package = own.substr(0, own.find('/'));
      auto found = types_.find(wanted);
      if (found == types_.end()) found = types_.find(package + "/" + wanted);
      if (found == types_.end() && wanted == "Header") found = types_.find("std_msgs/Header");
      if (found == types_.end())
        refuse(fmt::format("its definition lacks that of {}", in_quotes(wanted)));
      field.type = found->second.get();
    }
  root_ = types_.at(root).get();
  // One that holds itself would never end.
  std::vector<const Type*> above;
  const auto check = [&](const auto& self, Type& type) -> void {
    if (type.checked) return;
    if (std::ranges::find(above, &type) != above.end()) refuse("its definition holds itself");
    above.push_back(&type);
    for (const Field& field : type.fields)
      if (field.type != nullptr) self(self, const_cast<Type&>(*field.type));
    above.pop_back();
    type.checked = true;
  };
  check(check, *types_.at(root));
}

MessageDefinition::~MessageDefinition() = default;
MessageDefinition::MessageDefinition(MessageDefinition&&) noexcept = default;
MessageDefinition& MessageDefinition::operator=(MessageDefinition&&) noexcept = default;

void MessageDefinition::decode(std::span<const std::uint8_t> bytes, MessageNumbers& numbers,
                               bool with_paths) const {
  numbers.values.clear();
  numbers.shape.clear();
  numbers.names.clear();
  numbers.paths.clear();
  Decoder(bytes, numbers, with_paths).read(*root_);
}

}  // namespace axisfit
