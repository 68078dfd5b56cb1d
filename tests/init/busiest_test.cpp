#include "init/busiest.h"

#include <gtest/gtest.h>

#include <cmath>

namespace axisfit {
namespace {

/// A recording of 1000 samples at 1 ms that moves, in a sine of 20 periods a second, from `from` on
/// for 100 samples.
DraftRecording moving(Kind kind, std::size_t from) {
  DraftRecording recording{"a", "a.csv", {}, {}};
  GuessedColumn column;
  column.kind = kind;
  for (std::size_t i = 0; i < 1000; ++i) {
    recording.guess.time.values.push_back(1e-3 * double(i));
    const double phase = 2.0 * M_PI * 0.02 * (double(i) - double(from));
    column.values.push_back(i < from || i >= from + 100 ? 0.0 : std::sin(phase));
  }
  recording.guess.columns.push_back(column);
  return recording;
}

TEST(Busiest, IsWhereTheAxisMoves) {
  for (const Kind kind : {Kind::position, Kind::velocity})
    for (const std::size_t from : {0u, 300u, 720u, 900u}) {
      JobDraft draft{InitRequest{}};
      draft.recordings = {moving(kind, from), moving(kind, 500)};
      keep_busiest(draft, 400);
      const DraftRecording& kept = draft.recordings.front();
      ASSERT_EQ(kept.guess.time.values.size(), 200u);
      EXPECT_EQ(kept.guess.columns.front().values.size(), 200u);
      EXPECT_LE(*kept.trim_from, 1e-3 * double(from) + 0.01) << from;
      EXPECT_GE(*kept.trim_to, 1e-3 * double(from + 99) - 0.01) << from;
      EXPECT_EQ(kept.guess.time.values.front(), *kept.trim_from);
    }
}

TEST(Busiest, IsAllOfWhatIsShort) {
  JobDraft draft{InitRequest{}};
  draft.recordings = {moving(Kind::position, 300)};
  keep_busiest(draft, 1000);
  EXPECT_EQ(draft.recordings.front().guess.time.values.size(), 1000u);
  EXPECT_FALSE(draft.recordings.front().trim_from);
}

}  // namespace
}  // namespace axisfit
