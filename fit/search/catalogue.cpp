#include "fit/search/catalogue.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "fit/criterion/gains.h"
#include "fit/search/backlash.h"
#include "fit/solve/parameters.h"
#include "sim/equations.h"

namespace axisfit {
namespace {

std::size_t index_of_quantity(std::string_view name) { return quantity_index(name); }

/// Whether a quantity is estimated, or given to a single recording: then there is a value of it.
bool has_value(const Job& job, std::size_t quantity) {
  return std::ranges::any_of(job.free, [&](const auto& p) { return p.quantity == quantity; }) ||
         std::ranges::any_of(job.recordings, [&](const Recording& r) {
           return std::ranges::any_of(r.overrides,
                                      [&](const auto& o) { return o.first == quantity; });
         });
}

double neutral(const Quantity& quantity) {
  return std::isnan(quantity.default_value) ? 0.0 : quantity.default_value;
}

/// The structure of a job's model with the effect of a quantity switched on.
Structure extended(Structure structure, std::size_t quantity) {
  if (const auto effect = quantity_list()[quantity].effect) structure.effects.set(*effect);
  return structure;
}

/// Whether all strengths have a part in the job's axis, are not free yet and have no value.
bool is_absent(const Job& job, const std::vector<std::size_t>& strengths) {
  Model<double> model = job.model;
  const auto member = members(model);
  return std::ranges::all_of(strengths, [&](std::size_t q) {
    const QuantityEntry& entry = quantity_list()[q];
    const bool written = entry.effect && !job.model.structure.effects[*entry.effect];
    return is_used(entry, extended(job.model.structure, q)) && !has_value(job, q) &&
           (written || *member[q] == neutral(entry.quantity));
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
    quantities.push_back(index_of_quantity(std::string(effect) + "." + std::string(symbol)));
  return quantities;
}

Candidate candidate_of(const EffectInfo& effect, SearchEntry entry, bool is_in_model,
                       Vocabulary vocabulary) {
  Candidate candidate;
  candidate.name = words_on(vocabulary, effect.name);
  candidate.acts_on = words_on(vocabulary, name_of(effect.acts_on));
  candidate.meaning = words_on(vocabulary, effect.meaning);
  candidate.strengths = quantities_of(effect.name, entry.strengths);
  candidate.shapes = quantities_of(effect.name, entry.shapes);
  candidate.settings = std::move(entry.settings);
  candidate.largest = std::move(entry.largest);
  candidate.shapes_are_free = !entry.is_curve;
  candidate.probes = std::move(entry.probes);
  candidate.extends = words_on(vocabulary, entry.extends);
  candidate.is_curve = entry.is_curve;
  candidate.has_phase = entry.has_phase;
  // Of one effect there is one for each channel, and some are more of an effect that is there.
  if (const QuantityEntry& first = quantity_list(vocabulary)[candidate.strengths.front()];
      first.quantity.channel || is_in_model)
    candidate.name = first.name;
  return candidate;
}

/// A candidate of one quantity.
Candidate single(const std::string& name, const std::string& acts_on, const QuantityEntry& entry) {
  Candidate candidate;
  candidate.name = name;
  candidate.acts_on = acts_on;
  candidate.meaning = entry.quantity.meaning;
  candidate.strengths = {entry.index};
  candidate.settings = {{}};
  return candidate;
}

/// Whether a quantity has a value in the job's axis that somebody declared, not neutral, and that
/// is not estimated. Where a recording begins is known of each recording, not of the axis.
bool is_constant(const Job& job, const QuantityEntry& entry, double declared) {
  return is_used(entry, job.model.structure) && !has_value(job, entry.index) &&
         entry.group != "initial" && !entry.quantity.shape && declared != 0.0 &&
         declared != neutral(entry.quantity) && declared > entry.quantity.lower &&
         declared < entry.quantity.upper &&
         (!entry.signal ||
          (is_recorded(job, *entry.signal) && !is_ignored(entry, job.options.criterion)));
}

/// The range of a shape that may be negative, such as a place: it has no scale of its own, and is
/// sought where its settings lie, and a tenth of their span beyond.
std::pair<double, double> range_of_place(const Job& job, const Candidate& candidate,
                                         std::size_t shape) {
  const Quantity& q = job.entry(candidate.shapes[shape]).quantity;
  double least = INFINITY, most = -INFINITY;
  for (const auto& setting : candidate.settings) {
    least = std::min(least, setting[shape]);
    most = std::max(most, setting[shape]);
  }
  if (!(most > least)) return {q.lower, q.upper};
  const double beyond = 0.1 * (most - least);
  return {std::max(q.lower, least - beyond), std::min(q.upper, most + beyond)};
}

/// One of the shapes of a candidate; NaN where it has none of that name.
double shape_named(std::string_view name, const Candidate& candidate,
                   std::span<const double> shapes) {
  for (std::size_t i = 0; i < shapes.size(); ++i)
    if (quantity_list()[candidate.shapes[i]].name == name) return shapes[i];
  return NAN;
}

}  // namespace

bool Candidate::is_instrument() const {
  return quantity_list()[strengths.front()].signal.has_value();
}

bool is_part_of(const Candidate& part, const Candidate& whole) {
  return part.extends == whole.name && whole.extends.empty() &&
         (whole.gives_backlash || quantity_list()[part.strengths.front()].effect ==
                                      quantity_list()[whole.strengths.front()].effect);
}

std::vector<Candidate> catalogue(const Job& job, SearchScales scales) {
  scales.pinion_radius = motor_radius(job.model);
  if (job.vocabulary().joint == Joint::revolute)
    scales.short_travel *= 10.0;  // at a radius of 0.1 m
  const Structure& structure = job.model.structure;
  const Vocabulary vocabulary = job.vocabulary();
  Model<double> model = job.model;
  std::vector<Candidate> list;
  const auto add_if_absent = [&](Candidate candidate) {
    if (candidate.settings.empty() || !is_absent(job, candidate.strengths)) return;
    for (const std::size_t q : candidate.strengths)
      candidate.neutral.push_back(neutral(quantity_list()[q].quantity));
    list.push_back(std::move(candidate));
  };
  const bool rubs = Equations<double>(job.model).parts().directions;
  const auto add_effects = [&](ActsOn place, bool curves) {
    for (std::size_t e = 0; e < kEffects; ++e) {
      if (kEffectTable[e].acts_on != place) continue;
      for (SearchEntry& entry : kEffectTable[e].search(scales))
        if (entry.is_curve == curves && is_used(entry.used_by, structure) &&
            (entry.extends.empty() || structure.effects[*effect_named(entry.extends)]) &&
            (!entry.changes_dry_friction || rubs))
          add_if_absent(
              candidate_of(kEffectTable[e], std::move(entry), structure.effects[e], vocabulary));
    }
  };
  for (const ActsOn place : kPlacesToAct) add_effects(place, false);
  for (Candidate& c : transmission_candidates(job, scales)) list.push_back(std::move(c));
  const std::vector<double> both_signs{-2.0 * scales.interval, 2.0 * scales.interval};
  Candidate dead_time = single("dead_time", "drive", *find_quantity("T_d", kSourceVocabulary));
  dead_time.is_timing = true;
  dead_time.probes = later(scales);
  dead_time.probes.push_back(-2.0 * scales.interval);
  add_if_absent(std::move(dead_time));
  for (const SignalInfo& signal : kSignalTable) {
    if (!is_recorded(job, signal.signal)) continue;
    for (const std::string_view part : {"bias", "gain", "lag", "delay", "drift"}) {
      const QuantityEntry& entry =
          job.entry(index_of_quantity(std::string(signal.name) + "." + std::string(part)));
      if (is_ignored(entry, job.options.criterion)) continue;
      Candidate candidate = single(entry.name, "sensor", entry);
      if (part == "lag") candidate.probes = later(scales);
      candidate.is_timing = part == "delay" || part == "drift";
      if (part == "delay") candidate.probes = both_signs;
      if (part == "drift")
        for (const double delay : both_signs)
          candidate.probes.push_back(delay / (scales.end - scales.start));
      add_if_absent(std::move(candidate));
    }
  }
  const std::size_t mass = index_of_quantity("M"), added_mass = index_of_quantity("added_mass.dM");
  const bool offers_mass =
      std::ranges::any_of(list, [&](const Candidate& c) { return c.strengths[0] == added_mass; });
  for (const QuantityEntry& entry : quantity_list(vocabulary))
    if (const double declared = *members(model)[entry.index]; is_constant(job, entry, declared)) {
      if (entry.index == mass && offers_mass) continue;            // they say the same
      if (entry.quantity.used_by == UsedBy::controller) continue;  // computes with its settings
      Candidate candidate = single(entry.name, "axis file", entry);
      candidate.is_constant = true;
      candidate.neutral = {declared};
      list.push_back(std::move(candidate));
    }
  for (const ActsOn place : kPlacesToAct) add_effects(place, true);
  return list;
}

Job with_candidate(const Job& job, const Candidate& candidate, std::span<const double> values,
                   std::span<const double> strengths, std::span<const double> shapes) {
  Job extended_job = job;
  set_initial_values(extended_job, values);
  Structure& structure = extended_job.model.structure;
  const auto member = members(extended_job.model);
  structure = extended(structure, candidate.strengths.front());
  if (candidate.gives_backlash) give_backlash(extended_job, shape_named("J_m", candidate, shapes));
  // An effect that has been absent has no values yet.
  for (const QuantityEntry& entry : quantity_list()) {
    const bool same = entry.group == quantity_list()[candidate.strengths.front()].group;
    if (same && structure.effects != job.model.structure.effects)
      *member[entry.index] = neutral(entry.quantity);
  }
  for (std::size_t i = 0; i < candidate.strengths.size(); ++i) {
    const QuantityEntry& entry = job.entry(candidate.strengths[i]);
    FreeParameter p;
    if (candidate.is_constant) {
      p = free_parameter(entry, candidate.neutral[i]);
    } else if (std::isinf(candidate.neutral[i])) {
      p = free_parameter(entry, strengths[i]);
    } else {
      p.quantity = entry.index;
      p.lower = entry.quantity.lower;
      p.upper = entry.quantity.upper;
      p.logarithmic = false;
    }
    p.initial = std::clamp(strengths[i], p.lower, p.upper);
    extended_job.free.push_back(p);
  }
  for (std::size_t i = 0; i < candidate.shapes.size(); ++i) {
    *member[candidate.shapes[i]] = shapes[i];
    if (!candidate.shapes_are_free) continue;
    const QuantityEntry& entry = job.entry(candidate.shapes[i]);
    if (candidate.gives_backlash) {
      FreeParameter p = free_parameter(entry, shapes[i]);
      p.lower *= 1e-4;  // hardly any damping is as good as none, and no bound
      extended_job.free.push_back(p);
      continue;
    }
    const Quantity& q = entry.quantity;
    FreeParameter p;
    p.quantity = candidate.shapes[i];
    p.logarithmic = q.lower > 0.0;
    std::tie(p.lower, p.upper) =
        p.logarithmic ? std::pair(q.lower, q.upper) : range_of_place(job, candidate, i);
    if (!candidate.largest.empty()) p.upper = std::min(p.upper, candidate.largest[i]);
    p.initial = std::clamp(shapes[i], p.lower, p.upper);
    extended_job.free.push_back(p);
  }
  return extended_job;
}

}  // namespace axisfit
