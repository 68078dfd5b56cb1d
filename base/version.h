#pragma once

namespace axisfit {

/// Of the project; built from a clone at other than a release, with the commit: "0.1.0+g1a2b3c4".
const char* version();

}  // namespace axisfit
