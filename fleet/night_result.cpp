#include "fleet/night_result.h"

#include <fmt/format.h>

#include <limits>
#include <numeric>

#include "report/text/names.h"
#include "report/text/words.h"

namespace axisfit {
namespace {

using Json = nlohmann::ordered_json;

/// Its error without what recordings or their stretches differ by, which trends see for themselves.
double error_within(const RunResult& run, std::size_t parameter) {
  if (run.scatter)
    for (const ParameterScatter& scatter : run.scatter->parameters)
      if (scatter.parameter == parameter && scatter.deviation > 0.0) return scatter.within;
  return run.first.parameters[parameter].uncertainty.standard_error;
}

/// "periodic_force, period 0.036 m": a name with its shape, which tells one from another.
std::string effect_text(const Job& job, const Outcome& outcome) {
  std::string text(words_on(job.vocabulary(), outcome.hypothesis.name));
  for (const ParameterResult& p : outcome.parameters)
    if (const Quantity& quantity = quantity_of(job, p.id); quantity.shape)
      text += fmt::format(", {} {:.3g} {}", quantity.symbol, p.value, quantity.unit);
  return text;
}

std::vector<NightResult::Channel> channel_means(const Job& job) {
  std::vector<NightResult::Channel> channels;
  if (job.model.structure.channels == nullptr) return channels;
  const ChannelList& list = *job.model.structure.channels;
  for (std::size_t j = 0; j < list.size(); ++j) {
    double sum = 0.0;
    std::size_t count = 0;
    for (const Recording& recording : job.recordings)
      if (j < recording.channels.size()) {
        const std::vector<double>& values = recording.channels[j];
        sum = std::accumulate(values.begin(), values.end(), sum);
        count += values.size();
      }
    if (count > 0) channels.push_back({list[j].name, list[j].zero + sum / double(count)});
  }
  return channels;
}

}  // namespace

NightResult night_result(const RunResult& run) {
  NightResult night;
  night.status = grade_name(run.grade.grade);
  night.seconds = run.wall_time;
  const Job& job = run.baseline;
  const Vocabulary vocabulary = job.vocabulary();
  for (std::size_t i = 0; i < run.first.parameters.size(); ++i) {
    const ParameterResult& p = run.first.parameters[i];
    if (job.free[i].recording || !run.first.is_usable()) continue;
    const QuantityEntry& entry = job.entry(p.id.quantity);
    if (entry.group == "initial" || p.uncertainty.verdict() != ParameterVerdict::determined)
      continue;
    night.parameters.push_back(
        {name_of(job, p.id), std::string(entry.quantity.unit), p.value, error_within(run, i)});
  }
  for (std::size_t r = 0; r < run.first.recordings.size(); ++r) {
    const RecordingResult& fitted = run.first.recordings[r];
    for (std::size_t m = 0; m < fitted.signals.size(); ++m) {
      const Recording& recording = job.recordings[r];
      const SignalInfo on = info(recording.measurements[m].signal, vocabulary);
      night.residuals.push_back({recording.name, std::string(on.name), std::string(on.unit),
                                 recording.role == Role::fit ? "fit" : "validate",
                                 fitted.signals[m].rmse, fitted.signals[m].reduced_chi_square});
    }
  }
  night.channels = channel_means(job);
  return night;
}

void add_search(NightResult& night, const RunResult& run) {
  night.status = grade_name(run.grade.grade);
  night.seconds += run.wall_time;
  if (!run.selection) return;
  for (const Outcome& outcome : run.selection->effects)
    if (outcome.decision() == Decision::accepted)
      night.effects.push_back(effect_text(run.job(), outcome));
}

Json to_json(const NightResult& n) {
  Json parameters = Json::array(), residuals = Json::array(), channels = Json::array();
  for (const auto& p : n.parameters)
    parameters.push_back(Json::array({p.name, p.unit, p.value, p.standard_error}));
  for (const auto& r : n.residuals)
    residuals.push_back(Json::array({r.recording, r.signal, r.unit, r.role, r.rmse, r.chi_square}));
  for (const auto& c : n.channels) channels.push_back(Json::array({c.name, c.mean}));
  return {{"axis", n.axis},
          {"night", n.night},
          {"status", n.status},
          {"reason", n.reason},
          {"fingerprint", n.fingerprint},
          {"parameters", parameters},
          {"residuals", residuals},
          {"effects", n.effects},
          {"channels", channels},
          {"seconds", n.seconds}};
}

NightResult night_result_from(const Json& json) {
  NightResult n;
  const auto number = [](const Json& value) {  // JSON has no infinity
    return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
  };
  n.axis = json.at("axis");
  n.night = json.at("night");
  n.status = json.at("status");
  n.reason = json.at("reason");
  n.fingerprint = json.at("fingerprint");
  n.seconds = json.at("seconds");
  for (const Json& p : json.at("parameters"))
    n.parameters.push_back({p.at(0), p.at(1), number(p.at(2)), number(p.at(3))});
  for (const Json& r : json.at("residuals"))
    n.residuals.push_back({r.at(0), r.at(1), r.at(2), r.at(3), number(r.at(4)), number(r.at(5))});
  n.effects = json.at("effects").get<std::vector<std::string>>();
  for (const Json& c : json.at("channels")) n.channels.push_back({c.at(0), number(c.at(1))});
  return n;
}

}  // namespace axisfit
