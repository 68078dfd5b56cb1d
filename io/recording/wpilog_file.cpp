#include "io/recording/wpilog_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/file_watch.h"
#include "base/plain_text.h"

namespace axisfit {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::string_view kMagic = "WPILOG";
constexpr std::size_t kMostInArray = 64;
constexpr std::size_t kLongestControl = std::size_t{1} << 20;

enum class Control : std::uint8_t { start, finish, set_metadata };

/// A record says what cannot be.
struct Damaged : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Little-endian, unsigned.
std::uint64_t number_in(Bytes bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) value = (value << 8U) | bytes[i];
  return value;
}

/// Takes numbers and texts off the front of a control record.
class Reader {
 public:
  explicit Reader(Bytes bytes) : bytes_(bytes) {}

  std::uint64_t number(std::size_t bytes) { return number_in(take(bytes)); }
  std::string text() {
    const Bytes raw = take(number(4));
    return {reinterpret_cast<const char*>(raw.data()), raw.size()};
  }

 private:
  Bytes take(std::uint64_t size) {
    if (size > bytes_.size()) throw Damaged("a control record ends early");
    const Bytes taken = bytes_.first(size);
    bytes_ = bytes_.subspan(size);
    return taken;
  }

  Bytes bytes_;
};

/// How a type stores a number.
struct Format {
  std::string_view type;
  std::size_t bytes;
  double (*number)(Bytes);
};
constexpr std::array kFormats{
    Format{"boolean", 1, [](Bytes b) { return b[0] != 0 ? 1.0 : 0.0; }},
    Format{"int64", 8,
           [](Bytes b) { return static_cast<double>(static_cast<std::int64_t>(number_in(b))); }},
    Format{"float", 4,
           [](Bytes b) {
             const auto bits = static_cast<std::uint32_t>(number_in(b));
             return static_cast<double>(std::bit_cast<float>(bits));
           }},
    Format{"double", 8, [](Bytes b) { return std::bit_cast<double>(number_in(b)); }},
};

/// The records of one name and type.
class Entry {
 public:
  Entry(std::string name, std::string_view type) : name_(std::move(name)) {
    is_array_ = type.ends_with("[]");
    const std::string_view of = type.substr(0, type.size() - (is_array_ ? 2 : 0));
    const auto* const found = std::ranges::find(kFormats, of, &Format::type);
    if (found != kFormats.end())
      format_ = found;
    else
      obstacle_ = fmt::format(
          "has values of the type {}, which are no numbers; log its numbers by themselves",
          in_quotes(shortened(type)));
  }

  /// Whether its records are of use.
  bool is_wanted() const { return obstacle_.empty(); }

  /// No record of more bytes is.
  static constexpr std::size_t kMostBytes = 8 * kMostInArray;

  void add(std::uint64_t time, Bytes data) {
    const std::size_t count = data.size() / format_->bytes;
    if (count * format_->bytes != data.size() || (!is_array_ && count != 1))
      throw Damaged(
          fmt::format("a record of {} is not as long as its type", in_quotes(shortened(name_))));
    if (count == 0 || (width_ != 0 && count != width_)) return;
    width_ = count;
    times_.push_back(time);
    for (std::size_t i = 0; i < count; ++i)
      values_.push_back(format_->number(data.subspan(i * format_->bytes, format_->bytes)));
  }

  void add_too_long() {
    if (width_ == 0)
      obstacle_ = fmt::format(
          "has more than {} numbers in a record; log those of the axis by "
          "themselves",
          kMostInArray);
  }

  const std::vector<std::uint64_t>& times() const { return times_; }

  /// Appends its columns; times since `begin`, in us.
  void finish(std::uint64_t begin, Table& table) const {
    if (!obstacle_.empty() || times_.empty()) {
      table.columns.push_back(
          {.name = name_,
           .values = {},
           .obstacle = obstacle_.empty() ? std::string("has no values") : obstacle_});
      return;
    }
    Column times{.name = fmt::format("Time ({})", name_), .values = {}, .unit = "s"};
    for (const std::uint64_t t : times_)
      times.values.push_back(static_cast<double>(t - begin) * 1e-6);
    for (std::size_t i = 0; i < width_; ++i) {
      Column column{.name = is_array_ ? fmt::format("{}[{}]", name_, i) : name_, .values = {}};
      for (std::size_t k = i; k < values_.size(); k += width_) column.values.push_back(values_[k]);
      add_series(table, times, std::move(column));
    }
  }

 private:
  std::string name_;
  const Format* format_ = nullptr;
  bool is_array_ = false;
  std::string obstacle_;
  std::size_t width_ = 0;             ///< numbers in a record; 0: not known yet
  std::vector<std::uint64_t> times_;  ///< us
  std::vector<double> values_;        ///< record by record
};

class WpilogReader {
 public:
  explicit WpilogReader(const std::string& path) : path_(path) {}

  Table read() {
    check_readable(path_);
    const FileWatch watch(path_);
    in_.open(path_, std::ios::binary);
    left_ = std::filesystem::file_size(path_);
    try {
      read_header();
      while (read_record()) {
      }
    } catch (const Damaged& error) {
      throw RecordingError(
          path_, 0,
          fmt::format("is damaged before byte {}: {}; copy it again from the robot", at_,
                      error.what()));
    }
    if (watch.has_changed()) throw RecordingError(path_, 0, FileWatch::kMessage);
    return finish();
  }

 private:
  /// False where the file ends before.
  bool take(std::size_t size, std::vector<std::uint8_t>& bytes) {
    if (size > left_) return false;
    bytes.resize(size);
    in_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    left_ -= size;
    at_ += size;
    return static_cast<bool>(in_);
  }

  bool skip(std::uint64_t size) {
    if (size > left_) return false;
    // Most are so short that they are in memory already.
    constexpr std::uint64_t kShort = 4096;
    if (size < kShort)
      in_.ignore(static_cast<std::streamsize>(size));
    else
      in_.seekg(static_cast<std::streamoff>(size), std::ios::cur);
    left_ -= size;
    at_ += size;
    return static_cast<bool>(in_);
  }

  void read_header() {
    if (!take(12, bytes_) || !std::equal(kMagic.begin(), kMagic.end(), bytes_.begin()))
      throw RecordingError(path_, 0, "is no data log of WPILib; copy it again from the robot");
    const unsigned major = bytes_[7];
    if (major != 1)
      throw RecordingError(path_, 0,
                           fmt::format("is a data log of version {}, and only 1 is known; export "
                                       "it as CSV with AdvantageScope or the Data Log Tool",
                                       major));
    skip(number_in(Bytes(bytes_).subspan(8, 4)));
  }

  /// False at the end of the file, and where its last record is cut off.
  bool read_record() {
    if (!take(1, bytes_)) return false;
    const unsigned lengths = bytes_[0];
    if ((lengths & 0x80U) != 0) throw Damaged("a record begins with a bit that is always zero");
    const std::size_t id_bytes = 1 + (lengths & 3U), size_bytes = 1 + ((lengths >> 2U) & 3U),
                      time_bytes = 1 + ((lengths >> 4U) & 7U);
    if (!take(id_bytes + size_bytes + time_bytes, bytes_)) return false;
    const Bytes head(bytes_);
    const auto id = static_cast<std::uint32_t>(number_in(head.first(id_bytes)));
    const std::uint64_t size = number_in(head.subspan(id_bytes, size_bytes));
    const std::uint64_t time = number_in(head.last(time_bytes));
    if (size > left_) return false;
    return id == 0 ? read_control(size) : read_values(id, size, time);
  }

  bool read_control(std::uint64_t size) {
    if (size == 0) return true;  // of a log that was made longer than it was filled
    if (size > kLongestControl) throw Damaged("a control record is larger than 1 MB");
    if (!take(size, bytes_)) return false;
    Reader reader(bytes_);
    const auto type = static_cast<Control>(reader.number(1));
    const auto id = static_cast<std::uint32_t>(reader.number(4));
    if (type == Control::start) {
      const std::string name = reader.text(), entry_type = reader.text();
      started_[id] = entry_of(name, entry_type);
    } else if (type == Control::finish) {
      // Its number may be given to another entry; until then there should be no more of it.
      if (const auto found = started_.find(id); found != started_.end()) found->second.reset();
    } else if (type != Control::set_metadata) {
      throw Damaged("a control record is of an unknown type");
    }
    return true;
  }

  std::size_t entry_of(const std::string& name, const std::string& type) {
    const auto [at, is_new] = numbers_.try_emplace({name, type}, entries_.size());
    if (is_new) {
      const int count = ++of_name_[name];
      entries_.emplace_back(count == 1 ? name : fmt::format("{}({})", name, count), type);
    }
    return at->second;
  }

  bool read_values(std::uint32_t id, std::uint64_t size, std::uint64_t time) {
    const auto started = started_.find(id);
    if (started == started_.end()) throw Damaged("a record is of no entry");
    if (!started->second || !entries_[*started->second].is_wanted()) return skip(size);
    Entry& entry = entries_[*started->second];
    if (size > Entry::kMostBytes) {
      entry.add_too_long();
      return skip(size);
    }
    if (!take(size, bytes_)) return false;
    entry.add(time, bytes_);
    return true;
  }

  Table finish() const {
    std::uint64_t begin = std::numeric_limits<std::uint64_t>::max();
    for (const Entry& entry : entries_)
      for (const std::uint64_t t : entry.times()) begin = std::min(begin, t);
    Table table{path_, {}};
    for (const Entry& entry : entries_) entry.finish(begin, table);
    if (std::ranges::all_of(table.columns, [](const Column& c) { return !c.obstacle.empty(); }))
      throw RecordingError(path_, 0,
                           table.columns.empty()
                               ? "has no records; log the signals of the axis"
                               : fmt::format("has no numbers: {} {}",
                                             in_quotes(shortened(table.columns.front().name)),
                                             table.columns.front().obstacle));
    return table;
  }

  const std::string& path_;
  std::ifstream in_;
  std::uintmax_t left_ = 0, at_ = 0;  ///< bytes of the file
  std::vector<std::uint8_t> bytes_;   ///< taken last
  std::vector<Entry> entries_;
  std::map<std::pair<std::string, std::string>, std::size_t> numbers_;  ///< by name and type
  std::map<std::string, int> of_name_;
  std::unordered_map<std::uint32_t, std::optional<std::size_t>> started_;  ///< none: finished
};

}  // namespace

bool is_wpilog(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::array<char, kMagic.size()> magic{};
  in.read(magic.data(), magic.size());
  return in && std::string_view(magic.data(), magic.size()) == kMagic;
}

Table read_wpilog(const std::string& path) { return WpilogReader(path).read(); }

}  // namespace axisfit
