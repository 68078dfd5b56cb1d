// What the command lines of the programs share.
#pragma once

#include <CLI/CLI.hpp>
#include <iostream>
#include <string>
#include <vector>

#include "apps/version.h"
#include "sim/suggest.h"

namespace axisfit {

inline constexpr int kBadInput = 2;  ///< exit code

/// Parses the command line and returns what `work` does: the exit code. Mistakes of the user, in
/// the command line or told by an exception, end with their message on standard error and
/// kBadInput.
template <class Work>
int run_program(CLI::App& app, int argc, char** argv, Work&& work) {
  app.set_version_flag("--version", std::string("axisfit ") + version());
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (app.exit(error) == 0) return 0;
    std::vector<std::string> options;
    for (const CLI::Option* option : app.get_options())
      for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
    for (const std::string& unknown : app.remaining())
      if (const std::string meant = nearest(unknown, options);
          unknown.starts_with("-") && !meant.empty())
        std::cerr << "Did you mean " << meant << "?\n";
    return kBadInput;
  }
  try {
    return work();
  } catch (const std::exception& error) {  // ConfigError's text has a line for each mistake
    std::cerr << error.what() << '\n';
    return kBadInput;
  }
}

}  // namespace axisfit
