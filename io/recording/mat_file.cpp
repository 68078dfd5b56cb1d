#include "io/recording/mat_file.h"

#include <fmt/format.h>
#include <matio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>

#include "base/file_watch.h"
#include "base/plain_text.h"
#include "base/subprocess.h"

namespace axisfit {
namespace {

struct CloseMat {
  void operator()(mat_t* mat) const { Mat_Close(mat); }
};
struct FreeVariable {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using MatHandle = std::unique_ptr<mat_t, CloseMat>;
using Variable = std::unique_ptr<matvar_t, FreeVariable>;

// The first complaint of libmatio since the log was cleared. Its return values do not tell a cut
// off variable from a complete one (the rest of the data is zeros), nor a damaged file from the end
// of the file: the log is the only sign.
thread_local std::string complaint;

void keep_first_complaint(int /*level*/, char* message) {
  if (!complaint.empty() || message == nullptr) return;
  const std::string_view text(message);
  complaint = text.substr(0, text.find('\n'));
}

[[noreturn]] void throw_damaged(const std::string& file, const std::string& where) {
  throw RecordingError(file, 0,
                       where + "the file is damaged or truncated (libmatio: " + complaint +
                           "); save or copy it again");
}

std::string in_variable(const std::string& name) { return "variable " + in_quotes(name) + ": "; }

MatHandle open_mat(const std::string& path) {
  MatHandle mat(Mat_Open(path.c_str(), MAT_ACC_RDONLY));
  if (mat == nullptr) {
    throw RecordingError(path, 0,
                         "is not a MAT-file; save the recording with MATLAB's save or as CSV");
  }
  if (!complaint.empty()) throw_damaged(path, "");
  return mat;
}

// Why the variable `x` cannot be a column, and the line of MATLAB that makes columns of it; empty
// if it can. Structs of one element can.
std::string obstacle(const matvar_t& variable, const std::string& x) {
  const auto is = [&](std::string_view what, const std::string& line) {
    return fmt::format("is {}; in MATLAB '{}' converts it, before save", what, line);
  };
  switch (variable.class_type) {
    case MAT_C_CELL:
      return is("a cell array", x + " = cell2mat(" + x + ")");
    case MAT_C_CHAR:
      return "is text";
    case MAT_C_SPARSE:
      return is("a sparse matrix", x + " = full(" + x + ")");
    case MAT_C_FUNCTION:
      return "is a function handle";
    case MAT_C_OBJECT:
    case MAT_C_OPAQUE:
    case MAT_C_EMPTY:  // a class unknown to libmatio, as tables are in version 7.3
      return fmt::format(
          "is a table, timetable, timeseries or another object, which MATLAB alone can read; there "
          "'x = table2struct(x, \"ToScalar\", true)' converts a table x, and 'y = x.Data; t = "
          "x.Time' a timeseries, before save");
    default:
      break;
  }
  if (variable.rank != 2)
    return is("an array of more than two dimensions", x + " = squeeze(" + x + ")");
  const std::size_t rows = variable.dims[0];
  const std::size_t cols = variable.dims[1];
  if (rows == 0 || cols == 0) return "is an empty array";
  const bool single = rows == 1 && cols == 1;
  if (variable.class_type == MAT_C_STRUCT)
    return single ? "" : is("a struct array", x + " = struct(\"y\", [" + x + ".y])");
  if (variable.isComplex != 0) return is("a complex array", x + " = real(" + x + ")");
  return single ? "is a scalar" : "";
}

template <typename T>
std::vector<double> to_doubles(const matvar_t& variable) {
  const T* const data = static_cast<const T*>(variable.data);
  if (data == nullptr) return {};
  std::vector<double> values(variable.nbytes / sizeof(T));
  std::transform(data, data + values.size(), values.begin(),
                 [](T value) { return static_cast<double>(value); });
  return values;
}

// The elements column by column, as many as libmatio has read.
std::vector<double> elements(const matvar_t& variable) {
  switch (variable.class_type) {
    case MAT_C_DOUBLE:
      return to_doubles<double>(variable);
    case MAT_C_SINGLE:
      return to_doubles<float>(variable);
    case MAT_C_INT8:
      return to_doubles<std::int8_t>(variable);
    case MAT_C_UINT8:  // logical arrays as well
      return to_doubles<std::uint8_t>(variable);
    case MAT_C_INT16:
      return to_doubles<std::int16_t>(variable);
    case MAT_C_UINT16:
      return to_doubles<std::uint16_t>(variable);
    case MAT_C_INT32:
      return to_doubles<std::int32_t>(variable);
    case MAT_C_UINT32:
      return to_doubles<std::uint32_t>(variable);
    case MAT_C_INT64:
      return to_doubles<std::int64_t>(variable);
    case MAT_C_UINT64:
      return to_doubles<std::uint64_t>(variable);
    default:
      return {};
  }
}

void append_array(Table& mat, const std::string& name, const matvar_t& variable) {
  const std::size_t rows = variable.dims[0];
  const std::size_t cols = variable.dims[1];
  std::vector<double> values = elements(variable);
  if (values.size() % rows != 0 || values.size() / rows != cols) {
    throw RecordingError(mat.file, 0,
                         in_variable(name) + "its data do not match its size; save the file again");
  }
  if (rows == 1 || cols == 1) {
    mat.columns.push_back({name, std::move(values)});
    return;
  }
  const bool wide = cols > rows;  // then time runs along the rows
  const std::size_t signals = std::min(rows, cols);
  const std::size_t samples = std::max(rows, cols);
  for (std::size_t signal = 0; signal < signals; ++signal) {
    const std::string k = std::to_string(signal + 1);
    Column column{name + (wide ? "(" + k + ",:)" : "(:," + k + ")"), {}};
    column.values.reserve(samples);
    for (std::size_t sample = 0; sample < samples; ++sample) {
      column.values.push_back(values[wide ? signal + sample * rows : sample + signal * rows]);
    }
    mat.columns.push_back(std::move(column));
  }
}

void append(Table& mat, const std::string& name, matvar_t& variable) {
  if (std::string reason = obstacle(variable, name); !reason.empty()) {
    mat.columns.push_back({.name = name, .values = {}, .obstacle = std::move(reason)});
    return;
  }
  if (variable.class_type != MAT_C_STRUCT) {
    append_array(mat, name, variable);
    return;
  }
  const char* const* const fields = Mat_VarGetStructFieldnames(&variable);
  const unsigned count = Mat_VarGetNumberOfFields(&variable);
  for (unsigned i = 0; i < count; ++i) {
    matvar_t* const field = Mat_VarGetStructFieldByIndex(&variable, i, 0);
    const std::string path = name + "." + fields[i];
    if (field != nullptr) {
      append(mat, path, *field);
    } else {
      mat.columns.push_back({.name = path, .values = {}, .obstacle = "is an empty array"});
    }
  }
}

Table read_in_process(const std::string& path) {
  Mat_LogInitFunc("axisfit", keep_first_complaint);
  complaint.clear();
  const FileWatch watch(path);
  const MatHandle handle = open_mat(path);

  Table mat{path, {}};
  std::string last;  // variable that was read
  bool empty = true;
  while (const Variable variable{Mat_VarReadNext(handle.get())}) {
    empty = false;
    const std::string name = variable->name == nullptr ? "" : variable->name;
    // MATLAB keeps the contents of objects in a numeric variable without a name.
    if (name.empty() && variable->class_type != MAT_C_OPAQUE) continue;
    if (!complaint.empty()) throw_damaged(path, in_variable(name));
    append(mat, name, *variable);
    last = name;
  }
  if (watch.has_changed()) throw RecordingError(path, 0, FileWatch::kMessage);
  if (!complaint.empty())
    throw_damaged(path, last.empty() ? "" : "in or after variable " + in_quotes(last) + ": ");
  if (empty) {
    throw RecordingError(path, 0, "contains no variables; it may be truncated or not a MAT-file");
  }
  return mat;
}

using Json = nlohmann::json;

/// For the way from one process to another.
std::string packed(const Table& mat) {
  Json json{{"columns", Json::array()}};
  for (const Column& column : mat.columns) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(column.values.data());
    json["columns"].push_back(
        {{"name", column.name},
         {"obstacle", column.obstacle},
         {"values", Json::binary({bytes, bytes + column.values.size() * sizeof(double)})}});
  }
  std::string text;
  Json::to_msgpack(json, text);
  return text;
}

Table unpacked(const std::string& path, const Json& json) {
  Table mat{path, {}};
  for (const Json& column : json.at("columns")) {
    const auto& bytes = column.at("values").get_binary();
    std::vector<double> values(bytes.size() / sizeof(double));
    std::memcpy(values.data(), bytes.data(), bytes.size());
    mat.columns.push_back({.name = column.at("name"),
                           .values = std::move(values),
                           .obstacle = column.at("obstacle")});
  }
  return mat;
}

/// Reads in a process of its own, of limited memory: HDF5 1.10 follows what a damaged file says
/// until it crashes, and libmatio makes room for whatever a file states before it looks how much
/// there is.
Table read_in_subprocess(const std::string& path) {
  // Compressed columns of one value shrink to a thousandth, those of an instrument to a third.
  constexpr std::size_t kLeast = std::size_t{512} << 20, kPerByte = 64;
  const std::optional<std::string> reply = run_in_subprocess(
      [&] {
        try {
          return packed(read_in_process(path));
        } catch (const RecordingError& error) {
          std::string text;
          Json::to_msgpack(
              {{"refused", std::string(error.what()).substr(sanitized(path).size() + 2)}}, text);
          return text;
        }
      },
      kLeast + kPerByte * std::filesystem::file_size(path));
  if (!reply)
    throw RecordingError(path, 0,
                         "the file is damaged: libmatio cannot read it; save or copy it again");
  const Json json = Json::from_msgpack(*reply);
  if (json.contains("refused")) throw RecordingError(path, 0, json.at("refused"));
  return unpacked(path, json);
}

}  // namespace

Table read_mat(const std::string& path) {
  // libmatio would take an empty file for one of version 4.
  check_readable(path);
  if (std::ifstream(path, std::ios::binary).peek() == std::ifstream::traits_type::eof()) {
    throw RecordingError(path, 0, "the file is empty; save or copy it again");
  }
  return read_in_subprocess(path);
}

}  // namespace axisfit
