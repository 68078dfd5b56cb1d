// Programs as a shell runs them.
#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <string>

#include "tests/apps/files.h"

namespace axisfit {

struct Answer {
  int exit_code = -1;  ///< of a command that a signal ended: 128 and its number
  std::string out, err;
};

/// Runs a command in a folder. fit-params and simulate-axis are on its path.
inline Answer shell(const TempFolder& folder, const std::string& command) {
  const TempFolder outputs;
  const std::string script =
      outputs.write("script", "PATH='" AXISFIT_BIN "':\"$PATH\"\ncd '" + folder.path() +
                                  "' || exit\n" + command + "\n");
  const int status = std::system(("sh '" + script + "' >'" + outputs.path("out") + "' 2>'" +
                                  outputs.path("err") + "' </dev/null")
                                     .c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, outputs.read("out"), outputs.read("err")};
}

}  // namespace axisfit
