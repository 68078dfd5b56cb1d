#include "base/text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace axisfit {
namespace {

thread_local std::size_t line_width = kTextWidth;

/// Lines of at most `width` characters, unless a word is longer.
std::vector<std::string> broken(const std::string& text, std::size_t width) {
  std::vector<std::string> lines{""};
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = std::min(text.find(' ', at), text.size());
    if (text.compare(end, 2, " %") == 0) end = std::min(text.find(' ', end + 1), text.size());
    const std::string word = text.substr(at, end - at);
    std::string& line = lines.back();
    if (line.empty())
      line = word;
    else if (width_of(line) + 1 + width_of(word) <= width)
      line += " " + word;
    else
      lines.push_back(word);
    at = end + 1;
  }
  return lines;
}

constexpr std::size_t kIndent = 2, kGap = 2;
constexpr std::size_t kMinWrappedWidth = 20;  ///< width of a column to wrap in

struct Layout {
  std::vector<std::size_t> width;   ///< of each column
  std::vector<bool> begins_a_line;  ///< of a row, which all its columns do not fit in
};

/// The first column is left no more than there is room for.
Layout layout_of(const std::vector<std::vector<std::string>>& rows,
                 const std::vector<Alignment>& alignment) {
  std::vector<std::size_t> width(alignment.size(), 0);
  for (const auto& row : rows)
    for (std::size_t c = 0; c < row.size(); ++c)
      width[c] = alignment[c] == Alignment::wrapped ? kMinWrappedWidth
                                                    : std::max(width[c], width_of(row[c]));
  const std::size_t others =
      std::accumulate(width.begin() + 1, width.end(), kIndent) + kGap * (width.size() - 1);
  const std::size_t room = line_width - std::min(others, line_width);
  std::vector<bool> begins_a_line(width.size(), false);
  if (others > line_width) {
    std::size_t end = kIndent + width[0];
    for (std::size_t c = 1; c < width.size(); ++c) {
      begins_a_line[c] = end + kGap + width[c] > line_width;
      end = (begins_a_line[c] ? kIndent : end) + kGap + width[c];
    }
  } else if (width[0] > room) {
    width[0] = 0;
    for (const auto& row : rows)
      if (const std::size_t first = width_of(row[0]); first <= room)
        width[0] = std::max(width[0], first);
  }
  return {width, begins_a_line};
}

}  // namespace

TextWidth::TextWidth(std::size_t width) : before_(line_width) {
  constexpr std::size_t kNarrowest = 40;
  line_width = std::max(width, kNarrowest);
}

TextWidth::~TextWidth() { line_width = before_; }

std::size_t TextWidth::now() { return line_width; }

std::size_t width_of(std::string_view text) {
  constexpr std::string_view kCode = "\033[";
  std::size_t width = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text.substr(i, kCode.size()) == kCode)
      i = std::min(text.find('m', i), text.size());
    else if ((text[i] & 0xC0) != 0x80)
      ++width;
  }
  return width;
}

std::string format_table(const std::vector<std::vector<std::string>>& rows,
                         const std::vector<Alignment>& alignment) {
  const auto [width, begins_a_line] = layout_of(rows, alignment);
  std::string text;
  const auto end_line = [&text](std::string& line) {
    line.erase(line.find_last_not_of(' ') + 1);
    if (!line.empty()) text += line + "\n";
    line.assign(kIndent, ' ');
  };
  for (const auto& row : rows) {
    std::string line(kIndent, ' ');
    for (std::size_t c = 0; c < row.size(); ++c) {
      if (begins_a_line[c]) end_line(line);
      if (c > 0) line += std::string(kGap, ' ');
      if (alignment[c] == Alignment::wrapped) {
        const std::size_t indent = width_of(line);
        const auto lines =
            broken(row[c], line_width - std::min(indent, line_width - kMinWrappedWidth));
        for (std::size_t i = 0; i < lines.size(); ++i)
          line += (i > 0 ? "\n" + std::string(indent, ' ') : "") + lines[i];
        continue;
      }
      if (width_of(row[c]) > width[c]) {  // the first
        line += row[c];
        if (row.size() == 1) continue;
        end_line(line);
        line += std::string(width[c], ' ');
        continue;
      }
      const std::string pad(width[c] - width_of(row[c]), ' ');
      line += alignment[c] == Alignment::left ? row[c] + pad : pad + row[c];
    }
    end_line(line);
  }
  return text;
}

std::string paragraph(const std::string& text, std::size_t indent) {
  std::string result;
  for (const std::string& line : broken(text, line_width - indent))
    result += std::string(indent, ' ') + line + "\n";
  return result;
}

std::string with_digits_of(double value, double error) {
  if (!(error > 0.0) || !std::isfinite(error)) return fmt::format("{:.4g}", value);
  const int last = static_cast<int>(std::floor(std::log10(error))) - 1;
  const int first = value == 0.0 ? last : static_cast<int>(std::floor(std::log10(std::abs(value))));
  const int digits = std::clamp(first - last + 1, 1, 15);
  // Plain figures where they are readable, powers of ten elsewhere.
  if (last <= 0 && first < 7 && first > -4)
    return fmt::format("{:.{}f}", value, std::min(-last, 12));
  if (last > 0 && first < 5) return fmt::format("{:.0f}", value);
  return fmt::format("{:.{}e}", value, digits - 1);
}

}  // namespace axisfit
