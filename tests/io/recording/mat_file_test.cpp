#include "io/recording/mat_file.h"

#include <gtest/gtest.h>
#include <matio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

namespace axisfit {
namespace {

using Values = std::vector<double>;

// Which of libmatio's formats a test writes.
struct Format {
  const char* name;
  mat_ft version;
  matio_compression compression;
};

constexpr Format kPlain = {"V5", MAT_FT_MAT5, MAT_COMPRESSION_NONE};
constexpr Format kCompressed = {"V5Compressed", MAT_FT_MAT5, MAT_COMPRESSION_ZLIB};
constexpr Format kHdf5 = {"V73", MAT_FT_MAT73, MAT_COMPRESSION_NONE};

// Which element type in C++ belongs to which class and type of libmatio.
template <typename T>
struct MatType;
template <>
struct MatType<double> {
  static constexpr auto kClass = MAT_C_DOUBLE;
  static constexpr auto kType = MAT_T_DOUBLE;
};
template <>
struct MatType<float> {
  static constexpr auto kClass = MAT_C_SINGLE;
  static constexpr auto kType = MAT_T_SINGLE;
};
template <>
struct MatType<std::int8_t> {
  static constexpr auto kClass = MAT_C_INT8;
  static constexpr auto kType = MAT_T_INT8;
};
template <>
struct MatType<std::uint8_t> {
  static constexpr auto kClass = MAT_C_UINT8;
  static constexpr auto kType = MAT_T_UINT8;
};
template <>
struct MatType<std::int16_t> {
  static constexpr auto kClass = MAT_C_INT16;
  static constexpr auto kType = MAT_T_INT16;
};
template <>
struct MatType<std::uint16_t> {
  static constexpr auto kClass = MAT_C_UINT16;
  static constexpr auto kType = MAT_T_UINT16;
};
template <>
struct MatType<std::int32_t> {
  static constexpr auto kClass = MAT_C_INT32;
  static constexpr auto kType = MAT_T_INT32;
};
template <>
struct MatType<std::uint32_t> {
  static constexpr auto kClass = MAT_C_UINT32;
  static constexpr auto kType = MAT_T_UINT32;
};
template <>
struct MatType<std::int64_t> {
  static constexpr auto kClass = MAT_C_INT64;
  static constexpr auto kType = MAT_T_INT64;
};
template <>
struct MatType<std::uint64_t> {
  static constexpr auto kClass = MAT_C_UINT64;
  static constexpr auto kType = MAT_T_UINT64;
};

template <typename T>
matvar_t* array(const char* name, std::size_t rows, std::size_t cols, std::vector<T> values,
                int flags = 0) {
  if (values.size() != rows * cols) throw std::logic_error("array: wrong number of values");
  std::array<std::size_t, 2> dims = {rows, cols};
  return Mat_VarCreate(name, MatType<T>::kClass, MatType<T>::kType, 2, dims.data(), values.data(),
                       flags);
}

matvar_t* text(const char* name, std::string value) {
  std::array<std::size_t, 2> dims = {1, value.size()};
  return Mat_VarCreate(name, MAT_C_CHAR, MAT_T_UINT8, 2, dims.data(), value.data(), 0);
}

// Takes over the fields, which must have names.
matvar_t* structure(const char* name, const std::vector<matvar_t*>& fields) {
  std::vector<const char*> names;
  for (const matvar_t* field : fields) names.push_back(field->name);
  names.push_back(nullptr);
  const std::array<std::size_t, 2> dims = {1, 1};
  matvar_t* const result = Mat_VarCreateStruct2(name, 2, dims.data(), names.data());
  for (std::size_t i = 0; i < fields.size(); ++i) {
    Mat_VarSetStructFieldByIndex(result, i, 0, fields[i]);
  }
  return result;
}

// A directory of its own for each test, so that tests can run at the same time.
class MatFileTest : public ::testing::Test {
 protected:
  MatFileTest() {
    std::string name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    for (char& c : name) {
      if (c == '/') c = '.';
    }
    directory_ = std::filesystem::temp_directory_path() /
                 ("axisfit_mat_file_test." + std::to_string(::getpid()) + "." + name);
    std::filesystem::create_directories(directory_);
  }
  ~MatFileTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(directory_, ignored);
  }

  std::string path() const { return (directory_ / "rec.mat").string(); }

  // Writes and frees the variables. False if this libmatio cannot write the format.
  bool write(const Format& format, const std::vector<matvar_t*>& variables) const {
    mat_t* const mat = Mat_CreateVer(path().c_str(), nullptr, format.version);
    for (matvar_t* variable : variables) {
      if (variable == nullptr) throw std::logic_error("write: a variable was not created");
      if (mat != nullptr && Mat_VarWrite(mat, variable, format.compression) != 0) {
        throw std::logic_error("write: a variable was not written");
      }
      Mat_VarFree(variable);
    }
    return mat != nullptr && Mat_Close(mat) == 0;
  }

  void write_bytes(const std::string& bytes) const {
    std::ofstream(path(), std::ios::binary) << bytes;
  }

  std::string bytes() const {
    std::ifstream in(path(), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  // The message of the error of this action without the directory.
  template <typename Action>
  std::string error(Action action) const {
    try {
      action();
    } catch (const RecordingError& caught) {
      const std::string message = caught.what();
      const std::string prefix = directory_.string() + "/";
      return message.starts_with(prefix) ? message.substr(prefix.size()) : message;
    }
    return "no error";
  }

  std::string read_error() const {
    return error([this] { read_mat(path()); });
  }

  std::filesystem::path directory_;
};

const Values* values(const Table& mat, const std::string& name) {
  for (const Column& column : mat.columns) {
    if (column.name == name) return &column.values;
  }
  return nullptr;
}

std::string obstacle(const Table& mat, const std::string& name) {
  const Column* column = mat.find(name);
  return column == nullptr ? "not there" : column->obstacle;
}

std::size_t readable(const Table& mat) {
  return static_cast<std::size_t>(std::ranges::count(mat.columns, "", &Column::obstacle));
}

#define EXPECT_COLUMN(mat, name, ...)                    \
  do {                                                   \
    const Values* const found = values(mat, name);       \
    ASSERT_NE(found, nullptr) << "no column " << (name); \
    EXPECT_EQ(*found, (Values __VA_ARGS__));             \
  } while (false)

class MatFormats : public MatFileTest, public ::testing::WithParamInterface<Format> {};

INSTANTIATE_TEST_SUITE_P(All, MatFormats, ::testing::Values(kPlain, kCompressed, kHdf5),
                         [](const auto& format) { return std::string(format.param.name); });

TEST_P(MatFormats, ConvertsVectorsOfEveryNumericClass) {
  if (!write(
          GetParam(),
          {array<double>("d", 3, 1, {0.1, -2, 1e300}), array<float>("f", 1, 2, {0.5F, -1.25F}),
           array<std::int8_t>("i8", 2, 1, {-128, 127}), array<std::uint8_t>("u8", 2, 1, {0, 255}),
           array<std::int16_t>("i16", 1, 2, {-32768, 32767}),
           array<std::uint16_t>("u16", 2, 1, {0, 65535}),
           array<std::int32_t>("i32", 2, 1, {-2147483647, 2147483647}),
           array<std::uint32_t>("u32", 2, 1, {0, 4294967295U}),
           array<std::int64_t>("i64", 2, 1, {-(std::int64_t{1} << 53), 5}),
           array<std::uint64_t>("u64", 2, 1, {std::uint64_t{1} << 63, 5}),
           array<std::uint8_t>("flag", 4, 1, {0, 1, 1, 0}, MAT_F_LOGICAL)})) {
    GTEST_SKIP() << "this libmatio cannot write the format";
  }
  const Table mat = read_mat(path());
  EXPECT_EQ(mat.file, path());
  EXPECT_EQ(mat.columns.size(), 11u);
  EXPECT_EQ(readable(mat), mat.columns.size());
  EXPECT_COLUMN(mat, "d", {0.1, -2, 1e300});
  EXPECT_COLUMN(mat, "f", {0.5, -1.25});
  EXPECT_COLUMN(mat, "i8", {-128, 127});
  EXPECT_COLUMN(mat, "u8", {0, 255});
  EXPECT_COLUMN(mat, "i16", {-32768, 32767});
  EXPECT_COLUMN(mat, "u16", {0, 65535});
  EXPECT_COLUMN(mat, "i32", {-2147483647, 2147483647});
  EXPECT_COLUMN(mat, "u32", {0, 4294967295});
  EXPECT_COLUMN(mat, "i64", {-9007199254740992, 5});
  EXPECT_COLUMN(mat, "u64", {9223372036854775808.0, 5});
  EXPECT_COLUMN(mat, "flag", {0, 1, 1, 0});
}

TEST_P(MatFormats, SplitsMatricesAlongTheirLongerSide) {
  if (!write(GetParam(), {array<double>("tall", 3, 2, {1, 2, 3, 4, 5, 6}),
                          array<double>("wide", 2, 3, {1, 2, 3, 4, 5, 6}),
                          array<double>("square", 2, 2, {1, 2, 3, 4})})) {
    GTEST_SKIP() << "this libmatio cannot write the format";
  }
  const Table mat = read_mat(path());
  EXPECT_EQ(mat.columns.size(), 6u);
  EXPECT_COLUMN(mat, "tall(:,1)", {1, 2, 3});
  EXPECT_COLUMN(mat, "tall(:,2)", {4, 5, 6});
  EXPECT_COLUMN(mat, "wide(1,:)", {1, 3, 5});
  EXPECT_COLUMN(mat, "wide(2,:)", {2, 4, 6});
  EXPECT_COLUMN(mat, "square(:,1)", {1, 2});
  EXPECT_COLUMN(mat, "square(:,2)", {3, 4});
}

TEST_P(MatFormats, ReadsFieldsOfStructsAtAnyDepth) {
  if (!write(GetParam(),
             {structure("rec", {array<double>("t", 2, 1, {0, 1}), array<double>("fs", 1, 1, {1000}),
                                text("unit", "rad"),
                                structure("motor", {array<double>("q", 2, 1, {2, 3})})})})) {
    GTEST_SKIP() << "this libmatio cannot write the format";
  }
  const Table mat = read_mat(path());
  EXPECT_EQ(readable(mat), 2u);
  EXPECT_COLUMN(mat, "rec.t", {0, 1});
  EXPECT_COLUMN(mat, "rec.motor.q", {2, 3});
  EXPECT_EQ(obstacle(mat, "rec.fs"), "is a scalar");
  EXPECT_EQ(obstacle(mat, "rec.unit"), "is text");
}

TEST_P(MatFormats, RemembersWhatItCannotRead) {
  std::array<double, 2> part = {1, 2};
  mat_complex_split_t complex = {part.data(), part.data()};
  std::array<std::size_t, 2> two = {2, 1};
  std::array<std::size_t, 2> none = {0, 0};
  std::array<std::size_t, 3> cube = {2, 2, 2};
  std::array<double, 8> cube_values = {};
  std::array<matvar_t*, 2> cells = {array<double>(nullptr, 2, 1, {1, 2}), text(nullptr, "x")};
  if (!write(
          GetParam(),
          {array<double>("fs", 1, 1, {1000}), text("note", "warm"),
           Mat_VarCreate("z", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, two.data(), &complex, MAT_F_COMPLEX),
           Mat_VarCreate("none", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, none.data(), nullptr, 0),
           Mat_VarCreate("cube", MAT_C_DOUBLE, MAT_T_DOUBLE, 3, cube.data(), cube_values.data(), 0),
           Mat_VarCreate("cells", MAT_C_CELL, MAT_T_CELL, 2, two.data(), cells.data(), 0),
           array<double>("q", 2, 1, {3, 4})})) {
    GTEST_SKIP() << "this libmatio cannot write the format";
  }
  const Table mat = read_mat(path());
  EXPECT_EQ(readable(mat), 1u);
  EXPECT_COLUMN(mat, "q", {3, 4});
  EXPECT_EQ(obstacle(mat, "fs"), "is a scalar");
  EXPECT_EQ(obstacle(mat, "note"), "is text");
  EXPECT_EQ(obstacle(mat, "z"),
            "is a complex array; in MATLAB 'z = real(z)' converts it, before save");
  EXPECT_EQ(obstacle(mat, "none"), "is an empty array");
  EXPECT_EQ(
      obstacle(mat, "cube"),
      "is an array of more than two dimensions; in MATLAB 'cube = squeeze(cube)' converts it, "
      "before save");
  EXPECT_EQ(obstacle(mat, "cells"),
            "is a cell array; in MATLAB 'cells = cell2mat(cells)' converts it, before save");
}

// Nothing may pass as data that the file does not hold: libmatio fills up with zeros.
TEST_P(MatFormats, NoticesEveryCutInsideTheData) {
  Values ramp(2000);
  for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = 0.37 * static_cast<double>(i);
  if (!write(GetParam(), {array<double>("q", ramp.size(), 1, ramp)})) {
    GTEST_SKIP() << "this libmatio cannot write the format";
  }
  const std::string whole = bytes();
  ::testing::internal::CaptureStderr();
  for (std::size_t size = 0; size < whole.size(); size += size < 1000 ? 37 : 509) {
    write_bytes(whole.substr(0, size));
    EXPECT_THROW(read_mat(path()), RecordingError) << size << " of " << whole.size() << " bytes";
  }
  write_bytes(whole.substr(0, whole.size() - 1));
  EXPECT_THROW(read_mat(path()), RecordingError);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");

  write_bytes(whole);
  EXPECT_EQ(read_mat(path()).columns.at(0).values, ramp);
}

TEST_F(MatFileTest, NamesTheVariableThatIsCutOff) {
  ASSERT_TRUE(write(kCompressed, {array<double>("t", 2, 1, {0, 1}),
                                  array<double>("q", 1000, 1, Values(1000, 0.1))}));
  write_bytes(bytes().substr(0, bytes().size() - 10));
  EXPECT_EQ(read_error(),
            "rec.mat: variable 'q': the file is damaged or truncated (libmatio: InflateData: "
            "Read beyond EOF error: Processed 5168 bytes, expected 8000 bytes); save or copy it "
            "again");
}

TEST_F(MatFileTest, AFileThatCrashesHdf5IsRefused) {
  try {
    read_mat(AXISFIT_TESTDATA "/bad/damaged-7.3.mat");
    ADD_FAILURE() << "nothing was wrong with it";
  } catch (const RecordingError& error) {
    EXPECT_EQ(std::string(error.what()), AXISFIT_TESTDATA
              "/bad/damaged-7.3.mat: the file is damaged: libmatio cannot read it; save or copy "
              "it again");
  }
}

TEST_F(MatFileTest, TellsWhatIsWrongWithAFile) {
  EXPECT_EQ(read_error(),
            "rec.mat: cannot be opened (No such file or directory); check the path and the "
            "permissions");
  write_bytes("");
  EXPECT_EQ(read_error(), "rec.mat: the file is empty; save or copy it again");
  write_bytes("time,position\n0,1\n");
  EXPECT_EQ(read_error(),
            "rec.mat: is not a MAT-file; save the recording with MATLAB's save or as CSV");
  EXPECT_THROW(read_mat(directory_.string()), RecordingError);

  ASSERT_TRUE(write(kPlain, {}));
  EXPECT_EQ(read_error(), "rec.mat: contains no variables; it may be truncated or not a MAT-file");
}

// The elements of a version 5 file, for what libmatio cannot write. Little-endian like the header
// below says, whatever the machine.
std::string little_endian(std::uint32_t value) {
  std::string result;
  for (int shift = 0; shift < 32; shift += 8) {
    result += static_cast<char>((value >> shift) & 0xFFU);
  }
  return result;
}

std::string element(std::uint32_t type, std::string content) {
  const std::string tag =
      little_endian(type) + little_endian(static_cast<std::uint32_t>(content.size()));
  content.resize((content.size() + 7) / 8 * 8);
  return tag + content;
}

std::string uint8_variable(const std::string& name, const std::string& data) {
  const auto size = static_cast<std::uint32_t>(data.size());
  return element(14, element(6, little_endian(9) + little_endian(0)) +
                         element(5, little_endian(size) + little_endian(1)) + element(1, name) +
                         element(2, data));
}

TEST_F(MatFileTest, ReadsTheArraysBesideATable) {
  std::string header = "MATLAB 5.0 MAT-file";
  header.resize(116, ' ');
  header += std::string(8, '\0') + std::string("\x00\x01IM", 4);
  const std::string table =
      element(14, element(6, little_endian(17) + little_endian(0)) + element(1, "T") +
                      element(1, "MCOS") + element(1, "table") + uint8_variable("", "123456"));
  const std::string contents_of_objects = uint8_variable("", std::string(64, '\x07'));
  write_bytes(header + uint8_variable("q", "\x01\x02") + table + uint8_variable("u", "\x03\x04") +
              contents_of_objects);

  const Table mat = read_mat(path());
  EXPECT_EQ(readable(mat), 2u);
  EXPECT_COLUMN(mat, "q", {1, 2});
  EXPECT_COLUMN(mat, "u", {3, 4});
  ASSERT_EQ(mat.columns.size(), 3u);
  EXPECT_EQ(
      obstacle(mat, ""),
      "is a table, timetable, timeseries or another object, which MATLAB alone can read; there "
      "'x = table2struct(x, \"ToScalar\", true)' converts a table x, and 'y = x.Data; t = "
      "x.Time' a timeseries, before save");
}

}  // namespace
}  // namespace axisfit
