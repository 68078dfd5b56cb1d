// The files of this project that are made of the descriptions of keys: the JSON schemas below
// configs/schema, and the tables in docs/ between the lines
//
//   <!-- keys: job.recordings -->
//   <!-- end of keys -->
//
// Around the tables the pages are written by hand.
#pragma once

#include <map>
#include <string>

namespace axisfit {

/// What the files should hold, by their path relative to the folder of the project, whose pages
/// are read. Throws std::runtime_error for a page that cannot be read, lacks the end of a table,
/// names a table that there is not, or for a table that no page shows.
std::map<std::string, std::string> reference_files(const std::string& project);

}  // namespace axisfit
