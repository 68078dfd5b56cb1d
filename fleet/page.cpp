#include "fleet/page.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "base/embedded.h"
#include "base/version.h"
#include "report/html/html.h"
#include "report/html/packed.h"

AXISFIT_EMBEDDED(fleet_css)
AXISFIT_EMBEDDED(fleet_js)

namespace axisfit {
namespace {

using Json = nlohmann::ordered_json;

/// Numbers by axes and nights, as a browser's Float32Array has them.
struct Matrix {
  explicit Matrix(std::size_t size) : numbers(size, std::numeric_limits<float>::quiet_NaN()) {}
  std::vector<float> numbers;

  std::string packed() const {
    static_assert(std::endian::native == std::endian::little);
    return axisfit::packed(
        {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(float)});
  }
};

struct Course {
  std::string unit;
  Matrix values, errors;
};

/// JSON that cannot end the script element that it is in.
std::string for_script(const Json& json) {
  std::string text = json.dump();
  for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos; at += 6)
    text.replace(at, 1, "\\u003c");
  return text;
}

constexpr const char* kPage = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Fleet</title>
<meta name="generator" content="axisfit {0}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'">
<style>{1}</style></head><body>
<header><h1>Fleet</h1><p class="muted">{2} axes, {3} nights, {4} results: {5} failed, {6} without a usable fit. {7} courses are watched.</p></header>
<main>
<section aria-labelledby="axes"><h2 id="axes">Axes</h2><div id="map"></div>
<p><span class="key"><i></i>as it was</span><span class="key"><i data-state="parameter"></i>parameter changed</span><span class="key"><i data-state="effect"></i>effect appeared</span><span class="key"><i data-state="failures"></i>last night failed</span><span class="key"><i data-state="outlier"></i>unlike the fleet</span></p></section>
<section><h2 id="latest">Alarms, the latest first</h2><div class="scroll" id="alarms" tabindex="0" role="region" aria-labelledby="latest"></div></section>
<section aria-labelledby="courses"><h2 id="courses">Courses</h2>
<div class="controls"><label>Course <select id="course"></select></label><label>Axes <input id="filter" type="search" placeholder="part of a name"></label></div>
<div id="list"></div></section>
<section id="axis" aria-labelledby="axis-name" hidden><h2 id="axis-name"></h2><p id="axis-text" class="muted"></p><div id="axis-alarms"></div><h2>Nights, with 95 % intervals</h2><div id="charts"></div></section>
</main>
{8}<script>{9}</script></body></html>
)";

}  // namespace

std::string fleet_page(const std::vector<NightResult>& results, const FleetReport& report) {
  std::vector<std::string> names;
  for (const NightResult& r : results) names.push_back(r.night);
  const std::map<std::string, double> days = days_of(names);
  std::vector<std::pair<double, std::string>> nights;
  for (const auto& [name, day] : days) nights.emplace_back(day, name);
  std::ranges::sort(nights);
  std::map<std::string, std::size_t> night_places, axis_places;
  Json night_names = Json::array(), night_days = Json::array(), axes = Json::array();
  for (const auto& [day, name] : nights) {
    night_places[name] = night_places.size();
    night_names.push_back(name);
    night_days.push_back(day);
  }
  for (const NightResult& r : results)
    if (axis_places.emplace(r.axis, axis_places.size()).second)
      axes.push_back({{"name", r.axis}, {"state", ""}, {"results", 0}, {"failed", 0}});
  const std::size_t size = axes.size() * nights.size();
  std::map<std::string, Course> courses;
  const auto set = [&](const NightResult& r, const std::string& name, const std::string& unit,
                       double value, double error) {
    auto course = courses.find(name);
    if (course == courses.end())
      course = courses.emplace(name, Course{unit, Matrix(size), Matrix(size)}).first;
    const std::size_t at = axis_places.at(r.axis) * nights.size() + night_places.at(r.night);
    course->second.values.numbers[at] = static_cast<float>(value);
    course->second.errors.numbers[at] = static_cast<float>(error);
  };
  for (const NightResult& r : results) {
    Json& axis = axes[axis_places.at(r.axis)];
    axis["results"] = axis["results"].get<int>() + 1;
    if (r.status == "failed") axis["failed"] = axis["failed"].get<int>() + 1;
    for (const auto& p : r.parameters) set(r, p.name, p.unit, p.value, p.standard_error);
    for (const auto& s : r.residuals)
      if (s.role == "fit") set(r, residual_name(s), s.unit, s.rmse, 0.0);
  }
  std::map<std::string, std::size_t> course_places;
  Json list = Json::array();
  Html columns;
  for (const auto& [name, course] : courses) {
    const std::size_t k = course_places.size();
    course_places[name] = k;
    list.push_back({{"name", name}, {"unit", course.unit}});
    columns += html(
        "<script type=\"text/plain\" id=\"values-{0}\">{1}</script>\n"
        "<script type=\"text/plain\" id=\"errors-{0}\">{2}</script>\n",
        k, Html::raw(course.values.packed()), Html::raw(course.errors.packed()));
  }
  Json alarms = Json::array();
  for (const Alarm& a : report.alarms) {
    const auto course = course_places.find(a.what);
    const std::size_t axis = axis_places.at(a.axis);
    alarms.push_back(
        {{"axis", axis},
         {"at", night_places.at(a.night)},
         {"course", course == course_places.end() ? -1 : static_cast<int>(course->second)},
         {"text", a.text}});
    // The state that matters most, of those that it is in.
    constexpr std::array kRanks{"outlier", "parameter", "effect", "failures"};
    const auto rank = [&](const std::string& s) {
      return std::ranges::find(kRanks, s) - kRanks.begin();
    };
    const std::string state = kind_name(a.kind), known = axes[axis]["state"];
    if (known.empty() || rank(state) > rank(known)) axes[axis]["state"] = state;
  }
  const Json data{{"nights", night_names},
                  {"days", night_days},
                  {"axes", axes},
                  {"courses", list},
                  {"alarms", alarms}};
  const Html packed = html("<script type=\"application/json\" id=\"data\">{}</script>\n",
                           Html::raw(for_script(data))) +
                      columns;
  return html(kPage, version(), Html::raw(embedded_fleet_css()), report.axes, report.nights,
              report.results, report.failed, report.unusable, report.charts, packed,
              Html::raw(embedded_fleet_js()))
      .text();
}

}  // namespace axisfit
