// What the command lines of the programs share.
#pragma once

#include <CLI/CLI.hpp>
#include <csignal>
#include <iostream>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "base/suggest.h"
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
    constexpr std::size_t kColumn = 28;
    const std::string name = "  " + make_option_name(option, positional) + make_option_opts(option);
    const std::string text = paragraph(make_option_desc(option), kColumn);
    return name.size() + 2 > kColumn ? name + "\n" + text : name + text.substr(name.size());
  }
};

/// Parses the command line and returns what `work` does: the exit code. Mistakes of the user, in
/// the command line or told by an exception, end with their message on standard error and
/// kBadInput.
template <class Work>
int run_program(CLI::App& app, int argc, char** argv, Work&& work) {
  app.formatter(std::make_shared<NarrowHelp>());
  app.set_version_flag("--version", std::string("axisfit ") + version());
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (app.exit(error) == 0) return 0;
    std::vector<std::string> options;
    for (const CLI::Option* option : app.get_options())
      for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
    for (const std::string& unknown : app.remaining())
      if (const std::string meant = closest_match(unknown, options);
          unknown.starts_with("-") && !meant.empty())
        std::cerr << "Did you mean " << meant << "?\n";
    return kBadInput;
  }
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error of writing like another
  try {
    return work();
  } catch (const std::bad_alloc&) {
    std::cerr
        << "out of memory: this needs more than the machine has or a limit (ulimit -v) allows\n";
    return kBadInput;
  } catch (const std::exception& error) {  // ConfigError's text has a line for each mistake
    std::cerr << error.what() << '\n';
    return kBadInput;
  }
}

}  // namespace axisfit
