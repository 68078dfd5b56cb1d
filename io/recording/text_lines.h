// The lines of a text file, whatever its encoding, plain or compressed.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "base/file_watch.h"

namespace axisfit {

/// Takes the lines off a file, one after the other, in memory for one block. Reads gzip as it is,
/// and UTF-16 with a byte-order mark; a byte-order mark is left out. Lines end in LF or CR LF.
class TextLines {
 public:
  /// Throws RecordingError where there is no file, and where it is one of a known format that is no
  /// text.
  explicit TextLines(const std::string& path);
  ~TextLines();
  TextLines(const TextLines&) = delete;
  TextLines& operator=(const TextLines&) = delete;

  /// The next line without its end, valid until the next call; false at the end of the file. Throws
  /// RecordingError where it is no text, is damaged or longer than 16 MB, or where the file
  /// changed.
  bool next(std::string_view& line);

  /// What has been read beyond the line returned last; at first up to 1 MB from the beginning, by
  /// which kinds of files are told apart. Valid until the next call.
  std::string_view ahead() const { return std::string_view(buffer_).substr(begin_); }

  /// All that follows the line returned last, at once. Throws RecordingError as next() does, and
  /// where a small file unpacks to so much that it can be no recording.
  std::string rest();

  /// Of the line returned last, from 1.
  std::size_t number() const { return number_; }

  /// Bytes of text from the beginning of the file to the end of the line returned last.
  std::size_t bytes() const { return taken_; }

 private:
  class Source;

  void read_more();

  std::string path_;
  FileWatch watch_;
  std::unique_ptr<Source> source_;
  std::string buffer_;
  std::size_t begin_ = 0;  ///< of what was not taken yet, in the buffer
  bool at_end_ = false;    ///< of the file
  std::size_t number_ = 0, taken_ = 0;
};

/// A text in UTF-8: as it is if it is UTF-8, or else taken for that of a Western Windows (CP1252).
std::string in_utf8(std::string_view text);

}  // namespace axisfit
