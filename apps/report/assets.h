#pragma once
#include <string_view>
namespace axisfit {
struct ReportAssets {
  std::string_view css, script;
};
const ReportAssets& report_assets();
}  // namespace axisfit
