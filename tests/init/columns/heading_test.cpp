#include "init/columns/heading.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace axisfit {
namespace {

/// An encoder of 4096 counts that goes round thrice.
Table encoder(const char* name, const char* unit = "") {
  Table table;
  std::vector<double> times, values;
  for (int i = 0; i < 600; ++i) {
    const double count = std::floor(4096.0 * (1.6 + 1.5 * std::sin(0.02 * i)));
    times.push_back(0.01 * i);
    values.push_back(count - 4096.0 * std::floor(count / 4096.0));
  }
  table.columns = {{"t", times}, {name, values, unit}};
  return table;
}

TEST(Headings, AnAnswerKeepsWhatWasFound) {
  const RecordingFile file(encoder("Geber"));
  for (const char* text : {"position=Geber:rev/4096", "position=2:deg*0.087890625", "position=2",
                           "position=Geber:counts", "position=Geber:mm/1000"}) {
    const std::vector<ColumnAnswer> answers{read_answer(text)};
    const auto headings = headings_of(file, "a.csv", answers);
    EXPECT_DOUBLE_EQ(headings[1].overflow.wraps_after, 4096.0) << text;
    EXPECT_EQ(headings[1].answer, &answers[0]);
    EXPECT_EQ(headings[1].guess->rank, kAnswered);
  }
}

TEST(Headings, AnAnswerWithoutAUnitLeavesThatOfTheName) {
  Table table = encoder("enc [rev]");
  for (double& x : table.columns[1].values) x /= 4096.0;
  const RecordingFile file(table);
  const std::vector<ColumnAnswer> same{read_answer("position=2")}, other{read_answer("velocity=2")};
  EXPECT_EQ(headings_of(file, "a.csv", same)[1].guess->unit, "rev");
  EXPECT_DOUBLE_EQ(headings_of(file, "a.csv", same)[1].overflow.wraps_after, 1.0);
  EXPECT_EQ(headings_of(file, "a.csv", other)[1].guess->unit, "");
}

TEST(Headings, AUnitOfTheSourceCountsAsThatOfTheName) {
  const std::vector<ColumnAnswer> none;
  EXPECT_EQ(headings_of(RecordingFile(encoder("pos", "mm")), "a.csv", none)[1].guess->unit, "mm");
}

TEST(Headings, AColumnOfAnAnswerMustBeUsable) {
  Table table = encoder("Geber");
  for (double& x : table.columns[1].values) x = std::nan("");
  const RecordingFile file(table);
  const std::vector<ColumnAnswer> answers{read_answer("position=2:mm")};
  EXPECT_THROW(headings_of(file, "a.csv", answers), RecordingError);
  const std::vector<ColumnAnswer> none;
  const auto headings = headings_of(file, "a.csv", none);
  EXPECT_FALSE(headings[1].is_usable);
  EXPECT_EQ(described(file, headings), "t, Geber");
}

}  // namespace
}  // namespace axisfit
