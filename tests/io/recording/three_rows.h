// A small recording with columns that are hard to name.
#pragma once

#include "io/recording/recording_file.h"

namespace axisfit {

/// A recording of three rows with two columns of one name, one of numbers as names, and one
/// that cannot be used.
inline RecordingFile recording() {
  return RecordingFile(Table{"a.csv",
                             {{"time", {0.0, 1.0, 2.0}},
                              {"speed", {100.0, 200.0, -300.0}},
                              {"twice", {1.0, 1.0, 1.0}},
                              {"twice", {2.0, 2.0, 2.0}},
                              {"", {3.0, 3.0, 3.0}},
                              {"7", {4.0, 4.0, 4.0}},
                              {"text", {}, {}, {}, "has 'abc' in line 2"},
                              {"huge", {1.0, 1e31, 1.0}}},
                             {2, 3, 4}});
}

}  // namespace axisfit
