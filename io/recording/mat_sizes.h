// The sizes that a MATLAB file states, before libmatio takes them for true.
#pragma once

#include <string>

namespace axisfit {

/// libmatio makes room for whatever a file states, and looks later at how much there is: one
/// damaged byte can take all memory. So this looks first, at files of version 4 and 5 (MATLAB's -v6
/// and -v7). Throws RecordingError where a variable cannot be as large as stated, and for what is
/// not a file of any version.
void check_mat_sizes(const std::string& path);

}  // namespace axisfit
