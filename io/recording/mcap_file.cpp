#include "io/recording/mcap_file.h"

#include <fmt/format.h>
#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/file_watch.h"
#include "base/plain_text.h"
#include "io/recording/ros_message.h"

namespace axisfit {
namespace {

using Bytes = std::span<const std::uint8_t>;
using Json = nlohmann::json;

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr std::size_t kMostInRecord = std::size_t{1} << 30;
constexpr std::size_t kMostColumns = 4096;
constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

enum class Opcode : std::uint8_t { schema = 3, channel = 4, message = 5, chunk = 6 };

/// The record is cut off, or says what cannot be.
struct Damaged : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Takes numbers and texts off the front of a record.
class Reader {
 public:
  explicit Reader(Bytes bytes) : bytes_(bytes) {}

  bool done() const { return bytes_.empty(); }

  /// Little-endian, unsigned.
  template <class T>
  T number() {
    const Bytes raw = take(sizeof(T));
    std::uint64_t value = 0;
    for (std::size_t i = sizeof(T); i-- > 0;) value = (value << 8U) | raw[i];
    return static_cast<T>(value);
  }
  Bytes bytes(std::size_t size) { return take(size); }
  Bytes sized() { return take(number<std::uint32_t>()); }
  std::string text() {
    const Bytes raw = sized();
    return {reinterpret_cast<const char*>(raw.data()), raw.size()};
  }

 private:
  Bytes take(std::uint64_t size) {
    if (size > bytes_.size()) throw Damaged("a record ends early");
    const Bytes taken = bytes_.first(size);
    bytes_ = bytes_.subspan(size);
    return taken;
  }

  Bytes bytes_;
};

struct ReleaseZstd {
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};
struct ReleaseLz4 {
  void operator()(LZ4F_dctx* context) const { LZ4F_freeDecompressionContext(context); }
};

/// Unpacks into memory that grows with what there is, up to the size that is promised.
template <class Step>
std::vector<std::uint8_t> unpacked(Bytes packed, std::size_t promised, Step&& step) {
  constexpr std::size_t kBlock = std::size_t{1} << 20;
  std::vector<std::uint8_t> result;
  std::size_t size = 0;
  for (bool more = true; more;) {
    result.resize(std::min(promised + 1, size + kBlock));
    if (size == result.size()) throw Damaged("a chunk is larger than it says");
    const auto [taken, made] = step(packed, std::span(result).subspan(size));
    packed = packed.subspan(taken);
    size += made;
    more = taken > 0 || made > 0;
  }
  if (size != promised) throw Damaged("a chunk is not as long as it says");
  result.resize(size);
  return result;
}

std::vector<std::uint8_t> unpacked(const std::string& compression, Bytes packed,
                                   std::size_t promised) {
  if (promised > kMostInRecord) throw Damaged("a chunk is larger than 1 GB");
  if (compression.empty()) return {packed.begin(), packed.end()};
  if (compression == "zstd") {
    const std::unique_ptr<ZSTD_DCtx, ReleaseZstd> context(ZSTD_createDCtx());
    return unpacked(packed, promised, [&](Bytes in, std::span<std::uint8_t> out) {
      ZSTD_inBuffer from{in.data(), in.size(), 0};
      ZSTD_outBuffer to{out.data(), out.size(), 0};
      if (ZSTD_isError(ZSTD_decompressStream(context.get(), &to, &from)) != 0)
        throw Damaged("a chunk cannot be unpacked");
      return std::pair(from.pos, to.pos);
    });
  }
  if (compression == "lz4") {
    LZ4F_dctx* made = nullptr;
    if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION)) != 0)
      throw std::bad_alloc();
    const std::unique_ptr<LZ4F_dctx, ReleaseLz4> context(made);
    return unpacked(packed, promised, [&](Bytes in, std::span<std::uint8_t> out) {
      std::size_t taken = in.size(), written = out.size();
      if (LZ4F_isError(LZ4F_decompress(context.get(), out.data(), &written, in.data(), &taken,
                                       nullptr)) != 0)
        throw Damaged("a chunk cannot be unpacked");
      return std::pair(taken, written);
    });
  }
  throw Damaged(fmt::format("its compression {} is unknown", in_quotes(compression)));
}

/// The messages of a topic that have one definition, as columns.
class Topic {
 public:
  Topic(std::string name, std::string encoding, const std::string& schema_name,
        const std::string& schema_encoding, std::string_view schema)
      : name_(std::move(name)), is_json_(encoding == "json") {
    if (is_json_) return;
    if (encoding != "cdr" || schema_encoding != "ros2msg") {
      obstacle_ =
          fmt::format("has messages in {}; convert the recording to ros2msg or JSON, or export CSV",
                      shortened(encoding == "cdr"  ? schema_encoding + " definitions"
                                : encoding.empty() ? "an unknown encoding"
                                                   : encoding));
      return;
    }
    try {
      definition_.emplace(schema_name, schema);
    } catch (const std::runtime_error& error) {
      obstacle_ = fmt::format("cannot be read: {}; export the topic as CSV", error.what());
    }
  }

  void add(std::uint64_t log_time, Bytes data) {
    if (!obstacle_.empty()) return;
    try {
      is_json_ ? add_json(data) : add_cdr(data);
    } catch (const Json::exception&) {
      give_up("a message is no JSON");
      return;
    } catch (const std::runtime_error& error) {
      give_up(error.what());
      return;
    }
    log_times_.push_back(log_time);
  }

  std::size_t columns() const { return columns_.size(); }
  const std::vector<std::uint64_t>& log_times() const { return log_times_; }

  /// Appends the clock and the columns; times since `begin`, in ns.
  void finish(std::uint64_t begin, Table& table) {
    if (!obstacle_.empty() || columns_.empty()) {
      if (obstacle_.empty()) obstacle_ = "has no numbers";
      table.columns.push_back({.name = name_, .values = {}, .obstacle = obstacle_});
      return;
    }
    const std::size_t clock = table.columns.size();
    const auto stamp = stamps();
    Column times{
        .name = name_ + (stamp ? ".header.stamp" : " log time"), .values = {}, .unit = "s"};
    for (std::size_t i = 0; i < log_times_.size(); ++i) {
      const auto since = static_cast<std::int64_t>((stamp ? (*stamp)[i] : log_times_[i]) - begin);
      times.values.push_back(static_cast<double>(since) * 1e-9);
    }
    table.columns.push_back(std::move(times));
    for (auto& [path, values] : columns_) {
      if (stamp && path.starts_with(kStamp)) continue;
      values.resize(log_times_.size(), kMissing);
      table.columns.push_back(
          {.name = name_ + "." + path, .values = std::move(values), .clock = clock});
    }
  }

 private:
  static constexpr std::string_view kStamp = "header.stamp.";

  void give_up(std::string_view why) {
    obstacle_ = fmt::format("cannot be read: {}; export the topic as CSV", why);
    columns_.clear();
    log_times_.clear();
  }

  std::size_t column(const std::string& path) {
    const auto [found, is_new] = numbers_.try_emplace(path, columns_.size());
    if (is_new) columns_.emplace_back(path, std::vector<double>());
    return found->second;
  }

  void set(std::size_t column, double value) {
    std::vector<double>& values = columns_[column].second;
    values.resize(log_times_.size(), kMissing);
    values.push_back(value);
  }

  /// Messages of one shape have their values in the same order, so that paths are made once.
  void add_cdr(Bytes data) {
    definition_->decode(data, numbers_now_, false);
    if (numbers_now_.shape != shape_ || numbers_now_.names != names_ || order_.empty()) {
      definition_->decode(data, numbers_now_, true);
      shape_ = numbers_now_.shape;
      names_ = numbers_now_.names;
      order_.clear();
      for (std::string& path : numbers_now_.paths) order_.push_back(column(named(path)));
    }
    for (std::size_t i = 0; i < order_.size(); ++i) set(order_[i], numbers_now_.values[i]);
  }

  /// "position.elbow" for "position[0]" where the message names its joints.
  std::string named(const std::string& path) const {
    const std::size_t open = path.rfind('[');
    if (names_.empty() || !path.ends_with(']') || path.find('.') != std::string::npos) return path;
    std::size_t index = 0;
    std::from_chars(path.data() + open + 1, path.data() + path.size(), index);
    if (index >= names_.size() || std::ranges::count(names_, names_[index]) > 1) return path;
    return path.substr(0, open + 1).replace(open, 1, ".") + names_[index];
  }

  void add_json(Bytes data) {
    // Deeper ones are no messages of numbers, and would exhaust the stack.
    constexpr int kDeepest = 32;
    const Json message =
        Json::parse(data.begin(), data.end(), [](int depth, Json::parse_event_t, Json&) {
          if (depth > kDeepest) throw std::runtime_error("a message is nested too deeply");
          return true;
        });
    add_json(message, "");
  }

  void add_json(const Json& value, const std::string& path) {
    if (value.is_number() || value.is_boolean()) {
      const double number =
          value.is_boolean() ? (value.get<bool>() ? 1.0 : 0.0) : value.get<double>();
      set(column(path.empty() ? "value" : path), number);
    } else if (value.is_object()) {
      for (const auto& [key, inner] : value.items())
        add_json(inner, path.empty() ? key : path + "." + key);
    } else if (value.is_array() && value.size() <= kMostNumbers) {
      for (std::size_t i = 0; i < value.size(); ++i)
        add_json(value[i], fmt::format("{}[{}]", path, i));
    }
  }

  /// When the messages were made, in ns, where they say that within a day of when they were logged.
  std::optional<std::vector<std::uint64_t>> stamps() const {
    const auto values = [&](const char* name) -> const std::vector<double>* {
      const auto found = numbers_.find(std::string(kStamp) + name);
      return found == numbers_.end() ? nullptr : &columns_[found->second].second;
    };
    const std::vector<double>* seconds = values("sec");
    const std::vector<double>* rest = values("nanosec");
    if (rest == nullptr) rest = values("nsec");
    if (seconds == nullptr || rest == nullptr || seconds->size() != log_times_.size() ||
        rest->size() != log_times_.size())
      return std::nullopt;
    std::vector<std::uint64_t> result;
    for (std::size_t i = 0; i < log_times_.size(); ++i) {
      const double logged = static_cast<double>(log_times_[i]) * 1e-9;
      constexpr double kDay = 86400.0;
      if (!(std::abs((*seconds)[i] - logged) < kDay) || !((*rest)[i] >= 0.0)) return std::nullopt;
      if (!((*seconds)[i] >= 0.0) || !((*rest)[i] < 4e9)) return std::nullopt;
      result.push_back(static_cast<std::uint64_t>((*seconds)[i]) * 1000000000U +
                       static_cast<std::uint64_t>((*rest)[i]));
    }
    return result;
  }

  std::string name_;
  bool is_json_;
  std::optional<MessageDefinition> definition_;
  std::string obstacle_;
  std::vector<std::uint64_t> log_times_;                              ///< ns, of each message
  std::vector<std::pair<std::string, std::vector<double>>> columns_;  ///< path and values
  std::unordered_map<std::string, std::size_t> numbers_;              ///< of the paths
  MessageNumbers numbers_now_;
  std::vector<std::size_t> shape_, order_;  ///< of the last message, and the columns of its values
  std::vector<std::string> names_;
};

class McapReader {
 public:
  explicit McapReader(const std::string& path) : path_(path) {}

  Table read() {
    check_readable(path_);
    const FileWatch watch(path_);
    std::ifstream in(path_, std::ios::binary);
    std::array<char, kMagic.size()> magic{};
    in.read(magic.data(), magic.size());
    if (std::string_view(magic.data(), magic.size()) != kMagic)
      throw RecordingError(path_, 0,
                           "is no MCAP file; convert the recording with 'mcap convert' or "
                           "'ros2 bag convert'");
    const std::uintmax_t size = std::filesystem::file_size(path_);
    try {
      read_records(in, size);
    } catch (const Damaged& error) {
      throw RecordingError(path_, 0,
                           fmt::format("is damaged before byte {}: {}; copy it again, or repair it "
                                       "with 'mcap recover'",
                                       at_, error.what()));
    }
    if (watch.has_changed()) throw RecordingError(path_, 0, FileWatch::kMessage);
    return finish();
  }

 private:
  struct Schema {
    std::string name, encoding, text;
  };

  void read_records(std::istream& in, std::uintmax_t size) {
    constexpr std::size_t kHead = 9;
    std::vector<std::uint8_t> record;
    for (at_ = kMagic.size(); at_ + kHead <= size;) {
      std::array<std::uint8_t, kHead> head{};
      in.read(reinterpret_cast<char*>(head.data()), kHead);
      Reader reader(head);
      const auto opcode = static_cast<Opcode>(reader.number<std::uint8_t>());
      const auto length = reader.number<std::uint64_t>();
      at_ += kHead;
      // The end of a file whose recorder was stopped.
      if (!in || length > size - at_) return;
      at_ += length;
      if (opcode < Opcode::schema || opcode > Opcode::chunk) {
        in.seekg(static_cast<std::streamoff>(length), std::ios::cur);
        continue;
      }
      if (length > kMostInRecord) throw Damaged("a record is larger than 1 GB");
      record.resize(length);
      in.read(reinterpret_cast<char*>(record.data()), static_cast<std::streamsize>(length));
      if (!in) return;
      opcode == Opcode::chunk ? read_chunk(record) : take(opcode, record);
    }
  }

  void read_chunk(Bytes record) {
    Reader reader(record);
    reader.bytes(16);  // begin and end
    const auto size = reader.number<std::uint64_t>();
    const auto crc = reader.number<std::uint32_t>();
    const std::string compression = reader.text();
    const auto packed_size = reader.number<std::uint64_t>();
    const std::vector<std::uint8_t> records =
        unpacked(compression, reader.bytes(packed_size), size);
    if (crc != 0 && crc != ::crc32_z(0, records.data(), records.size()))
      throw Damaged("the checksum of a chunk is wrong");
    for (Reader inner{Bytes(records)}; !inner.done();) {
      const auto opcode = static_cast<Opcode>(inner.number<std::uint8_t>());
      take(opcode, inner.bytes(inner.number<std::uint64_t>()));
    }
  }

  void take(Opcode opcode, Bytes record) {
    Reader reader(record);
    if (opcode == Opcode::schema) {
      const auto id = reader.number<std::uint16_t>();
      Schema schema{reader.text(), reader.text(), {}};
      const Bytes text = reader.sized();
      schema.text.assign(text.begin(), text.end());
      schemas_.insert_or_assign(id, std::move(schema));
    } else if (opcode == Opcode::channel) {
      add_channel(reader);
    } else if (opcode == Opcode::message) {
      const auto id = reader.number<std::uint16_t>();
      reader.number<std::uint32_t>();
      const auto log_time = reader.number<std::uint64_t>();
      reader.number<std::uint64_t>();
      const auto channel = channels_.find(id);
      if (channel == channels_.end()) throw Damaged("a message has no channel");
      Topic& topic = *topics_[channel->second];
      const std::size_t before = topic.columns();
      topic.add(log_time, reader.bytes(record.size() - 22));
      columns_ += topic.columns() - std::min(before, topic.columns());
      if (columns_ > kMostColumns)
        throw RecordingError(path_, 0,
                             "has more than 4096 numbers in its messages; leave topics out with "
                             "'mcap filter' or 'ros2 bag convert'");
    }
  }

  /// Channels of one topic and definition share columns: several publish to it.
  void add_channel(Reader& reader) {
    const auto id = reader.number<std::uint16_t>();
    const auto schema_id = reader.number<std::uint16_t>();
    const std::string topic = reader.text(), encoding = reader.text();
    if (channels_.contains(id)) return;  // it is repeated in every chunk
    const auto found = schemas_.find(schema_id);
    const Schema schema = found == schemas_.end() ? Schema() : found->second;
    const auto key = std::tuple(topic, encoding, schema.name, schema.text);
    const auto [at, is_new] = by_definition_.try_emplace(key, topics_.size());
    channels_[id] = at->second;
    if (!is_new) return;
    const int count = ++of_name_[topic];
    topics_.push_back(
        std::make_unique<Topic>(count == 1 ? topic : fmt::format("{}({})", topic, count), encoding,
                                schema.name, schema.encoding, schema.text));
  }

  Table finish() {
    std::optional<std::uint64_t> begin;
    for (const auto& topic : topics_)
      for (const std::uint64_t t : topic->log_times()) begin = std::min(begin.value_or(t), t);
    Table table{path_, {}};
    for (const auto& topic : topics_) topic->finish(begin.value_or(0), table);
    if (std::ranges::all_of(table.columns, [](const Column& c) { return !c.obstacle.empty(); }))
      throw RecordingError(path_, 0,
                           table.columns.empty()
                               ? "has no messages"
                               : fmt::format("has no numbers: the topic {} {}",
                                             in_quotes(shortened(table.columns.front().name)),
                                             table.columns.front().obstacle));
    return table;
  }

  const std::string& path_;
  std::uintmax_t at_ = 0;  ///< end of the record that is being read
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, std::size_t> channels_;  ///< to the topic
  std::map<std::tuple<std::string, std::string, std::string, std::string>, std::size_t>
      by_definition_;
  std::map<std::string, int> of_name_;
  std::vector<std::unique_ptr<Topic>> topics_;
  std::size_t columns_ = 0;
};

}  // namespace

Table read_mcap(const std::string& path) { return McapReader(path).read(); }

}  // namespace axisfit
