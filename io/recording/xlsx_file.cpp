#include "io/recording/xlsx_file.h"

#include <fmt/format.h>
#include <minizip/unzip.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <optional>
#include <pugixml.hpp>
#include <string_view>

#include "base/plain_text.h"
#include "io/recording/table_builder.h"
#include "io/recording/text_layout.h"

namespace axisfit {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 16;
constexpr std::size_t kLongestElement = std::size_t{16} << 20;
constexpr std::size_t kMostSharedText = std::size_t{256} << 20;
constexpr std::size_t kMostColumns = 16384, kMostRows = 1048576;  // Excel's own

/// The name of an element or attribute without the prefix of its namespace.
std::string_view local(std::string_view name) {
  const std::size_t colon = name.rfind(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

pugi::xml_node child(const pugi::xml_node& node, std::string_view name) {
  for (const pugi::xml_node& c : node.children())
    if (local(c.name()) == name) return c;
  return {};
}

std::string_view attribute(const pugi::xml_node& node, std::string_view name) {
  for (const pugi::xml_attribute& a : node.attributes())
    if (local(a.name()) == name) return a.value();
  return {};
}

std::size_t number_of(std::string_view text, std::size_t otherwise) {
  std::size_t number = 0;
  const char* const end = text.data() + text.size();
  return !text.empty() && std::from_chars(text.data(), end, number).ptr == end ? number : otherwise;
}

/// A string item: its text, or those of its runs; not the phonetic ones.
std::string text_of(const pugi::xml_node& item) {
  std::string text;
  for (const pugi::xml_node& part : item.children()) {
    if (local(part.name()) == "t") text += part.text().get();
    if (local(part.name()) == "r") text += child(part, "t").text().get();
  }
  return text;
}

/// Column from 0 of a reference such as "AB12".
std::optional<std::size_t> column_of(std::string_view reference) {
  std::size_t column = 0, letters = 0;
  for (; letters < reference.size() && reference[letters] >= 'A' && reference[letters] <= 'Z';
       ++letters)
    if (letters < 4) column = 26 * column + static_cast<std::size_t>(reference[letters] - 'A' + 1);
  if (letters == 0 || letters > 3) return std::nullopt;
  return column - 1;
}

enum class Format { number, date, duration };

/// Whether a format code shows a date or a time. Quoted texts, escaped characters and what stands
/// in brackets, but for elapsed times, do not count.
Format format_of(std::string_view code) {
  bool date = false, time = false, elapsed = false;
  for (std::size_t i = 0; i < code.size(); ++i) {
    const char c = code[i];
    if (c == ';') break;  // what follows shows negative numbers
    if (c == '"') {
      i = std::min(code.find('"', i + 1), code.size());
    } else if (c == '\\' || c == '_' || c == '*') {
      ++i;
    } else if (c == '[') {
      const std::size_t end = std::min(code.find(']', i), code.size());
      const std::string_view inside = code.substr(i + 1, end - i - 1);
      elapsed = elapsed || inside.find_first_not_of("hHmMsS") == std::string_view::npos;
      i = end;
    } else {
      date = date || std::string_view("yYdD").find(c) != std::string_view::npos;
      time = time || std::string_view("hHsS").find(c) != std::string_view::npos;
    }
  }
  return elapsed ? Format::duration : date || time ? Format::date : Format::number;
}

Format built_in_format(std::size_t id) {
  if (id == 46) return Format::duration;
  return (id >= 14 && id <= 22) || id == 45 || id == 47 ? Format::date : Format::number;
}

/// The part of an archive that is being read.
class Part {
 public:
  Part(unzFile zip, const std::string& file, const std::string& name) : zip_(zip), file_(file) {
    open_ = ::unzLocateFile(zip, name.c_str(), 2) == UNZ_OK && ::unzOpenCurrentFile(zip) == UNZ_OK;
  }
  ~Part() {
    if (open_) ::unzCloseCurrentFile(zip_);
  }
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;

  bool is_open() const { return open_; }

  /// Appends a block; false at the end.
  bool append_to(std::string& text) {
    std::array<char, kBlock> block;
    const int got = ::unzReadCurrentFile(zip_, block.data(), static_cast<unsigned>(block.size()));
    if (got < 0)
      throw RecordingError(file_, 0, "is damaged: it cannot be unpacked; save or copy it again");
    text.append(block.data(), static_cast<std::size_t>(got));
    return got > 0;
  }

  std::string whole() {
    std::string text;
    while (append_to(text))
      if (text.size() > kLongestElement)
        throw RecordingError(file_, 0, "has a part that is impossibly large; save it again");
    return text;
  }

 private:
  unzFile zip_;
  const std::string& file_;
  bool open_ = false;
};

/// Takes the elements of one name off a part, one after the other.
class Elements {
 public:
  Elements(Part& part, const std::string& file, std::string name)
      : part_(part), file_(file), name_(std::move(name)) {}

  /// The next one, parsed; false at the end of the part.
  bool next(pugi::xml_document& document) {
    buffer_.erase(0, behind_);
    behind_ = 0;
    std::size_t begin = 0, end = 0;
    for (std::size_t from = 0;;) {
      begin = find_tag("<", from);
      if (begin != std::string::npos && find_end(begin, end)) break;
      if (begin == std::string::npos) {
        // A tag may be cut off at the end of the block.
        const std::size_t kept = std::min(buffer_.size(), std::size_t{64});
        buffer_.erase(0, buffer_.size() - kept);
      }
      from = 0;
      if (buffer_.size() > kLongestElement)
        throw RecordingError(file_, 0, "has a row or text that is impossibly large; save it again");
      if (!part_.append_to(buffer_)) {
        if (begin == std::string::npos) return false;
        throw RecordingError(file_, 0, "is damaged: a part ends early; save or copy it again");
      }
    }
    behind_ = end;
    constexpr unsigned kKeepBlanks = pugi::parse_ws_pcdata_single;
    if (!document.load_buffer(buffer_.data() + begin, end - begin,
                              pugi::parse_default | kKeepBlanks))
      throw RecordingError(file_, 0, "is damaged: its XML is not valid; save it again");
    return true;
  }

 private:
  /// Where a tag of the name begins; `open` is "<" or "</".
  std::size_t find_tag(std::string_view open, std::size_t from) const {
    for (std::size_t at = buffer_.find(name_, from); at != std::string::npos;
         at = buffer_.find(name_, at + 1)) {
      const std::size_t behind = at + name_.size();
      if (behind >= buffer_.size()) return std::string::npos;
      if (std::string_view(" \t\r\n/>").find(buffer_[behind]) == std::string_view::npos) continue;
      const std::size_t start = buffer_.rfind('<', at);
      if (start == std::string::npos || start < from) continue;
      const std::string_view before = std::string_view(buffer_).substr(start, at - start);
      const std::string_view prefix = before.substr(std::min(open.size(), before.size()));
      const bool is_prefix =
          prefix.empty() ||
          (prefix.back() == ':' && prefix.find_first_of(" /=\"'<>") == std::string_view::npos);
      if (before.starts_with(open) && is_prefix) return start;
    }
    return std::string::npos;
  }

  /// Where the element that begins there ends.
  bool find_end(std::size_t begin, std::size_t& end) const {
    const std::size_t close = buffer_.find('>', begin);
    if (close == std::string::npos) return false;
    if (buffer_[close - 1] == '/') {
      end = close + 1;
      return true;
    }
    const std::size_t last = find_tag("</", close);
    if (last == std::string::npos) return false;
    const std::size_t behind = buffer_.find('>', last);
    if (behind == std::string::npos) return false;
    end = behind + 1;
    return true;
  }

  Part& part_;
  const std::string& file_;
  std::string name_;
  std::string buffer_;
  std::size_t behind_ = 0;  ///< what was taken
};

std::string without_trailing_zeros(std::string text) {
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text;
}

}  // namespace

class XlsxRows::Workbook {
 public:
  explicit Workbook(const std::string& path) : path_(path) {
    check_readable(path);
    refuse_other_formats();
    zip_.reset(::unzOpen64(path.c_str()));
    if (!zip_) throw RecordingError(path, 0, "is no workbook (.xlsx); save it as one, or as CSV");
    find_sheets();
    read_shared_strings();
    read_styles();
    for (const auto& [name, part] : sheets_) {
      open_sheet(name, part);
      std::vector<std::string> fields;
      if (!next(fields)) continue;
      first_ = std::move(fields);
      return;
    }
    throw RecordingError(path, 0, "has no worksheet with data");
  }

  bool next(std::vector<std::string>& fields) {
    if (first_) {
      fields = std::move(*first_);
      first_.reset();
      return true;
    }
    pugi::xml_document document;
    if (!rows_->next(document)) return false;
    const pugi::xml_node row = document.first_child();
    number_ = number_of(attribute(row, "r"), number_ + 1);
    if (number_ > kMostRows)
      throw RecordingError(path_, 0,
                           fmt::format("has a row {}, beyond the last of Excel", number_));
    fields.clear();
    std::size_t column = 0;
    for (const pugi::xml_node& cell : row.children()) {
      if (local(cell.name()) != "c") continue;
      column = column_of(attribute(cell, "r")).value_or(column);
      if (column >= kMostColumns)
        throw RecordingError(path_, number_, "has more columns than Excel");
      fields.resize(std::max(fields.size(), column + 1));
      fields[column] = value_of(cell);
      ++column;
    }
    return true;
  }

  std::size_t number() const { return number_; }
  const std::string& sheet() const { return sheet_; }

 private:
  struct Close {
    void operator()(void* zip) const { ::unzClose(zip); }
  };

  void refuse_other_formats() const {
    std::array<char, 4> head{};
    std::ifstream(path_, std::ios::binary).read(head.data(), head.size());
    const std::string_view begin(head.data(), head.size());
    if (begin == "\xD0\xCF\x11\xE0")
      throw RecordingError(path_, 0,
                           "is an old workbook (.xls), or one with a password; save it as .xlsx "
                           "without a password, or as CSV");
    if (!begin.starts_with("PK"))
      throw RecordingError(path_, 0, "is no workbook (.xlsx); save it as one, or as CSV");
  }

  std::optional<std::string> part(const std::string& name) const {
    Part part(zip_.get(), path_, name);
    if (!part.is_open()) return std::nullopt;
    return part.whole();
  }

  pugi::xml_document parsed(const std::string& text) const {
    pugi::xml_document document;
    if (!document.load_buffer(text.data(), text.size()))
      throw RecordingError(path_, 0, "is damaged: its XML is not valid; save it again");
    return document;
  }

  void find_sheets() {
    const auto book = part("xl/workbook.xml"), relations = part("xl/_rels/workbook.xml.rels");
    if (!book || !relations)
      throw RecordingError(path_, 0, "is a zip archive, but no workbook; unpack it");
    std::map<std::string, std::string, std::less<>> targets;
    const pugi::xml_document related = parsed(*relations);
    for (const pugi::xml_node& r : related.document_element().children()) {
      std::string target(attribute(r, "Target"));
      targets[std::string(attribute(r, "Id"))] =
          target.starts_with('/') ? target.substr(1) : "xl/" + target;
    }
    const pugi::xml_document document = parsed(*book);
    const pugi::xml_node root = document.document_element();
    const std::string_view since_1904 = attribute(child(root, "workbookPr"), "date1904");
    first_day_ = since_1904 == "1" || since_1904 == "true" ? 24107 : 25569;
    for (const pugi::xml_node& sheet : child(root, "sheets").children()) {
      const auto target = targets.find(attribute(sheet, "id"));
      if (target != targets.end())
        sheets_.emplace_back(std::string(attribute(sheet, "name")), target->second);
    }
  }

  void read_shared_strings() {
    Part part(zip_.get(), path_, "xl/sharedStrings.xml");
    if (!part.is_open()) return;
    Elements items(part, path_, "si");
    std::size_t bytes = 0;
    for (pugi::xml_document document; items.next(document);) {
      strings_.push_back(text_of(document.first_child()));
      bytes += strings_.back().size() + sizeof(std::string);
      if (bytes > kMostSharedText)
        throw RecordingError(path_, 0, "has more than 256 MB of text; export it as CSV");
    }
  }

  void read_styles() {
    const auto text = part("xl/styles.xml");
    if (!text) return;
    const pugi::xml_document document = parsed(*text);
    const pugi::xml_node root = document.document_element();
    std::map<std::size_t, Format> own;
    for (const pugi::xml_node& format : child(root, "numFmts").children())
      own[number_of(attribute(format, "numFmtId"), 0)] = format_of(attribute(format, "formatCode"));
    for (const pugi::xml_node& style : child(root, "cellXfs").children()) {
      const std::size_t id = number_of(attribute(style, "numFmtId"), 0);
      const auto found = own.find(id);
      formats_.push_back(found == own.end() ? built_in_format(id) : found->second);
    }
  }

  void open_sheet(const std::string& name, const std::string& part) {
    sheet_ = name;
    number_ = 0;
    rows_.reset();
    sheet_part_.reset();
    sheet_part_ = std::make_unique<Part>(zip_.get(), path_, part);
    if (!sheet_part_->is_open())
      throw RecordingError(
          path_, 0,
          fmt::format("has no part for its sheet {}; save it again", in_quotes(shortened(name))));
    rows_ = std::make_unique<Elements>(*sheet_part_, path_, "row");
  }

  std::string value_of(const pugi::xml_node& cell) const {
    const std::string_view type = attribute(cell, "t");
    if (type == "inlineStr") return text_of(child(cell, "is"));
    std::string text = child(cell, "v").text().get();
    if (type == "s") {
      const std::size_t index = number_of(text, strings_.size());
      return index < strings_.size() ? strings_[index] : std::string();
    }
    if (!type.empty() && type != "n") return text;
    const std::size_t style = number_of(attribute(cell, "s"), 0);
    const Format format = style < formats_.size() ? formats_[style] : Format::number;
    double days = 0.0;
    const char* const end = text.data() + text.size();
    if (format == Format::number || std::from_chars(text.data(), end, days).ptr != end) return text;
    return clock_text(days, format);
  }

  /// Days since the epoch of the workbook, as a date; those of less than one are a time.
  std::string clock_text(double days, Format format) const {
    constexpr double kDay = 86400.0, kMost = 2958466.0;  // the year 10000
    if (format == Format::duration || days < 1.0 || !(days < kMost))
      return without_trailing_zeros(fmt::format("{:.6f}", days * kDay));
    // A double of some 46000 days is no finer than a microsecond.
    const auto microseconds = 10 * static_cast<std::int64_t>(std::llround(days * kDay * 1e5));
    constexpr std::int64_t kDayMicroseconds = 86400000000;
    const std::int64_t day = microseconds / kDayMicroseconds - first_day_;
    const std::int64_t rest = microseconds % kDayMicroseconds;
    const std::chrono::year_month_day date{
        std::chrono::sys_days(std::chrono::days(static_cast<int>(day)))};
    return without_trailing_zeros(
        fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:06}", int(date.year()),
                    unsigned(date.month()), unsigned(date.day()), rest / 3600000000,
                    rest / 60000000 % 60, rest / 1000000 % 60, rest % 1000000));
  }

  std::string path_;
  std::unique_ptr<void, Close> zip_;
  std::vector<std::pair<std::string, std::string>> sheets_;  ///< name and part
  std::vector<std::string> strings_;
  std::vector<Format> formats_;
  std::int64_t first_day_ = 25569;  ///< 1970-01-01, in days of the workbook
  std::string sheet_;
  std::unique_ptr<Part> sheet_part_;
  std::unique_ptr<Elements> rows_;
  std::size_t number_ = 0;
  std::optional<std::vector<std::string>> first_;  ///< row, read to see whether there is one
};

XlsxRows::XlsxRows(const std::string& path) : workbook_(std::make_unique<Workbook>(path)) {}
XlsxRows::~XlsxRows() = default;
bool XlsxRows::next(std::vector<std::string>& fields) { return workbook_->next(fields); }
std::size_t XlsxRows::number() const { return workbook_->number(); }
const std::string& XlsxRows::sheet() const { return workbook_->sheet(); }

Table read_xlsx(const std::string& path) {
  constexpr std::size_t kHead = 1000;
  XlsxRows sheet(path);
  std::vector<TextRow> rows;
  TextRow row;
  while (rows.size() < kHead && sheet.next(row.fields)) {
    row.line = sheet.number();
    const bool blank = std::ranges::all_of(row.fields, [](const auto& f) { return f.empty(); });
    if (!blank) rows.push_back(row);
  }
  // Numbers are stored with a point, whatever Excel shows.
  TextLayout layout = find_layout(path, rows, '\t');
  const std::size_t first_row = layout.first_row;
  layout.series_end_early = true;  // blank cells at the end of a row are not stored
  TableBuilder builder(path, std::move(layout));
  for (std::size_t i = first_row; i < rows.size(); ++i) builder.add(rows[i]);
  while (sheet.next(row.fields)) {
    row.line = sheet.number();
    builder.add(row);
  }
  return builder.finish();
}

}  // namespace axisfit
