#include "fleet/alarms.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>
#include <stdexcept>

#include "base/text_table.h"
#include "base/units.h"
#include "fleet/control_chart.h"
#include "fleet/trend.h"

namespace axisfit {
namespace {

std::optional<double> date_of(const std::string& night) {
  int year = 0, month = 0, day = 0, read = 0;
  if (std::sscanf(night.c_str(), "%4d-%2d-%2d%n", &year, &month, &day, &read) != 3 ||
      read != static_cast<int>(night.size()))
    return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year(year),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  if (!date.ok()) return std::nullopt;
  return static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count());
}

std::optional<double> number_of(const std::string& night) {
  long value = 0;
  const auto read = std::from_chars(night.data(), night.data() + night.size(), value);
  if (read.ec != std::errc() || read.ptr != night.data() + night.size()) return std::nullopt;
  return static_cast<double>(value);
}

/// The results of one axis.
using AxisNights = std::vector<const NightResult*>;

struct Course {
  std::string axis, unit;
  Trend trend;
};

/// The course of each parameter of each axis.
std::map<std::string, std::vector<Course>> courses_of(const std::map<std::string, AxisNights>& axes,
                                                      const std::map<std::string, double>& days) {
  std::map<std::string, std::vector<Course>> courses;
  for (const auto& [axis, nights] : axes) {
    std::map<std::string, std::pair<std::string, std::vector<TrendNight>>> by_name;
    std::set<std::string> channels;
    for (const NightResult* n : nights)
      for (const auto& c : n->channels) channels.insert(c.name);
    for (const NightResult* n : nights) {
      std::vector<NightResult::Parameter> watched = n->parameters;
      // What no parameter explains. Its error is a guess: the own scatter is learnt anyway.
      constexpr double kErrorOfResidual = 0.02;
      for (const auto& r : n->residuals)
        if (r.role == "fit")
          watched.push_back({residual_name(r), r.unit, r.rmse, kErrorOfResidual * r.rmse});
      for (const auto& p : watched) {
        if (!std::isfinite(p.value) || !(p.standard_error > 0.0)) continue;
        TrendNight night{n->night, days.at(n->night), p.value, p.standard_error, {}};
        for (const std::string& name : channels) {
          const auto c = std::ranges::find(n->channels, name, &NightResult::Channel::name);
          if (c != n->channels.end() && std::isfinite(c->mean)) night.channels.push_back(c->mean);
        }
        if (night.channels.size() != channels.size()) continue;
        auto& [unit, list] = by_name[p.name];
        unit = p.unit;
        list.push_back(std::move(night));
      }
    }
    for (auto& [name, entry] : by_name)
      courses[name].push_back({axis, entry.first, Trend(std::move(entry.second))});
  }
  return courses;
}

/// "in 5 weeks"
std::string in_time(double days) {
  if (days < 14.0) return fmt::format("in {:.0f} days", std::max(1.0, days));
  if (days < 100.0) return fmt::format("in {:.0f} weeks", days / 7.0);
  return fmt::format("in {:.0f} months", days / 30.4);
}

std::string limit_text(const std::string& name, const Course& course, const Change& change,
                       const AlarmOptions& options) {
  const auto limit = options.limits.find(name);
  if (limit == options.limits.end()) return "";
  const auto& [amount, unit] = limit->second;
  const auto factor = unit_factor(unit, course.unit);
  if (const auto* error = std::get_if<UnitError>(&factor))
    throw std::runtime_error(fmt::format("limit of {}: {}", name, error->message));
  const double bound = amount * std::get<double>(factor), now = course.trend.nights().back().value;
  const std::string text = with_unit(fmt::format("{:.4g}", amount), unit);
  if ((change.before < bound) != (now < bound))
    return fmt::format(" The limit of {} is passed.", text);
  const double days = (bound - now) / change.per_day;
  if (change.per_day == 0.0 || !(days > 0.0)) return "";
  return fmt::format(" At this rate the limit of {} is met {}.", text, in_time(days));
}

/// "2.7 %", "12 %", "766-fold", or the difference where there is no ratio.
std::string amount_of(const Change& change, const std::string& unit) {
  if (change.before > 0.0 && change.after > 0.0) {
    const double ratio = change.after / change.before, percent = 100.0 * std::abs(ratio - 1.0);
    if (ratio >= 3.0) return fmt::format("{:.3g}-fold", ratio);
    return percent < 9.95 ? fmt::format("{:.2g} %", percent) : fmt::format("{:.0f} %", percent);
  }
  return with_unit(fmt::format("{:.3g}", std::abs(change.after - change.before)), unit);
}

Alarm alarm_of(const std::string& name, const Course& course, const Change& change,
               const AlarmOptions& options) {
  const std::vector<TrendNight>& nights = course.trend.nights();
  Alarm alarm{Alarm::Kind::parameter,
              course.axis,
              name,
              nights[change.night].night,
              nights[change.since].night,
              change.before,
              change.after,
              change.errors,
              {}};
  alarm.text = fmt::format("{} {} {} since {}, from {:.4g} to {}, {:.1f} standard errors.", name,
                           change.after > change.before ? "up" : "down",
                           amount_of(change, course.unit), alarm.since, change.before,
                           with_unit(fmt::format("{:.4g}", change.after), course.unit),
                           std::abs(change.errors));
  alarm.text += limit_text(name, course, change, options);
  return alarm;
}

/// An effect that is there on two of three nights in a row, and was not before.
void add_effects(const AxisNights& nights, std::vector<Alarm>& alarms) {
  std::map<std::string, std::vector<std::size_t>> seen;  // by names without shapes: nights
  for (std::size_t i = 0; i < nights.size(); ++i)
    for (const std::string& effect : nights[i]->effects)
      seen[effect.substr(0, effect.find(','))].push_back(i);
  for (const auto& [name, when] : seen) {
    if (when.front() == 0) continue;  // as the axis came
    for (std::size_t k = 1; k < when.size(); ++k) {
      if (when[k] - when[k - 1] > 2) continue;
      const NightResult& now = *nights[when[k]];
      // With the shape that most nights give it: a single one may be led astray.
      std::map<std::string, int> forms;
      for (const NightResult* night : nights)
        for (const std::string& effect : night->effects)
          if (effect.substr(0, effect.find(',')) == name) ++forms[effect];
      const std::string& full =
          std::ranges::max_element(forms, {}, &std::pair<const std::string, int>::second)->first;
      alarms.push_back(
          {Alarm::Kind::effect, now.axis, name, now.night, nights[when[k - 1]]->night, 0.0, 0.0,
           0.0, fmt::format("{} has appeared, since {}.", full, nights[when[k - 1]]->night)});
      break;
    }
  }
}

/// Axes whose parameter is far from those of the others.
void add_outliers(const std::string& name, const std::vector<Course>& courses,
                  std::vector<Alarm>& alarms) {
  constexpr std::size_t kLeast = 8;
  constexpr double kFar = 6.0;
  if (courses.size() < kLeast) return;
  std::vector<double> means;
  for (const Course& c : courses) means.push_back(c.trend.mean());
  const auto median = [](std::vector<double> v) {
    std::ranges::sort(v);
    return 0.5 * (v[(v.size() - 1) / 2] + v[v.size() / 2]);
  };
  const double middle = median(means);
  std::vector<double> deviations;
  for (const double m : means) deviations.push_back(std::abs(m - middle));
  const double spread = 1.4826 * median(deviations);
  for (std::size_t i = 0; i < courses.size(); ++i)
    if (spread > 0.0 && std::abs(means[i] - middle) > kFar * spread) {
      const std::vector<TrendNight>& nights = courses[i].trend.nights();
      alarms.push_back(
          {Alarm::Kind::outlier, courses[i].axis, name, nights.back().night, nights.front().night,
           middle, means[i], (means[i] - middle) / spread,
           fmt::format("{} is {}, where the fleet has {}, {:.0f} times its spread away.", name,
                       with_unit(fmt::format("{:.6g}", means[i]), courses[i].unit),
                       with_unit(fmt::format("{:.6g}", middle), courses[i].unit),
                       std::abs(means[i] - middle) / spread)});
    }
}

}  // namespace

const char* kind_name(Alarm::Kind kind) {
  constexpr std::array kNames{"parameter", "effect", "failures", "outlier"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::string residual_name(const NightResult::Residual& residual) {
  return fmt::format("residual of {} in {}", residual.signal, residual.recording);
}

std::map<std::string, double> days_of(const std::vector<std::string>& nights) {
  const std::set<std::string> all(nights.begin(), nights.end());
  std::map<std::string, double> days;
  for (const auto& read : {date_of, number_of}) {
    days.clear();
    for (const std::string& night : all)
      if (const auto day = read(night)) days[night] = *day;
    if (days.size() == all.size()) return days;
  }
  days.clear();
  for (const std::string& night : all) days[night] = static_cast<double>(days.size());
  return days;
}

FleetReport look_at(const std::vector<NightResult>& results, const AlarmOptions& options) {
  FleetReport report;
  report.results = results.size();
  std::vector<std::string> names;
  for (const NightResult& r : results) names.push_back(r.night);
  const std::map<std::string, double> days = days_of(names);
  report.nights = days.size();
  std::map<std::string, AxisNights> axes;
  for (const NightResult& r : results) {
    AxisNights& nights = axes[r.axis];
    report.failed += r.status == "failed";
    report.unusable += r.status != "failed" && r.parameters.empty();
    nights.push_back(&r);
  }
  for (auto& [axis, nights] : axes)
    std::ranges::stable_sort(nights, {}, [&](const NightResult* n) { return days.at(n->night); });
  report.axes = axes.size();

  const auto courses = courses_of(axes, days);
  for (const auto& [name, list] : courses) report.charts += list.size();
  // A false alarm of an axis may come from any of its charts.
  const double per_axis = static_cast<double>(report.charts) /
                          static_cast<double>(std::max<std::size_t>(1, axes.size()));
  report.threshold = threshold_for(options.one_in * std::max(1.0, per_axis));
  for (const auto& [name, list] : courses) {
    std::vector<Trend> trends;
    for (const Course& course : list) trends.push_back(course.trend);
    const ScatterPrior prior = prior_of(trends);
    for (const Course& course : list)
      for (const Change& change : course.trend.changes(prior, report.threshold))
        report.alarms.push_back(alarm_of(name, course, change, options));
    add_outliers(name, list, report.alarms);
  }
  for (const auto& [axis, nights] : axes) {
    add_effects(nights, report.alarms);
    const NightResult& last = *nights.back();
    if (last.status == "failed")
      report.alarms.push_back({Alarm::Kind::failures, axis, "", last.night, last.night, 0.0, 0.0,
                               0.0, "The last night failed: " + last.reason});
  }
  std::ranges::stable_sort(report.alarms, {},
                           [&](const Alarm& a) { return std::pair(a.axis, days.at(a.night)); });
  return report;
}

nlohmann::ordered_json to_json(const FleetReport& report) {
  nlohmann::ordered_json alarms = nlohmann::ordered_json::array();
  for (const Alarm& a : report.alarms)
    alarms.push_back({{"axis", a.axis},
                      {"kind", kind_name(a.kind)},
                      {"what", a.what},
                      {"night", a.night},
                      {"since", a.since},
                      {"before", a.before},
                      {"after", a.after},
                      {"standard_errors", a.errors},
                      {"text", a.text}});
  return {{"axes", report.axes},           {"nights", report.nights},
          {"results", report.results},     {"failed", report.failed},
          {"unusable", report.unusable},   {"courses", report.charts},
          {"threshold", report.threshold}, {"alarms", alarms}};
}

std::string report_text(const FleetReport& report) {
  std::string text = fmt::format(
      "{} axes, {} nights, {} results: {} failed, {} without a usable fit.\n"
      "{} courses of parameters are watched; a chart alarms at {:.2f}.\n\n",
      report.axes, report.nights, report.results, report.failed, report.unusable, report.charts,
      report.threshold);
  if (report.alarms.empty()) return text + "No axis has changed.\n";
  std::vector<std::vector<std::string>> rows{{"axis", "night", "alarm"}};
  for (const Alarm& a : report.alarms) rows.push_back({a.axis, a.night, a.text});
  return text + format_table(rows, {Alignment::left, Alignment::left, Alignment::left});
}

}  // namespace axisfit
