#include "io/recording/xlsx_file.h"

#include <gtest/gtest.h>
#include <minizip/zip.h>

#include <cmath>
#include <map>

#include "tests/apps/files.h"

namespace axisfit {
namespace {

using Parts = std::map<std::string, std::string>;

class XlsxTest : public ::testing::Test {
 protected:
  /// A workbook of one sheet with these parts besides, or instead.
  std::string workbook(const std::string& sheet_data, const Parts& more = {}) {
    Parts parts{
        {"xl/workbook.xml",
         R"(<workbook xmlns:r="r"><sheets><sheet name="Log" sheetId="1" r:id="rId1"/></sheets></workbook>)"},
        {"xl/_rels/workbook.xml.rels",
         R"(<Relationships><Relationship Id="rId1" Target="worksheets/sheet1.xml"/></Relationships>)"},
        {"xl/worksheets/sheet1.xml",
         "<worksheet><sheetData>" + sheet_data + "</sheetData></worksheet>"}};
    for (const auto& [name, text] : more) parts[name] = text;
    const std::string path = folder_.path("book.xlsx");
    zipFile zip = zipOpen64(path.c_str(), APPEND_STATUS_CREATE);
    for (const auto& [name, text] : parts) {
      zipOpenNewFileInZip(zip, name.c_str(), nullptr, nullptr, 0, nullptr, 0, nullptr, Z_DEFLATED,
                          6);
      zipWriteInFileInZip(zip, text.data(), static_cast<unsigned>(text.size()));
      zipCloseFileInZip(zip);
    }
    zipClose(zip, nullptr);
    return path;
  }

  static std::vector<std::vector<std::string>> rows(const std::string& path) {
    XlsxRows sheet(path);
    std::vector<std::vector<std::string>> all;
    for (std::vector<std::string> fields; sheet.next(fields);) all.push_back(fields);
    return all;
  }

  template <class Read>
  std::string error(Read&& read) const {
    try {
      read();
    } catch (const RecordingError& caught) {
      return folder_.without_path(caught.what());
    }
    return "no error";
  }

  TempFolder folder_;
};

using Rows = std::vector<std::vector<std::string>>;

TEST_F(XlsxTest, ReadsWhatAWriterOfWorkbooksWrites) {
  const Table table = read_xlsx(std::string(AXISFIT_TESTDATA) + "/xlsx/recording.xlsx");
  ASSERT_EQ(table.columns.size(), 6u);
  EXPECT_EQ(table.rows(), 50u);
  EXPECT_EQ(table.lines.front(), 5u);
  EXPECT_EQ(table.columns[0].name, "Clock");
  EXPECT_NEAR(table.columns[0].values[7], 1773680691.07, 1e-5);
  EXPECT_EQ(table.columns[1].unit, "ms");
  EXPECT_EQ(table.columns[2].values[3], 0.375);
  EXPECT_EQ(table.columns[3].values[1], -1.5);
  EXPECT_EQ(table.columns[4].obstacle,
            "has 'start' in line 5, which is no number; correct it or leave the field blank");
  EXPECT_TRUE(std::isnan(table.columns[5].values[1]));
  EXPECT_EQ(table.columns[5].values[10], 30.5);
}

TEST_F(XlsxTest, ReadsCellsOfEveryKind) {
  const Parts more{
      {"xl/sharedStrings.xml",
       "<sst><si><t>Weg &amp; Zeit</t></si><si><r><t>a</t></r><r><rPr/><t xml:space=\"preserve\"> "
       "b</t></r><rPh><t>x</t></rPh></si></sst>"},
      {"xl/styles.xml",
       R"(<styleSheet><numFmts><numFmt numFmtId="170" formatCode="[h]:mm:ss"/>)"
       R"(<numFmt numFmtId="171" formatCode="0.0&quot;days&quot;"/></numFmts>)"
       R"(<cellXfs><xf numFmtId="0"/><xf numFmtId="22"/><xf numFmtId="170"/><xf numFmtId="171"/>)"
       R"(</cellXfs></styleSheet>)"}};
  EXPECT_EQ(
      rows(workbook(
          R"(<row r="2"><c r="A2" t="s"><v>0</v></c><c r="C2" t="s"><v>1</v></c></row>)"
          R"(<row r="3"><c t="inlineStr"><is><t>in</t></is></c><c><v>1.5E-3</v></c>)"
          R"(<c t="b"><v>1</v></c><c t="e"><v>#DIV/0!</v></c><c t="str"><f>1</f><v>7</v></c></row>)"
          R"(<row><c s="1"><v>46097.711700810185</v></c><c s="1"><v>0.5</v></c>)"
          R"(<c s="2"><v>1.5</v></c><c s="3"><v>3</v></c></row><row/>)",
          more)),
      (Rows{{"Weg & Zeit", "", "a b"},
            {"in", "1.5E-3", "1", "#DIV/0!", "7"},
            {"2026-03-16T17:04:50.95", "43200", "129600", "3"},
            {}}));
}

TEST_F(XlsxTest, FindsTheSheetThatHasRows) {
  const std::string path = workbook(
      "",
      {{"xl/workbook.xml",
        R"(<x:workbook xmlns:x="x" xmlns:r="r"><x:workbookPr date1904="1"/><x:sheets>)"
        R"(<x:sheet name="Empty" r:id="rId1"/><x:sheet name="Data" r:id="rId2"/></x:sheets></x:workbook>)"},
       {"xl/_rels/workbook.xml.rels",
        R"(<Relationships><Relationship Id="rId1" Target="worksheets/sheet1.xml"/>)"
        R"(<Relationship Id="rId2" Target="/xl/other.xml"/></Relationships>)"},
       {"xl/other.xml",
        R"(<x:worksheet><x:sheetData><x:row><x:c><x:v>4</x:v></x:c></x:row></x:sheetData></x:worksheet>)"}});
  XlsxRows sheet(path);
  EXPECT_EQ(sheet.sheet(), "Data");
  std::vector<std::string> fields;
  ASSERT_TRUE(sheet.next(fields));
  EXPECT_EQ(fields, std::vector<std::string>{"4"});
  EXPECT_EQ(sheet.number(), 1u);
  EXPECT_FALSE(sheet.next(fields));
}

TEST_F(XlsxTest, ReadsRowsThatCrossBlocks) {
  std::string data;
  constexpr int kRows = 20000;
  for (int i = 0; i < kRows; ++i)
    data += "<row r=\"" + std::to_string(i + 1) + "\"><c><v>" + std::to_string(i) +
            "</v></c><c><v>" + std::to_string(2 * i) + "</v></c></row>";
  const Table table = read_xlsx(workbook(data));
  ASSERT_EQ(table.rows(), std::size_t{kRows});
  for (int i = 0; i < kRows; ++i) ASSERT_EQ(table.columns[1].values[std::size_t(i)], 2.0 * i);
}

TEST_F(XlsxTest, SaysWhatIsWrongWithAFile) {
  const auto text = [&](const std::string& contents) {
    return error([&] { read_xlsx(folder_.write("book.xlsx", contents)); });
  };
  EXPECT_EQ(text("t,x\n0,1\n"), "book.xlsx: is no workbook (.xlsx); save it as one, or as CSV");
  EXPECT_EQ(
      text("\xD0\xCF\x11\xE0 and more"),
      "book.xlsx: is an old workbook (.xls), or one with a password; save it as .xlsx without "
      "a password, or as CSV");
  EXPECT_EQ(text("PK\x03\x04 and more"),
            "book.xlsx: is no workbook (.xlsx); save it as one, or as CSV");
  EXPECT_EQ(error([&] { read_xlsx(workbook("")); }), "book.xlsx: has no worksheet with data");
  EXPECT_EQ(error([&] { read_xlsx(workbook("<row><c><v>1</v></row>")); }),
            "book.xlsx: is damaged: its XML is not valid; save it again");
  EXPECT_EQ(error([&] { read_xlsx(workbook("<row><c><v>1</v></c>")); }),
            "book.xlsx: is damaged: a part ends early; save or copy it again");
  EXPECT_EQ(error([&] { read_xlsx(workbook("<row r=\"9999999\"><c><v>1</v></c></row>")); }),
            "book.xlsx: has a row 9999999, beyond the last of Excel");
  EXPECT_EQ(error([&] { read_xlsx(workbook("<row><c r=\"ZZZ1\"><v>1</v></c></row>")); }),
            "book.xlsx:1: has more columns than Excel");
  EXPECT_EQ(
      error([&] { read_xlsx(workbook("<row><c t=\"inlineStr\"><is><t>no</t></is></c></row>")); }),
      "book.xlsx:1: there are no rows of numbers below this line; check how it was recorded or "
      "exported");
}

}  // namespace
}  // namespace axisfit
