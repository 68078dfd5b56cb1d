#include "report/html/chart.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>

#include "base/rounding.h"
#include "report/html/packed.h"
#include "sim/sampling.h"

namespace axisfit {
namespace {

// Of the drawing, in its own units: about pixels of a page.
constexpr double kWide = 760.0, kNarrow = 380.0, kHeight = 230.0;
constexpr double kLeft = 70.0, kRight = 12.0, kTop = 10.0, kBottom = 42.0;
constexpr std::size_t kDots = 300;     // of a series, at most
constexpr std::size_t kFewDots = 200;  // which are larger

using Values = std::vector<double>;

double power_of_ten_below(double x) { return std::pow(10.0, std::floor(std::log10(x))); }

/// A scale from values to places in the drawing.
class Scale {
 public:
  Scale(double low, double high, bool log, double from, double to)
      : low_(low), high_(high), log_(log), from_(from), to_(to) {}

  bool shows(double value) const { return std::isfinite(value) && (!log_ || value > 0.0); }
  double operator()(double value) const {
    return from_ + (to_ - from_) * (in(value)-in(low_)) / (in(high_)-in(low_));
  }
  double low() const { return low_; }
  double high() const { return high_; }

  /// Round values within, some five of them, and what they are multiples of; zero where they are
  /// powers of ten.
  std::pair<std::vector<double>, double> ticks() const {
    std::vector<double> result;
    if (log_) {
      const int first = static_cast<int>(std::ceil(std::log10(low_) - 1e-9));
      const int last = static_cast<int>(std::floor(std::log10(high_) + 1e-9));
      const int every = std::max(1, (last - first) / 5);
      for (int e = first; e <= last; e += every) result.push_back(std::pow(10.0, e));
      if (result.size() > 1) return {result, 0.0};
      result.clear();
    }
    const double rough = (high_ - low_) / 5.0;
    const double unit = power_of_ten_below(rough);
    const double step = unit * (rough < 1.5 * unit   ? 1.0
                                : rough < 3.5 * unit ? 2.0
                                : rough < 7.5 * unit ? 5.0
                                                     : 10.0);
    for (double i = std::ceil(low_ / step); i * step <= high_ * (1.0 + 1e-12) + 1e-12 * step; ++i)
      result.push_back(i * step);
    return {result, step};
  }

 private:
  double in(double value) const { return log_ ? std::log10(value) : value; }
  double low_, high_;
  bool log_;
  double from_, to_;
};

std::string power_of_ten(int n) {
  constexpr const char* kRaised[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = "10";
  for (const char c : std::to_string(n)) text += c == '-' ? "⁻" : kRaised[c - '0'];
  return text;
}

/// "mm/s" of "m/s" and -3; with the power itself where the unit takes no prefix.
std::string scaled_unit(const std::string& unit, int power) {
  if (power == 0) return unit;
  constexpr const char* kPrefixes[] = {"p", "n", "µ", "m", "", "k", "M", "G"};
  const std::string symbol = unit.substr(0, unit.find_first_of(" /"));
  for (const char* takes_prefix : {"m", "s", "N", "A", "V", "rad", "Hz"})
    if (symbol == takes_prefix && power >= -12 && power <= 9)
      return kPrefixes[power / 3 + 4] + unit;
  return power_of_ten(power) + (unit.empty() ? "" : " " + unit);
}

/// What stands beside an axis. The labels are short; what they leave out, a power of a thousand or
/// where they count from, is told by the name.
struct AxisText {
  std::vector<double> ticks;
  std::vector<std::string> labels;
  std::string name;
};

AxisText text_of(const ChartAxis& axis, const Scale& scale) {
  const auto with_minus = [](std::string text) {
    return text.starts_with('-') ? "−" + text.substr(1) : text;
  };
  const auto [ticks, step] = scale.ticks();
  AxisText text{ticks, {}, axis.label};
  std::string unit = axis.unit;
  if (step == 0.0) {
    for (const double v : ticks) {
      const int n = static_cast<int>(std::lround(std::log10(v)));
      text.labels.push_back(n >= -2 && n <= 3 ? fmt::format("{:g}", v) : power_of_ten(n));
    }
  } else {
    const double span = scale.high() - scale.low();
    double from = 0.0;
    if (span < 0.01 * std::max(std::abs(scale.low()), std::abs(scale.high()))) {
      const double round = std::pow(10.0, std::ceil(std::log10(span)));
      from = round * std::floor(scale.low() / round);
      text.name +=
          " from " + with_minus(fmt::format("{:.12g}", from)) + (unit.empty() ? "" : " " + unit);
    }
    const double largest = std::max(std::abs(scale.low() - from), std::abs(scale.high() - from));
    const int power = largest < 0.01 || largest >= 1e5
                          ? 3 * static_cast<int>(std::floor(std::log10(largest) / 3.0))
                          : 0;
    const double one = std::pow(10.0, power);
    const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step / one) + 1e-9)));
    for (const double v : ticks)
      text.labels.push_back(std::abs(v - from) < 0.5 * step
                                ? "0"
                                : with_minus(fmt::format("{:.{}f}", (v - from) / one, decimals)));
    unit = scaled_unit(unit, power);
  }
  if (!unit.empty()) text.name += " (" + unit + ")";
  return text;
}

/// Writes the path of an SVG in tenths of a unit, relative to the last point: that is short.
class Pen {
 public:
  void line_to(double x, double y) {
    move(down_ ? 'l' : 'm', x, y);
    down_ = true;
  }
  void dot(double x, double y) {
    move('m', x, y);
    path_ += "h0";
  }
  void lift() { down_ = false; }
  bool is_down() const { return down_; }
  const std::string& path() const { return path_; }

 private:
  void move(char how, double x, double y) {
    const long to_x = std::lround(10.0 * x), to_y = std::lround(10.0 * y);
    const auto tenths = [](long t) { return fmt::format("{:g}", 0.1 * static_cast<double>(t)); };
    const std::string dy = tenths(to_y - y_);
    path_ += how + tenths(to_x - x_) + (dy.starts_with('-') ? "" : ",") + dy;
    x_ = to_x;
    y_ = to_y;
  }

  std::string path_;
  long x_ = 0, y_ = 0;
  bool down_ = false;
};

/// Smallest and largest of what will be drawn.
struct Extent {
  double low = INFINITY, high = -INFINITY;
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

double y_of(const ChartSeries& s, const ChartColumns& columns, std::size_t i) {
  const double y = columns[s.y].values[i];
  return s.minus ? y - columns[*s.minus].values[i] : y;
}

std::size_t length_of(const ChartSeries& s, const ChartColumns& columns) {
  std::size_t n = std::min(columns[s.x].values.size(), columns[s.y].values.size());
  if (s.minus) n = std::min(n, columns[*s.minus].values.size());
  return n;
}

Scale scale_of(Extent extent, bool log, double margin, double from, double to) {
  if (!(extent.low <= extent.high)) extent = {log ? 0.1 : 0.0, 1.0};
  // Values that differ by rounding are one: a scale cannot be divided between them.
  constexpr double kRounding = 1e-12;
  if (log) {
    const double factor = std::pow(extent.high, margin) / std::pow(extent.low, margin);
    const double least = extent.high <= (1.0 + kRounding) * extent.low ? 2.0 : 1.0;
    return {extent.low / factor / least, extent.high * factor * least, true, from, to};
  }
  const double size = std::max(std::abs(extent.low), std::abs(extent.high));
  double room = margin * (extent.high - extent.low);
  if (!(extent.high - extent.low > kRounding * size)) room = std::max(1e-12, 0.1 * size);
  return {extent.low - room, extent.high + room, false, from, to};
}

/// What is zoomed into wants the width of the page.
bool is_wide(const Chart& chart) { return !chart.recording.empty(); }

class Drawing {
 public:
  Drawing(const Chart& chart, const ChartColumns& columns)
      : chart_(chart),
        columns_(columns),
        width_(is_wide(chart) ? kWide : kNarrow),
        x_(scale([&](const ChartSeries& s, std::size_t i) { return columns_[s.x].values[i]; },
                 chart.x.log, {}, 0.0, kLeft, width_ - kRight)),
        y_(scale([&](const ChartSeries& s, std::size_t i) { return y_of(s, columns_, i); },
                 chart.y.log, chart.bands, 0.06, kHeight - kBottom, kTop)) {}

  Html svg() const {
    return html(R"(<svg viewBox="0 0 {} {}" role="img" aria-label="{}">)", width_, kHeight,
                chart_.title) +
           ranges() + axes() + each(chart_.series, [&](const ChartSeries& s) { return path(s); }) +
           events() + names_of_bands() + Html::raw("</svg>");
  }

 private:
  template <class Value>
  Scale scale(Value&& value, bool log, const std::vector<ChartRange>& also, double margin,
              double from, double to) const {
    Extent extent;
    for (const ChartSeries& s : chart_.series)
      for (std::size_t i = 0; i < length_of(s, columns_); ++i)
        if (const double v = value(s, i); std::isfinite(v) && (!log || v > 0.0)) extent.add(v);
    for (const ChartRange& range : also) {
      extent.add(range.from);
      extent.add(range.to);
    }
    return scale_of(extent, log, margin, from, to);
  }

  Html ranges() const {
    Html all;
    for (const ChartRange& p : chart_.phases) {
      const double from = x_(std::clamp(p.from, x_.low(), x_.high()));
      const double to = x_(std::clamp(p.to, x_.low(), x_.high()));
      all += html(R"(<rect class="phase {}" x="{:.1f}" y="{}" width="{:.1f}" height="{}"/>)",
                  p.kind, from, kTop, std::max(0.5, to - from), kHeight - kTop - kBottom);
    }
    for (const ChartRange& b : chart_.bands)
      all += html(R"(<rect class="band" x="{}" y="{:.1f}" width="{}" height="{:.1f}"/>)", kLeft,
                  y_(b.to), width_ - kLeft - kRight, std::max(1.0, y_(b.from) - y_(b.to)));
    return all;
  }

  Html axes() const {
    Html all;
    const AxisText x = text_of(chart_.x, x_), y = text_of(chart_.y, y_);
    for (std::size_t i = 0; i < x.ticks.size(); ++i)
      all += html(R"(<path class="grid" d="M{0:.1f},{1}V{2}"/>)"
                  R"(<text class="tick" x="{0:.1f}" y="{3}" text-anchor="middle">{4}</text>)",
                  x_(x.ticks[i]), kTop, kHeight - kBottom, kHeight - kBottom + 14.0, x.labels[i]);
    for (std::size_t i = 0; i < y.ticks.size(); ++i)
      all += html(R"(<path class="grid" d="M{1},{0:.1f}H{2}"/>)"
                  R"(<text class="tick" x="{3}" y="{4:.1f}" text-anchor="end">{5}</text>)",
                  y_(y.ticks[i]), kLeft, width_ - kRight, kLeft - 6.0, y_(y.ticks[i]) + 3.5,
                  y.labels[i]);
    all += html(R"(<path class="axis" d="M{},{}V{}H{}"/>)", kLeft, kTop, kHeight - kBottom,
                width_ - kRight);
    all += html(R"(<text class="label" x="{}" y="{}" text-anchor="middle">{}</text>)",
                0.5 * (kLeft + width_ - kRight), kHeight - 8.0, x.name);
    return all + html(R"(<text class="label" x="{0}" y="{1}" text-anchor="middle" )"
                      R"svg(transform="rotate(-90 {0} {1})">{2}</text>)svg",
                      13.0, 0.5 * (kTop + kHeight - kBottom), y.name);
  }

  /// A line through the smallest and the largest value of every column of pixels, in their order.
  std::string line(const ChartSeries& s) const {
    constexpr double kColumn = 1.5;  // wide
    const Values& x = columns_[s.x].values;
    const auto column = [&](std::size_t i) { return std::floor(x_(x[i]) / kColumn); };
    const auto shown = [&](std::size_t i) {
      return x_.shows(x[i]) && y_.shows(y_of(s, columns_, i));
    };
    const std::size_t n = length_of(s, columns_);
    Pen pen;
    double before = 0.0;
    for (std::size_t i = 0; i < n;) {
      if (!shown(i)) {
        pen.lift();
        ++i;
        continue;
      }
      std::size_t low = i, high = i, end = i + 1;
      for (; end < n && shown(end) && column(end) == column(i); ++end) {
        if (y_of(s, columns_, end) < y_of(s, columns_, low)) low = end;
        if (y_of(s, columns_, end) > y_of(s, columns_, high)) high = end;
      }
      for (const std::size_t k : {std::min(low, high), std::max(low, high)}) {
        const double y = y_(y_of(s, columns_, k));
        if (s.style == LineStyle::steps && pen.is_down()) pen.line_to(x_(x[k]), before);
        pen.line_to(x_(x[k]), y);
        before = y;
        if (low == high) break;
      }
      i = end;
    }
    return pen.path();
  }

  std::string dots(const ChartSeries& s) const {
    const Values& x = columns_[s.x].values;
    const std::size_t n = length_of(s, columns_), every = n / kDots + 1;
    Pen pen;
    for (std::size_t i = 0; i < n; i += every)
      if (const double y = y_of(s, columns_, i); x_.shows(x[i]) && y_.shows(y))
        pen.dot(x_(x[i]), y_(y));
    return pen.path();
  }

  Html path(const ChartSeries& s) const {
    const bool as_dots = s.style == LineStyle::dots;
    const char* kind = !as_dots ? "" : length_of(s, columns_) <= kFewDots ? " dots few" : " dots";
    return html(R"(<path class="series {}{}" d="{}"/>)", s.role, kind, as_dots ? dots(s) : line(s));
  }

  /// Ticks below the upper edge, one for each pixel in which something happens; where they are
  /// few, also lines.
  Html events() const {
    std::vector<std::vector<double>> places;
    std::size_t count = 0;
    for (const ChartEvents& e : chart_.events) {
      std::vector<double>& at = places.emplace_back();
      for (const double t : columns_[e.at].values)
        if (t >= x_.low() && t <= x_.high() && (at.empty() || x_(t) >= at.back() + 1.0))
          at.push_back(x_(t));
      count += at.size();
    }
    const bool few = static_cast<double>(count) <= (width_ - kLeft - kRight) / 12.0;
    Html all;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const ChartEvents& e = chart_.events[i];
      std::string ticks, lines;
      for (const double x : places[i]) {
        ticks += fmt::format("M{:.1f},{}v8", x, kTop);
        lines += fmt::format("M{:.1f},{}V{}", x, kTop, kHeight - kBottom);
      }
      if (few) all += html(R"(<path class="event line {}" d="{}"/>)", e.kind, lines);
      all +=
          html(R"(<path class="event {}" d="{}"><title>{}</title></path>)", e.kind, ticks, e.text);
    }
    return all;
  }

  Html names_of_bands() const {
    return each(chart_.bands, [&](const ChartRange& b) {
      return html(R"(<text class="tick" x="{}" y="{:.1f}" text-anchor="end">{}</text>)",
                  width_ - kRight - 6.0, y_(b.to) - 5.0, b.text);
    });
  }

  const Chart& chart_;
  const ChartColumns& columns_;
  const double width_;
  const Scale x_, y_;
};

Html swatch(const std::string& looks, const std::string& words, const char* kind) {
  return html(R"(<span class="{}"><span class="swatch {}"></span>{}</span>)", kind, looks, words);
}

/// Names of the series, kinds of events and phases, in their colours.
Html legend(const Chart& chart, const ChartColumns& columns) {
  Html all = each(chart.series, [](const ChartSeries& s) {
    return swatch(fmt::format("{}{}", s.role, s.style == LineStyle::dots ? " dots" : ""), s.label,
                  "key");
  });
  for (const ChartEvents& e : chart.events)
    all += swatch(fmt::format("tick {}", e.kind),
                  fmt::format("{} ({})", e.kind, columns[e.at].values.size()), "kind");
  std::set<std::string_view> kinds;
  for (const ChartRange& p : chart.phases)
    if (kinds.insert(p.kind).second)
      all += swatch(fmt::format("area {}", p.kind),
                    p.kind == "limit" ? "at a limit" : std::string(p.kind), "kind");
  return all;
}

nlohmann::ordered_json column_data(const ChartColumn& column) {
  const std::size_t n = column.values.size();
  const double start = column.values.empty() ? 0.0 : column.values.front();
  if (column.step == 0.0)
    return {
        {"length", n},
        {"start", start},
        // As it was meant, without the rounding of many sums.
        {"interval",
         n > 1 ? round_to_digits((column.values.back() - start) / static_cast<double>(n - 1), 12)
               : 1.0}};
  std::string bytes(4 * n, '\0');
  std::uint32_t before = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double v = column.values[i];
    const auto k = static_cast<std::uint32_t>(
        std::isfinite(v) ? static_cast<std::int32_t>(std::lround((v - column.origin) / column.step))
                         : std::numeric_limits<std::int32_t>::min());
    const std::uint32_t difference = k - before;
    before = k;
    for (std::size_t plane = 0; plane < 4; ++plane)
      bytes[plane * n + i] = static_cast<char>(difference >> (8 * plane) & 0xFF);
  }
  return {{"length", n}, {"start", column.origin}, {"step", column.step}, {"data", packed(bytes)}};
}

nlohmann::ordered_json axis_data(const ChartAxis& axis) {
  return {{"label", axis.label}, {"unit", axis.unit}, {"log", axis.log}};
}

nlohmann::ordered_json chart_json(const Chart& chart) {
  using Json = nlohmann::ordered_json;
  constexpr const char* kStyles[] = {"line", "dots", "steps"};
  Json series = Json::array(), phases = Json::array(), bands = Json::array(),
       events = Json::array();
  bool dots = true;
  for (const ChartSeries& s : chart.series) {
    Json one{{"label", s.label},
             {"role", s.role},
             {"x", s.x},
             {"y", s.y},
             {"style", kStyles[static_cast<std::size_t>(s.style)]}};
    if (s.minus) one["minus"] = *s.minus;
    series.push_back(std::move(one));
    dots = dots && s.style == LineStyle::dots;
  }
  for (const ChartRange& p : chart.phases)
    phases.push_back({{"from", p.from}, {"to", p.to}, {"kind", p.kind}, {"text", p.text}});
  for (const ChartRange& b : chart.bands)
    bands.push_back({{"from", b.from}, {"to", b.to}, {"text", b.text}});
  for (const ChartEvents& e : chart.events)
    events.push_back({{"kind", e.kind}, {"text", e.text}, {"at", e.at}});
  Json json{
      {"id", chart.id},          {"title", chart.title},    {"kind", dots ? "points" : "lines"},
      {"x", axis_data(chart.x)}, {"y", axis_data(chart.y)}, {"series", std::move(series)}};
  if (!chart.recording.empty()) json.update(Json{{"time", true}, {"recording", chart.recording}});
  if (!phases.empty()) json["phases"] = std::move(phases);
  if (!bands.empty()) json["bands"] = std::move(bands);
  if (!events.empty()) json["events"] = std::move(events);
  return json;
}

}  // namespace

ChartColumns::Index ChartColumns::add(std::vector<double> values, double resolution,
                                      double origin) {
  double largest = 0.0;
  for (const double v : values)
    if (std::isfinite(v)) largest = std::max(largest, std::abs(v - origin));
  double step = power_of_ten_below(resolution);
  while (largest > 1e9 * step) step *= 10.0;
  return index_of({std::move(values), step, origin});
}

ChartColumns::Index ChartColumns::index_of(ChartColumn column) {
  const auto same = std::ranges::find(columns_, column);
  if (same != columns_.end()) return static_cast<Index>(same - columns_.begin());
  columns_.push_back(std::move(column));
  return columns_.size() - 1;
}

ChartColumns::Index ChartColumns::add_times(std::vector<double> times) {
  const std::size_t n = times.size();
  const double interval = n > 1 ? mean_interval(times) : 1.0;
  double shortest = interval;
  bool even = true;
  for (std::size_t i = 1; i < n; ++i) {
    shortest = std::min(shortest, times[i] - times[i - 1]);
    even = even &&
           std::abs(times[i] - times.front() - static_cast<double>(i) * interval) < 1e-6 * interval;
  }
  if (even) {
    return index_of({std::move(times)});
  }
  const double origin = std::floor(times.front());
  return add(std::move(times), 1e-3 * shortest, origin);
}

ChartColumns::Index ChartColumns::add_coarse(std::vector<double> values) {
  Extent extent;
  for (const double v : values)
    if (std::isfinite(v)) extent.add(v);
  const double range = extent.high - extent.low;
  return add(std::move(values), range > 0.0 && std::isfinite(range) ? 1e-4 * range : 1.0);
}

ChartColumns::Index ChartColumns::add_for_log(std::vector<double> values) {
  double least = INFINITY;
  for (const double v : values)
    if (v > 0.0) least = std::min(least, v);
  return add(std::move(values), std::isfinite(least) ? 0.01 * least : 1.0);
}

Html figure(const Chart& chart, const ChartColumns& columns) {
  return html(R"(<figure class="chart{}" id="{}"><figcaption>{}</figcaption>)"
              R"(<div class="tools"></div><div class="legend">{}</div><div class="reading"></div>)"
              "{}</figure>",
              is_wide(chart) ? " wide" : "", chart.id, chart.title, legend(chart, columns),
              Drawing(chart, columns).svg());
}

nlohmann::ordered_json chart_data(std::span<const Chart> charts, const ChartColumns& columns) {
  nlohmann::ordered_json json{{"columns", nlohmann::ordered_json::array()},
                              {"charts", nlohmann::ordered_json::array()}};
  for (std::size_t i = 0; i < columns.size(); ++i)
    json["columns"].push_back(column_data(columns[i]));
  for (const Chart& chart : charts) json["charts"].push_back(chart_json(chart));
  return json;
}

}  // namespace axisfit
