#include "report/html/report_charts.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>

#include "fit/data/standstill.h"
#include "fit/judge/spectrum.h"
#include "report/text/names.h"
#include "report/text/words.h"
#include "sim/sampling.h"

namespace axisfit {
namespace {

using Values = std::vector<double>;

/// Of a value that noise of this size hides.
double resolution(const Measurement& m) { return 0.01 * m.sigma; }

std::string signal_name(const Measurement& m, Vocabulary vocabulary) {
  return std::string(info(m.signal, vocabulary).name);
}

/// "Velocity of step"
std::string title_of(const Measurement& m, const Recording& recording, Vocabulary vocabulary) {
  std::string name = signal_name(m, vocabulary);
  name.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(name.front())));
  return fmt::format("{} of {}", name, recording.name);
}

/// Whether values are told apart better by their logarithms.
bool spans_a_decade(const std::vector<double>& values) {
  const auto [least, most] = std::ranges::minmax(values);
  return most > 10.0 * least;
}
std::string unit_of(const Measurement& m, Vocabulary vocabulary) {
  return std::string(info(m.signal, vocabulary).unit);
}

/// Stretches of time in which a condition holds, from what holds from each instant on. Those that
/// nobody could see apart are joined.
class Stretches {
 public:
  Stretches(std::string_view kind, std::string text, double smallest)
      : kind_(kind), text_(std::move(text)), smallest_(smallest) {}

  void add(double time, bool holds) {
    if (holds == holds_) return;
    holds_ = holds;
    if (!holds)
      list_.back().to = time;
    else if (list_.empty() || time - list_.back().to > smallest_)
      list_.push_back({time, time, kind_, text_});
  }
  void end(double time, std::vector<ChartRange>& all) {
    add(time, false);
    all.insert(all.end(), list_.begin(), list_.end());
  }

 private:
  std::string_view kind_;
  std::string text_;
  double smallest_;
  bool holds_ = false;
  std::vector<ChartRange> list_;
};

std::vector<ChartRange> phases_of(const Recording& recording,
                                  const std::vector<ModeChange>& modes) {
  const double start = recording.times.front(), end = recording.times.back();
  const double smallest = 5e-4 * (end - start);
  Stretches standstill("standstill", "standstill", smallest);
  Stretches preamplifier("limit", "preamplifier at its limit", smallest);
  Stretches motor("limit", "motor voltage at its limit", smallest);
  const std::vector<bool> at_standstill = axisfit::at_standstill(recording);
  for (std::size_t i = 0; i < at_standstill.size(); ++i)
    standstill.add(recording.times[i], at_standstill[i]);
  for (const ModeChange& change : modes) {
    preamplifier.add(change.time, change.mode.v_c != 0);
    motor.add(change.time, change.mode.v_m != 0);
  }
  std::vector<ChartRange> phases;
  for (Stretches* stretches : {&standstill, &preamplifier, &motor}) stretches->end(end, phases);
  return phases;
}

struct EventTimes {
  std::string_view kind;
  std::string_view text;
  Values times;
};

/// What happened between one mode and the next.
std::vector<EventTimes> events_of(const std::vector<ModeChange>& modes, Vocabulary vocabulary) {
  std::vector<EventTimes> list{{"contact", "teeth touch", {}},
                               {"separation", "teeth separate", {}},
                               {"limit", "a limit is reached or left", {}},
                               {"stick", words_on(vocabulary, "the arm sticks"), {}},
                               {"slip", words_on(vocabulary, "the arm breaks away"), {}}};
  for (std::size_t i = 1; i < modes.size(); ++i) {
    const Mode &from = modes[i - 1].mode, &to = modes[i].mode;
    const bool happened[] = {
        from.contact != to.contact && to.contact != 0, from.contact != 0 && to.contact == 0,
        from.v_c != to.v_c || from.v_m != to.v_m, from.sliding != 0 && to.sliding == 0,
        from.sliding == 0 && to.sliding != 0};
    for (std::size_t k = 0; k < list.size(); ++k)
      if (happened[k]) list[k].times.push_back(modes[i].time);
  }
  std::erase_if(list, [](const EventTimes& e) { return e.times.empty(); });
  return list;
}

/// Every so many, so that few enough are left for a picture.
template <class T>
std::vector<T> thinned(const std::vector<T>& values) {
  constexpr std::size_t kMost = 2000;
  const std::size_t every = (values.size() + kMost - 1) / kMost;
  std::vector<T> kept;
  for (std::size_t i = 0; i < values.size(); i += std::max<std::size_t>(1, every))
    kept.push_back(values[i]);
  return kept;
}

bool varies(const Values& values) {
  const auto [low, high] = std::ranges::minmax(values);
  return high - low > 1e-9 * std::max(std::abs(low), std::abs(high));
}

double wrapped_angle(double angle) {
  const double turn = 2.0 * std::numbers::pi;
  return angle - turn * std::floor(angle / turn);
}

struct Variable {
  const char* id;
  ChartAxis axis;
  double (*value)(const Sample&);
};

/// What a residual is shown against, besides time: what the axis has.
std::vector<Variable> variables(const Structure& structure) {
  const Capabilities& has = capabilities(structure);
  const auto on = [&](const char* unit) {
    return std::string(unit_on(vocabulary_of(structure), unit));
  };
  std::vector<Variable> list{
      {"velocity", {"velocity", on("m/s")}, [](const Sample& s) { return s.velocity; }},
      {"position", {"position", on("m")}, [](const Sample& s) { return s.position; }}};
  if (has.has_motor)
    list.push_back({"angle", {"motor angle", "rad"}, [](const Sample& s) {
                      return wrapped_angle(s.motor_angle);
                    }});
  list.push_back({"force",
                  {std::string(words_on(vocabulary_of(structure),
                                        has.has_backlash ? "gear force" : "drive force")),
                   on("N")},
                  [](const Sample& s) { return s.gear_force; }});
  if (has.is_electric)
    list.push_back({"current", {"current", "A"}, [](const Sample& s) { return s.current; }});
  return list;
}

}  // namespace

ReportCharts::ReportCharts(const RunResult& run_result) : run_result_(run_result) {
  const Job& job = run_result.job();
  for (std::size_t r = 0; r < job.recordings.size(); ++r) {
    const Recording& recording = job.recordings[r];
    const SimulatedRecording& simulation = run_result.fit().recordings[r].free_running;
    RecordingCharts charts;
    charts.times = columns_.add_times(recording.times);
    charts.phases = phases_of(recording, simulation.modes);
    const double duration = recording.times.back() - recording.times.front();
    for (EventTimes& e : events_of(simulation.modes, job.vocabulary()))
      charts.events.push_back(
          {e.kind, std::string(e.text),
           columns_.add(std::move(e.times), 1e-7 * duration, std::floor(recording.times.front()))});
    for (std::size_t m = 0; m < recording.measurements.size(); ++m) {
      const Measurement& measurement = recording.measurements[m];
      charts.measured.push_back(columns_.add(measurement.values, resolution(measurement)));
      charts.simulated.push_back(columns_.add(simulation.simulated[m], resolution(measurement)));
    }
    recordings_.push_back(std::move(charts));
  }
}

Html ReportCharts::add(Chart chart) {
  charts_.push_back(std::move(chart));
  return figure(charts_.back(), columns_);
}

Chart ReportCharts::over_time(std::size_t recording, std::string id, std::string title,
                              ChartAxis y) const {
  const RecordingCharts& r = recordings_[recording];
  return {.id = fmt::format("{}-{}", id, recording + 1),
          .title = std::move(title),
          .x = {"time", "s"},
          .y = std::move(y),
          .series = {},
          .recording = run_result_.job().recordings[recording].name,
          .phases = r.phases,
          .events = r.events};
}

Html ReportCharts::overview() {
  if (!run_result_.diagnosis || run_result_.diagnosis->tests.empty()) return {};
  // Of what the first model and the last one were judged by, where the first is worst.
  SeriesKey worst = run_result_.diagnosis->tests.front().series;
  double most = 0.0;
  for (const SeriesTest& test : run_result_.diagnosis->tests) {
    double excess = test.reduced_chi_square;
    if (run_result_.selection)
      if (const SignalScore* s = find_series(run_result_.scores.front().signals, test.series);
          s != nullptr && s->as_fitted())
        excess = s->as_fitted()->reduced_chi_square;
    if (excess > most) {
      most = excess;
      worst = test.series;
    }
  }
  const Recording& recording = run_result_.job().recordings[worst.recording];
  const Measurement& m = recording.measurements[worst.measurement];
  const RecordingCharts& r = recordings_[worst.recording];
  const Vocabulary vocabulary = run_result_.job().vocabulary();
  const ChartAxis y{signal_name(m, vocabulary), unit_of(m, vocabulary)};
  const auto measured = r.measured[worst.measurement];
  if (run_result_.selection && run_result_.selection->models.size() > 1) {
    const auto judged = [&](const FitResult& fit) {
      return columns_.add(fit.recordings[worst.recording].as_fitted().simulated[worst.measurement],
                          resolution(m));
    };
    const bool tracking = run_result_.fit().recordings[worst.recording].tracking.has_value();
    Chart chart = over_time(
        worst.recording, "before-after",
        fmt::format("Residual of the {} of {}, before and after{}", y.label, recording.name,
                    tracking ? ", " + simulation_name(run_result_.job().options, true) : ""),
        {"residual", y.unit});
    chart.series = {
        {"before", "reference", r.times, measured, LineStyle::line,
         judged(run_result_.selection->models.front().fit)},
        {"after", "residual", r.times, measured, LineStyle::line, judged(run_result_.fit())}};
    return add(std::move(chart));
  }
  Chart chart = over_time(worst.recording, "overview", title_of(m, recording, vocabulary), y);
  chart.series = {{"measured", "measured", r.times, measured},
                  {"simulated", "simulated", r.times, r.simulated[worst.measurement]}};
  return add(std::move(chart));
}

Html ReportCharts::traces(std::size_t recording) {
  const Recording& data = run_result_.job().recordings[recording];
  const RecordingResult& result = run_result_.fit().recordings[recording];
  const RecordingCharts& r = recordings_[recording];
  Html all;
  for (std::size_t m = 0; m < data.measurements.size(); ++m) {
    const Measurement& measurement = data.measurements[m];
    const Vocabulary vocabulary = run_result_.job().vocabulary();
    const std::string name = signal_name(measurement, vocabulary),
                      unit = unit_of(measurement, vocabulary);
    const std::string of = fmt::format("{} of {}", name, data.name);
    Chart trace = over_time(recording, "trace-" + name, title_of(measurement, data, vocabulary),
                            {name, unit});
    trace.series = {{"measured", "measured", r.times, r.measured[m]},
                    {"simulated", "simulated", r.times, r.simulated[m]}};
    all += add(std::move(trace));
    const auto residual = [&](std::string id, std::string title, ChartColumns::Index simulated) {
      Chart chart = over_time(recording, id + name, std::move(title), {"residual", unit});
      chart.series = {
          {"measured - simulated", "residual", r.times, r.measured[m], LineStyle::line, simulated}};
      chart.bands = {{-2.0 * measurement.sigma, 2.0 * measurement.sigma, {}, "2 sigma"}};
      all += add(std::move(chart));
    };
    residual("residual-", "Residual of the " + of, r.simulated[m]);
    if (result.tracking)
      residual("held-",
               fmt::format("Residual of the {}, {}", of,
                           simulation_name(run_result_.job().options, true)),
               columns_.add(result.tracking->simulated[m], resolution(measurement)));
  }
  return all + hysteresis(recording);
}

Html ReportCharts::hysteresis(std::size_t recording) {
  const Recording& data = run_result_.job().recordings[recording];
  const SimulatedRecording& simulation = run_result_.fit().recordings[recording].as_fitted();
  std::optional<std::size_t> motor, load;
  for (std::size_t m = 0; m < data.measurements.size(); ++m) {
    if (data.measurements[m].signal == Signal::position) motor = m;
    if (data.measurements[m].signal == Signal::load_position) load = m;
  }
  if (!motor || !load) return {};
  const auto loop = [&](const char* label, const Values& of_motor, const Values& of_load) {
    Values apart = of_load;
    for (std::size_t i = 0; i < apart.size(); ++i) apart[i] -= of_motor[i];
    return ChartSeries{label, label, columns_.add_coarse(thinned(of_motor)),
                       columns_.add_coarse(thinned(apart)), LineStyle::dots};
  };
  const std::string unit(unit_on(run_result_.job().vocabulary(), "m"));
  return add(
      {.id = fmt::format("hysteresis-{}", recording + 1),
       .title = fmt::format("Load against motor in {}", data.name),
       .x = {"position of the motor", unit},
       .y = {"load - motor", unit},
       .series = {
           loop("measured", data.measurements[*motor].values, data.measurements[*load].values),
           loop("simulated", simulation.simulated[*motor], simulation.simulated[*load])}});
}

ChartSeries ReportCharts::mean_line(std::string label, std::string_view role, const Values& x,
                                    const Values& y) {
  std::vector<std::size_t> order(x.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return x[i]; });
  const std::size_t ranges = std::min<std::size_t>(40, std::max<std::size_t>(1, x.size() / 10));
  Values mean_x, mean_y;
  for (std::size_t k = 0; k < ranges; ++k) {
    const std::size_t first = k * x.size() / ranges, end = (k + 1) * x.size() / ranges;
    double sum_x = 0.0, sum_y = 0.0;
    for (std::size_t i = first; i < end; ++i) {
      sum_x += x[order[i]];
      sum_y += y[order[i]];
    }
    const double n = static_cast<double>(end - first);
    mean_x.push_back(sum_x / n);
    mean_y.push_back(sum_y / n);
  }
  return {std::move(label), role, columns_.add_coarse(std::move(mean_x)),
          columns_.add_coarse(std::move(mean_y))};
}

Html ReportCharts::views(const SeriesTest& test) {
  const ResidualSeries& series = test.series;
  const Recording& recording = run_result_.job().recordings[series.recording];
  const Measurement& m = recording.measurements[series.measurement];
  const SimulatedRecording& simulation = run_result_.fit().recordings[series.recording].as_fitted();
  const Vocabulary vocabulary = run_result_.job().vocabulary();
  const std::string id = fmt::format("{}-{}{}", series.recording + 1, signal_name(m, vocabulary),
                                     series.fitted ? "" : "-judged");
  const ChartAxis y{"residual", unit_of(m, vocabulary)};
  Values residual = series.values;
  for (double& v : residual) v *= m.sigma;
  const auto dots = columns_.add_coarse(thinned(residual));

  Html all;
  const auto scatter = [&](const char* variable, const ChartAxis& axis, const Values& x) {
    if (!varies(x)) return;
    Chart chart{.id = fmt::format("{}-over-{}", id, variable),
                .title = "Against " + axis.label,
                .x = axis,
                .y = y,
                .series = {{"residual", "residual", columns_.add_coarse(thinned(x)), dots,
                            LineStyle::dots}}};
    chart.series.push_back(mean_line("mean", "mean", x, residual));
    all += add(std::move(chart));
  };
  for (const Variable& variable : variables(run_result_.job().model.structure)) {
    Values x;
    for (const std::size_t i : series.samples) x.push_back(variable.value(simulation.samples[i]));
    scatter(variable.id, variable.axis, x);
  }
  Values times;
  for (const std::size_t i : series.samples) times.push_back(recording.times[i]);
  scatter("time", {"time", "s"}, times);

  const double interval = mean_interval(recording.times);
  const std::size_t n = series.values.size();
  const auto wanted = static_cast<std::size_t>(std::max(40.0, 6.0 * test.autocorrelation_time));
  Values correlation = autocorrelation(series.values, std::min(n - 1, std::min(n / 2, wanted)));
  Values lags;
  for (std::size_t lag = 0; lag < correlation.size(); ++lag)
    lags.push_back(static_cast<double>(lag) * interval);
  const double chance = 1.96 / std::sqrt(static_cast<double>(n));
  all += add({.id = id + "-autocorrelation",
              .title = "Autocorrelation",
              .x = {"lag", "s"},
              .y = {"autocorrelation"},
              .series = {{"autocorrelation", "residual", columns_.add_times(std::move(lags)),
                          columns_.add(std::move(correlation), 1e-3)}},
              .bands = {{-chance, chance, {}, "95 % band of white noise"}}});
  Spectrum spectrum = power_spectrum(series.values, interval);
  if (!spectrum.wave.empty())
    all += add({.id = id + "-spectrum",
                .title = "Power spectrum (1 for the stated noise)",
                .x = {"frequency", "Hz", true},
                .y = {"power", "", true},
                .series = {{"power", "residual", columns_.add_times(std::move(spectrum.wave)),
                            columns_.add_for_log(std::move(spectrum.size))}}});
  return all;
}

Html ReportCharts::missing_force(std::size_t recording) {
  // The declared model's, and what is left of it.
  const auto force_of = [&](const ModelScore& score) -> const MissingForce& {
    return score.forces[recording];
  };
  const bool added = run_result_.selection && run_result_.selection->models.size() > 1;
  const MissingForce& before = run_result_.selection ? force_of(run_result_.scores.front())
                                                     : run_result_.diagnosis->forces[recording];
  if (!before.found) return {};
  const MissingForce* after = added ? &force_of(run_result_.scores.back()) : nullptr;
  if (after != nullptr && !after->found) after = nullptr;
  Values supplied;
  for (std::size_t i = 0; after != nullptr && i < before.force.size(); ++i)
    supplied.push_back(before.force[i] - after->force[i]);

  const std::string name = run_result_.job().recordings[recording].name;
  const Vocabulary vocabulary = run_result_.job().vocabulary();
  const auto say = [&](const char* text) { return std::string(words_on(vocabulary, text)); };
  const ChartAxis y{say("missing force"), std::string(unit_on(vocabulary, "N"))};
  const double resolution = 0.01 * std::max(before.noise, 1e-6 * before.rms) + 1e-12;
  Html all;
  Chart chart = over_time(recording, "force", say("Missing force on the arm") + " in " + name, y);
  const auto times = recordings_[recording].times;
  chart.series = {{after ? "baseline model" : say("missing force"), "force", times,
                   columns_.add(before.force, resolution)}};
  if (after != nullptr) {
    chart.series.push_back(
        {"explained by the added effects", "accepted", times, columns_.add(supplied, resolution)});
    chart.series.push_back(
        {"remaining", "residual", times, columns_.add(after->force, resolution)});
  }
  all += add(std::move(chart));

  const auto dots = columns_.add_coarse(thinned(before.force));
  for (const Variable& variable : variables(run_result_.job().model.structure)) {
    Values x;
    for (const Sample& s : before.samples) x.push_back(variable.value(s));
    if (!varies(x)) continue;
    Chart over{
        .id = fmt::format("force-{}-over-{}", recording + 1, variable.id),
        .title = say("Missing force against ") + variable.axis.label,
        .x = variable.axis,
        .y = y,
        .series = {{"missing", "force", columns_.add_coarse(thinned(x)), dots, LineStyle::dots}}};
    over.series.push_back(after
                              ? mean_line("explained by the added effects", "accepted", x, supplied)
                              : mean_line("mean", "mean", x, before.force));
    all += add(std::move(over));
  }
  Chart spectrum{.id = fmt::format("force-{}-in-space", recording + 1),
                 .title = say("Spatial spectrum of the missing force"),
                 .x = {say("cycles per metre"), std::string(unit_on(vocabulary, "1/m"))},
                 .y = {"amplitude", y.unit},
                 .series = {}};
  const auto line = [&](const std::string& label, const char* role, const MissingForce& force) {
    Values positions;
    for (const Sample& s : force.samples) positions.push_back(s.position);
    Spectrum found = spatial_spectrum(thinned(force.force), thinned(positions));
    if (!found.wave.empty())
      spectrum.series.push_back({label, role, columns_.add_times(std::move(found.wave)),
                                 columns_.add_coarse(std::move(found.size))});
  };
  line(after ? "baseline model" : say("missing force"), "force", before);
  if (after != nullptr) line("remaining", "residual", *after);
  if (!spectrum.series.empty()) all += add(std::move(spectrum));
  return all;
}

Html ReportCharts::prediction(const RecordingPrediction& prediction) {
  const Recording& data = run_result_.job().recordings[prediction.recording];
  const RecordingCharts& r = recordings_[prediction.recording];
  const Vocabulary vocabulary = run_result_.job().vocabulary();
  Html all;
  for (const SignalPrediction& p : prediction.signals) {
    const Measurement& measured = data.measurements[p.measurement];
    const std::string name = signal_name(measured, vocabulary);
    Chart chart =
        over_time(prediction.recording, "prediction-" + name,
                  fmt::format("Error of the predicted {} of {}, free running, in its 95 % "
                              "bands",
                              name, data.name),
                  {"error", unit_of(measured, vocabulary)});
    const auto edge = [&](const char* label, std::string_view role, double times) {
      Values values = p.band.half_width;
      for (double& w : values) w *= times;
      chart.series.push_back({label, role, r.times, columns_.add_coarse(std::move(values))});
    };
    edge("at any one time, above", "force", 1.0);
    edge("below", "force", -1.0);
    edge("of the whole curve, above", "reference", p.band.whole);
    edge("below", "reference", -p.band.whole);
    chart.series.push_back({"measured - predicted", "residual", r.times, r.measured[p.measurement],
                            LineStyle::line, r.simulated[p.measurement]});
    all += add(std::move(chart));
  }
  return all;
}

Html ReportCharts::profile(const Profile& profile) {
  const ParameterResult& p = run_result_.fit().parameters[profile.parameter];
  const FreeParameter& free = run_result_.job().free[profile.parameter];
  const std::string name = name_of(run_result_.job(), p.id),
                    unit(quantity_of(run_result_.job(), p.id).unit);
  Values x, deviance, parabola;
  for (const ProfilePoint& point : profile.points) {
    x.push_back(point.value);
    deviance.push_back(point.deviance);
    const double distance = free.scale == Scale::logarithmic
                                ? p.value * std::log(point.value / p.value)
                                : point.value - p.value;
    parabola.push_back(std::pow(distance / p.uncertainty.standard_error, 2));
  }
  const auto at = columns_.add_coarse(std::move(x));
  Chart chart{.id = fmt::format("profile-{}", profile.parameter + 1),
              .title = "Profile of " + name,
              .x = {name, unit},
              .y = {"deviance"},
              .series = {{"profile", "measured", at, columns_.add_coarse(std::move(deviance))}},
              .bands = {{0.0, profile.threshold, {}, "95 % interval"}}};
  if (p.uncertainty.determined)
    chart.series.push_back(
        {"from the standard error", "reference", at, columns_.add_coarse(std::move(parabola))});
  return add(std::move(chart));
}

Html ReportCharts::convergence() {
  const FitResult& fit = run_result_.fit();
  Html all;
  Values iterations, cost, rate;
  double so_far = 0.0;
  for (const Stage& stage : fit.stages) {
    so_far += stage.iterations;
    iterations.push_back(so_far);
    cost.push_back(stage.reduced_cost);
    rate.push_back(stage.observer_gain);
  }
  const ChartAxis over{"iterations"};
  if (iterations.size() > 1) {
    const auto at = columns_.add(std::move(iterations), 1.0);
    all += add({.id = "cost",
                .title = "Cost at the end of each stage",
                .x = over,
                .y = {"reduced cost", "", spans_a_decade(cost)},
                .series = {{"cost", "measured", at, columns_.add_for_log(std::move(cost)),
                            LineStyle::steps}}});
    if (std::ranges::any_of(rate, [](double r) { return r > 0.0; }))
      all += add({.id = "observer-gain",
                  .title = "Observer gain",
                  .x = over,
                  .y = {"observer gain", "1/s"},
                  .series = {{"observer gain", "simulated", at,
                              columns_.add_coarse(std::move(rate)), LineStyle::steps}}});
  }
  Values ends;
  for (const StartResult& start : run_result_.first.starts)
    if (start.usable) ends.push_back(start.reduced_cost);
  if (ends.size() > 1) {
    std::ranges::sort(ends);
    Values number(ends.size());
    std::iota(number.begin(), number.end(), 1.0);
    all += add({.id = "starts",
                .title = "Final cost of each start, best first",
                .x = {"start"},
                .y = {"reduced cost", "", spans_a_decade(ends)},
                .series = {{"reduced cost", "measured", columns_.add(std::move(number), 1.0),
                            columns_.add_for_log(std::move(ends)), LineStyle::dots}}});
  }
  return all;
}

}  // namespace axisfit
