#include "io/recording/mat_file.h"

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
#include "base/suggest.h"

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

// Why the variable cannot be a column, or an empty string if it can. Structs of one element can.
std::string obstacle(const matvar_t& variable) {
  switch (variable.class_type) {
    case MAT_C_CELL:
      return "a cell array";
    case MAT_C_CHAR:
      return "text";
    case MAT_C_SPARSE:
      return "a sparse matrix";
    case MAT_C_FUNCTION:
      return "a function handle";
    case MAT_C_OBJECT:
    case MAT_C_OPAQUE:
    case MAT_C_EMPTY:  // a class unknown to libmatio, as tables are in version 7.3
      return "a table, timetable or another object";
    default:
      break;
  }
  if (variable.rank != 2) return "an array of more than two dimensions";
  const std::size_t rows = variable.dims[0];
  const std::size_t cols = variable.dims[1];
  if (rows == 0 || cols == 0) return "an empty array";
  const bool single = rows == 1 && cols == 1;
  if (variable.class_type == MAT_C_STRUCT) return single ? "" : "a struct array";
  if (variable.isComplex != 0) return "a complex array";
  return single ? "a scalar" : "";
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

void append_array(MatFile& mat, const std::string& name, const matvar_t& variable) {
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

void append(MatFile& mat, const std::string& name, matvar_t& variable) {
  if (std::string kind = obstacle(variable); !kind.empty()) {
    mat.ignored.push_back({name, std::move(kind)});
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
      mat.ignored.push_back({path, "an empty array"});
    }
  }
}

// The items separated by commas; those beyond a readable number of them are only counted.
template <typename Items, typename Describe>
std::string list(const Items& items, Describe describe) {
  constexpr std::size_t kMost = 20;
  std::string text;
  for (std::size_t i = 0; i < std::min(items.size(), kMost); ++i) {
    text += (i == 0 ? "" : ", ") + describe(items[i]);
  }
  if (items.size() > kMost) text += " and " + std::to_string(items.size() - kMost) + " more";
  return text;
}

[[noreturn]] void throw_missing(const MatFile& mat, const std::string& name) {
  for (const IgnoredVariable& variable : mat.ignored) {
    if (variable.name != name || name.empty()) continue;
    throw RecordingError(mat.file, 0,
                         in_variable(name) + "it is " + variable.kind +
                             ", which cannot be read; export it as a numeric vector");
  }
  std::vector<std::string> names;
  for (const Column& column : mat.columns) names.push_back(column.name);
  std::string message = "there is no variable " + in_quotes(name);
  if (const std::string guess = closest_match(name, names); !guess.empty()) {
    message += " (did you mean " + in_quotes(guess) + "?)";
  }
  if (names.empty()) {
    message += "; the file has no numeric vectors";
  } else {
    message += "; the file has " + list(names, in_quotes);
  }
  if (!mat.ignored.empty()) {
    message += "; not readable unless exported as numeric vectors: " +
               list(mat.ignored, [](const IgnoredVariable& variable) {
                 return (variable.name.empty() ? "one of unknown name" : in_quotes(variable.name)) +
                        " (" + variable.kind + ")";
               });
  }
  throw RecordingError(mat.file, 0, message);
}

MatFile read_in_process(const std::string& path) {
  Mat_LogInitFunc("axisfit", keep_first_complaint);
  complaint.clear();
  const FileWatch watch(path);
  const MatHandle handle = open_mat(path);

  MatFile mat{path, {}, {}};
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
std::string packed(const MatFile& mat) {
  Json json{{"columns", Json::array()}, {"ignored", Json::array()}};
  for (const Column& column : mat.columns) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(column.values.data());
    json["columns"].push_back(
        {{"name", column.name},
         {"values", Json::binary({bytes, bytes + column.values.size() * sizeof(double)})}});
  }
  for (const IgnoredVariable& variable : mat.ignored)
    json["ignored"].push_back({{"name", variable.name}, {"kind", variable.kind}});
  std::string text;
  Json::to_msgpack(json, text);
  return text;
}

MatFile unpacked(const std::string& path, const Json& json) {
  MatFile mat{path, {}, {}};
  for (const Json& column : json.at("columns")) {
    const auto& bytes = column.at("values").get_binary();
    std::vector<double> values(bytes.size() / sizeof(double));
    std::memcpy(values.data(), bytes.data(), bytes.size());
    mat.columns.push_back({column.at("name"), std::move(values)});
  }
  for (const Json& variable : json.at("ignored"))
    mat.ignored.push_back({variable.at("name"), variable.at("kind")});
  return mat;
}

/// Reads in a process of its own, of limited memory: HDF5 1.10 follows what a damaged file says
/// until it crashes, and libmatio makes room for whatever a file states before it looks how much
/// there is.
MatFile read_in_subprocess(const std::string& path) {
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

MatFile read_mat(const std::string& path) {
  // libmatio would take an empty file for one of version 4.
  if (open_recording(path).peek() == std::ifstream::traits_type::eof()) {
    throw RecordingError(path, 0, "the file is empty; save or copy it again");
  }
  return read_in_subprocess(path);
}

Table select(const MatFile& mat, std::span<const std::string> names) {
  Table table;
  table.file = mat.file;
  for (const std::string& name : names) {
    const auto found = std::find_if(mat.columns.begin(), mat.columns.end(),
                                    [&name](const Column& column) { return column.name == name; });
    if (found == mat.columns.end()) throw_missing(mat, name);
    const std::vector<double>& values = found->values;
    if (!table.columns.empty() && values.size() != table.rows()) {
      throw RecordingError(mat.file, 0,
                           in_variable(name) + "it has " + std::to_string(values.size()) +
                               " values, but " + in_quotes(table.columns.front().name) + " has " +
                               std::to_string(table.rows()) +
                               "; the signals of a recording must have the same length");
    }
    const auto bad = std::find_if_not(values.begin(), values.end(),
                                      [](double value) { return std::isfinite(value); });
    if (bad != values.end()) {
      throw RecordingError(mat.file, 0,
                           in_variable(name) + "element " +
                               std::to_string(bad - values.begin() + 1) + " is " +
                               (std::isnan(*bad) ? "NaN" : "infinite") +
                               "; remove the sample or cut the recording there");
    }
    table.columns.push_back(*found);
  }
  return table;
}

}  // namespace axisfit
