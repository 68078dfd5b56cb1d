#include "io/recording/text_lines.h"

#include <iconv.h>
#include <zlib.h>

#include <array>
#include <cerrno>
#include <filesystem>

#include "base/plain_text.h"
#include "io/recording/table.h"

namespace axisfit {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 20;
constexpr std::size_t kLongestLine = std::size_t{16} << 20;

/// What files that are no text begin with, and how to make one of them that is.
struct KnownFormat {
  std::string_view beginning, what, remedy;
};
constexpr std::array kKnownFormats{
    KnownFormat{"MDF     ", "is a measurement file (MDF4)",
                "convert it to CSV or MATLAB with asammdf ('asammdf', File, Export) or the tool "
                "that recorded it"},
    KnownFormat{"UnFinMF ", "is an unfinished measurement file (MDF4)",
                "finish and convert it to CSV with asammdf or the tool that recorded it"},
    KnownFormat{"TDSm", "is a TDMS file of LabVIEW",
                "convert it to CSV with npTDMS ('tdmsinfo', TdmsFile.as_dataframe().to_csv()) or "
                "with DIAdem"},
    KnownFormat{"\x89HDF\r\n", "is an HDF5 file",
                "name it .mat if MATLAB wrote it, or export its columns as CSV"},
    KnownFormat{"MATLAB 5.0", "is a MATLAB file", "let its name end in .mat"},
    KnownFormat{"\x89MCAP0\r\n", "is an MCAP file", "let its name end in .mcap"},
    KnownFormat{"#ROSBAG", "is a bag of ROS 1",
                "convert it with 'mcap convert' or rosbags-convert to MCAP"},
    KnownFormat{"SQLite format 3", "is an SQLite file, as older bags of ROS 2 are",
                "convert it with 'ros2 bag convert' to MCAP"},
    KnownFormat{"PK\x03\x04", "is a zip archive or a workbook",
                "let its name end in .xlsx if it is a workbook, or unpack it"},
    KnownFormat{"\xD0\xCF\x11\xE0", "is an old workbook of Excel (.xls)",
                "save it as .xlsx or CSV"},
    KnownFormat{"PAR1", "is a Parquet file", "export it as CSV"},
    KnownFormat{"BZh", "is compressed with bzip2", "unpack it"},
    KnownFormat{"\xFD"
                "7zXZ",
                "is compressed with xz", "unpack it"},
    KnownFormat{"\x28\xB5\x2F\xFD", "is compressed with zstd", "unpack it"},
    KnownFormat{"7z\xBC\xAF", "is a 7z archive", "unpack it"},
};

void refuse_known_formats(const std::string& path, std::string_view text) {
  for (const KnownFormat& format : kKnownFormats)
    if (text.starts_with(format.beginning))
      throw RecordingError(path, 0, std::string(format.what) + "; " + std::string(format.remedy));
}

/// A conversion from one encoding to another, a piece at a time.
class Conversion {
 public:
  Conversion(const char* to, const char* from) : handle_(::iconv_open(to, from)) {}
  ~Conversion() {
    if (is_open()) ::iconv_close(handle_);
  }
  Conversion(const Conversion&) = delete;
  Conversion& operator=(const Conversion&) = delete;

  // NOLINTNEXTLINE(performance-no-int-to-ptr): iconv says so
  bool is_open() const { return handle_ != reinterpret_cast<iconv_t>(-1); }

  /// Converts what is complete of `text`; the rest stays in it. What is in no encoding becomes a
  /// question mark.
  std::string take(std::string& text) {
    std::string converted;
    char* in = text.data();
    std::size_t left = text.size();
    std::array<char, 65536> piece;
    while (left > 0) {
      char* out = piece.data();
      std::size_t room = piece.size();
      const std::size_t done = ::iconv(handle_, &in, &left, &out, &room);
      converted.append(piece.data(), piece.size() - room);
      if (done != static_cast<std::size_t>(-1)) break;
      if (errno == EINVAL) break;
      if (errno == E2BIG) continue;
      converted += '?';
      const std::size_t skipped = std::min<std::size_t>(left, unit_);
      in += skipped;
      left -= skipped;
    }
    text.erase(0, text.size() - left);
    return converted;
  }

  /// Bytes of the smallest piece of the source encoding.
  void set_unit(std::size_t bytes) { unit_ = bytes; }

 private:
  iconv_t handle_;
  std::size_t unit_ = 1;
};

}  // namespace

/// Bytes of the file, unpacked and in UTF-8.
class TextLines::Source {
 public:
  explicit Source(const std::string& path) : path_(path), file_(::gzopen(path.c_str(), "rb")) {
    if (file_ == nullptr) throw RecordingError(path, 0, "cannot be opened; check the permissions");
    ::gzbuffer(file_, 1 << 18);
  }
  ~Source() { ::gzclose(file_); }
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;

  /// Appends a block; nothing at the end of the file.
  void append_to(std::string& text) {
    const bool first = !begun_;
    begun_ = true;
    std::string block = read();
    if (first) {
      refuse_known_formats(path_, block);
      const bool little = block.starts_with("\xFF\xFE"), big = block.starts_with("\xFE\xFF");
      if (little || big) {
        block.erase(0, 2);
        utf16_ = std::make_unique<Conversion>("UTF-8", little ? "UTF-16LE" : "UTF-16BE");
        utf16_->set_unit(2);
      } else if (block.starts_with("\xEF\xBB\xBF")) {
        block.erase(0, 3);
      }
    }
    if (utf16_) {
      rest_ += block;
      block = utf16_->take(rest_);
    }
    if (block.find('\0') != std::string::npos)
      throw RecordingError(path_, 0,
                           "is not a text file (it holds null bytes); export the recording as CSV");
    text += block;
  }

 private:
  std::string read() {
    std::string block(kBlock, '\0');
    const int got = ::gzread(file_, block.data(), static_cast<unsigned>(block.size()));
    int error = Z_OK;
    ::gzerror(file_, &error);
    if (error == Z_MEM_ERROR) throw std::bad_alloc();
    if (got < 0 || error == Z_BUF_ERROR)
      throw RecordingError(path_, 0,
                           error == Z_ERRNO ? "could not be read completely; check the disk"
                                            : "is damaged: it cannot be unpacked; copy it again");
    block.resize(static_cast<std::size_t>(got));
    return block;
  }

  std::string path_;
  gzFile file_;
  bool begun_ = false;
  std::unique_ptr<Conversion> utf16_;
  std::string rest_;  ///< what the conversion could not take yet
};

TextLines::TextLines(const std::string& path) : path_(path), watch_(path) {
  check_readable(path);
  source_ = std::make_unique<Source>(path);
  read_more();
}

TextLines::~TextLines() = default;

void TextLines::read_more() {
  buffer_.erase(0, begin_);
  begin_ = 0;
  const std::size_t before = buffer_.size();
  source_->append_to(buffer_);
  at_end_ = buffer_.size() == before;
  if (at_end_ && watch_.has_changed()) throw RecordingError(path_, 0, FileWatch::kMessage);
}

bool TextLines::next(std::string_view& line) {
  std::size_t searched = begin_;
  std::size_t end = std::string::npos;
  for (;;) {
    end = buffer_.find('\n', searched);
    if (end != std::string::npos || at_end_) break;
    const std::size_t waiting = buffer_.size() - begin_;
    if (waiting > kLongestLine)
      throw RecordingError(path_, number_ + 1,
                           "the line is longer than 16 MB: is this a recording in text?");
    read_more();
    searched = begin_ + waiting;
  }
  if (end == std::string::npos && begin_ == buffer_.size()) return false;
  const std::size_t stop = std::min(end, buffer_.size());
  line = std::string_view(buffer_).substr(begin_, stop - begin_);
  taken_ += std::min(stop + 1, buffer_.size()) - begin_;
  begin_ = std::min(stop + 1, buffer_.size());
  if (line.ends_with('\r')) line.remove_suffix(1);
  ++number_;
  if (number_ == 1 && line.find('\r') != std::string_view::npos)
    throw RecordingError(path_, 1,
                         "lines end in a carriage return alone; save the file with line feeds");
  return true;
}

std::string TextLines::rest() {
  constexpr std::size_t kPacked = 100;  // times as long as the file
  const std::size_t most = kPacked * std::filesystem::file_size(path_) + kLongestLine;
  while (!at_end_) {
    if (buffer_.size() > most)
      throw RecordingError(path_, 0,
                           "unpacks to more than a hundred times its size; unpack it, and look "
                           "whether it is a recording");
    read_more();
  }
  std::string text = buffer_.substr(begin_);
  begin_ = buffer_.size();
  return text;
}

std::string in_utf8(std::string_view text) {
  if (find_invalid_utf8(text) == std::string_view::npos) return std::string(text);
  Conversion windows("UTF-8", "CP1252");
  std::string bytes(text);
  return windows.is_open() ? windows.take(bytes) : sanitized(text);
}

}  // namespace axisfit
