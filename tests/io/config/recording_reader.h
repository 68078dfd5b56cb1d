// Signals of a recording, read from YAML.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "io/config/recording_series.h"

namespace axisfit {

/// The signals of a recording "a.csv" with a column t of its times.
class RecordingReaderTest : public ::testing::Test {
 protected:
  explicit RecordingReaderTest(std::vector<Column> columns) {
    sources_.tables = {{"a.csv", {"a.csv", std::move(columns), {}}}};
  }

  /// Reads signals as in a job, and calls read(node, reader) with them.
  template <class Read>
  auto read_signals(const std::string& signals, Read&& read) {
    diagnostics_ = std::make_unique<Diagnostics>();
    const auto node =
        ConfigNode::parse("file: a.csv\ntime: {column: t, unit: s}\nsignals: {" + signals + "}",
                          "job.yaml", *diagnostics_);
    ConfigMap map(*node);
    SeriesReader reader(sources_);
    reader.open_own(*map.required("file"), "a.csv");
    reader.read_own_times(*map.required("time"));
    return read(*map.required("signals"), reader);
  }
  std::string said() const {
    std::string text;
    for (const Diagnostic& d : diagnostics_->sorted()) text += d.message + "\n";
    return text;
  }

  RecordingSources sources_;
  std::unique_ptr<Diagnostics> diagnostics_;
};

}  // namespace axisfit
