#include "io/config/recording_column.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tests/io/recording/three_rows.h"

namespace axisfit {
namespace {

/// What `read` makes of a YAML text, and what it says of it.
struct Outcome {
  std::optional<std::vector<double>> values;
  std::string said;
};

Outcome outcome(const std::string& yaml,
                const std::function<std::optional<std::vector<double>>(const ConfigNode&)>& read) {
  Diagnostics diagnostics;
  Outcome found;
  found.values = read(*ConfigNode::parse(yaml, "job.yaml", diagnostics));
  for (const Diagnostic& d : diagnostics.sorted())
    found.said += (found.said.empty() ? "" : "\n") + d.message;
  return found;
}

Outcome column(const std::string& yaml, std::string_view unit = "m/s") {
  return outcome(yaml,
                 [&](const ConfigNode& node) { return read_column(recording(), node, unit); });
}

TEST(RecordingColumn, ConvertsAColumn) {
  EXPECT_EQ(column("{column: speed, unit: mm/s}").values, (std::vector<double>{0.1, 0.2, -0.3}));
  EXPECT_EQ(column("{column: speed, unit: mm/s, sign: -1, factor: 2}").values,
            (std::vector<double>{-0.2, -0.4, 0.6}));
  EXPECT_EQ(column("{column: 2, unit: m/s}").values, (std::vector<double>{100.0, 200.0, -300.0}));
}

TEST(RecordingColumn, ANameComesBeforeANumber) {
  EXPECT_EQ(column("{column: 7, unit: m/s}").values, (std::vector<double>{4.0, 4.0, 4.0}));
  EXPECT_EQ(column("{column: 5, unit: m/s}").values, (std::vector<double>{3.0, 3.0, 3.0}));
  EXPECT_FALSE(column("{column: 9, unit: m/s}").values);
}

TEST(RecordingColumn, SaysWhyAColumnCannotBeUsed) {
  EXPECT_EQ(column("{column: sped, unit: m/s}").said,
            "no column 'sped' in a.csv; did you mean 'speed'? It has time, speed, twice, twice, 7, "
            "text, huge");
  EXPECT_EQ(column("{column: twice, unit: m/s}").said,
            "columns 3 and 4 of a.csv are both named 'twice': give the number of the column "
            "instead of its name");
  EXPECT_EQ(column("{column: text, unit: m/s}").said, "'text' in a.csv has 'abc' in line 2");
  EXPECT_EQ(column("{column: huge, unit: m/s}").said,
            "a.csv:3: 'huge' has the impossible value 1e+31: remove the row");
  EXPECT_EQ(column("{column: speed, unit: m/s, factor: 0}").said,
            "factor must not be zero: it would erase the column");
  EXPECT_NE(column("{column: speed, unit: kg}").said.find("'kg' cannot be converted"),
            std::string::npos);
}

TEST(RecordingColumn, ARowThatIsRepeatedHasNoTime) {
  const Table table{"b.csv", {{"t", {0.0, 1.0, 1.0, 2.0}}, {"x", {5.0, 6.0, 6.0, 7.0}}}, {}};
  const auto times = [](const Table& of) {
    const RecordingFile file(of);
    return outcome("{column: t, unit: s}",
                   [&](const ConfigNode& node) { return read_times(file, node); });
  };
  const Outcome merged = times(table);
  ASSERT_TRUE(merged.values);
  EXPECT_TRUE(std::isnan((*merged.values)[2]));
  EXPECT_EQ((*merged.values)[3], 2.0);
  Table different = table;
  different.columns[1].values[2] = 6.5;
  EXPECT_FALSE(times(different).values);
  EXPECT_TRUE(repeats_row(RecordingFile(table), 2));
  EXPECT_FALSE(repeats_row(RecordingFile(table), 0));
  EXPECT_FALSE(repeats_row(RecordingFile(different), 2));
}

TEST(RecordingColumn, ColumnsWithoutNamesHaveNumbers) {
  const RecordingFile plain(Table{"b.csv", {{"", {1.0}}, {"", {2.0}}}, {}});
  const Outcome none = outcome("{column: x, unit: m/s}", [&](const ConfigNode& node) {
    return read_column(plain, node, "m/s");
  });
  EXPECT_EQ(none.said,
            "no column 'x' in b.csv, whose columns have no names: give a number from 1 to 2");
}

TEST(RecordingColumn, CountersAreMadeContinuousOnlyWhereTheyCanBe) {
  EXPECT_EQ(column("{column: speed, unit: m/s, wraps_after: 600}").values,
            (std::vector<double>{100.0, 200.0, 300.0}));
  EXPECT_EQ(column("{column: speed, unit: m/s, wraps_after: 400}").said,
            "a.csv:3: 200 is more than wraps_after beyond the least value: correct or remove it");
  EXPECT_EQ(column("{column: speed, unit: m/s, signed_bits: 16}").said,
            "a.csv:4: -300 is no integer of so many bits without a sign: correct or remove "
            "signed_bits");
}

TEST(RecordingColumn, TimesIncrease) {
  const auto times = [](std::vector<double> values) {
    const RecordingFile file(Table{"a.csv", {{"t", std::move(values)}}, {2, 3, 4}});
    return outcome("{column: t, unit: s}",
                   [&](const ConfigNode& node) { return read_times(file, node); });
  };
  EXPECT_TRUE(times({0.0, NAN, 1e-9 + 1e-15}).values);
  EXPECT_EQ(times({0.0, 1.0, 1.0}).said,
            "a.csv:4: time 1 s does not increase from 1 s: samples must be in order of time, "
            "without repeats");
  EXPECT_EQ(times({0.0, 1.0, 1.0 + 5e-10}).said,
            "a.csv:4: 5e-10 s after the sample before, less than the 1e-09 s that a simulation can "
            "step: check the unit of time");
}

}  // namespace
}  // namespace axisfit
