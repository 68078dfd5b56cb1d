// A named series of numbers: what a recording is made of.
#pragma once

#include <string>
#include <vector>

namespace axisfit {

struct Column {
  std::string name;
  std::vector<double> values;
  std::string unit{};  ///< as written in a row of units below the header; empty: there is none
};

}  // namespace axisfit
