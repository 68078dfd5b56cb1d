// What a first job is to be made of.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "init/columns/answers.h"

namespace axisfit {

struct InitRequest {
  std::vector<std::string> recordings;  ///< paths
  std::string folder = ".";             ///< where the files are meant to go
  std::string axis{};  ///< its file, or the name of a machine; empty: one is to be made
  bool is_machine = false;
  /// One of several, to be compared: only the busiest samples are used, and when the motion follows
  /// is as the first look saw it.
  bool is_on_trial = false;
  std::optional<double> gain{};  ///< K_f of the axis to be made, N per unit of the input
  Answers answers{};
};

}  // namespace axisfit
