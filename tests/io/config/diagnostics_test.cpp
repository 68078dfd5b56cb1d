#include "io/config/diagnostics.h"

#include <gtest/gtest.h>

namespace axisfit {
namespace {

TEST(Diagnostics, GivesTheDiagnosticsOfTheException) {
  Diagnostics diagnostics;
  EXPECT_NO_THROW(diagnostics.throw_if_any());
  diagnostics.add({"b.yaml", 9, 1, "late"});
  diagnostics.add({"a.yaml", 1, 2, "other file"});
  diagnostics.add({"b.yaml", 2, 3, "early\nin two lines"});
  diagnostics.add({"b.yaml", 9, 1, "late"});
  EXPECT_FALSE(diagnostics.empty());
  try {
    diagnostics.throw_if_any();
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(),
                 "b.yaml:2:3: early?in two lines\nb.yaml:9:1: late\na.yaml:1:2: other file");
    ASSERT_EQ(error.diagnostics().size(), 3U);
    EXPECT_EQ(error.diagnostics()[0].file, "b.yaml");
    EXPECT_EQ(error.diagnostics()[0].line, 2);
    EXPECT_EQ(error.diagnostics()[0].column, 3);
  }
}

TEST(Diagnostics, KeepsNoMoreDiagnosticsThanAnybodyReads) {
  Diagnostics diagnostics;
  for (int line = 1; line <= 5000; ++line) diagnostics.add({"a.yaml", line, 1, "wrong"});
  EXPECT_TRUE(diagnostics.full());
  EXPECT_EQ(diagnostics.sorted().size(), 1000U);
  EXPECT_EQ(diagnostics.count(), 5000U);
}

}  // namespace
}  // namespace axisfit
