#include "init/free_choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "base/rounding.h"
#include "base/units.h"
#include "fit/data/noise.h"
#include "fit/data/recording_check.h"
#include "fit/design/forecast.h"
#include "init/job_text.h"
#include "io/config/diagnostics.h"
#include "io/config/job_file.h"
#include "io/config/yaml_text.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;

constexpr double kRoom = 0.01;  ///< s, of the delay between two clocks, to either side
constexpr const char* kOnlyRatios = "a motion shows only ratios to it";

/// With the effects at that part of their initial strengths. False: it cannot be told.
bool take_out_open(JobDraft& draft, double strength, const StopFlag* stop) {
  for (;;) {
    if (is_set(stop)) {
      draft.guesses.emplace_back(
          "what the recordings determine was not looked at, since the run was stopped");
      return false;
    }
    const Job job = draft_job(draft);
    const std::vector<double> start = draw_start(job, 0);
    std::vector<double> values = start;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const QuantityEntry& entry = job.entry(job.free[i].quantity);
      if (entry.effect && entry.quantity.lower == 0.0) values[i] *= strength;
    }
    if (strength != 1.0 && values == start) return true;  // looked at already
    const Forecast found = forecast(job, values);
    if (!found.finite) {
      draft.guesses.push_back(
          "identifiability could not be checked: with the values of the axis file the simulation "
          "does not finish");
      return false;
    }
    if (job.free.size() == 1) return true;
    DraftParameter* last = nullptr;
    bool unseen = false;
    std::size_t index = 0;
    for (DraftParameter& parameter : draft.parameters) {
      if (!parameter.reason_not_free.empty()) continue;
      const ParameterUncertainty& u = found.uncertainty.parameters[index];
      if (!u.determined || u.weak) {
        last = &parameter;
        unseen = std::ranges::count(found.identifiability.without_influence, index) > 0;
      }
      ++index;
    }
    if (last == nullptr) return true;
    const std::string_view need =
        excitation_needed(*find_quantity(last->name, draft.vocabulary()), draft.vocabulary());
    last->reason_not_free =
        unseen ? "no recorded signal depends on it" : "these recordings do not determine it";
    if (!need.empty()) last->reason_not_free += fmt::format("; it needs {}", need);
    if (last->name == "K_f") last->reason_not_free = kOnlyRatios;
  }
}

}  // namespace

Job draft_job(const JobDraft& draft) {
  try {
    return read_job_draft(job_files(draft), fs::absolute(draft.request.folder).string()).job;
  } catch (const ConfigError& error) {
    // The places are of a file that the user never sees.
    std::set<std::string> messages;
    for (const Diagnostic& d : error.diagnostics()) messages.insert(d.message);
    throw std::runtime_error(
        fmt::format("no job can be created from these recordings:\n{}", fmt::join(messages, "\n")));
  }
}

void list_parameters(JobDraft& draft) {
  // What no data sheet tells, the most wanted first. A gain of the drive last: what it scales
  // has precedence.
  static const std::vector<std::string> kWanted{"M", "B_a", "V_L", "T_p", "k_g", "b_g", "F_s", "H"};
  const auto add = [&](const std::string& name, const std::string& entry = "{}") {
    const QuantityEntry& called = draft.quantity(name);
    if (is_used(called, draft.structure)) draft.parameters.push_back({called.name, entry});
  };
  if (capabilities(draft.structure).has_back_emf)
    for (const char* of_motor : {"K_m", "R"}) add(of_motor);
  // Wherever the user's K_f takes them.
  const bool any_gain = draft.starter && draft.starter->gain_guessed;
  const auto bounds = [](double lower, double upper, std::string_view unit) {
    return fmt::format("{{bounds: [{}, {}]}}", with_unit(lower, unit), with_unit(upper, unit));
  };
  for (const std::string& name : kWanted) {
    if (name == "F_s" && draft.is_force_driven()) continue;
    add(name);
  }
  for (const QuantityEntry& entry : quantity_list()) {
    // What the axis file leaves to its default is for the search.
    const bool has_default = !std::isnan(entry.quantity.default_value);
    if (!entry.effect || !is_used(entry, draft.structure) || has_default) continue;
    const Quantity& q = draft.quantity(entry.name).quantity;
    const bool force = draft.starter && entry.quantity.unit == "N";
    const double most =
        force ? std::min((any_gain ? 1e4 : 2.0) * draft.starter->largest_force, q.upper) : 0.0;
    add(entry.name, force ? bounds(q.lower < 0.0 ? -most : 0.0, most, q.unit) : "{}");
    if (draft.goes_one_way && entry.name == "constant_force.F_0")
      draft.parameters.back().reason_not_free =
          "the motion goes one way, which does not tell it from friction: it needs one that "
          "goes both ways";
  }
  if (draft.starter && !draft.is_force_driven()) add("K_1");
  if (draft.joined)  // two clocks may differ to either side
    draft.parameters.push_back(
        {"T_d", fmt::format("{{initial: 0 s, bounds: [-{0}, {0}]}}", with_unit(kRoom, "s"))});
  // An encoder that rounds down reads half a step low.
  const RecordingGuess& first = draft.recordings.front().guess;
  const GuessedColumn* position = first.find(Kind::position);
  const bool offset = position && !draft.is_direct() && !draft.is_rounded_away(*position, first);
  if (const double resolution = offset ? resolution_of(position->values) : 0.0; resolution > 0.0)
    add("position.bias", bounds(-round_to_digits(resolution, 2), round_to_digits(resolution, 2),
                                unit_on(draft.vocabulary(), "m")));
  if (!draft.is_force_driven() ||
      std::ranges::any_of(draft.recordings, &DraftRecording::drives_in_newtons))
    return;
  add("K_f");
  if (draft.starter || draft.request.is_machine)
    draft.parameters.back().reason_not_free = kOnlyRatios;
}

void choose_free(JobDraft& draft, const StopFlag* stop) {
  constexpr double kHardly = 1e-3;
  if (take_out_open(draft, 1.0, stop)) take_out_open(draft, kHardly, stop);
}

}  // namespace axisfit
