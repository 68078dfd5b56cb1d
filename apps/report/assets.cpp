#include "apps/report/assets.h"
namespace axisfit {
const ReportAssets& report_assets() {
  static const ReportAssets a{
      "body{font:15px system-ui;max-width:1000px;margin:auto} svg{width:100%} "
      ".series{fill:none;stroke:#0072b2} .series.simulated{stroke:#d55e00} "
      ".dots{stroke-width:3;stroke-linecap:round} .phase{fill:#ddd} .band{fill:#eee} "
      ".grid{stroke:#eee} .axis{fill:none;stroke:#333} .tick,.label{font-size:11px} "
      ".event{stroke:#333} .figures{display:grid;grid-template-columns:1fr 1fr 1fr} "
      "table{font-size:13px}",
      "1;"};
  return a;
}
}  // namespace axisfit
