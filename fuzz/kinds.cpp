// Recordings of all kinds that are told by what they begin with: what is read is a table that says
// of every column what it has, or why it cannot be used. Text that is none of them is the target
// csv's.
#include <cmath>

#include "fuzz/check.h"
#include "io/recording/change_list_file.h"
#include "io/recording/codesys_file.h"
#include "io/recording/halscope_file.h"
#include "io/recording/json_file.h"
#include "io/recording/recording_file.h"
#include "io/recording/sysid_file.h"
#include "io/recording/wpilog_file.h"

namespace axisfit::fuzz {
namespace {

bool is_of_a_kind(const std::string& path, std::string_view input) {
  return is_wpilog(path) || is_codesys(input) || is_sysid(input) || is_halscope(input) ||
         is_json(input) || is_change_list(input);
}

void check_columns(const RecordingFile& file) {
  require(!file.columns().empty(), "a recording without columns was read");
  for (const Column& column : file.columns()) {
    if (!column.obstacle.empty()) {
      require_message(sanitized(column.obstacle));
      continue;
    }
    require(!column.values.empty(), "a column without values was read", column.name);
    if (!column.clock) continue;
    const Column& clock = file.columns().at(*column.clock);
    require(clock.values.size() == column.values.size(), "a column is not as long as its clock",
            column.name);
    for (const double t : clock.values) require(std::isfinite(t), "a time is none", clock.name);
  }
}

}  // namespace

void check_input(const Folder& folder, std::string_view input) {
  const std::string path = folder.write("data", input);
  if (!is_of_a_kind(path, input)) return;
  for (const char* recording : {"", "#slow-forward"})
    refusable([&] { check_columns(RecordingFile(path + recording)); });
}

}  // namespace axisfit::fuzz
