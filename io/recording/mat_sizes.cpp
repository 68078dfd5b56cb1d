#include "io/recording/mat_sizes.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <new>
#include <optional>
#include <string>
#include <string_view>

#include "base/plain_text.h"
#include "io/recording/csv.h"

namespace axisfit {
namespace {

/// What is stated does not fit what there is.
struct Oversized {};

std::uint64_t product(std::uint64_t a, std::uint64_t b) {
  std::uint64_t result = 0;
  return __builtin_mul_overflow(a, b, &result) ? std::numeric_limits<std::uint64_t>::max() : result;
}

/// Bytes in their order, of which only so many are left.
class Bytes {
 public:
  explicit Bytes(std::uint64_t size) : left_(size) {}
  virtual ~Bytes() = default;

  std::uint64_t left() const { return left_; }

  void read(void* to, std::uint64_t n) {
    if (n > left_) throw Oversized();
    left_ -= n;
    take(static_cast<char*>(to), n);
  }
  void skip(std::uint64_t n) {
    if (n > left_) throw Oversized();
    left_ -= n;
    leave(n);
  }

 private:
  virtual void take(char* to, std::uint64_t n) = 0;
  virtual void leave(std::uint64_t n) = 0;

  std::uint64_t left_;
};

class Stored : public Bytes {
 public:
  explicit Stored(std::string_view bytes) : Bytes(bytes.size()), bytes_(bytes) {}

 private:
  void take(char* to, std::uint64_t n) override {
    std::ranges::copy(bytes_.substr(0, n), to);
    bytes_.remove_prefix(n);
  }
  void leave(std::uint64_t n) override { bytes_.remove_prefix(n); }

  std::string_view bytes_;
};

/// What zlib has compressed. It makes no more than 1032 bytes of one.
class Inflated : public Bytes {
 public:
  explicit Inflated(std::string_view compressed) : Bytes(product(1032, compressed.size())) {
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(compressed.data()));
    stream_.avail_in = static_cast<uInt>(compressed.size());
    if (inflateInit(&stream_) != Z_OK) throw std::bad_alloc();
  }
  ~Inflated() override { inflateEnd(&stream_); }
  Inflated(const Inflated&) = delete;
  Inflated& operator=(const Inflated&) = delete;

 private:
  void take(char* to, std::uint64_t n) override {
    stream_.next_out = reinterpret_cast<Bytef*>(to);
    stream_.avail_out = static_cast<uInt>(n);
    while (stream_.avail_out > 0)
      if (const int result = inflate(&stream_, Z_SYNC_FLUSH);
          result != Z_OK && !(result == Z_STREAM_END && stream_.avail_out == 0))
        throw Oversized();
  }
  void leave(std::uint64_t n) override {
    std::array<char, 4096> ignored;
    for (std::uint64_t part; (part = std::min<std::uint64_t>(n, ignored.size())) > 0; n -= part)
      take(ignored.data(), part);
  }

  z_stream stream_{};
};

/// Walks through the elements of a file of version 5.
class Walk5 {
 public:
  explicit Walk5(bool swapped) : swapped_(swapped) {}

  /// A variable, of which the type and size have not been read yet.
  void variable(Bytes& bytes) {
    name_.clear();
    const Tag tag = read_tag(bytes);
    if (tag.type == kMatrix) matrix(bytes, tag.size, 0);
  }

  /// Of the variable that was walked through last, as far as known.
  const std::string& name() const { return name_; }

  std::uint32_t number(Bytes& bytes) const {
    std::uint32_t value = 0;
    bytes.read(&value, sizeof value);
    return swapped_ ? __builtin_bswap32(value) : value;
  }

  static constexpr std::uint32_t kMatrix = 14, kCompressed = 15;

 private:
  struct Tag {
    std::uint32_t type = 0, size = 0;
    bool small = false;  ///< the value, up to four bytes, is within the tag
  };

  Tag read_tag(Bytes& bytes) const {
    const std::uint32_t word = number(bytes);
    if (word >> 16 != 0) return {word & 0xFFFF, word >> 16, true};
    return {word, number(bytes), false};
  }

  /// The value of the next element, with its padding, before only `end` bytes are left. libmatio
  /// knows the type and where that is fixed the size, and does not look.
  std::string value(Bytes& bytes, std::uint64_t end, std::uint32_t type,
                    std::optional<std::uint32_t> size = {}) const {
    const Tag tag = read_tag(bytes);
    constexpr std::uint64_t kMost = 1 << 20;
    if (tag.type != type || tag.size != size.value_or(tag.size) ||
        tag.size > (tag.small ? 4 : std::min(kMost, room(bytes, end))))
      throw Oversized();
    std::string text(tag.size, '\0');
    bytes.read(text.data(), tag.size);
    bytes.skip(std::min(padding(tag), room(bytes, end)));
    return text;
  }

  static std::uint64_t room(const Bytes& bytes, std::uint64_t end) {
    return bytes.left() - std::min(end, bytes.left());
  }
  static std::uint64_t padding(const Tag& tag) {
    return tag.small ? 4 - tag.size : (8 - tag.size % 8) % 8;
  }

  Tag element(Bytes& bytes, std::uint64_t end) const {
    const Tag tag = read_tag(bytes);
    if (tag.size > (tag.small ? 4 : room(bytes, end))) throw Oversized();
    return tag;
  }
  void skip(Bytes& bytes, std::uint64_t end, const Tag& tag) const {
    bytes.skip(tag.size);
    bytes.skip(std::min(padding(tag), room(bytes, end)));
  }

  void nested(Bytes& bytes, const Tag& tag, int depth) const {
    constexpr int kMaxDepth = 100;
    if (tag.type != kMatrix || tag.small || depth == kMaxDepth) throw Oversized();
    Walk5(swapped_).matrix(bytes, tag.size, depth + 1);
  }

  /// An array of the size stated. libmatio goes by its class and dimensions, and reads on beyond
  /// its end where it lacks something.
  void matrix(Bytes& bytes, std::uint64_t size, int depth) {
    if (size == 0) return;  // an empty one within a cell or struct
    const bool cut = size > bytes.left();
    const std::uint64_t end = cut ? 0 : bytes.left() - size;
    enum : std::uint32_t { int8 = 1, int32 = 5, uint32 = 6 };
    const std::uint32_t flags = first_number(value(bytes, end, uint32, 8));
    const std::uint32_t kind = flags & 0xFF;
    const bool is_complex = (flags & 0x0800) != 0;
    enum : std::uint32_t { cell = 1, structure = 2, object = 3, sparse = 5, last_known = 15 };
    std::uint64_t arrays = 0, vectors = 0;  // what must come
    if (kind <= last_known) {
      const std::uint64_t values = count(value(bytes, end, int32));
      name_ = value(bytes, end, int8);
      if (kind == object) value(bytes, end, int8);  // its class
      if (kind == structure || kind == object) {
        const std::uint32_t length = first_number(value(bytes, end, int32, 4));
        const std::string fields = value(bytes, end, int8);
        arrays = length == 0 ? 0 : product(values, fields.size() / length);
      } else if (kind == cell) {
        arrays = values;
      } else if (kind == sparse) {
        vectors = is_complex ? 4 : 3;
      } else if (values > 0) {
        vectors = is_complex ? 2 : 1;
        if (values > room(bytes, end)) throw Oversized();
      }
    }
    if (cut || product(arrays, 8) > room(bytes, end)) throw Oversized();
    for (; arrays > 0; --arrays) nested(bytes, element(bytes, end), depth);
    for (; vectors > 0; --vectors) {
      const Tag tag = element(bytes, end);
      // Nothing comes after the last numbers of a variable, which may be many.
      if (depth == 0 && vectors == 1) return;
      skip(bytes, end, tag);
    }
    while (room(bytes, end) >= 8) {
      const Tag tag = element(bytes, end);
      if (tag.type == kMatrix && !tag.small)
        nested(bytes, tag, depth);
      else
        skip(bytes, end, tag);
    }
    bytes.skip(room(bytes, end));
  }

  std::uint32_t first_number(const std::string& value) const {
    Stored bytes(value);
    return number(bytes);
  }

  std::uint64_t count(const std::string& dimensions) const {
    std::uint64_t all = 1;
    for (Stored bytes(dimensions); bytes.left() > 0;) all = product(all, number(bytes));
    return all;
  }

  bool swapped_;
  std::string name_;
};

[[noreturn]] void throw_damaged(const std::string& path, const std::string& name, int index) {
  const std::string variable =
      name.empty() ? "variable " + std::to_string(index) : "variable " + in_quotes(name);
  throw RecordingError(path, 0,
                       variable +
                           ": the file is damaged or truncated: it is too short for this variable; "
                           "save or copy it again");
}

constexpr std::size_t kHeader5 = 128;

void check5(const std::string& path, std::string_view file, bool swapped) {
  Stored all(file.substr(kHeader5));
  Walk5 walk(swapped);
  for (int index = 1; all.left() >= 8; ++index) {
    const std::string_view remaining = file.substr(file.size() - all.left());
    try {
      const std::uint32_t type = walk.number(all), size = walk.number(all);
      if (type == Walk5::kCompressed) {
        Inflated inflated(remaining.substr(8, size));
        walk.variable(inflated);
      } else {
        Stored stored(remaining.substr(0, std::uint64_t{8} + size));
        walk.variable(stored);
      }
      all.skip(size);
    } catch (const Oversized&) {
      throw_damaged(path, walk.name(), index);
    }
  }
}

/// What stands before the values of a variable of version 4.
class Head4 {
 public:
  /// Throws Oversized where the name is not there.
  explicit Head4(Bytes& bytes) {
    bytes.read(words_.data(), sizeof words_);
    const bool swapped = words_[0] > kLargestType;
    if (swapped)
      for (std::uint32_t& word : words_) word = __builtin_bswap32(word);
    // The type itself says whether it is big-endian, and libmatio believes it.
    const bool big_endian = digit(1000) == 1;
    if (!is_valid() || big_endian != (swapped == (std::endian::native == std::endian::little)) ||
        words_[4] > bytes.left())
      throw Oversized();
    name_.resize(words_[4]);
    bytes.read(name_.data(), name_.size());
    if (!name_.ends_with('\0')) throw Oversized();
    name_.pop_back();
  }

  const std::string& name() const { return name_; }

  /// Bytes of the values.
  std::uint64_t size() const {
    return product(product(words_[1], words_[2]), kSizes[digit(10)] * (1 + words_[3]));
  }

 private:
  static constexpr std::uint32_t kLargestType = 9999;                      // four decimal digits
  static constexpr std::array<std::uint64_t, 6> kSizes{8, 4, 4, 2, 2, 1};  // of types of numbers

  std::uint32_t digit(std::uint32_t of) const { return words_[0] / of % 10; }
  bool is_valid() const {
    const bool sparse = digit(1) == 2;  // row, column, value and perhaps its imaginary part
    return words_[0] <= kLargestType && digit(1000) <= 1 && digit(100) == 0 &&
           digit(10) < kSizes.size() && digit(1) <= 2 && words_[3] <= 1 && words_[4] > 0 &&
           (!sparse || words_[2] == 3 || words_[2] == 4);
  }

  std::array<std::uint32_t, 5> words_{};  // type, rows, columns, whether complex, size of name
  std::string name_;
};

void check4(const std::string& path, std::string_view file) {
  Stored all(file);
  for (int index = 1; all.left() > 0; ++index) {
    std::string name;
    try {
      const Head4 head(all);
      name = head.name();
      all.skip(head.size());
    } catch (const Oversized&) {
      if (index == 1 && name.empty())
        throw RecordingError(path, 0,
                             "is not a MAT-file; save the recording with MATLAB's save or as CSV");
      throw_damaged(path, name, index);
    }
  }
}

}  // namespace

void check_mat_sizes(const std::string& path) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  std::string file(static_cast<std::size_t>(std::max<std::streamoff>(in.tellg(), 0)), '\0');
  in.seekg(0).read(file.data(), static_cast<std::streamsize>(file.size()));
  std::uint16_t version = 0, order = 0;
  if (file.size() >= kHeader5) {
    std::memcpy(&version, file.data() + 124, sizeof version);
    std::memcpy(&order, file.data() + 126, sizeof order);
  }
  constexpr std::uint16_t kSame = 'M' << 8 | 'I', kSwapped = 'I' << 8 | 'M';
  const bool swapped = order == kSwapped;
  if (swapped) version = static_cast<std::uint16_t>(version << 8 | version >> 8);
  const bool is_later = order == kSame || swapped;
  if (is_later && version == 0x0100)
    check5(path, file, swapped);
  else if (!is_later || version != 0x0200)  // else HDF5 looks after itself
    check4(path, file);
}

}  // namespace axisfit
