#pragma once

#include <string_view>

namespace axisfit {

/// What report.html inlines: the contents of its style and its script element. Neither contains
/// "</". Built from this folder and, with AXISFIT_INTERACTIVE_REPORT, from uPlot, whose licence is
/// kept in the script.
struct ReportAssets {
  std::string_view css;
  std::string_view script;  ///< empty where the build has no npm: the charts are still pictures
};

const ReportAssets& report_assets();

}  // namespace axisfit
