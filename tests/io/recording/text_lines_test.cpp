#include "io/recording/text_lines.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <zlib.h>

#include <string>
#include <string_view>

#include "tests/io/recording/table_fixture.h"

namespace axisfit {
namespace {

using TextLinesTest = TableTest;

TEST_F(TextLinesTest, ReadsWindowsAndUtf16AndGzip) {
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

TEST_F(TextLinesTest, RefusesUnusableFiles) {
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

TEST_F(TextLinesTest, RefusesFilesThatCannotBeOpened) {
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

TEST_F(TextLinesTest, ReadsFilesLargerThanOneChunk) {
  std::string text = "t,q\n";
  constexpr std::size_t kRows = 200000;
  for (std::size_t i = 0; i < kRows; ++i) text += std::to_string(i) + ",0.25\n";
  const Table table = read(text);
  ASSERT_EQ(table.rows(), kRows);
  EXPECT_EQ(table.columns[0].values.back(), kRows - 1.0);
  EXPECT_EQ(table.lines.back(), kRows + 1);
}

TEST_F(TextLinesTest, TheRestIsWhatNoLineWasTakenOf) {
  std::ofstream(path(), std::ios::binary) << "a\n" << std::string(3 << 20, 'b') << "\nc";
  TextLines lines(path());
  EXPECT_TRUE(lines.ahead().starts_with("a\nb"));
  std::string_view line;
  ASSERT_TRUE(lines.next(line));
  EXPECT_TRUE(lines.ahead().starts_with("bbb"));
  EXPECT_EQ(lines.rest(), std::string(3 << 20, 'b') + "\nc");
  EXPECT_FALSE(lines.next(line));
}

TEST_F(TextLinesTest, TheRestIsInProportionToTheFile) {
  const gzFile file = gzopen(path().c_str(), "wb");
  const std::string nothing(1 << 20, ' ');
  for (int i = 0; i < 50; ++i) gzwrite(file, nothing.data(), 1 << 20);
  gzclose(file);
  try {
    TextLines(path()).rest();
    FAIL() << "no error";
  } catch (const RecordingError& caught) {
    EXPECT_EQ(without_directory(caught.what()),
              "rec.csv: unpacks to more than a hundred times its size; unpack it, and look whether "
              "it is a recording");
  }
}

}  // namespace
}  // namespace axisfit
