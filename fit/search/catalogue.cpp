#include "fit/search/catalogue.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>
#include <utility>

#include "fit/criterion/gains.h"
#include "fit/search/transmission.h"
#include "fit/solve/parameters.h"
#include "sim/equations.h"

namespace axisfit {
namespace {

/// Whether a quantity is estimated, or given to a single recording: then there is a value of it.
bool has_value(const Job& job, std::size_t quantity) {
  return std::ranges::any_of(job.free, [&](const auto& p) { return p.quantity == quantity; }) ||
         std::ranges::any_of(job.recordings, [&](const Recording& r) {
           return std::ranges::any_of(r.overrides,
                                      [&](const auto& o) { return o.first == quantity; });
         });
}

/// Whether all strengths have a part in the job's axis, are not free yet and have no value. A
/// shape, such as an exponent, may have one: another takes its place.
bool is_absent(const Job& job, const std::vector<std::size_t>& strengths) {
  Model<double> model = job.model;
  const auto member = members(model);
  return std::ranges::all_of(strengths, [&](std::size_t q) {
    const QuantityEntry& entry = quantity_list()[q];
    const bool written = entry.effect && !job.model.structure.effects[*entry.effect];
    return is_used(entry, with_effect_of(job.model.structure, q)) && !has_value(job, q) &&
           (written || entry.quantity.shape || *member[q] == neutral_value(entry.quantity));
  });
}

bool is_recorded(const Job& job, Signal signal) {
  return std::ranges::any_of(job.recordings, [&](const Recording& r) {
    const Measurement* m = r.find(signal);
    return r.role == Role::fit && m != nullptr && m->fitted;
  });
}

/// The quantities of an effect with these symbols.
std::vector<std::size_t> quantities_of(std::string_view effect,
                                       const std::vector<std::string_view>& symbols) {
  std::vector<std::size_t> quantities;
  for (const std::string_view symbol : symbols)
    quantities.push_back(quantity_index(std::string(effect) + "." + std::string(symbol)));
  return quantities;
}

Hypothesis hypothesis_of(const EffectInfo& effect, SearchEntry entry, bool is_in_model,
                         Vocabulary vocabulary) {
  Hypothesis hypothesis;
  hypothesis.name = words_on(vocabulary, effect.name);
  hypothesis.acts_on = words_on(vocabulary, name_of(effect.acts_on));
  hypothesis.meaning = words_on(vocabulary, effect.meaning);
  hypothesis.strengths = quantities_of(effect.name, entry.strengths);
  hypothesis.shapes = quantities_of(effect.name, entry.shapes);
  const std::vector<std::size_t> held = quantities_of(effect.name, entry.held);
  hypothesis.shapes.insert(hypothesis.shapes.end(), held.begin(), held.end());
  hypothesis.held = held.size();
  hypothesis.settings = std::move(entry.settings);
  hypothesis.largest = std::move(entry.largest);
  hypothesis.probes = std::move(entry.probes);
  hypothesis.extends = words_on(vocabulary, entry.extends);
  if (entry.is_curve) hypothesis.kind = HypothesisKind::curve;
  hypothesis.has_phase = entry.has_phase;
  // An effect may have one hypothesis for each channel, and some only extend an effect of the
  // model.
  if (const QuantityEntry& first = quantity_list(vocabulary)[hypothesis.strengths.front()];
      first.quantity.channel || is_in_model)
    hypothesis.name = first.name;
  return hypothesis;
}

/// A hypothesis of one quantity.
Hypothesis single(const std::string& name, const std::string& acts_on, HypothesisKind kind,
                  const QuantityEntry& entry) {
  Hypothesis hypothesis;
  hypothesis.name = name;
  hypothesis.acts_on = acts_on;
  hypothesis.meaning = entry.quantity.meaning;
  hypothesis.kind = kind;
  hypothesis.strengths = {entry.index};
  hypothesis.settings = {{}};
  return hypothesis;
}

/// Whether a quantity has a value in the job's axis that somebody declared, not neutral, and that
/// is not estimated. Where a recording begins is known of each recording, not of the axis.
bool is_constant(const Job& job, const QuantityEntry& entry, double declared) {
  return is_used(entry, job.model.structure) && !has_value(job, entry.index) &&
         entry.group != "initial" && !entry.quantity.shape && declared != 0.0 &&
         declared != neutral_value(entry.quantity) && declared > entry.quantity.lower &&
         declared < entry.quantity.upper &&
         (!entry.signal ||
          (is_recorded(job, *entry.signal) && !is_ignored(entry, job.options.criterion)));
}

/// What may differ from recording to recording, such as a payload: of the hypotheses of one number
/// that add to mass, offset and dry friction, those of one recording alone. What one of two
/// recordings has beyond a mass that is free, the other lacks: there the second has it.
std::vector<Hypothesis> of_single_recordings(const Job& job, const std::vector<Hypothesis>& list) {
  std::vector<std::size_t> fitted;
  for (std::size_t r = 0; r < job.recordings.size(); ++r)
    if (job.recordings[r].role == Role::fit) fitted.push_back(r);
  std::vector<Hypothesis> found;
  if (fitted.size() < 2) return found;
  const std::size_t added_mass = quantity_index("added_mass.dM");
  for (const std::size_t quantity :
       {added_mass, quantity_index("payload_change.dM"), quantity_index("constant_force.F_0"),
        quantity_index("coulomb_friction.F_c")}) {
    const std::vector<std::size_t> strengths{quantity};
    const auto shared = std::ranges::find(list, strengths, &Hypothesis::strengths);
    if (shared == list.end()) continue;
    const bool is_relative =
        quantity == added_mass && fitted.size() == 2 && has_value(job, quantity_index("M"));
    for (const std::size_t r : std::span(fitted).subspan(is_relative ? 1 : 0)) {
      Hypothesis& own = found.emplace_back(*shared);
      own.recording = r;
      own.name += "@" + job.recordings[r].name;
      own.meaning += " in '" + job.recordings[r].name + "' alone";
    }
  }
  return found;
}

}  // namespace

std::vector<Hypothesis> catalogue(const Job& job, SearchScales scales) {
  scales.pinion_radius = motor_radius(job.model);
  if (job.vocabulary().joint == Joint::revolute)
    scales.short_travel *= 10.0;  // at a radius of 0.1 m
  const Structure& structure = job.model.structure;
  const Vocabulary vocabulary = job.vocabulary();
  Model<double> model = job.model;
  std::vector<Hypothesis> list;
  const auto add_if_absent = [&](Hypothesis hypothesis) {
    if (hypothesis.settings.empty() || !is_absent(job, hypothesis.strengths)) return;
    for (const std::size_t q : hypothesis.strengths) {
      const Quantity& quantity = quantity_list()[q].quantity;
      hypothesis.neutral.push_back(quantity.shape ? *members(model)[q] : neutral_value(quantity));
    }
    list.push_back(std::move(hypothesis));
  };
  const bool has_dry_friction = Equations<double>(job.model).parts().directions;
  const auto add_effects = [&](ActsOn place, bool curves) {
    for (std::size_t e = 0; e < kEffects; ++e) {
      if (kEffectTable[e].acts_on != place) continue;
      for (SearchEntry& entry : kEffectTable[e].search(scales))
        if (entry.is_curve == curves && is_used(entry.used_by, structure) &&
            (entry.extends.empty() || structure.effects[*effect_named(entry.extends)]) &&
            (!entry.changes_dry_friction || has_dry_friction))
          add_if_absent(
              hypothesis_of(kEffectTable[e], std::move(entry), structure.effects[e], vocabulary));
    }
  };
  for (const ActsOn place : kPlacesToAct) add_effects(place, false);
  for (Hypothesis& c : transmission_hypotheses(job, scales)) list.push_back(std::move(c));
  const std::vector<double> both_signs{-2.0 * scales.interval, 2.0 * scales.interval};
  Hypothesis dead_time =
      single("dead_time", "drive", HypothesisKind::clock, *find_quantity("T_d", kSourceVocabulary));
  dead_time.probes = later(scales);
  dead_time.probes.push_back(-2.0 * scales.interval);
  add_if_absent(std::move(dead_time));
  for (const SignalInfo& signal : kSignalTable) {
    if (!is_recorded(job, signal.signal)) continue;
    for (const std::string_view part : {"bias", "gain", "lag", "delay", "drift"}) {
      const QuantityEntry& entry =
          job.entry(quantity_index(std::string(signal.name) + "." + std::string(part)));
      if (is_ignored(entry, job.options.criterion)) continue;
      const bool is_clock = part == "delay" || part == "drift";
      Hypothesis hypothesis =
          single(entry.name, "sensor",
                 is_clock ? HypothesisKind::clock : HypothesisKind::instrument, entry);
      if (part == "lag") hypothesis.probes = later(scales);
      if (part == "delay") hypothesis.probes = both_signs;
      if (part == "drift")
        for (const double delay : both_signs)
          hypothesis.probes.push_back(delay / (scales.end - scales.start));
      add_if_absent(std::move(hypothesis));
    }
  }
  const std::size_t mass = quantity_index("M"), added_mass = quantity_index("added_mass.dM");
  const bool offers_mass =
      std::ranges::any_of(list, [&](const Hypothesis& c) { return c.strengths[0] == added_mass; });
  for (const QuantityEntry& entry : quantity_list(vocabulary))
    if (const double declared = *members(model)[entry.index]; is_constant(job, entry, declared)) {
      if (entry.index == mass && offers_mass) continue;            // they say the same
      if (entry.quantity.used_by == UsedBy::controller) continue;  // computes with its settings
      Hypothesis hypothesis = single(entry.name, "axis file", HypothesisKind::constant, entry);
      hypothesis.neutral = {declared};
      list.push_back(std::move(hypothesis));
    }
  for (Hypothesis& own : of_single_recordings(job, list)) list.push_back(std::move(own));
  for (const ActsOn place : kPlacesToAct) add_effects(place, true);
  return list;
}

}  // namespace axisfit
