#include "base/terminal.h"

#include <fmt/color.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <string_view>

#include "base/text_table.h"

namespace axisfit {
namespace {

std::string_view environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

}  // namespace

bool is_terminal(int file) {
  const std::string_view terminal = environment("TERM");
  return isatty(file) != 0 && !terminal.empty() && terminal != "dumb";
}

bool takes_colour(int file) { return is_terminal(file) && environment("NO_COLOR").empty(); }

std::size_t terminal_width(int file) {
  winsize size = {};
  if (ioctl(file, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  const unsigned long columns =
      std::strtoul(std::string(environment("COLUMNS")).c_str(), nullptr, 10);
  return columns > 0 ? columns : kTextWidth;
}

std::size_t text_width(int file) {
  return isatty(file) != 0 ? std::min(terminal_width(file), kTextWidth) : kTextWidth;
}

std::string toned(std::string_view words, Tone tone, bool colour) {
  const auto in = [&](fmt::terminal_color hue) { return fmt::format(fmt::fg(hue), "{}", words); };
  if (colour) switch (tone) {
      case Tone::good:
        return in(fmt::terminal_color::green);
      case Tone::caution:
        return in(fmt::terminal_color::yellow);
      case Tone::bad:
        return in(fmt::terminal_color::red);
      case Tone::neutral:
        break;
    }
  return std::string(words);
}

std::string with_bold_headings(const std::string& text) {
  std::string result;
  std::istringstream lines(text);
  std::string line, next;
  for (bool more = static_cast<bool>(std::getline(lines, line)); more; line = next) {
    more = static_cast<bool>(std::getline(lines, next));
    const bool heading = !line.empty() && line[0] != ' ' && more && next.starts_with("  ");
    result += (heading ? fmt::format(fmt::emphasis::bold, "{}", line) : line) + "\n";
  }
  return result;
}

}  // namespace axisfit
