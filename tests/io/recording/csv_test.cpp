#include "io/recording/csv.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <bit>
#include <cfloat>
#include <clocale>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <locale>
#include <random>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace axisfit {
namespace {

// A directory of its own for each test, so that tests can run at the same time.
class TableTest : public ::testing::Test {
 protected:
  TableTest() {
    const auto* const info = ::testing::UnitTest::GetInstance()->current_test_info();
    directory_ = std::filesystem::temp_directory_path() /
                 ("axisfit_table_test." + std::to_string(::getpid()) + "." + info->name());
    std::filesystem::create_directories(directory_);
  }
  ~TableTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(directory_, ignored);
  }

  std::string path() const { return (directory_ / "rec.csv").string(); }

  Table read(std::string_view text) const {
    std::ofstream(path(), std::ios::binary) << text;
    return read_csv(path());
  }

  // The message of the error for this text, without the directory.
  std::string error(std::string_view text) const {
    try {
      read(text);
    } catch (const RecordingError& caught) {
      return without_directory(caught.what());
    }
    return "no error";
  }

  std::string without_directory(const std::string& message) const {
    const std::string prefix = directory_.string() + "/";
    return message.starts_with(prefix) ? message.substr(prefix.size()) : message;
  }

  std::filesystem::path directory_;
};

using Values = std::vector<double>;

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

TEST_F(TableTest, ReadsNamesValuesAndLines) {
  const Table table = read("time,position\n0,1.5\n0.001,-2e-3\n");
  EXPECT_EQ(table.file, path());
  ASSERT_EQ(table.columns.size(), 2u);
  EXPECT_EQ(table.columns[0].name, "time");
  EXPECT_EQ(table.columns[0].values, (Values{0, 0.001}));
  EXPECT_EQ(table.columns[1].values, (Values{1.5, -2e-3}));
  EXPECT_EQ(table.rows(), 2u);
  EXPECT_EQ(table.lines, (std::vector<std::size_t>{2, 3}));
  EXPECT_EQ(table.where(1), path() + ":3");
}

TEST_F(TableTest, FindsColumnsByExactName) {
  const Table table = read("q,Q\n1,2\n");
  EXPECT_EQ(table.find("Q"), &table.columns[1]);
  EXPECT_EQ(table.find("x"), nullptr);
  EXPECT_EQ(table.find(""), nullptr);
}

TEST_F(TableTest, AcceptsWhatSpreadsheetsAndLoggersWrite) {
  const std::vector<std::string_view> variants = {
      "a,b\n1,2\n3,-4\n",  // plain
      "a,b\n1,2\n3,-4",    // no line end at the end
      // Two literals: the escape would go on. NOLINTNEXTLINE(bugprone-suspicious-missing-comma)
      "\xEF\xBB\xBF"
      "a,b\r\n1,2\r\n3,-4\r\n",                // byte-order mark, CRLF
      "a,b\n1,2\n3,-4\n\n \t\r\n\n",           // blank lines at the end
      "a;b\n1;2\n3;-4\n",                      // semicolons
      "a\tb\n1\t2\n3\t-4\n",                   // tabs
      "\"a\",\"b\"\n\"1\",2\n 3 , \"-4\" \n",  // quotes and blanks
      " a , b \n 1 , 2 \n\t3\t,\t-4\t\n",      // blanks
      "\"a\"\t b \n 1\t\"2\"\n3 \t -4\n",      // the same with tabs
      "a,b\n+1,2.\n3.0e0,-4E+00\n",            // other spellings of the numbers
      "a;b\n1,0;+2\n3;-4,00e0\n",              // decimal commas
      "a,b,\n1,2,\n3,-4, \n",                  // separators at the end of every line
  };
  for (const std::string_view text : variants) {
    SCOPED_TRACE(text);
    const Table table = read(text);
    ASSERT_EQ(table.columns.size(), 2u);
    EXPECT_EQ(table.columns[0].name, "a");
    EXPECT_EQ(table.columns[1].name, "b");
    EXPECT_EQ(table.columns[0].values, (Values{1, 3}));
    EXPECT_EQ(table.columns[1].values, (Values{2, -4}));
    EXPECT_EQ(table.lines, (std::vector<std::size_t>{2, 3}));
  }
}

TEST_F(TableTest, SkipsCommentsAboveTheNames) {
  for (const char* text : {"# rig 7\n#\nt,x\n1,2\n3,4\n", "% rig, 7\n% t,x\n1,2\n3,4\n",
                           "// rig 7\n// 2 kHz\nt,x\ns,m\n1,2\n3,4\n", "# t,x\n1,2\n3,4\n",
                           "#t,x\r\n-1,2\r\n3,4\r\n"}) {
    SCOPED_TRACE(text);
    const Table table = read(text);
    ASSERT_EQ(table.columns.size(), 2u);
    EXPECT_EQ(table.columns[0].name, "t");
    EXPECT_EQ(table.columns[1].name, "x");
    EXPECT_EQ(table.columns[1].values, (std::vector{2.0, 4.0}));
  }
  EXPECT_EQ(read("# rig\nt,x\n1,2\n3,4\n").lines, (std::vector<std::size_t>{3, 4}));
}

TEST_F(TableTest, ReadsARowOfUnits) {
  for (const char* text :
       {"t;v;k\ns;mm/s;\n0,5;1;2\n1;2,5;3\n", "t,v,k\ns,mm/s,\n0.5,1,2\n1,2.5,3\n",
        "t\tv\tk\n[s]\t[mm/s]\t-\n0.5\t1\t2\n1\t2.5\t3\n",
        "Rig 7, Axis 2\nmade by hand\n\nt,v,k\ns,mm/s,\n0.5,1,2\n1,2.5,3\n"}) {
    SCOPED_TRACE(text);
    const Table table = read(text);
    ASSERT_EQ(table.columns.size(), 3u);
    EXPECT_EQ(table.columns[0].name, "t");
    EXPECT_EQ(table.columns[0].unit, "s");
    EXPECT_EQ(table.columns[1].unit, "mm/s");
    EXPECT_EQ(table.columns[2].unit, "");
    EXPECT_EQ(table.columns[1].values, (Values{1, 2.5}));
  }
}

TEST_F(TableTest, TellsWhatAColumnHoldsBesidesNumbers) {
  const auto obstacle = [&](std::string_view text, std::size_t column) {
    return read(text).columns.at(column).obstacle;
  };
  EXPECT_EQ(obstacle("t,v\n0,abc\n1,2\n", 1),
            "has 'abc' in line 2, which is no number; correct it or leave the field blank");
  EXPECT_EQ(
      obstacle("t;v\n0,5;1\n1;1.5\n", 1),
      "has '1.5' in line 3, with a decimal point, but other numbers have a decimal comma; use "
      "one of them throughout");
  EXPECT_EQ(obstacle("t,v\n0,1\n1,1e999\n", 1),
            "has '1e999' in line 3, which is out of the range of a double; choose another unit or "
            "fix the number");
  EXPECT_EQ(obstacle("t,v\n0,1\n1,inf\n", 1),
            "has 'inf' in line 3, which is not finite; remove the row or cut the recording there");
  EXPECT_EQ(obstacle("t,v\n0,\n1,nan\n", 1), "has no values");
  EXPECT_EQ(obstacle("t,v\n0,abc\n1,2\n", 0), "");
}

TEST_F(TableTest, TakesNothingElseForANumber) {
  for (const char* text : {"1 2", "1.2.3", "0x10", "1e", ".", "+", "+-1", "--1", "1,000,000",
                           "1.000,5", "1,5e", ",", "1d3", "12 s", "inf", "-Infinity", "1e-999"}) {
    SCOPED_TRACE(text);
    const Table table = read(std::string("a;b\n0;7\n1;8\n2;") + text + "\n");
    ASSERT_EQ(table.columns.size(), 2u);
    EXPECT_FALSE(table.columns[1].obstacle.empty());
  }
}

TEST_F(TableTest, MissingValuesAreNaN) {
  for (const char* missing :
       {"", "NaN", "nan", "N/A", "#N/A", "NULL", "none", "-", "NaN(1)", "\"\""}) {
    SCOPED_TRACE(missing);
    const Table table = read(std::string("t,v\n0,1\n1,") + missing + "\n2,3\n");
    EXPECT_EQ(table.columns[1].obstacle, "");
    EXPECT_EQ(table.rows(), 3u);
    EXPECT_TRUE(std::isnan(table.columns[1].values[1]));
    EXPECT_EQ(table.columns[1].values[2], 3.0);
  }
}

TEST_F(TableTest, TrueAndFalseAreNumbers) {
  EXPECT_EQ(read("t,on\n0,TRUE\n1,false\n").columns[1].values, (Values{1, 0}));
}

TEST_F(TableTest, ReadsDatesAndTimes) {
  const Values iso = read("Timestamp;v\n2026-03-16T17:04:51.25Z;1\n2026-03-16 18:04:51,5+01:00;2\n")
                         .columns[0]
                         .values;
  EXPECT_EQ(iso, (Values{1773680691.25, 1773680691.5}));
  EXPECT_EQ(read("clock;v\n10:15:30.125;1\n10:15:31;2\n").columns[0].values,
            (Values{36930.125, 36931.0}));
  for (const char* wrong : {"2026-13-16T17:04:51", "2026-03-16", "24:00:00", "10:15", "10:61:00"})
    EXPECT_NE(read(std::string("c;v\n0;0\n1;1\n") + wrong + ";2\n").columns[0].obstacle, "")
        << wrong;
}

TEST_F(TableTest, QuotedNamesMayHoldDelimitersAndQuotes) {
  const Table table = read("\"q (rad, motor)\";\"the \"\"raw\"\" one\"\n1;2\n");
  ASSERT_EQ(table.columns.size(), 2u);
  EXPECT_EQ(table.columns[0].name, "q (rad, motor)");
  EXPECT_EQ(table.columns[1].name, "the \"raw\" one");
}

TEST_F(TableTest, ColumnsMayLackNames) {
  for (const char* text : {"0,1.5\n0.001,-2e-3\n", "0\t1.5\n0.001\t-2e-3\n", "0 1.5\n0.001 -2e-3\n",
                           "a recording\n\n0,1.5\n0.001,-2e-3\n"}) {
    SCOPED_TRACE(text);
    const Table table = read(text);
    ASSERT_EQ(table.columns.size(), 2u);
    EXPECT_EQ(table.columns[0].name, "");
    EXPECT_EQ(table.columns[1].values, (Values{1.5, -2e-3}));
  }
  EXPECT_EQ(read("t,,q\n0,1,2\n").columns[1].name, "");
  EXPECT_EQ(read("t,q,t\n0,1,2\n").columns[2].name, "t");
}

TEST_F(TableTest, ReadsWindowsAndUtf16AndGzip) {
  EXPECT_EQ(read("Gr\xF6\xDF"
                 "e;x\n1;2\n")
                .columns[0]
                .name,
            "Größe");
  std::string wide = "\xFF\xFE";
  for (const char c : std::string_view("t;x\n1;2,5\n")) wide += {c, '\0'};
  EXPECT_EQ(read(wide).columns[1].values, (Values{2.5}));
  const std::string packed = path() + ".gz";
  const gzFile file = gzopen(packed.c_str(), "wb");
  gzputs(file, "t,x\n1,2\n");
  gzclose(file);
  EXPECT_EQ(read_csv(packed).columns[1].values, (Values{2}));
}

TEST_F(TableTest, BlanksMaySeparate) {
  const Table table = read("t  x   y\n 0  1.5 2\n 1 2.5   3\n");
  ASSERT_EQ(table.columns.size(), 3u);
  EXPECT_EQ(table.columns[1].name, "x");
  EXPECT_EQ(table.columns[1].values, (Values{1.5, 2.5}));
  EXPECT_EQ(read("0,5 1,5\n1 2,5\n2 3,5\n").columns[1].values, (Values{1.5, 2.5, 3.5}));
}

TEST_F(TableTest, KeepsTheTextOfTheFileInMessagesShort) {
  const Table table = read("a\n1\n2\n3\nx\x1B[31m" + std::string(500, 'y') + "1\n");
  EXPECT_LT(table.columns[0].obstacle.size(), 200u);
}

TEST_F(TableTest, TellsWhichColumnARowLacksOrExceeds) {
  EXPECT_EQ(error("t,q,u\n0,1,2\n1,2\n"),
            "rec.csv:3: 2 fields for the 3 columns of the header, none for column 'u'; complete or "
            "remove the row");
  EXPECT_EQ(error("t,q,u\n0,1\n1,2\n"),
            "rec.csv:2: 2 fields for the 3 columns of the header, none for column 'u'; complete or "
            "remove the row");
  EXPECT_EQ(error("t,x\n0,1\n1,2,3\n"),
            "rec.csv:3: 3 fields for the 2 columns of the header, more after column 'x'; name them "
            "or remove them; or, if these are decimal commas, separate the fields by semicolons");
  EXPECT_EQ(error("t\n0\n1,2\n"),
            "rec.csv:3: 2 fields for the 1 column of the header, more after column 't'; name them "
            "or remove them; or, if these are decimal commas, separate the fields by semicolons");
  EXPECT_EQ(read("t,q,\n0,1,,,\n1,2\n").columns.size(), 2u);
  EXPECT_EQ(read("t,q\n,\n0,1\n,\n1,2\n").rows(), 2u);
}

TEST_F(TableTest, ARowReadsAlikeWhereverItStands) {
  // The first thousand rows are split into fields; below them plain rows are read in one go.
  std::string above = "a,b\n";
  for (int i = 0; i < 1100; ++i) above += "0,0.5\n";
  const auto last_row = [&](const std::string& text) {
    const std::string message = error(text);
    if (message != "no error") return message.substr(message.find(' '));
    const Table table = read(text);
    std::string values;
    for (const Column& column : table.columns)
      values += std::to_string(column.values.back()) + (column.obstacle.empty() ? " " : "! ");
    return values;
  };
  for (const char* const row :
       {"1,-2.5e3", "+1,-2500", " 1 ,\t-2500 ", "\"1\",-2500", "1,-2500\r", "1", "1,2,3", "1,2,",
        "1,", ",2", "1,inf", "1,nan", "1,2x", "1e999,2", "0x1,2", "1;2", "\"1,2", "1,2 3"})
    EXPECT_EQ(last_row(std::string("a,b\n0,0.5\n0,0.5\n0,0.5\n") + row + "\n"),
              last_row(above + row + "\n"))
        << row;
}

TEST_F(TableTest, LinesBetweenRowsDoNotCountUnlessTheyAreText) {
  EXPECT_EQ(read("t\r\n0\r\n\r\n# pause\r\n1\r\n").columns[0].values, (Values{0, 1}));
  EXPECT_EQ(read("t,x\n0,1\n1,2\nEOF\n").rows(), 2u);
  EXPECT_EQ(error("t,x\n0,1\n1,2\nt,x\n0,1\n1,2\n2,3\n3,4\n4,5\n5,6\n6,7\n7,8\n8,9\n9,9\n"),
            "rec.csv:4: 't' is no row of numbers, but rows follow; remove the line, or the rows of "
            "another recording");
}

TEST_F(TableTest, RefusesUnusableFiles) {
  EXPECT_EQ(error("\"t,q\n0,1\n"),
            "rec.csv:1: field 1: the quotes are not balanced; close them before the next separator "
            "and on the same line");
  for (const char* text : {"", "\n\r\n", "\xEF\xBB\xBF"})
    EXPECT_EQ(error(text), "rec.csv: the file is empty; record or export it again");
  for (const char* text : {"t,q", "t,q\n", "t,q\r\n\r\n"})
    EXPECT_EQ(
        error(text),
        "rec.csv:1: there are no rows of numbers below this line; check how it was recorded or "
        "exported");
  EXPECT_EQ(error("t,q\r0,1\r"),
            "rec.csv:1: lines end in a carriage return alone; save the file with line feeds");
  EXPECT_EQ(error(std::string_view("t,q\n0,1\0\n", 9)),
            "rec.csv: is not a text file (it holds null bytes); export the recording as CSV");
  EXPECT_EQ(error("MDF     4.10"),
            "rec.csv: is a measurement file (MDF4); convert it to CSV or MATLAB with asammdf "
            "('asammdf', File, Export) or the tool that recorded it");
  EXPECT_EQ(error("TDSm1234"),
            "rec.csv: is a TDMS file of LabVIEW; convert it to CSV with npTDMS ('tdmsinfo', "
            "TdmsFile.as_dataframe().to_csv()) or with DIAdem");
  EXPECT_EQ(error("\x1F\x8B\x08 no gzip"),
            "rec.csv: is damaged: it cannot be unpacked; copy it again");
}

TEST_F(TableTest, RefusesFilesThatCannotBeOpened) {
  try {
    read_csv(path());
    FAIL() << "no error";
  } catch (const RecordingError& caught) {
    EXPECT_EQ(without_directory(caught.what()),
              "rec.csv: cannot be opened (No such file or directory); check the path and the "
              "permissions");
  }
  EXPECT_THROW(read_csv(directory_.string()), RecordingError);
  ASSERT_EQ(::mkfifo(path().c_str(), 0600), 0);  // nobody writes to it
  EXPECT_THROW(read_csv(path()), RecordingError);
}

TEST_F(TableTest, ReadsFilesLargerThanOneChunk) {
  std::string text = "t,q\n";
  constexpr std::size_t kRows = 200000;
  for (std::size_t i = 0; i < kRows; ++i) text += std::to_string(i) + ",0.25\n";
  const Table table = read(text);
  ASSERT_EQ(table.rows(), kRows);
  EXPECT_EQ(table.columns[0].values.back(), kRows - 1.0);
  EXPECT_EQ(table.lines.back(), kRows + 1);
}

TEST(Table, WithoutColumnsHasNoRows) { EXPECT_EQ(Table{}.rows(), 0u); }

TEST(Table, NamesRowsWhenThereAreNoLines) {
  EXPECT_EQ((Table{"rec.mat", {{"t", {0, 1}}}, {}}).where(1), "rec.mat: row 2");
}

TEST(RecordingError, NamesTheLineOnlyWhenThereIsOne) {
  EXPECT_STREQ(RecordingError("rec.csv", 17, "no").what(), "rec.csv:17: no");
  EXPECT_STREQ(RecordingError("rec.csv", 0, "no").what(), "rec.csv: no");
}

std::string written(const Table& table, int significant_digits = 0) {
  std::ostringstream out;
  write_csv(out, table.columns, significant_digits);
  return out.str();
}

TEST(WriteCsv, WritesTheShortestExactOrTheRequestedDigits) {
  const Table table{"", {{"a", {0.1, 1e22, 100}}, {"b", {1.0 / 3, -0.0, 2}}}, {}};
  EXPECT_EQ(written(table), "a,b\n0.1,0.3333333333333333\n1e+22,-0\n100,2\n");
  EXPECT_EQ(written(table, 3), "a,b\n0.1,0.333\n1e+22,-0\n100,2\n");
}

TEST(WriteCsv, LeavesNoValueEmptyAndQuotesNamesThatNeedIt) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(written({"", {{"m(:,1)", {nan, 1}}, {"the \"raw\" one", {2, nan}}}, {}}),
            "\"m(:,1)\",\"the \"\"raw\"\" one\"\n,2\n1,\n");
}

TEST(WriteCsv, RefusesWhatTheProgramGotWrong) {
  EXPECT_THROW(written({"", {{"a", {1}}, {"b", {}}}, {}}), std::logic_error);
  EXPECT_THROW(written({"", {{"a", {1}}}, {}}, -1), std::logic_error);
  EXPECT_THROW(written({"", {{"a", {1}}}, {}}, 18), std::logic_error);
}

// All kinds of doubles: every exponent, subnormal numbers, both zeros and the limits.
Values many_doubles() {
  Values values = {0.0,      -0.0,    1.0,      0.1,           DBL_MIN,
                   -DBL_MIN, DBL_MAX, -DBL_MAX, DBL_TRUE_MIN,  9007199254740993.0,
                   1e22,     1e23,    5e-324,   123456789e-15, 0.30000000000000004};
  std::mt19937_64 bits(1);
  while (values.size() < 20000) {
    const std::uint64_t pattern = bits();
    double value = 0;
    std::memcpy(&value, &pattern, sizeof value);
    if (std::isfinite(value)) values.push_back(value);
  }
  return values;
}

TEST_F(TableTest, RoundTripIsExact) {
  const Table table{"", {{"v", many_doubles()}}, {}};
  for (const int digits : {0, 17}) {
    const Table copy = read(written(table, digits));
    ASSERT_EQ(copy.rows(), table.rows());
    for (std::size_t i = 0; i < table.rows(); ++i) {
      ASSERT_TRUE(same_bits(copy.columns[0].values[i], table.columns[0].values[i])) << i;
    }
  }
}

// Decimal commas and thousands points, whether or not the machine has a German locale.
class GermanNumbers : public std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST_F(TableTest, LocaleDoesNotMatter) {
  const std::locale before = std::locale::global(std::locale(std::locale(), new GermanNumbers));
  const std::string c_before = std::setlocale(LC_ALL, nullptr);
  std::setlocale(LC_ALL, "de_DE.UTF-8");  // as far as there is one

  const Table table{"", {{"t", {1234567.25, 0.5}}}, {}};
  const std::string text = written(table);
  const Table copy = read(text);
  std::string message = error("t,u\n0,1\n" + std::string(2000, '\n') + "1\n");

  std::setlocale(LC_ALL, c_before.c_str());
  std::locale::global(before);
  EXPECT_EQ(text, "t\n1234567.25\n0.5\n");
  EXPECT_EQ(copy.columns[0].values, table.columns[0].values);
  EXPECT_TRUE(message.starts_with("rec.csv:2003: ")) << message;
}

}  // namespace
}  // namespace axisfit
