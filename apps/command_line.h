// What the command lines of the programs share.
#pragma once

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <csignal>
#include <iostream>
#include <limits>
#include <memory>
#include <new>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/plain_text.h"
#include "base/suggest.h"
#include "base/terminal.h"
#include "base/text_table.h"
#include "base/version.h"

namespace axisfit {

inline constexpr int kBadInput = 2;  ///< exit code

/// Help that fits the width of text: options with the names of their values, what they do beside.
class NarrowHelp : public CLI::Formatter {
 public:
  std::string make_description(const CLI::App* app) const override {
    return paragraph(app->get_description());
  }
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    // One blank line between groups, of which the library makes two.
    return CLI::detail::find_and_replace(CLI::Formatter::make_help(app, std::move(name), mode),
                                         "\n\n\n", "\n\n");
  }
  std::string make_option_name(const CLI::Option* option, bool positional) const override {
    const std::string name = CLI::Formatter::make_option_name(option, positional);
    return name.substr(0, name.find('{'));  // without the value of a flag that is given none
  }
  std::string make_option_opts(const CLI::Option* option) const override {
    if (!option->get_option_text().empty()) return " " + option->get_option_text();
    const std::string type = option->get_type_name();
    // Without what is allowed, which the message about a mistake tells.
    return option->get_type_size() == 0 || option->get_positional()
               ? ""
               : " " + type.substr(0, type.find(':'));
  }
  std::string make_option_desc(const CLI::Option* option) const override {
    const std::string default_text = option->get_default_str();
    return option->get_description() + (default_text.empty() ? "" : "; default: " + default_text);
  }
  std::string make_option(const CLI::Option* option, bool positional) const override {
    const std::size_t column = TextWidth::now() < kTextWidth ? 8 : 28;
    const std::string name = "  " + make_option_name(option, positional) + make_option_opts(option);
    const std::string text = paragraph(make_option_desc(option), column);
    return name.size() + 2 > column ? name + "\n" + text : name + text.substr(name.size());
  }
};

/// What is wrong with a number on the command line; empty where nothing is. In full, decimal and
/// finite: the library's own reading takes a leading zero for octal, and not-a-number for in range.
template <class T>
std::string number_error(const std::string& text, T lower, T upper, const char* kind, T& value) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error == std::errc() && stop == end && value >= lower && value <= upper) return "";
  return fmt::format("{} is not {} from {} to {}", in_quotes(text), kind, lower, upper);
}

inline CLI::Validator number(double lower, double upper) {
  return {[=](std::string& text) {
            double value = 0.0;
            return number_error(text, lower, upper, "a number", value);
          },
          ""};
}

/// Takes leading zeros away.
template <class T = int>
CLI::Validator whole_number(T lower, T upper = std::numeric_limits<T>::max()) {
  return {[=](std::string& text) {
            T value = 0;
            const std::string error = number_error(text, lower, upper, "a whole number", value);
            if (error.empty()) text = fmt::format("{}", value);
            return error;
          },
          ""};
}

/// As a script gives a name where a variable of it is not set.
inline const CLI::Validator kNotEmpty{
    [](std::string& text) { return std::string(text.empty() ? "the name is empty" : ""); }, ""};

/// Nobody reads standard output, or its disk is full.
struct OutputError : std::runtime_error {
  explicit OutputError(int error)
      : std::runtime_error("cannot write to standard output"), broken_pipe(error == EPIPE) {}
  bool broken_pipe;
};

/// A text for standard output. Throws OutputError.
inline void print(const std::string& text) {
  errno = 0;
  if (!(std::cout << text).flush()) throw OutputError(errno);
}

/// A text for standard error, of which nothing controls the terminal.
inline void print_error(const std::string& text) { std::cerr << sanitized_lines(text); }

/// Without it, the first files that are opened would take the places of standard streams that are
/// closed, and messages would be written into them. What is opened instead cannot be written to or
/// read from either.
inline void occupy_standard_streams() {
  for (const int stream : {0, 1, 2})
    if (::fcntl(stream, F_GETFD) < 0 && errno == EBADF)
      ::open("/dev/null", stream == 0 ? O_WRONLY : O_RDONLY);  // takes the lowest that is free
}

/// Parses the command line and returns what `work` does: the exit code. Mistakes of the user, in
/// the command line or told by an exception, end with their message on standard error and
/// kBadInput; so does a call without arguments, with `short_help`. `PROGRAM help` is --help.
template <class Work>
int run_program(CLI::App& app, const char* short_help, int argc, char** argv, Work&& work) {
  occupy_standard_streams();
  app.formatter(std::make_shared<NarrowHelp>());
  app.option_defaults()->group("Other");
  app.set_help_flag("-h,--help", "print this help");
  app.set_version_flag("-V,--version", std::string("axisfit ") + version(), "print the version");
  if (argc == 1) {
    print_error(short_help);
    return kBadInput;
  }
  try {
    const TextWidth narrow(text_width(STDOUT_FILENO));
    if (argc == 2 && std::string_view(argv[1]) == "help")
      app.parse(std::vector<std::string>{"--help"});
    else
      app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream message;
    if (app.exit(error, std::cout, message) == 0) return 0;
    print_error(message.str());
    std::vector<std::string> options;
    for (const CLI::Option* option : app.get_options())
      for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
    for (const std::string& unknown : app.remaining())
      if (const std::string meant = closest_match(unknown, options);
          unknown.starts_with("-") && !meant.empty())
        print_error("Did you mean " + meant + "?\n");
    return kBadInput;
  }
  // A file that may not grow, or a pipe that nobody reads, is an error of writing like another.
  std::signal(SIGXFSZ, SIG_IGN);
  const auto on_broken_pipe = std::signal(SIGPIPE, SIG_IGN);
  try {
    return work();
  } catch (const OutputError& error) {
    if (error.broken_pipe) {  // as `head` leaves it: no mistake of anybody's
      std::signal(SIGPIPE, on_broken_pipe);
      std::raise(SIGPIPE);
    }
    print_error(fmt::format("{}\n", error.what()));
    return kBadInput;
  } catch (const std::bad_alloc&) {
    std::cerr
        << "out of memory: this needs more than the machine has or a limit (ulimit -v) allows\n";
    return kBadInput;
  } catch (const std::exception& error) {  // ConfigError's text has a line for each mistake
    print_error(fmt::format("{}\n", error.what()));
    return kBadInput;
  }
}

}  // namespace axisfit
