// Charts of the report: one description, drawn twice. As SVG, for readers without scripts and for
// paper; and as data, from which the page's script draws charts to zoom into.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "report/html/html.h"

namespace axisfit {

/// Values that charts share. Not a number: none.
struct ChartColumn {
  std::vector<double> values;
  /// To what they are kept for the script: a power of ten. Zero: they are evenly spaced, and need
  /// not be kept one by one.
  double step = 0.0;
  double origin = 0.0;  ///< what the multiples of the step are counted from

  bool operator==(const ChartColumn&) const = default;
};

/// All that the charts of a page draw.
class ChartColumns {
 public:
  using Index = std::size_t;

  /// Keeps values to a power of ten that is no more than `resolution` (> 0), in the unit of the
  /// values, or so much coarser that they fit 31 bits, counted from `origin`.
  Index add(std::vector<double> values, double resolution, double origin = 0.0);
  /// Increasing times, to a thousandth of the shortest interval.
  Index add_times(std::vector<double> times);
  /// Values for a chart that nobody reads numbers from: to a ten-thousandth of their range.
  Index add_coarse(std::vector<double> values);
  /// Values for a logarithmic axis: to a hundredth of the smallest above zero.
  Index add_for_log(std::vector<double> values);

  const ChartColumn& operator[](Index i) const { return columns_[i]; }
  std::size_t size() const { return columns_.size(); }

 private:
  /// Where a column is: many charts draw the same one.
  Index index_of(ChartColumn column);

  std::vector<ChartColumn> columns_;
};

enum class LineStyle { line, dots, steps };

struct ChartSeries {
  std::string label;
  /// What it shows, and so its colour: measured, simulated, residual, force, accepted, mean,
  /// reference.
  std::string_view role;
  ChartColumns::Index x = 0, y = 0;
  LineStyle style = LineStyle::line;
  std::optional<ChartColumns::Index> minus = {};  ///< y is column y less this one
};

struct ChartAxis {
  std::string label;
  std::string unit = {};  ///< empty: none
  bool log = false;
};

/// A stretch of x (phase) or of y (band).
struct ChartRange {
  double from = 0.0, to = 0.0;
  std::string_view kind = {};  ///< of a phase: "standstill", "limit"
  std::string text;
};

/// Marks of one kind along x.
struct ChartEvents {
  std::string_view kind;  ///< "contact", "separation", "limit", "stick", "slip"
  std::string text;
  ChartColumns::Index at = 0;
};

struct Chart {
  std::string id;  ///< of the element in the page; letters, digits and hyphens
  std::string title;
  ChartAxis x, y;
  std::vector<ChartSeries> series;
  /// Name of the recording whose time x is; all such charts are zoomed together. Empty: none.
  std::string recording = {};
  std::vector<ChartRange> phases = {}, bands = {};
  std::vector<ChartEvents> events = {};
};

/// The figure of the chart: title, legend, and a still SVG. Lines are thinned to what the width
/// shows, by minimum and maximum, dots to every so many. Its rows for tools and for what is read
/// are empty; the script fills them, and nothing moves.
Html figure(const Chart& chart, const ChartColumns& columns);

/// What the script draws the charts from: {"columns": [...], "charts": [...]}. Columns are
/// differences of whole multiples of their step, compressed by zlib, in base64; a missing value is
/// -2147483648.
nlohmann::ordered_json chart_data(std::span<const Chart> charts, const ChartColumns& columns);

}  // namespace axisfit
