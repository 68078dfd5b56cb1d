#include "apps/result_json.h"

#include "apps/version.h"

namespace axisfit {
namespace {

using Json = nlohmann::ordered_json;

const char* text(Status status) {
  switch (status) {
    case Status::converged:
      return "converged";
    case Status::not_converged:
      return "not_converged";
    case Status::failed:
      return "failed";
  }
  return "";
}

/// A number, or null where there is none.
Json optional(bool present, double value) { return present ? Json(value) : Json(nullptr); }
Json optional(const std::optional<double>& value) {
  return optional(value.has_value(), value.value_or(0.0));
}

Json recording_json(const Recording& recording, const RecordingResult& result) {
  Json signals = Json::array();
  const bool finished = result.prediction.finished;
  for (const SignalError& e : result.signals) {
    Json signal{{"name", info(e.signal).name},
                {"unit", info(e.signal).unit},
                {"fitted", e.fitted},
                {"rmse", optional(finished, e.rmse)},
                {"nrmse_percent", optional(finished, e.nrmse_percent)},
                {"sigma", e.sigma},
                {"sigma_source", e.sigma_given ? "given" : "differences"},
                {"reduced_chi_square", optional(finished, e.reduced_chi_square)}};
    if (e.prediction_rmse) {
      signal["prediction_rmse"] = optional(e.prediction_rmse);
      signal["prediction_reduced_chi_square"] = optional(e.prediction_reduced_chi_square);
    }
    signals.push_back(std::move(signal));
  }
  return {{"name", recording.name},
          {"file", recording.file},
          {"role", recording.role == Role::fit ? "fit" : "validate"},
          {"samples", recording.times.size()},
          {"start_s", recording.times.front()},
          {"end_s", recording.times.back()},
          {"events", result.prediction.events},
          {"signals", std::move(signals)}};
}

}  // namespace

Json result_json(const JobFile& file, const FitResult& result, double wall_time_s) {
  const Job& job = file.job;
  Json recordings = Json::array(), parameters = Json::array(), stages = Json::array(),
       starts = Json::array();
  for (std::size_t r = 0; r < job.recordings.size(); ++r)
    recordings.push_back(recording_json(job.recordings[r], result.recordings[r]));
  for (std::size_t i = 0; i < job.free.size(); ++i) {
    const FreeParameter& free = job.free[i];
    const ParameterResult& p = result.parameters[i];
    const ParameterUncertainty& u = p.uncertainty;
    const Quantity& quantity = quantity_list()[free.quantity].quantity;
    parameters.push_back(
        {{"name", p.name},
         {"unit", quantity.unit},
         {"meaning", quantity.meaning},
         {"value", p.value},
         {"determined", u.determined},
         {"standard_error", optional(u.determined, u.standard_error)},
         {"confidence_interval", u.determined ? Json{u.lower, u.upper} : Json(nullptr)},
         {"initial", free.initial},
         {"lower", free.lower},
         {"upper", free.upper},
         {"scale", free.logarithmic ? "log" : "linear"},
         {"at_bound", u.at_bound}});
  }
  for (const Stage& s : result.stages)
    stages.push_back({{"coupling_rate", s.coupling_rate},
                      {"reduced_cost", s.reduced_cost},
                      {"iterations", s.iterations},
                      {"accepted", s.accepted}});
  for (const StartResult& s : result.starts)
    starts.push_back(
        {{"from", s.from}, {"to", s.to}, {"usable", s.usable}, {"reduced_cost", s.reduced_cost}});
  return {{"version", kVersion},
          {"status", text(result.status)},
          {"usable", result.usable},
          {"verdict", result.verdict},
          {"message", result.message},
          {"axis", file.rig.name},
          {"recordings", std::move(recordings)},
          {"parameters", std::move(parameters)},
          {"reduced_chi_square", result.reduced_chi_square},
          {"coupling_rate", result.coupling_rate},
          {"stages", std::move(stages)},
          {"starts", std::move(starts)},
          {"iterations", result.iterations},
          {"seed", job.options.seed},
          {"wall_time_s", wall_time_s}};
}

}  // namespace axisfit
