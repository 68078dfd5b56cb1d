#include "report/result_json.h"

#include <algorithm>
#include <cmath>

#include "base/version.h"
#include "fit/data/standstill.h"
#include "fit/search/suspects.h"
#include "io/config/axis_file.h"
#include "report/text/names.h"
#include "report/text/report_text.h"
#include "report/text/words.h"
#include "sim/rig.h"

namespace axisfit {
namespace {

using Json = nlohmann::ordered_json;

// Of the documents: grows when a key changes its meaning or goes, not when one is added.
constexpr int kSchemaVersion = 1;

/// The solver's outcome.
const char* status_name(const FitVerdict& verdict) {
  if (verdict.has_minimum()) return "converged";
  return verdict.kind == FitVerdict::Kind::no_minimum ? "not_converged" : "failed";
}

const char* text(InverseStart start) {
  switch (start) {
    case InverseStart::not_tried:
      return "not_tried";
    case InverseStart::no_better:
      return "no_better";
    case InverseStart::better:
      return "better";
  }
  return "";
}

const char* noise_name(NoiseSource noise) {
  switch (noise) {
    case NoiseSource::given:
      return "given";
    case NoiseSource::differences:
      return "differences";
    case NoiseSource::standstill:
      return "standstill";
    case NoiseSource::fit:
      return "fit";
  }
  return "";
}

/// A number, or null where there is none.
Json optional(bool present, double value) { return present ? Json(value) : Json(nullptr); }
Json finite(double value) { return optional(std::isfinite(value), value); }

/// A list with one entry for each of the values.
template <class Values, class Entry>
Json list(const Values& values, Entry&& entry) {
  Json array = Json::array();
  for (const auto& value : values) array.push_back(entry(value));
  return array;
}

/// A key that tells the unit on the joint: "rms_n", "speed_radps".
std::string key_on(Vocabulary vocabulary, std::string_view name, std::string_view unit) {
  return column_name(name, unit_on(vocabulary, unit));
}

Json signal_json(const Measurement& measurement, const SignalError& e, bool finished,
                 Vocabulary vocabulary) {
  const SignalInfo on = info(e.signal, vocabulary);
  Json signal{{"name", on.name},
              {"unit", on.unit},
              {"fitted", e.fitted},
              {"rmse", optional(finished, e.rmse)},
              {"nrmse_percent", optional(finished, e.nrmse_percent)},
              {"sigma", e.sigma},
              {"sigma_source", noise_name(e.noise)},
              {"reduced_chi_square", optional(finished, e.reduced_chi_square)}};
  if (e.prediction_rmse) {
    signal["prediction_rmse"] = *e.prediction_rmse;
    signal["prediction_reduced_chi_square"] = e.prediction_reduced_chi_square.value();
  }
  if (const auto excluded = excluded_samples(measurement)) {
    signal["excluded_samples"] = excluded->samples;
    signal["excluded_mean"] = excluded->mean;
  }
  return signal;
}

Json recording_json(const Recording& recording, const RecordingResult& result,
                    const std::vector<std::string>& warnings, Vocabulary vocabulary) {
  Json signals = Json::array();
  for (std::size_t m = 0; m < recording.measurements.size(); ++m)
    signals.push_back(signal_json(recording.measurements[m], result.signals[m],
                                  result.free_running.finished, vocabulary));
  return {{"name", recording.name},
          {"file", recording.file},
          {"role", role_name(recording, true)},
          {"samples", recording.times.size()},
          {"start_s", recording.times.front()},
          {"end_s", recording.times.back()},
          {"events", result.free_running.events},
          {"command_sigma", recording.command_sigma},
          {"command_sigma_source", noise_name(recording.command_noise)},
          {"warnings", warnings},
          {"signals", std::move(signals)}};
}

Json interval_json(const ParameterUncertainty& u) {
  return u.has_interval() ? Json{u.lower, u.upper} : Json(nullptr);
}

/// What is said of an estimate wherever it stands.
Json estimate_json(const Job& job, const ParameterResult& p) {
  const Quantity& quantity = quantity_of(job, p.id);
  const ParameterUncertainty& u = p.uncertainty;
  Json estimate{{"name", name_of(job, p.id)},
                {"unit", quantity.unit},
                {"meaning", quantity.meaning},
                {"value", p.value},
                {"verdict", verdict_name(u.verdict())},
                {"standard_error", optional(u.determined, u.standard_error)},
                {"confidence_interval", interval_json(u)}};
  for (const GuessInfluence& guess : p.rests_on)
    estimate["rests_on"].push_back(
        {{"name", name_of(job, guess.id)}, {"elasticity", guess.elasticity}});
  if (p.budget.gain)
    estimate["at_other_gain"] = {{"observer_gain", p.budget.gain->observer_gain},
                                 {"value", p.budget.gain->value}};
  if (p.budget.rival)
    estimate["with_rival"] = {{"in_place_of", p.budget.rival->chosen},
                              {"effect", p.budget.rival->rival},
                              {"value", p.budget.rival->value}};
  if (p.other_hold)
    estimate["with_other_hold"] = {{"value", p.other_hold->value},
                                   {"is_better", p.other_hold->is_better}};
  return estimate;
}

template <class Parameters>
Json estimates_json(const Job& job, const Parameters& parameters) {
  return list(parameters, [&](const ParameterResult& p) { return estimate_json(job, p); });
}

Json parameter_json(const Job& job, const ParameterResult& p, const FreeParameter& free) {
  Json parameter = estimate_json(job, p);
  parameter.update(Json{{"initial", free.initial},
                        {"lower", free.lower},
                        {"upper", free.upper},
                        {"scale", scale_name(free.scale)}});
  return parameter;
}

/// What the model is good for.
Json uses_json(const Job& job, const FitUses& uses) {
  Json json;
  json["missing_force_percent"] =
      uses.missing_force_percent ? Json(*uses.missing_force_percent) : Json(nullptr);
  json["recording"] =
      uses.missing_force_percent ? Json(job.recordings[uses.force_recording].name) : Json(nullptr);
  json["followed_for_s"] = uses.followed_for ? Json(*uses.followed_for) : Json(nullptr);
  json["followed_to_the_end"] = uses.is_followed_to_the_end;
  return json;
}

Json other_day_json(const Job& job, const OtherDay& day) {
  Json parameters = Json::array();
  for (const ParameterResult& p : day.parameters) {
    parameters.push_back(
        {{"name", name_of(job, p.id)},
         {"unit", quantity_of(job, p.id).unit},
         {"value", p.value},
         {"standard_error", optional(p.uncertainty.determined, p.uncertainty.standard_error)}});
  }
  return {{"recording", job.recordings[day.recording].name},
          {"parameters", std::move(parameters)},
          {"missing_force_percent", day.percent},
          {"missing_force_percent_as_fitted", day.percent_before}};
}

/// Where the time went.
Json work_json(const std::array<WorkTime, kWorkNames.size()>& times) {
  Json json = Json::object();
  for (std::size_t k = 0; k < times.size(); ++k)
    json[std::string(kWorkNames[k])] = {{"wall_time_s", times[k].wall},
                                        {"processor_time_s", times[k].processor}};
  return json;
}

/// What is known of the parameters together.
Json identifiability_json(const Job& job, const Eigen::MatrixXd& correlation,
                          const Identifiability& known) {
  const auto name = [&](std::size_t i) { return name_of(job, job.free[i]); };
  Json rows = Json::array();
  for (const auto& row : correlation.rowwise()) rows.push_back(list(row, finite));
  return {{"correlation", std::move(rows)},
          {"singular_values", known.singular_values},
          {"without_influence", list(known.without_influence, name)},
          {"weak_directions", list(known.weak,
                                   [&](const WeakDirection& weak) {
                                     Json parts = Json::object();
                                     for (const WeakDirection::Part& part : weak.parts)
                                       parts[name(part.parameter)] = part.change;
                                     return Json{{"singular_value", weak.singular_value},
                                                 {"direction", std::move(parts)},
                                                 {"description", weak_direction_text(job, weak)}};
                                   })},
          {"combinations", list(known.combinations, [&](const Combination& c) {
             return Json{{"name", name_of(job, c)},
                         {"value", c.value},
                         {"standard_error", c.standard_error}};
           })}};
}

/// What the intervals rest on.
Json assumptions_json(const FitResult& fit) {
  return {{"residuals",
           "stationary, with the variance and autocorrelation estimated for each signal, not below "
           "the stated noise"},
          {"model", "linear over the intervals"},
          {"input_noise_fraction", fit.input_part},
          {"autocorrelation_time", fit.autocorrelation_time},
          {"degrees_of_freedom", fit.degrees_of_freedom}};
}

/// What a balance of forces tells without a simulation.
Json inverse_dynamics_json(const Job& job, const SecondOpinion& opinion, InverseStart start) {
  const Vocabulary vocabulary = job.vocabulary();
  const auto& [estimate, contradictions] = opinion;
  Json parameters = estimates_json(job, estimate.parameters);
  for (std::size_t i = 0; i < parameters.size(); ++i)
    parameters[i]["contradicts_fit"] = std::ranges::find(contradictions, i) != contradictions.end();
  return {{"start", text(start)},
          {"exact", estimate.exact},
          {"cutoff_hz", estimate.cutoff},
          {key_on(vocabulary, "residual", "N"), estimate.residual},
          {key_on(vocabulary, "drive_rms", "N"), estimate.drive_rms},
          {"parameters", std::move(parameters)}};
}

Json comparison_json(const Job& job, const Comparison& comparison) {
  return {{"horizons_s", comparison.horizons},
          {"judged_horizon_s", comparison.judged},
          {"windows", comparison.windows},
          {"preferred", comparison.preferred},
          {"models", list(comparison.models, [&](const ComparedModel& m) {
             Json parameters = Json::object();
             for (const ParameterResult& p : m.parameters) parameters[name_of(job, p.id)] = p.value;
             return Json{{"name", m.name},
                         {"parameters", std::move(parameters)},
                         {"missing_force", finite(m.missing_force)},
                         {"free_running", list(m.free_running, [](double e) { return finite(e); })},
                         {"inside_percent", finite(m.inside_percent)},
                         {"curves", m.curves},
                         {"whole_curves_inside", m.whole_inside},
                         {"aic", finite(m.aic)},
                         {"bic", finite(m.bic)},
                         {"log_ratio", m.log_ratio},
                         {"log_ratio_error", finite(m.log_ratio_error)},
                         {"windows_lost", m.windows_lost}};
           })}};
}

Json horizon_json(const HorizonChoice& choice) {
  return {{"stretches", choice.stretches},
          {"stretch_s", choice.longest},
          {"chosen", choice.chosen},
          {"trials", list(choice.trials, [](const HorizonTrial& t) {
             return Json{{"observer_gain", given_gain(t.criterion)},
                         {"horizon_s", window_length(t.criterion)},
                         {"error", finite(t.error)}};
           })}};
}

Json scatter_json(const Scatter& scatter, const Job& job) {
  return {{"of_stretches", scatter.of_stretches},
          {"groups", list(scatter.groups,
                          [&](const Scatter::Group& g) {
                            return Json{{"recording", job.recordings[g.recording].name},
                                        {"fitted", g.fitted},
                                        {"from_s", g.from},
                                        {"to_s", g.to}};
                          })},
          {"parameters", list(scatter.parameters, [&](const ParameterScatter& p) {
             return Json{{"name", name_of(job, job.free[p.parameter])},
                         {"standard_error_within", p.within},
                         {"standard_deviation", p.deviation},
                         {"interval", {p.lower, p.upper}},
                         {"estimates", list(p.groups, [](const EstimateOfGroup& e) {
                            return Json{
                                {"value", optional(e.determined, e.value)},
                                {"standard_error", optional(e.determined, e.standard_error)}};
                          })}};
           })}};
}

Json prediction_json(const RecordingPrediction& prediction, const Job& job) {
  const Recording& recording = job.recordings[prediction.recording];
  return {{"recording", recording.name},
          {"draws", prediction.draws},
          {"signals", list(prediction.signals, [&](const SignalPrediction& p) {
             const Measurement& measured = recording.measurements[p.measurement];
             return Json{{"signal", info(measured.signal, job.vocabulary()).name},
                         {"rmse", finite(p.rmse)},
                         {"half_width_median", p.band.median()},
                         {"half_width_largest", p.band.largest()},
                         {"whole_curve_factor", p.band.whole},
                         {"inside_percent", finite(p.inside_percent)},
                         {"whole_curve_inside", p.is_whole_inside}};
           })}};
}

Json motion_json(const MotionPrediction& motion, Vocabulary vocabulary) {
  Json signals = Json::array();
  for (std::size_t s = 0; s < motion.signals.size(); ++s) {
    const std::size_t at = motion.columns.size() - 3 * (motion.signals.size() - s);
    const Band band{motion.columns[at + 1].values};
    signals.push_back({{"signal", info(motion.signals[s], vocabulary).name},
                       {"half_width_median", band.median()},
                       {"half_width_largest", band.largest()}});
  }
  return {{"motion", motion.name}, {"signals", std::move(signals)}};
}

Json profile_json(const Job& job, const Profile& profile) {
  const auto end = [](const ProfileEnd& e) {
    return Json{{"value", optional(!e.open, e.value)}, {"open", e.open}};
  };
  Json json{{"name", name_of(job, job.free[profile.parameter])},
            {"lower", end(profile.lower)},
            {"upper", end(profile.upper)},
            {"threshold", profile.threshold},
            {"points", list(profile.points, [](const ProfilePoint& p) {
               return Json{{"value", p.value}, {"deviance", p.deviance}};
             })}};
  if (profile.better)
    json["better"] = {{"reduced_cost", profile.better->reduced_cost},
                      {"values", profile.better->to}};
  return json;
}

Json suggestion_json(const Job& job, const Suggestion& s) {
  const Vocabulary vocabulary = job.vocabulary();
  const std::string travel = key_on(vocabulary, "travel", "m"),
                    speed = key_on(vocabulary, "speed", "m/s");
  Json predicted = Json::array();
  for (std::size_t i = 0; i < job.free.size(); ++i) {
    const ParameterUncertainty& u = s.predicted.parameters[i];
    predicted.push_back({{"name", name_of(job, job.free[i])},
                         {"standard_error", optional(u.determined, u.standard_error)},
                         {"confidence_interval", interval_json(u)}});
  }
  return {{"motion", motion_text(s.experiment.motion, vocabulary)},
          {"duration_s", s.experiment.duration},
          {"parameter", name_of(job, job.free[s.parameter])},
          {"predicted", std::move(predicted)},
          {"limits",
           {{travel, {*s.limits.lowest, *s.limits.highest}},
            {speed, *s.limits.speed},
            {"voltage_v", *s.limits.command}}},
          {"reach", {{travel, {s.reach.lowest, s.reach.highest}}, {speed, s.reach.speed}}},
          {"motions_tried", s.tried},
          {"motions_feasible", s.feasible}};
}

Json force_json(const MissingForce& force, Vocabulary vocabulary) {
  if (!force.found) return nullptr;
  return {{key_on(vocabulary, "rms", "N"), force.rms},
          {key_on(vocabulary, "noise", "N"), force.noise},
          {"cutoff_hz", force.cutoff},
          {key_on(vocabulary, "drive_rms", "N"), force.drive_rms}};
}

Json test_json(const Job& job, const SeriesTest& test) {
  const Recording& recording = job.recordings[test.series.recording];
  return {{"recording", recording.name},
          {"signal",
           info(recording.measurements[test.series.measurement].signal, job.vocabulary()).name},
          {"role", role_name(recording, test.series.fitted)},
          {"reduced_chi_square", test.reduced_chi_square},
          {"autocorrelation_time", test.autocorrelation_time},
          {"unexplained_percent", test.unexplained_percent},
          {"explained", test.explained},
          {"dependences",
           list(test.dependences,
                [](const Dependence& d) {
                  return Json{{"variable", d.on}, {"fraction", d.fraction}, {"p_value", d.p_value}};
                })},
          {"outliers", list(test.outliers,
                            [&](std::size_t i) {
                              return Json{{"time_s", recording.times[test.series.samples[i]]},
                                          {"residual_over_sigma", test.series.values[i]}};
                            })},
          {"drift",
           {{"over_sigma_per_second", test.drift.per_second},
            {"standard_error", finite(test.drift.standard_error)},
            {"p_value", test.drift.p_value}}},
          {"resolution", test.resolution}};
}

/// Of a hypothesis, its strengths or its shapes.
Json quantities_json(const Job& job, const Hypothesis& hypothesis,
                     const std::vector<std::size_t>& quantities,
                     const std::vector<double>& values) {
  Json array = Json::array();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const ParameterId id{quantities[i], hypothesis.recording};
    array.push_back(
        {{"name", name_of(job, id)}, {"unit", quantity_of(job, id).unit}, {"value", values[i]}});
  }
  return array;
}

Json suspect_json(const Job& job, const Scored& s) {
  return {
      {"name", s.hypothesis->name},
      {"acts_on", s.hypothesis->acts_on},
      {"meaning", s.hypothesis->meaning},
      {"fraction", s.fraction},
      {"strengths", quantities_json(job, *s.hypothesis, s.hypothesis->strengths, s.own.strengths)},
      {"shapes", quantities_json(job, *s.hypothesis, s.hypothesis->shapes, s.own.shapes)}};
}

Json residual_json(const Job& job, const Diagnosis& diagnosis,
                   const std::vector<Scored>& suspects) {
  Json forces = Json::array();
  for (std::size_t r = 0; r < job.recordings.size(); ++r) {
    Json force{{"recording", job.recordings[r].name}};
    const Json found = force_json(diagnosis.forces[r], job.vocabulary());
    if (!found.is_null()) force.update(found);
    if (!found.is_null()) forces.push_back(std::move(force));
  }
  Json json{
      {"explained", diagnosis.explained},
      {"tests", list(diagnosis.tests, [&](const SeriesTest& t) { return test_json(job, t); })},
      {"suspected_effects", list(suspects, [&](const Scored& s) { return suspect_json(job, s); })}};
  if (const Scored* cause = likely_cause(suspects)) json["likely_cause"] = cause->hypothesis->name;
  json["missing_force"] = std::move(forces);
  return json;
}

Json closed_form_term_json(const ClosedForm::Term& term) {
  return {{"factor", term.factor},
          {"standard_error", term.standard_error},
          {"unit", term.unit},
          {"form", term.form}};
}

Json effect_json(const Job& job, const Outcome& t) {
  const bool judged = t.improvement.comparable;
  Json json{{"name", t.hypothesis.name},
            {"acts_on", t.hypothesis.acts_on},
            {"meaning", t.hypothesis.meaning},
            {"decision", decision_name(t.decision())},
            {"accepted", t.decision() == Decision::accepted},
            {"in_model", t.in_model},
            {"reason", reason_text(job, t)},
            {"round", t.round},
            {"score", t.score},
            {"parameters", estimates_json(job, t.parameters)},
            {"p_value", optional(judged, t.improvement.p_value)},
            {"validation_improvement_percent", optional(judged, t.improvement.validate_percent)}};
  if (t.replication)
    json["elsewhere"] = {{"alike", t.replication->is_alike},
                         {"agree", t.replication->is_near},
                         {"parameters", estimates_json(job, t.replication->parameters)}};
  if (t.closed_form)
    json["closed_form"] = {{"text", closed_form_text(*t.closed_form)},
                           {"terms", list(t.closed_form->terms, closed_form_term_json)},
                           {"chi_square", t.closed_form->chi_square},
                           {"degrees_of_freedom", t.closed_form->degrees_of_freedom}};
  return json;
}

Json score_json(const Job& job, const SignalScore& score) {
  const Recording& recording = job.recordings[score.recording];
  const SignalInfo signal =
      info(recording.measurements[score.measurement].signal, job.vocabulary());
  const bool finished = score.free_running.has_value();
  const SignalErrors errors = score.free_running.value_or(SignalErrors());
  Json json{{"name", signal.name},
            {"unit", signal.unit},
            {"role", role_name(recording, score.fitted)},
            {"rmse", optional(finished, errors.rmse)},
            {"nrmse_percent", optional(finished, errors.nrmse_percent)},
            {"reduced_chi_square", optional(finished, errors.reduced_chi_square)}};
  if (score.tracking) {
    json["prediction_rmse"] = score.tracking->rmse;
    json["prediction_reduced_chi_square"] = score.tracking->reduced_chi_square;
  }
  return json;
}

Json model_json(const FittedModel& model, const ModelScore& score) {
  Json recordings = Json::array();
  for (std::size_t r = 0; r < model.job.recordings.size(); ++r) {
    const Recording& recording = model.job.recordings[r];
    Json signals = Json::array();
    for (const SignalScore& s : score.signals)
      if (s.recording == r) signals.push_back(score_json(model.job, s));
    recordings.push_back({{"name", recording.name},
                          {"role", role_name(recording, true)},
                          {"signals", std::move(signals)},
                          {"missing_force", force_json(score.forces[r], model.job.vocabulary())}});
  }
  return {{"added", model.added},
          {"reduced_chi_square", finite(model.fit.reduced_chi_square)},
          {"recordings", std::move(recordings)},
          {"parameters", estimates_json(model.job, model.fit.parameters)}};
}

/// What only a closed loop has.
Json selection_json(const RunResult& run_result) {
  const EffectSelection& selection = *run_result.selection;
  const std::vector<ModelScore>& scores = run_result.scores;
  Json models = Json::array();
  for (std::size_t i = 0; i < selection.models.size(); ++i)
    models.push_back(model_json(selection.models[i], scores[i]));
  const Job& job = run_result.job();
  Json json{
      {"effects", list(selection.effects, [&](const Outcome& t) { return effect_json(job, t); })},
      {"before", models.front()},
      {"after", models.back()}};
  models.erase(0);
  json["models"] = std::move(models);
  json["selection"] = {{"verdict", verdict_text(selection)},
                       {"explained", selection.explained},
                       {"held_out_blocks", selection.held_out_blocks},
                       {"roles_exchanged", run_result.roles_exchanged},
                       {"hints", list(run_result.discriminations, [&](const Discrimination& d) {
                          return discrimination_text(d, job.vocabulary());
                        })}};
  return json;
}

Json recording_check_json(const Job& job, const Recording& recording, const RecordingCheck& check) {
  const Sampling& sampling = check.sampling;
  Json signals = Json::array();
  for (std::size_t m = 0; m < check.measurements.size(); ++m) {
    const ValueCheck& values = check.measurements[m];
    const Measurement& measurement = recording.measurements[m];
    signals.push_back({{"name", info(measurement.signal, job.vocabulary()).name},
                       {"unit", info(measurement.signal, job.vocabulary()).unit},
                       {"lowest", values.low},
                       {"highest", values.high},
                       {"sigma", measurement.sigma},
                       {"sigma_source", noise_name(measurement.noise)},
                       {"noise", values.noise},
                       {"resolution", values.resolution},
                       {"repetition", values.repetition},
                       {"filter_corner_hz",
                        optional(values.filter.has_value(),
                                 values.filter ? values.filter->corner / sampling.interval : 0.0)},
                       {"stuck_samples", values.stuck},
                       {"stuck_at_s", optional(values.stuck > 0, values.stuck_at)},
                       {"jump", values.jump},
                       {"jump_at_s", optional(values.jump != 0.0, values.jump_at)},
                       {"clipped_samples", values.clipped},
                       {"clipped_at", optional(values.clipped > 0, values.clipped_at)}});
  }
  return {{"name", recording.name},
          {"role", role_name(recording, true)},
          {"samples", sampling.samples},
          {"start_s", recording.times.front()},
          {"end_s", recording.times.back()},
          {"interval_s", sampling.interval},
          {"jitter", sampling.jitter},
          {"gaps", sampling.gaps},
          {"largest_gap_s", optional(sampling.gaps > 0, sampling.largest_gap)},
          {"largest_gap_at_s", optional(sampling.gaps > 0, sampling.gap_at)},
          {"command",
           {{"lowest", check.command.low},
            {"highest", check.command.high},
            {"sigma", recording.command_sigma},
            {"sigma_source", noise_name(recording.command_noise)},
            {"switches", check.switches},
            {"fraction_of_time_at_maximum", check.at_maximum}}},
          {"signals", std::move(signals)},
          {"rates", list(check.rates,
                         [&](const RateCheck& rate) {
                           return Json{{"signal", info(rate.rate, job.vocabulary()).name},
                                       {"of", info(rate.of, job.vocabulary()).name},
                                       {"ratio", rate.found.ratio},
                                       {"correlation", rate.found.correlation}};
                         })},
          {"warnings", warnings_for(job, recording, check)}};
}

const char* errors_known_name(ErrorsKnown known) {
  switch (known) {
    case ErrorsKnown::fully:
      return "fully";
    case ErrorsKnown::to_first_order:
      return "to first order";
    case ErrorsKnown::no:
      return "no";
  }
  return "";
}

}  // namespace

Json result_json(const RunResult& run_result) {
  const Job& job = run_result.job();
  const FitResult& fit = run_result.fit();
  Json recordings = Json::array(), parameters = Json::array();
  for (std::size_t r = 0; r < job.recordings.size(); ++r)
    recordings.push_back(
        recording_json(job.recordings[r], fit.recordings[r],
                       warnings_for(run_result.baseline, job.recordings[r], run_result.checks[r]),
                       job.vocabulary()));
  for (std::size_t i = 0; i < job.free.size(); ++i)
    parameters.push_back(parameter_json(job, fit.parameters[i], as_specified(run_result, i)));
  Json json{{"schema_version", kSchemaVersion},
            {"axisfit", version()},
            {"status", status_name(fit.verdict)},
            {"usable", run_result.grade.is_usable()},
            {"grade", grade_name(run_result.grade.grade)},
            {"uses", uses_json(job, run_result.grade.uses)},
            {"interrupted", run_result.interrupted},
            {"errors_known", errors_known_name(run_result.errors_known)},
            {"time_limit_reached", run_result.time_limit.has_value()},
            {"verdict", grade_text(job, run_result.grade, fit)},
            {"message", fit.message},
            {"axis", run_result.baseline.axis},
            {"joint", joint_name(job.vocabulary().joint)},
            {"recordings", std::move(recordings)},
            {"parameters", std::move(parameters)},
            {"reduced_chi_square", finite(fit.reduced_chi_square)},
            {"residual", run_result.diagnosis
                             ? residual_json(job, *run_result.diagnosis, run_result.suspects)
                             : Json(nullptr)}};
  json.update(identifiability_json(job, fit.correlation, fit.identifiability));
  json["assumptions"] = assumptions_json(fit);
  if (run_result.second_opinion)
    json["inverse_dynamics"] =
        inverse_dynamics_json(job, *run_result.second_opinion, run_result.inverse_start);
  if (run_result.options.predict)
    json["prediction"] = list(run_result.predictions, [&](const RecordingPrediction& p) {
      return prediction_json(p, job);
    });
  if (run_result.motion)
    json["predicted_motion"] = motion_json(*run_result.motion, job.vocabulary());
  if (run_result.horizon) json["horizon"] = horizon_json(*run_result.horizon);
  if (run_result.comparison) json["comparison"] = comparison_json(job, *run_result.comparison);
  if (!run_result.other_days.empty())
    json["other_days"] =
        list(run_result.other_days, [&](const OtherDay& day) { return other_day_json(job, day); });
  if (run_result.scatter) json["scatter"] = scatter_json(*run_result.scatter, job);
  if (!run_result.profiles.empty())
    json["profile"] =
        list(run_result.profiles, [&](const Profile& p) { return profile_json(job, p); });
  if (run_result.options.suggest_experiment)
    json["next_experiment"] =
        run_result.suggestion ? suggestion_json(job, *run_result.suggestion) : Json(nullptr);
  if (run_result.selection) json.update(selection_json(run_result));
  json.update(Json{{"observer_gain", fit.observer_gain},
                   {"horizon_s", window_length(job.options.criterion)},
                   {"stages", list(fit.stages,
                                   [](const Stage& s) {
                                     return Json{{"observer_gain", s.observer_gain},
                                                 {"reduced_cost", finite(s.reduced_cost)},
                                                 {"iterations", s.iterations},
                                                 {"accepted", s.accepted}};
                                   })},
                   {"starts", list(run_result.first.starts,
                                   [](const StartResult& s) {
                                     return Json{{"from", s.from},
                                                 {"to", s.to},
                                                 {"usable", s.usable},
                                                 {"reduced_cost", finite(s.reduced_cost)}};
                                   })},
                   {"minima", list(distinct_minima(run_result.first.starts),
                                   [](const Minimum& m) {
                                     return Json{{"reduced_cost", m.reduced_cost},
                                                 {"starts", m.starts},
                                                 {"values", m.values}};
                                   })},
                   {"iterations", fit.iterations},
                   {"seed", run_result.baseline.options.seed},
                   {"wall_time_s", run_result.wall_time},
                   {"work", work_json(run_result.times)}});
  if (fit.better_gain) json["better_observer_gain"] = *fit.better_gain;
  if (fit.quiet_gain) json["quiet_observer_gain"] = *fit.quiet_gain;
  return json;
}

Json first_look_json(const FirstLook& look) {
  const auto term = [](const FirstLook::Term& found) {
    return Json{{"value", found.value}, {"standard_error", finite(found.error)}};
  };
  const auto direction = [&] {
    switch (look.direction) {
      case FirstLook::Direction::along:
        return "as_declared";
      case FirstLook::Direction::turned:
        return "turned";
      case FirstLook::Direction::open:
        break;
    }
    return "open";
  };
  return {{"M", term(look.mass)},
          {"B_a", term(look.viscous)},
          {"F_c", term(look.coulomb)},
          {"F_0",
           Json{{"value", -look.constant.value}, {"standard_error", finite(look.constant.error)}}},
          {"delay_s", term(look.delay)},
          {"unexplained_percent", 100.0 * look.unexplained},
          {"direction", direction()}};
}

Json check_json(const Job& job, const std::vector<RecordingCheck>& checks,
                const std::optional<FirstLook>& look, const Forecast& forecast,
                const RunTimeEstimate& run_time) {
  Json recordings = Json::array();
  for (std::size_t r = 0; r < checks.size(); ++r)
    recordings.push_back(recording_check_json(job, job.recordings[r], checks[r]));
  Json parameters = Json::array();
  for (std::size_t i = 0; i < job.free.size() && forecast.finite; ++i) {
    const ParameterUncertainty& u = forecast.uncertainty.parameters[i];
    Json sensitivity = Json::array();
    for (std::size_t s = 0; s < forecast.series.size(); ++s) {
      const Recording& recording = job.recordings[forecast.series[s].recording];
      const Measurement& m = recording.measurements[forecast.series[s].measurement];
      sensitivity.push_back(
          {{"recording", recording.name},
           {"signal", info(m.signal, job.vocabulary()).name},
           {"rms_over_noise",
            forecast.sensitivity(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(s))}});
    }
    parameters.push_back({{"name", name_of(job, job.free[i])},
                          {"initial", job.free[i].initial},
                          {"verdict", verdict_name(u.verdict())},
                          {"standard_error", optional(u.determined, u.standard_error)},
                          {"sensitivity", std::move(sensitivity)}});
  }
  Json json{{"schema_version", kSchemaVersion},
            {"axisfit", version()},
            {"recordings", std::move(recordings)},
            {"first_look", look ? first_look_json(*look) : Json(nullptr)},
            {"evaluation_time_s", run_time.evaluation},
            {"expected_time_s",
             {{"explained", run_time.explained},
              {"unexplained", run_time.unexplained},
              {"close_loop_nothing_missing", run_time.nothing_missing},
              {"close_loop_one_effect", run_time.one_effect},
              {"close_loop_no_effect", run_time.no_effect}}},
            {"finite", forecast.finite},
            {"parameters", std::move(parameters)}};
  json.update(
      identifiability_json(job, forecast.uncertainty.correlation, forecast.identifiability));
  return json;
}

nlohmann::ordered_json axes_json(const std::vector<AxisRun>& axes) {
  nlohmann::ordered_json json;
  for (const AxisRun& axis : axes) json["axes"][axis.name] = result_json(axis.result);
  json["shared_inertias"] = nlohmann::ordered_json::array();
  const auto estimate = [](const Estimated& found) -> nlohmann::ordered_json {
    return {{"value", found.value}, {"standard_error", found.error}};
  };
  for (const SharedInertia& s : shared_inertias(axes))
    json["shared_inertias"].push_back({{"axes", {s.one, s.other}},
                                       {"unit", s.unit},
                                       {"value", s.both.value},
                                       {"standard_error", s.both.error},
                                       {s.one, estimate(s.from_one)},
                                       {s.other, estimate(s.from_other)},
                                       {"apart_standard_errors", s.apart}});
  return json;
}

}  // namespace axisfit
