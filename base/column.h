// A named series of numbers: what a recording is made of.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace axisfit {

struct Column {
  std::string name;
  std::vector<double> values;          ///< NaN: there is none here
  std::string unit{};                  ///< as the source says it; empty: it says none
  std::optional<std::size_t> clock{};  ///< index of the column with the times of these values;
                                       ///< none: the source does not say which it is
  std::string obstacle{};  ///< why it cannot be used, as the end of a sentence that begins with its
                           ///< name; empty: it can
};

}  // namespace axisfit
