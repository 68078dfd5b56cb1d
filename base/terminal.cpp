#include "base/terminal.h"

#include <fmt/color.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <sstream>
#include <string_view>
#include <utility>

#include "base/text_table.h"

namespace axisfit {
namespace {

std::string_view environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// How a report words its verdicts: at the beginning of a line, or at its end.
constexpr std::pair<std::string_view, fmt::terminal_color> kVerdicts[]{
    {"No usable fit", fmt::terminal_color::red},
    {"Usable fit", fmt::terminal_color::green},
    {"Unexplained", fmt::terminal_color::yellow},
    {"Stopped early", fmt::terminal_color::yellow},
    {"  accepted  ", fmt::terminal_color::green},
    {"  undecided  ", fmt::terminal_color::yellow},
    {"weakly determined", fmt::terminal_color::yellow},
    {"not determined", fmt::terminal_color::red},
    {"at bound", fmt::terminal_color::yellow}};

std::string with_verdict(const std::string& line) {
  for (const auto& [words, colour] : kVerdicts) {
    if (!line.starts_with(words) && !line.ends_with(words)) continue;
    const std::size_t at = line.starts_with(words) ? 0 : line.size() - words.size();
    return line.substr(0, at) + fmt::format(fmt::fg(colour), "{}", words) +
           line.substr(at + words.size());
  }
  return line;
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

std::string coloured(const std::string& report) {
  std::string text;
  std::istringstream lines(report);
  std::string line, next;
  // A heading stands at the margin, above what is indented.
  for (bool more = static_cast<bool>(std::getline(lines, line)); more; line = next) {
    more = static_cast<bool>(std::getline(lines, next));
    const bool heading = !line.empty() && line[0] != ' ' && more && next.starts_with("  ");
    text += (heading ? fmt::format(fmt::emphasis::bold, "{}", line) : with_verdict(line)) + "\n";
  }
  return text;
}

}  // namespace axisfit
