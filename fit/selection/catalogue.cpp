#include "fit/selection/catalogue.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fit/estimation/continuation.h"
#include "sim/effects/effects.h"

namespace axisfit {
namespace {

std::size_t index_of_quantity(std::string_view name) { return find_quantity(name)->index; }

/// n values from a to b, each the same multiple of the one before.
std::vector<std::vector<double>> geometric(double a, double b, int n) {
  std::vector<std::vector<double>> values;
  for (int i = 0; i < n; ++i) values.push_back({a * std::pow(b / a, double(i) / double(n - 1))});
  return values;
}

struct Entry {
  std::string_view name;
  std::string_view acts_on;
  std::vector<std::string_view> strengths;  // quantities of the effect, or full names
  std::vector<std::string_view> shapes = {};
  std::vector<std::vector<double>> settings = {{}};
};

/// The effects of sim/effects, with the settings of their shapes. An effect with several strengths
/// that mean different things stands here once for each.
std::vector<Entry> entries(const Scales& s, double pinion_radius) {
  std::vector<std::vector<double>> periods;
  for (const double period : s.periods) periods.push_back({period});
  // Per turn of the motor: those that the residual shows, and the likely ones.
  const auto orders_of = [&](const std::vector<double>& lengths) {
    std::vector<std::vector<double>> orders{{1.0}, {2.0}, {3.0}, {4.0}, {6.0}};
    for (const double length : lengths)
      orders.push_back({2.0 * std::numbers::pi * pinion_radius / length});
    return orders;
  };
  const double speed = std::max(s.speed, 1e-3);
  // From a few cycles in the recording up to a third of the sampling rate.
  auto modes = geometric(std::max(1.0, 4.0 / (s.end - s.start)), 0.33 / s.interval, 20);
  for (auto& mode : modes) mode.push_back(0.03);
  return {
      {"coulomb_friction", "friction", {"F_c"}},
      {"directional_friction", "friction", {"dB_a"}},
      {"stribeck_friction",
       "friction",
       {"F_st"},
       {"v_st"},
       geometric(0.003 * speed, 0.3 * speed, 5)},
      {"position_friction", "friction", {"G_c"}},
      {"position_friction", "friction", {"G_q"}},
      {"position_friction", "friction", {"G_c", "G_q"}},
      {"position_friction", "friction", {"G_b"}},
      {"load_friction", "friction", {"mu"}},
      {"dahl_friction", "friction", {"F_d"}, {"l_d"}, geometric(1e-5, 1e-2, 4)},
      {"constant_force", "arm force", {"F_0"}},
      {"quadratic_drag", "arm force", {"c"}},
      {"stroke_spring", "arm force", {"k_s"}},
      {"periodic_force", "arm force", {"F_s1", "F_c1"}, {"period"}, periods},
      {"periodic_force", "arm force", {"F_s2", "F_c2"}},
      {"added_mass", "inertia", {"dM"}},
      {"elastic_mode", "inertia", {"m_e"}, {"f_e", "zeta_e"}, modes},
      {"cogging_torque", "motor torque", {"T_s", "T_c"}, {"order"}, orders_of(s.periods)},
      {"torque_ripple", "motor torque", {"r_s", "r_c"}, {"order"}, orders_of(s.drive_periods)},
      {"torque_droop", "motor torque", {"c_i"}},
      {"torque_fade", "motor torque", {"c_t"}},
      {"drive_lag", "drive", {"T_l"}},
      {"command_offset", "drive", {"U_0"}},
  };
}

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
  if (const auto effect = effect_named(quantity_list()[quantity].group))
    structure.effects.set(*effect);
  return structure;
}

/// Whether all strengths have a part in the job's axis, are not free yet and have no value.
bool is_absent(const Job& job, const std::vector<std::size_t>& strengths) {
  Model<double> model = job.model;
  const auto member = members(model);
  return std::ranges::all_of(strengths, [&](std::size_t q) {
    const QuantityEntry& entry = quantity_list()[q];
    const auto effect = effect_named(entry.group);
    const bool written = effect && !job.model.structure.effects[*effect];
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

std::string meaning_of(std::string_view effect) {
  std::string text;
  const Effects<double> effects{};
  visit_effects(effects, [&](std::size_t, const auto& e) {
    if (e.name == effect) text = e.meaning;
  });
  return text;
}

/// The ends of a curve; one over the motor angle has none.
std::vector<double> ends_of(std::string_view curve, const Scales& s) {
  if (curve == "force_over_velocity") return {s.velocity_low, s.velocity_high};
  if (curve == "force_over_position") return {s.position_low, s.position_high};
  if (curve == "force_over_time") return {s.start, s.end};
  return {};
}

Candidate curve(std::string_view name, const Scales& scales) {
  Candidate candidate;
  candidate.name = name;
  candidate.acts_on = "arm force";
  candidate.meaning = meaning_of(name);
  candidate.is_curve = true;
  candidate.shapes_are_free = false;
  candidate.settings = {ends_of(name, scales)};
  for (const QuantityEntry& entry : quantity_list()) {
    if (entry.group != name) continue;
    // The constant part of a curve is another effect's, and the first and last coefficient hold it.
    if (entry.quantity.shape)
      candidate.shapes.push_back(entry.index);
    else if (entry.quantity.symbol != "c1" &&
             (entry.quantity.symbol != "c16" || candidate.settings[0].empty()))
      candidate.strengths.push_back(entry.index);
  }
  return candidate;
}

}  // namespace

std::vector<double> neutral_strengths(const Candidate& candidate) {
  std::vector<double> values;
  for (const std::size_t q : candidate.strengths)
    values.push_back(neutral(quantity_list()[q].quantity));
  return values;
}

std::vector<Candidate> catalogue(const Job& job, const Scales& scales) {
  std::vector<Candidate> list;
  const auto add_if_absent = [&](Candidate candidate) {
    if (!candidate.settings.empty() && is_absent(job, candidate.strengths))
      list.push_back(std::move(candidate));
  };
  const std::vector<double> later{2.0 * scales.interval, 8.0 * scales.interval};
  const std::vector<double> both_signs{-2.0 * scales.interval, 2.0 * scales.interval};
  for (const Entry& entry : entries(scales, job.model.axis.r_g)) {
    Candidate candidate;
    candidate.name = entry.name;
    candidate.acts_on = entry.acts_on;
    candidate.meaning = meaning_of(entry.name);
    for (const auto symbol : entry.strengths)
      candidate.strengths.push_back(
          index_of_quantity(std::string(entry.name) + "." + std::string(symbol)));
    for (const auto symbol : entry.shapes)
      candidate.shapes.push_back(
          index_of_quantity(std::string(entry.name) + "." + std::string(symbol)));
    candidate.settings = entry.settings;
    if (entry.name == "drive_lag") candidate.probes = later;
    // A part of an effect that needs another part of it, as a second harmonic the first.
    const auto effect = effect_named(entry.name);
    if (entry.strengths[0] == "F_s2" && !job.model.structure.effects[*effect]) continue;
    // The offset of a force source is a constant force by another name: no recording decides.
    if (entry.name == "command_offset" && capabilities(job.model.structure).is_force_driven)
      continue;
    add_if_absent(std::move(candidate));
  }
  Candidate dead_time{"dead_time", "drive", "dead time of the command", {}, {}, {{}}};
  dead_time.strengths = {index_of_quantity("T_d")};
  dead_time.probes = later;
  add_if_absent(std::move(dead_time));
  for (const SignalInfo& signal : kSignalTable) {
    if (!is_recorded(job, signal.signal)) continue;
    for (const std::string_view part : {"bias", "gain", "lag", "delay"}) {
      const std::string name = std::string(signal.name) + "." + std::string(part);
      const QuantityEntry* entry = find_quantity(name);
      if (is_ignored(*entry, job.options.observer)) continue;
      Candidate candidate{name,           "sensor", std::string(entry->quantity.meaning),
                          {entry->index}, {},       {{}}};
      if (part == "lag") candidate.probes = later;
      if (part == "delay") candidate.probes = both_signs;
      add_if_absent(std::move(candidate));
    }
  }
  for (const std::string_view name :
       {"force_over_velocity", "force_over_position", "force_over_motor_angle", "force_over_time"})
    add_if_absent(curve(name, scales));
  return list;
}

Job with_candidate(const Job& job, const Candidate& candidate, std::span<const double> values,
                   std::span<const double> strengths, std::span<const double> shapes) {
  Job extended_job = job;
  for (std::size_t i = 0; i < values.size(); ++i)
    extended_job.free[i].initial = std::clamp(values[i], job.free[i].lower, job.free[i].upper);
  Structure& structure = extended_job.model.structure;
  const auto member = members(extended_job.model);
  structure = extended(structure, candidate.strengths.front());
  // An effect that has been absent has no values yet.
  for (const QuantityEntry& entry : quantity_list()) {
    const bool same = entry.group == quantity_list()[candidate.strengths.front()].group;
    if (same && structure.effects != job.model.structure.effects)
      *member[entry.index] = neutral(entry.quantity);
  }
  for (std::size_t i = 0; i < candidate.strengths.size(); ++i) {
    const Quantity& q = quantity_list()[candidate.strengths[i]].quantity;
    FreeParameter p;
    p.quantity = candidate.strengths[i];
    p.lower = q.lower;
    p.upper = q.upper;
    p.initial = std::clamp(strengths[i], q.lower, q.upper);
    p.logarithmic = false;
    extended_job.free.push_back(p);
  }
  for (std::size_t i = 0; i < candidate.shapes.size(); ++i) {
    *member[candidate.shapes[i]] = shapes[i];
    if (!candidate.shapes_are_free) continue;
    const Quantity& q = quantity_list()[candidate.shapes[i]].quantity;
    FreeParameter p;
    p.quantity = candidate.shapes[i];
    p.lower = q.lower;
    p.upper = q.upper;
    p.initial = std::clamp(shapes[i], q.lower, q.upper);
    extended_job.free.push_back(p);
  }
  return extended_job;
}

}  // namespace axisfit
