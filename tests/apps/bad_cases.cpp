#include "tests/apps/bad_cases.h"

#include <gtest/gtest.h>
#include <matio.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <regex>

#include "tests/apps/files.h"

namespace axisfit {
namespace {

std::string all_replaced(const std::string& text, const std::string& from, const std::string& to) {
  return std::regex_replace(text, std::regex(from), to);
}

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

std::string utf16(const std::string& text) {
  std::string wide;
  for (const char c : text) wide += {c, '\0'};
  return wide;
}

std::string gzipped(const std::string& text) {
  const TempFolder folder;
  const gzFile file = gzopen(folder.path("gz").c_str(), "wb");
  gzwrite(file, text.data(), static_cast<unsigned>(text.size()));
  gzclose(file);
  return folder.read("gz");
}

/// The times of the good recording as another clock counts them.
std::string on_clock(const std::string& csv, const std::string& second, int digits,
                     const std::string& point) {
  // "0.3" becomes `second`, "0", `point`, "3" and zeros.
  return all_replaced(csv, "\n([01])\\.(\\d)",
                      "\n" + second + "$01" + point + "$02" +
                          std::string(static_cast<std::size_t>(digits - 1), '0'));
}

/// A velocity that goes on where its instrument has an end.
std::string clipped_sine() {
  std::string csv = "t,u,v\n";
  for (int i = 0; i < 400; ++i) {
    const double t = 0.005 * i, noise = 1e-3 * ((7 * i) % 5 - 2);
    csv += std::to_string(t) + "," + std::to_string(2.0 * std::sin(6.0 * t)) + "," +
           std::to_string(std::clamp(1.2 * std::sin(6.0 * t - 1.0) + noise, -1.0, 1.0)) + "\n";
  }
  return csv;
}

/// MAT-files of the columns t, u and v of a CSV text.
class MatWriter {
 public:
  explicit MatWriter(const std::string& csv) {
    folder_.write("data.csv", csv);
    for (const Column& c : read_csv(folder_.path("data.csv")).columns) columns_.push_back(c);
  }

  std::string write(const std::string& kind) {
    const mat_ft format = kind == "version 4"     ? MAT_FT_MAT4
                          : kind == "version 7.3" ? MAT_FT_MAT73
                                                  : MAT_FT_MAT5;
    compression_ = kind == "compressed" ? MAT_COMPRESSION_ZLIB : MAT_COMPRESSION_NONE;
    mat_t* const mat = Mat_CreateVer(folder_.path("data.mat").c_str(), nullptr, format);
    write(mat, kind);
    Mat_Close(mat);
    return folder_.read("data.mat");
  }

 private:
  matvar_t* vector(const char* name, std::vector<double>& values) {
    std::size_t dims[2] = {values.size(), 1};
    return Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, values.data(), 0);
  }
  void put(mat_t* mat, matvar_t* variable) const {
    EXPECT_EQ(Mat_VarWrite(mat, variable, compression_), 0);
    Mat_VarFree(variable);
  }

  void write(mat_t* mat, const std::string& kind) {
    std::vector<double>&t = columns_[0].values, &u = columns_[1].values, &v = columns_[2].values;
    const std::size_t n = t.size();
    if (kind == "matrix") {
      std::vector<double> all = t;
      all.insert(all.end(), u.begin(), u.end());
      all.insert(all.end(), v.begin(), v.end());
      std::size_t dims[2] = {n, 3};
      put(mat, Mat_VarCreate("m", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, all.data(), 0));
      return;
    }
    if (kind == "struct") {
      std::size_t one[2] = {1, 1};
      const char *outer[] = {"t", "in", "v"}, *inner[] = {"u"};
      matvar_t* const in = Mat_VarCreateStruct("in", 2, one, inner, 1);
      Mat_VarSetStructFieldByName(in, "u", 0, vector("u", u));
      matvar_t* const log = Mat_VarCreateStruct("log", 2, one, outer, 3);
      Mat_VarSetStructFieldByName(log, "t", 0, vector("t", t));
      Mat_VarSetStructFieldByName(log, "in", 0, in);
      Mat_VarSetStructFieldByName(log, "v", 0, vector("v", v));
      put(mat, log);
      return;
    }
    put(mat, vector("t", t));
    put(mat, vector("u", u));
    std::size_t dims[3] = {n, 1, 1};
    if (kind == "complex") {
      mat_complex_split_t parts = {v.data(), u.data()};
      put(mat, Mat_VarCreate("v", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, &parts, MAT_F_COMPLEX));
    } else if (kind == "sparse") {
      std::vector<mat_uint32_t> rows(n), starts{0, static_cast<mat_uint32_t>(n)};
      for (std::size_t i = 0; i < n; ++i) rows[i] = static_cast<mat_uint32_t>(i);
      mat_sparse_t data = {};
      data.nzmax = data.nir = data.ndata = static_cast<mat_uint32_t>(n);
      data.njc = 2;
      data.ir = rows.data();
      data.jc = starts.data();
      data.data = v.data();
      put(mat,
          Mat_VarCreate("v", MAT_C_SPARSE, MAT_T_DOUBLE, 2, dims, &data, MAT_F_DONT_COPY_DATA));
    } else if (kind == "text") {
      std::string text(n, 'v');
      std::size_t row[2] = {1, n};
      put(mat, Mat_VarCreate("v", MAT_C_CHAR, MAT_T_UTF8, 2, row, text.data(), 0));
    } else if (kind == "cells") {
      std::size_t one[2] = {1, 1};
      std::vector<matvar_t*> cells;
      for (double& x : v)
        cells.push_back(Mat_VarCreate(nullptr, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, one, &x, 0));
      put(mat, Mat_VarCreate("v", MAT_C_CELL, MAT_T_CELL, 2, dims, cells.data(), 0));
    } else if (kind == "cube") {
      std::size_t cube[3] = {2, 2, 3};
      put(mat, Mat_VarCreate("v", MAT_C_DOUBLE, MAT_T_DOUBLE, 3, cube, v.data(), 0));
    } else if (kind == "scalar" || kind == "short") {
      dims[0] = kind == "scalar" ? 1 : n - 1;
      put(mat, Mat_VarCreate("v", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, v.data(), 0));
    } else {
      if (kind == "NaN") v[4] = std::numeric_limits<double>::quiet_NaN();
      put(mat, vector("v", v));
    }
  }

  TempFolder folder_;
  std::vector<Column> columns_;
  matio_compression compression_ = MAT_COMPRESSION_NONE;
};

/// What a case may pass a file through, by name.
std::string made(const std::string& how, const std::string& text) {
  using Filter = std::function<std::string(const std::string&)>;
  const auto swap = [](const std::string& from, const std::string& to) -> Filter {
    return [=](const std::string& s) { return all_replaced(s, from, to); };
  };
  const auto fixed = [](std::string s) -> Filter {
    return [s = std::move(s)](const std::string&) { return s; };
  };
  static const std::map<std::string, Filter> filters{
      {"byte-order mark", [](const std::string& s) { return "\xEF\xBB\xBF" + s; }},
      {"CRLF", swap("\n", "\r\n")},
      {"CR", swap("\n", "\r")},
      {"semicolons", swap(",", ";")},
      {"tabs", swap(",", "\t")},
      {"spaces", swap(",", " ")},
      {"blanks", swap(",", " , ")},
      {"quotes", swap("([^,\n]+)", "\"$1\"")},
      {"separators at the end", swap("\n", ",\n")},
      {"decimal commas", swap("\\.", ",")},
      {"decimal commas between semicolons",
       [](const std::string& s) { return all_replaced(all_replaced(s, ",", ";"), "\\.", ","); }},
      {"decimal commas between tabs",
       [](const std::string& s) { return all_replaced(all_replaced(s, ",", "\t"), "\\.", ","); }},
      {"one decimal comma between semicolons",
       [](const std::string& s) { return replaced(all_replaced(s, ",", ";"), "1.377", "1,377"); }},
      {"a column more", swap(",(\\d\\.\\d+)\n", ",$1,5\n")},
      {"no command", swap(",2,", ",0,")},
      {"a clipped sine", fixed(clipped_sine())},
      {"400 digits", swap("1\\.377", std::string(400, '7'))},
      {"a line of 1 MB", swap("1\\.377", repeated("1,", 1 << 19))},
      {"a header of 1 MB", swap("t,u,v", std::string(1 << 20, 't') + ",u,v")},
      {"seconds since 1970", [](const std::string& s) { return on_clock(s, "170000000", 3, "."); }},
      {"milliseconds since 1970",
       [](const std::string& s) { return on_clock(s, "170000000", 3, ""); }},
      {"nanoseconds since 1970",
       [](const std::string& s) { return on_clock(s, "170000000", 9, ""); }},
      {"UTF-16", [](const std::string& s) { return "\xFF\xFE" + utf16(s); }},
      {"UTF-16 without mark", utf16},
      {"Latin-1",
       [](const std::string& s) {
         return "# gr\xF6\xDF"
                "er\n" +
                s;
       }},
      {"Latin-1 in a number", swap("1\\.377", "1.377\xB5")},
      {"null bytes",
       [](const std::string& s) { return replaced(s, "1.377", std::string(5, '\0')); }},
      {"gzip", gzipped},
      {"zip", fixed(std::string("PK\x03\x04\x14\0\x06\0\x08\0", 10) + "[Content_Types].xml")},
      {"PNG", fixed(std::string("\x89PNG\r\n\x1A\n\0\0\0\rIHDR", 16) + repeated("\xC3\x28", 99))},
      {"nested lists", fixed("axis: " + std::string(100'000, '[') + "\n")},
      {"nested maps", fixed("axis: " + repeated("{a: ", 100'000) + "\n")},
      {"2 MB", [](const std::string& s) { return s + repeated("# nothing\n", 200'000); }},
      {"long text", [](const std::string& s) { return repeated(s, 40); }},
  };
  constexpr std::string_view kMat = "MATLAB";
  if (!how.starts_with(kMat)) return filters.at(how)(text);
  const std::string kind = how.substr(std::min(how.size(), kMat.size() + 1));
  const std::string good = MatWriter(text).write(kind);
  if (kind.starts_with("cut at ")) return good.substr(0, std::stoul(kind.substr(7)));
  if (kind.starts_with("cut by ")) return good.substr(0, good.size() - std::stoul(kind.substr(7)));
  std::string changed = good;
  if (kind == "version 9") changed[125] = 9;
  if (kind == "huge") changed[163] = '\x7F';  // the highest byte of the first size
  if (kind == "damaged") std::fill_n(changed.begin() + 130, 40, '\x5A');
  return changed;
}

}  // namespace

BadCases::BadCases(const std::string& path) : cases_(YAML::LoadFile(path)) {
  for (const auto& file : cases_["good"]) good_.emplace(file.first.Scalar(), file.second.Scalar());
}

std::vector<std::string> BadCases::families() const {
  std::vector<std::string> names;
  for (const auto& entry : cases_)
    if (entry.second.IsSequence()) names.push_back(entry.first.Scalar());
  return names;
}

InputFiles BadCases::files_of(const YAML::Node& node) const {
  InputFiles files = good_;
  for (const auto& entry : node) {
    const std::string name = entry.first.Scalar();
    if (name.find('.') == std::string::npos) continue;
    if (entry.second.IsMap())
      for (const auto& change : entry.second)
        files[name] = replaced(files[name], change.first.Scalar(), change.second.Scalar());
    else if (entry.second.Scalar() == "missing")
      files.erase(name);
    else
      files[name] = entry.second.Scalar();
  }
  for (const auto& entry : node["made"]) {
    const std::string name = entry.first.Scalar();
    const auto before = files.find(name);
    files[name] =
        made(entry.second.Scalar(), before == files.end() ? files.at("data.csv") : before->second);
  }
  return files;
}

}  // namespace axisfit
