#pragma once

#include <string_view>

namespace axisfit {

/// What report.html inlines: the contents of its style and its script element. Neither contains
/// "</". Built from this folder.
struct ReportAssets {
  std::string_view css, script;
};

const ReportAssets& report_assets();

}  // namespace axisfit
