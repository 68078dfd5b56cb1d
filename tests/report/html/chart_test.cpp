#include "report/html/chart.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <regex>

namespace axisfit {
namespace {

using Json = nlohmann::ordered_json;

std::string from_base64(const std::string& text) {
  static const std::string digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int held = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
    if ((held += 6) >= 8) bytes += static_cast<char>(bits >> (held -= 8) & 0xFF);
  }
  return bytes;
}

/// The values of a column as the script has them.
std::vector<double> decoded(const Json& column) {
  const std::size_t n = column["length"];
  std::vector<double> values;
  if (column.contains("interval")) {
    for (std::size_t i = 0; i < n; ++i)
      values.push_back(double(column["start"]) + double(i) * double(column["interval"]));
    return values;
  }
  const std::string packed = from_base64(column["data"]);
  std::string bytes(4 * n, '\0');
  uLongf size = static_cast<uLongf>(bytes.size());
  EXPECT_EQ(
      uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size,
                 reinterpret_cast<const Bytef*>(packed.data()), static_cast<uLong>(packed.size())),
      Z_OK);
  EXPECT_EQ(size, 4 * n);
  std::uint32_t k = 0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t plane = 0; plane < 4; ++plane)
      k += static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[plane * n + i]))
           << (8 * plane);
    const auto whole = static_cast<std::int32_t>(k);
    values.push_back(whole == std::numeric_limits<std::int32_t>::min()
                         ? NAN
                         : double(column["start"]) + double(column["step"]) * whole);
  }
  return values;
}

std::vector<double> through_script(const ChartColumns& columns, ChartColumns::Index i) {
  return decoded(chart_data({}, columns)["columns"][i]);
}

TEST(ChartColumns, ReachTheScriptToHalfTheirStep) {
  ChartColumns columns;
  std::vector<double> values;
  for (int i = 0; i < 5000; ++i) values.push_back(1.3 * std::sin(0.01 * i) - 0.4 + 1e-4 * (i % 7));
  const auto at = columns.add(values, 3e-5);
  EXPECT_EQ(columns[at].step, 1e-5);
  const std::vector<double> shown = through_script(columns, at);
  ASSERT_EQ(shown.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) ASSERT_NEAR(shown[i], values[i], 0.5001e-5);
}

TEST(ChartColumns, AreKeptOnce) {
  ChartColumns columns;
  const auto first = columns.add({1.0, 2.0}, 0.1);
  EXPECT_EQ(columns.add({1.0, 2.0}, 0.1), first);
  EXPECT_NE(columns.add({1.0, 2.0}, 0.01), first);
  EXPECT_NE(columns.add({1.0, 2.5}, 0.1), first);
  EXPECT_EQ(columns.size(), 3u);
}

TEST(ChartColumns, KeepGapsAndLargeValues) {
  ChartColumns columns;
  const auto at = columns.add({-4e12, NAN, 5e12, 0.0, INFINITY}, 1e-3);
  const std::vector<double> shown = through_script(columns, at);
  EXPECT_NEAR(shown[0], -4e12, 1e-9 * 5e12);
  EXPECT_TRUE(std::isnan(shown[1]));
  EXPECT_NEAR(shown[2], 5e12, 1e-9 * 5e12);
  EXPECT_EQ(shown[3], 0.0);
  EXPECT_TRUE(std::isnan(shown[4]));
}

TEST(ChartColumns, EvenTimesAreTwoNumbersAndUnevenOnesStayExactAnywhere) {
  ChartColumns columns;
  std::vector<double> even, uneven;
  for (int i = 0; i < 1000; ++i) {
    even.push_back(0.25 + 1e-3 * i);
    uneven.push_back(1.7e9 + 1e-3 * i + 2e-4 * (i % 3));  // s since 1970
  }
  const auto first = columns.add_times(even), second = columns.add_times(uneven);
  EXPECT_FALSE(chart_data({}, columns)["columns"][first].contains("data"));
  const auto shown_even = through_script(columns, first),
             shown_uneven = through_script(columns, second);
  for (std::size_t i = 0; i < even.size(); ++i) {
    ASSERT_NEAR(shown_even[i], even[i], 1e-9);
    ASSERT_NEAR(shown_uneven[i], uneven[i], 2e-6);
  }
}

TEST(ChartColumns, NoiseOf20000SamplesTakesTwoBytesEach) {
  ChartColumns columns;
  std::vector<double> values;
  for (int i = 0; i < 20000; ++i)
    values.push_back(std::sin(1e-3 * i) + 2e-3 * std::sin(12345.678 * i * i));
  columns.add(values, 2e-5);
  EXPECT_LT(chart_data({}, columns).dump().size(), 50000u);
}

Chart sine(ChartColumns& columns, std::size_t samples) {
  std::vector<double> x, y;
  for (std::size_t i = 0; i < samples; ++i) {
    x.push_back(1e-3 * double(i));
    y.push_back(std::sin(0.01 * double(i)));
  }
  y[samples / 2] = 7.0;  // a spike of one sample
  const auto times = columns.add_times(x);
  return {.id = "trace",
          .title = "velocity of <script>alert(1)</script>",
          .x = {"time", "s"},
          .y = {"velocity", "m/s"},
          .series = {{"measured", "measured", times, columns.add(y, 1e-4)}},
          .recording = "a & b"};
}

/// One step of a path, relative to where the last one ended.
struct Move {
  char how = 'm';  ///< 'm' without a line, 'l' with one
  double x = 0.0, y = 0.0;
};

/// The path of the measured series in a drawing.
std::vector<Move> moves_of(const std::string& svg) {
  const std::size_t path = svg.find("<path class=\"series measured\"");
  if (path == std::string::npos) return {};
  const std::size_t begin = svg.find(" d=\"", path) + 4, end = svg.find('"', begin);
  const std::regex move("([ml])(-?[0-9.]+),?(-?[0-9.]+)");
  const std::string d = svg.substr(begin, end - begin);
  std::vector<Move> moves;
  for (std::sregex_iterator at(d.begin(), d.end(), move), last; at != last; ++at)
    moves.push_back({(*at)[1].str().front(), std::stod((*at)[2]), std::stod((*at)[3])});
  return moves;
}

TEST(Chart, ThinsLongSeriesAndLosesNoSpike) {
  ChartColumns columns;
  const Chart chart = sine(columns, 200000);
  const std::string svg = figure(chart, columns).text();
  EXPECT_LT(svg.size(), 30000u);
  // The axis reaches beyond 7, and the line reaches the spike: 6 % below the top of the frame.
  double y = 0.0, highest = INFINITY;
  for (const Move& move : moves_of(svg)) highest = std::min(highest, y += move.y);
  EXPECT_NEAR(highest, 20.0, 1.5);
}

TEST(Chart, StepsHoldTheirValueUntilTheNextSample) {
  ChartColumns columns;
  const auto x = columns.add({0.0, 1.0, 2.0, 4.0}, 1e-3);
  const auto y = columns.add({0.0, 2.0, 2.0, -1.0}, 1e-3);
  const Chart chart{.id = "steps",
                    .title = "command",
                    .x = {"x"},
                    .y = {"y"},
                    .series = {{"command", "measured", x, y, LineStyle::steps}}};
  const std::vector<Move> moves = moves_of(figure(chart, columns).text());
  // Level to the next sample, then upright; the frame is 298 wide and y points down.
  ASSERT_EQ(moves.size(), 7u);
  EXPECT_EQ(moves[0].how, 'm');
  const std::vector<double> level{74.5, 0.0, 74.5, 0.0, 149.0, 0.0};
  for (std::size_t i = 0; i < level.size(); ++i) {
    EXPECT_EQ(moves[i + 1].how, 'l');
    EXPECT_EQ(moves[i + 1].x, level[i]) << i;
    if (level[i] > 0.0) {
      EXPECT_EQ(moves[i + 1].y, 0.0) << i;
    }
  }
  EXPECT_LT(moves[2].y, 0.0);
  EXPECT_EQ(moves[4].y, 0.0);
  EXPECT_NEAR(moves[6].y, -1.5 * moves[2].y, 0.15);
}

TEST(Chart, ShowsNamesAsText) {
  ChartColumns columns;
  const Chart chart = sine(columns, 100);
  const std::string svg = figure(chart, columns).text();
  EXPECT_EQ(svg.find("<script"), std::string::npos);
  EXPECT_NE(svg.find("velocity of &lt;script&gt;alert(1)&lt;/script&gt;"), std::string::npos);
}

TEST(Chart, NamesWhatItDrawsAndLeavesRoomForTheScript) {
  ChartColumns columns;
  Chart chart = sine(columns, 100);
  chart.series[0].label = "<b>";
  chart.phases = {{0.01, 0.02, "limit", "at its limit"}, {0.05, 0.06, "limit", "at its limit"}};
  chart.events = {{"contact", "teeth touch", columns.add({0.03, 0.04}, 1e-3)}};
  const std::string text = figure(chart, columns).text();
  EXPECT_NE(
      text.find("<div class=\"tools\"></div><div class=\"legend\">"
                "<span class=\"key\"><span class=\"swatch measured\"></span>&lt;b&gt;</span>"
                "<span class=\"kind\"><span class=\"swatch tick contact\"></span>contact (2)</span>"
                "<span class=\"kind\"><span class=\"swatch area limit\"></span>at a limit</span>"
                "</div><div class=\"reading\"></div><svg"),
      std::string::npos)
      << text;
  EXPECT_NE(text.find("<path class=\"event line contact\""), std::string::npos);
}

TEST(Chart, DrawsDotsAsLinesWithoutLength) {
  ChartColumns columns;
  for (const std::size_t samples : {100u, 1000u}) {
    Chart chart = sine(columns, samples);
    chart.series[0].style = LineStyle::dots;
    const std::string text = figure(chart, columns).text();
    const std::string begin = samples == 100 ? "<path class=\"series measured dots few\" d=\"m"
                                             : "<path class=\"series measured dots\" d=\"m";
    const std::size_t path = text.find(begin);
    ASSERT_NE(path, std::string::npos);
    const std::size_t d = path + begin.size();
    const std::string dots = text.substr(d, text.find('"', d) - d);
    EXPECT_EQ(std::ranges::count(dots, 'h'), samples == 100 ? 100 : 250);
  }
}

TEST(Chart, IsDescribedToTheScript) {
  ChartColumns columns;
  const std::vector<Chart> charts{sine(columns, 100)};
  const Json chart = chart_data(charts, columns)["charts"][0];
  EXPECT_EQ(chart["id"], "trace");
  EXPECT_EQ(chart["kind"], "lines");
  EXPECT_EQ(chart["time"], true);
  EXPECT_EQ(chart["recording"], "a & b");
  EXPECT_EQ(chart["y"]["unit"], "m/s");
  EXPECT_EQ(chart["series"][0]["role"], "measured");
  EXPECT_EQ(chart["series"][0]["y"], 1);
}

TEST(Chart, OfValuesThatDifferByRoundingIsDrawnAsOfOneValue) {
  for (const bool log : {false, true}) {
    ChartColumns columns;
    const double value = 12345.678;
    const auto x = columns.add({0.0, 1.0}, 1.0);
    const auto y = columns.add({value, std::nextafter(value, INFINITY)}, 1e-300);
    const Chart chart{.id = "flat",
                      .title = "flat",
                      .x = {"x"},
                      .y = {"y", "", log},
                      .series = {{"flat", "measured", x, y}}};
    const std::string svg = figure(chart, columns).text();
    EXPECT_LT(svg.size(), 5000u);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
  }
}

/// The labels along x and its name, of a chart whose x is from one value to another.
std::vector<std::string> texts_along_x(const ChartAxis& axis, double from, double to) {
  ChartColumns columns;
  const auto x = columns.add({from, to}, 1e-3 * (to - from));
  const std::string svg =
      figure({.id = "chart",
              .title = "chart",
              .x = axis,
              .y = {"y"},
              .series = {{"line", "measured", x, columns.add({0.0, 1.0}, 1e-3)}}},
             columns)
          .text();
  const std::regex text("(?:class=\"tick\"|class=\"label\")[^>]*\"middle\">([^<]*)<");
  std::vector<std::string> texts;
  for (std::sregex_iterator at(svg.begin(), svg.end(), text), last; at != last; ++at)
    texts.push_back((*at)[1]);
  return texts;
}

TEST(Chart, LabelsAreShortAndTheNameTellsWhatTheyLeaveOut) {
  using Texts = std::vector<std::string>;
  EXPECT_EQ(texts_along_x({"velocity", "m/s"}, -1.0, 1.0),
            (Texts{"−1.0", "−0.5", "0", "0.5", "1.0", "velocity (m/s)"}));
  EXPECT_EQ(texts_along_x({"residual", "m"}, -2e-4, 2e-4),
            (Texts{"−200", "−100", "0", "100", "200", "residual (µm)"}));
  EXPECT_EQ(texts_along_x({"moment", "N m"}, 0.0, 8e-3),
            (Texts{"0", "2", "4", "6", "8", "moment (mN m)"}));
  // Where the unit takes no prefix: a square millimetre is not a thousandth of a square metre.
  EXPECT_EQ(texts_along_x({"area", "m^2"}, 0.0, 8e-3),
            (Texts{"0", "2", "4", "6", "8", "area (10⁻³ m^2)"}));
  EXPECT_EQ(texts_along_x({"power"}, 0.0, 4e5),
            (Texts{"0", "100", "200", "300", "400", "power (10³)"}));
  EXPECT_EQ(texts_along_x({"time", "s"}, 1700.25, 1702.25),
            (Texts{"0.5", "1.0", "1.5", "2.0", "time from 1700 s (s)"}));
  EXPECT_EQ(texts_along_x({"time", "s"}, -1700.0, -1699.9955),
            (Texts{"0", "1", "2", "3", "4", "time from −1700 s (ms)"}));
  EXPECT_EQ(texts_along_x({"frequency", "Hz", true}, 1e-5, 1e-1),
            (Texts{"10⁻⁵", "10⁻⁴", "10⁻³", "0.01", "0.1", "frequency (Hz)"}));
}

TEST(Chart, OfNothingIsEmptyAndStillDrawn) {
  ChartColumns columns;
  const auto none = columns.add({}, 1.0);
  const Chart chart{.id = "none",
                    .title = "none",
                    .x = {"x"},
                    .y = {"y", "", true},
                    .series = {{"nothing", "measured", none, none}}};
  EXPECT_NE(figure(chart, columns).text().find("</svg>"), std::string::npos);
  EXPECT_EQ(figure(chart, columns).text().find("nan"), std::string::npos);
}

}  // namespace
}  // namespace axisfit
