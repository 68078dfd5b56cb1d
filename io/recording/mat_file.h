#pragma once

#include <string>

#include "io/recording/table.h"

namespace axisfit {

// Reads a MAT-file of version 4, 5 (MATLAB's -v6 and -v7) or 7.3.
//
// Every real numeric or logical 1xN or Nx1 array becomes a column with the name of the variable,
// converted to double (64-bit integers beyond 2^53 are rounded). An NxM matrix becomes M columns
// "name(:,k)", or N columns "name(k,:)" if it is wider than high, k from 1. The fields of a 1x1
// struct are treated like variables with the name "struct.field", at any depth. The columns may
// differ in length, because a file often holds more than one recording, and hold infinite values.
// Anything else (scalars, empty and complex arrays, more than two dimensions, sparse matrices,
// text, cells, struct arrays, tables and other objects) is a column with an obstacle, which says
// how MATLAB converts it. libmatio does not tell the name of a table or another object in a version
// 5 file, so that it is empty there.
//
// Throws RecordingError if the file cannot be opened, is no MAT-file, holds no variables, or is
// damaged or cut off. Sets libmatio's process-wide log function, so that nothing is printed; not to
// be called while another thread uses libmatio.
Table read_mat(const std::string& path);

}  // namespace axisfit
