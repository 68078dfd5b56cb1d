// Workbooks. An input that is no archive is one sheet, as XML, and behind zero bytes the parts
// sharedStrings, styles and workbook: a fuzzer finds little where a checksum ends every attempt.
#include <minizip/zip.h>

#include <array>

#include "fuzz/check.h"
#include "io/recording/xlsx_file.h"

namespace axisfit::fuzz {
namespace {

std::string workbook(const Folder& folder, std::string_view input) {
  constexpr std::array kParts{"xl/worksheets/sheet1.xml", "xl/sharedStrings.xml", "xl/styles.xml",
                              "xl/workbook.xml"};
  constexpr std::string_view kBook =
      R"(<workbook xmlns:r="r"><sheets><sheet name="s" r:id="a"/></sheets></workbook>)";
  constexpr std::string_view kRelations =
      R"(<Relationships><Relationship Id="a" Target="worksheets/sheet1.xml"/></Relationships>)";
  std::string path = folder.path("data.xlsx");
  const zipFile zip = zipOpen64(path.c_str(), APPEND_STATUS_CREATE);
  const auto add = [&](const char* name, std::string_view text) {
    zipOpenNewFileInZip(zip, name, nullptr, nullptr, 0, nullptr, 0, nullptr, 0, 0);
    zipWriteInFileInZip(zip, text.data(), static_cast<unsigned>(text.size()));
    zipCloseFileInZip(zip);
  };
  add("xl/_rels/workbook.xml.rels", kRelations);
  for (std::size_t part = 0; part < kParts.size(); ++part) {
    const std::size_t end = std::min(input.find('\0'), input.size());
    const std::string_view text = input.substr(0, end);
    input.remove_prefix(std::min(end + 1, input.size()));
    add(kParts[part], part + 1 == kParts.size() && text.empty() ? kBook : text);
  }
  zipClose(zip, nullptr);
  return path;
}

}  // namespace

void check_input(const Folder& folder, std::string_view input) {
  const std::string path =
      input.starts_with("PK") ? folder.write("data.xlsx", input) : workbook(folder, input);
  refusable([&] {
    const Table table = read_xlsx(path);
    require(table.lines.size() == table.rows(), "not every row has a number");
    for (const Column& column : table.columns) {
      require(column.values.size() == table.rows(), "columns differ in length", column.name);
      if (!column.obstacle.empty()) require_message(sanitized(column.obstacle));
    }
  });
}

}  // namespace axisfit::fuzz
