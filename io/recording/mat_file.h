#pragma once

#include <span>
#include <string>
#include <vector>

#include "io/recording/csv.h"

namespace axisfit {

// A variable (or field of a struct) of a MAT-file that cannot be a column.
struct IgnoredVariable {
  std::string name;  // "struct.field" for fields; empty if the file format hides it, see read_mat
  std::string kind;  // with its article, such as "a cell array"
};

// The numeric vectors of a MAT-file. Unlike the columns of a Table they may differ in length,
// because a file often holds more than one recording, and may hold values that are not finite.
struct MatFile {
  std::string file;             // the source as it is named in messages
  std::vector<Column> columns;  // in the order of the file
  std::vector<IgnoredVariable> ignored;
};

// Reads a MAT-file of version 4, 5 (MATLAB's -v6 and -v7) or 7.3.
//
// Every real numeric or logical 1xN or Nx1 array becomes a column with the name of the variable,
// converted to double (64-bit integers beyond 2^53 are rounded). An NxM matrix becomes M columns
// "name(:,k)", or N columns "name(k,:)" if it is wider than high, k from 1. The fields of a 1x1
// struct are treated like variables with the name "struct.field", at any depth. Anything else
// (scalars, empty and complex arrays, more than two dimensions, sparse matrices, text, cells,
// struct arrays, tables and other objects) is listed in `ignored`. libmatio does not tell the name
// of a table or another object in a version 5 file, so that it is empty there.
//
// Throws RecordingError if the file cannot be opened, is no MAT-file, holds no variables, or is
// damaged or cut off. Sets libmatio's process-wide log function, so that nothing is printed; not to
// be called while another thread uses libmatio.
MatFile read_mat(const std::string& path);

// Returns the columns called `names`, in this order, as a table without lines.
//
// Throws RecordingError if a name is missing (the message suggests the nearest one and lists what
// there is), if the columns differ in length, or if a value is not finite.
Table select(const MatFile& mat, std::span<const std::string> names);

}  // namespace axisfit
