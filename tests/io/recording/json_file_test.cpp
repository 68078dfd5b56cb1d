#include "io/recording/json_file.h"

#include <cmath>

#include "tests/io/recording/kind_fixture.h"

namespace axisfit {
namespace {

using JsonTest = KindTest;

TEST_F(JsonTest, ReadsRowsColumnsAndLinesAlike) {
  const std::vector<std::string> variants = {
      R"([{"t": 0, "x": 1.5}, {"t": 0.1, "x": -2e-3}])",
      "[\n  {\"t\": 0,\n   \"x\": 1.5},\n  {\"x\": -2e-3, \"t\": 0.1}\n]\n",
      R"({"t": [0, 0.1], "x": [1.5, -0.002]})",
      R"({"made": {"by": "a test", "rate": 10}, "t": [0, 0.1], "x": [1.5, -0.002]})",
      "{\"t\": 0, \"x\": 1.5}\n{\"t\": 0.1, \"x\": -0.002}\n",
      "\xEF\xBB\xBF{\"t\": 0, \"x\": 1.5}\r\n\r\n{\"t\": 0.1, \"x\": -0.002}",
  };
  for (const std::string& text : variants) {
    SCOPED_TRACE(text);
    const RecordingFile file = read(text);
    ASSERT_EQ(file.columns().size(), 2u);
    EXPECT_EQ(column(file, "t").values, (Values{0, 0.1}));
    EXPECT_EQ(column(file, "x").values, (Values{1.5, -2e-3}));
  }
}

TEST_F(JsonTest, NamesAreThePathsInARow) {
  const RecordingFile file = read(
      R"([{"t": 0, "motor": {"current": 2, "on": true}, "q": [1, [2, 3]]},
          {"t": 1, "motor": {"current": 4, "on": false}, "q": [5, [6, 7]]}])");
  EXPECT_EQ(column(file, "motor.current").values, (Values{2, 4}));
  EXPECT_EQ(column(file, "motor.on").values, (Values{1, 0}));
  EXPECT_EQ(column(file, "q[0]").values, (Values{1, 5}));
  EXPECT_EQ(column(file, "q[1][0]").values, (Values{2, 6}));
  EXPECT_EQ(column(file, "q[1][1]").values, (Values{3, 7}));
  EXPECT_EQ(file.columns().size(), 6u);
}

TEST_F(JsonTest, ARowMayLackValues) {
  const RecordingFile file =
      read(R"([{"t": 0, "x": 1}, {"t": 1}, {"t": 2, "x": null}, {"x": 4, "t": 3, "x": 5}])");
  const Values& x = column(file, "x").values;
  ASSERT_EQ(x.size(), 4u);
  EXPECT_TRUE(std::isnan(x[1]) && std::isnan(x[2]));
  EXPECT_EQ(x[3], 5.0);
}

TEST_F(JsonTest, RowsAndColumnsMayBeBelowAKey) {
  const RecordingFile file = read(
      R"({"axis": "x", "data": [{"t": 0, "x": 1}, {"t": 1, "x": 2}], "force": {"N": [1, 2, 3]}})");
  EXPECT_EQ(column(file, "data.t").values, (Values{0, 1}));
  EXPECT_EQ(column(file, "data.x").values, (Values{1, 2}));
  EXPECT_EQ(column(file, "force.N").values, (Values{1, 2, 3}));
}

TEST_F(JsonTest, TextsAreTimesOrObstacles) {
  const RecordingFile file = read(
      R"([{"at": "2026-03-16T00:00:01Z", "x": "1.5", "mode": "idle"},
          {"at": "2026-03-16T00:00:02.5Z", "x": "2.5", "mode": "run"}])");
  const Values& at = column(file, "at").values;
  EXPECT_EQ(at[1] - at[0], 1.5);
  EXPECT_EQ(column(file, "x").values, (Values{1.5, 2.5}));
  EXPECT_EQ(problem(file, "mode"),
            "'mode' in run.dat has 'idle' as value 1, which is no finite number");
}

TEST_F(JsonTest, OfManyNumbersInARowTheFirstAreTaken) {
  std::string row = "{\"t\": 0, \"ranges\": [[9]";
  for (int i = 1; i < 100; ++i) row += ", " + std::to_string(i);
  row += ", [1], {\"a\": 1}], \"x\": 3}";
  const RecordingFile file = read("[" + row + "," + row + "]");
  EXPECT_EQ(file.columns().size(), 66u);
  EXPECT_EQ(column(file, "ranges[63]").values, (Values{63, 63}));
  EXPECT_EQ(column(file, "x").values, (Values{3, 3}));
}

TEST_F(JsonTest, TheLastLineMayBeCutOff) {
  const RecordingFile file = read("{\"t\":0,\"x\":1}\n{\"t\":1,\"x\":2}\n{\"t\":2,\"x\"");
  EXPECT_EQ(column(file, "t").values, (Values{0, 1}));
  EXPECT_EQ(column(file, "x").values, (Values{1, 2}));
  EXPECT_TRUE(file.where(1).ends_with("run.dat:2"));
  EXPECT_EQ(error("{\"t\":0}\n{\"t\":\n{\"t\":2}\n"),
            "run.dat:2: is no JSON from here on; export it again (NaN and Infinity are null in "
            "JSON)");
}

TEST_F(JsonTest, RefusesWhatIsNoRecording) {
  EXPECT_EQ(error("[{\"t\": 0,\n\"x\": NaN}]"),
            "run.dat:2: is no JSON from here on; export it again (NaN and Infinity are null in "
            "JSON)");
  EXPECT_EQ(error("[[0, 1], [1, 2]]"),
            "run.dat: has rows without names; make objects of them, as {\"time\": 0.0, "
            "\"position\": 0.1}");
  const std::string none =
      "run.dat: holds no numbers in rows or columns: it should be an array of objects, an object "
      "of arrays, or have an object in every line; see the page on recordings";
  for (const char* text : {"{}", "[]", "{\"t\": 0, \"x\": 1}", "[{\"mode\": \"idle\"}]"})
    EXPECT_EQ(error(text), none) << text;
  EXPECT_EQ(error("{\"a\": " + std::string(100000, '[')).substr(0, 29),
            "run.dat: has rows without nam");
  std::string deep = "[";
  for (int i = 0; i < 100000; ++i) deep += "{\"a\":";
  EXPECT_EQ(error(deep),
            "run.dat: is nested deeper than 32; is it a recording? Its rows should be simple "
            "objects");
  EXPECT_EQ(error("[{\"" + std::string(2000, 'a') + "\": 1}]"),
            "run.dat: has a name longer than 1000 bytes");
}

TEST_F(JsonTest, MemoryIsInProportionToTheText) {
  // Few bytes that ask for very many missing values.
  std::string columns = "{\"a\":0";
  for (int i = 0; i < 4000; ++i) columns += ",\"" + std::to_string(i) + "\":1";
  std::string rows = "[" + columns + "}";
  for (int i = 0; i < 20000; ++i) rows += ",{\"a\":1}";
  EXPECT_EQ(error(rows + "]"),
            "run.dat: has columns without a value in nearly all rows; leave them out, or write "
            "signals of different rates to files of their own");
  columns += ",";
  for (int i = 4000; i < 4200; ++i) columns += "\"" + std::to_string(i) + "\":1,";
  EXPECT_EQ(error("[" + columns + "\"z\":1}]"),
            "run.dat: has more than 4096 columns; leave out those that are not of the axis");
}

TEST_F(JsonTest, OtherTextsAreTables) {
  for (const char* text : {"", "t,x\n", "[Header]\n", "{t}\n", "[1, 2]\n", "[key]; [value]\n"})
    EXPECT_FALSE(is_json(text)) << text;
  for (const char* text : {" {\"", "[ {", "\n[\n{"}) EXPECT_TRUE(is_json(text)) << text;
}

}  // namespace
}  // namespace axisfit
