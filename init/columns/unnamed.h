// Columns without a single name: their values tell what moves, and what drives it.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "init/columns/column_set.h"

namespace axisfit {

/// What a column is, and why.
struct Inferred {
  std::size_t place;
  Kind kind;
  std::string reason;
};

/// A position is what another column is the rate of, and is no rate itself; what drives them is
/// what goes best with their acceleration. `columns` are those that are known already, by answers,
/// and `free` the values of the others by their places, at the times.
std::vector<Inferred> infer_unnamed(const std::vector<double>& times, ColumnSet& columns,
                                    std::map<std::size_t, std::vector<double>> free);

}  // namespace axisfit
