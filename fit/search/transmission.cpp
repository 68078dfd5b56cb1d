#include "fit/search/transmission.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "fit/data/recording_check.h"
#include "fit/search/options.h"

namespace axisfit {
namespace {

constexpr SearchOptions::Transmission kOptions;

std::size_t index_of(std::string_view quantity) { return quantity_index(quantity); }

bool is_free(const Job& job, std::string_view quantity) {
  return std::ranges::find(job.free, index_of(quantity), &FreeParameter::quantity) !=
         job.free.end();
}

Hypothesis hypothesis(std::string name, std::string meaning, std::string_view strength,
                      double neutral) {
  Hypothesis c;
  c.name = std::move(name);
  c.acts_on = name_of(ActsOn::transmission);
  c.meaning = std::move(meaning);
  c.strengths = {index_of(strength)};
  c.neutral = {neutral};
  return c;
}

/// Stiffness and damping of two masses that swing against each other.
struct Coupling {
  double stiffness, damping;
};
Coupling coupling(double motor, double arm, double frequency) {
  const double w = 2.0 * std::numbers::pi * frequency;
  const double stiffness = motor * arm / (motor + arm) * w * w;
  return {stiffness, 2.0 * kOptions.damping_ratio * stiffness / w};
}

}  // namespace

std::vector<Hypothesis> transmission_hypotheses(const Job& job, const SearchScales& scales) {
  const Structure& structure = job.model.structure;
  const Capabilities& has = capabilities(structure);
  const Axis<double>& axis = job.model.axis;
  const std::string kGap(words_on(job.vocabulary(), "gap between motor and arm"));
  if (has.has_backlash) {
    if (axis.H != 0.0 || is_free(job, "H")) return {};
    Hypothesis gap = hypothesis("backlash", kGap, "H", 0.0);
    gap.settings = {{}};
    gap.extends = "compliance";
    return {std::move(gap)};
  }
  const double stroke = scales.position_high - scales.position_low;
  if (structure.effects[*effect_named("soft_transmission")] || !(scales.mass > 0.0) ||
      !(stroke > 0.0))
    return {};

  Hypothesis soft = hypothesis("compliance", "transmission that gives way", "k_g",
                               std::numeric_limits<double>::infinity());
  Hypothesis gap = hypothesis("backlash", kGap, "H", 0.0);
  soft.shapes = {index_of("b_g")};
  gap.shapes = {index_of("k_g"), index_of("b_g")};
  const bool splits_mass = has.is_force_driven;
  const bool frees_mass = splits_mass && !is_free(job, "M");
  for (Hypothesis* c : {&soft, &gap}) {
    c->kind = HypothesisKind::transmission;
    if (splits_mass) c->shapes.push_back(index_of("J_m"));
    if (frees_mass) c->shapes.push_back(index_of("M"));
  }
  const double r2 = std::pow(motor_radius(job.model), 2);
  const auto setting = [&](std::vector<double> values, double motor) {
    if (splits_mass) values.push_back(motor * r2);
    if (frees_mass) values.push_back(scales.mass - motor);
    return values;
  };
  std::vector<double> shares{axis.J_m / r2 / scales.mass};
  if (splits_mass) shares.assign(kOptions.motor_parts.begin(), kOptions.motor_parts.end());
  for (const double share : shares) {
    const double motor = share * scales.mass, arm = scales.mass - motor;
    if (!(motor > 0.0) || !(arm > 0.0)) return {};
    soft.settings.push_back(
        setting({coupling(motor, arm, kOptions.frequencies[1]).damping}, motor));
    for (const double frequency : kOptions.frequencies) {
      const auto [stiffness, damping] = coupling(motor, arm, frequency);
      gap.settings.push_back(setting({stiffness, damping}, motor));
    }
  }
  const double middle = shares[shares.size() / 2] * scales.mass;
  for (const double frequency : kOptions.frequencies)
    soft.probes.push_back(coupling(middle, scales.mass - middle, frequency).stiffness);
  for (const double part : kOptions.gaps) gap.probes.push_back(part * stroke);
  return {std::move(soft), std::move(gap)};
}

void give_backlash(Job& job, double J_m) {
  job.model.structure.transmission = Transmission::backlash;
  Axis<double>& axis = job.model.axis;
  axis.H = 0.0;
  if (!capabilities(job.model.structure).is_force_driven) return;
  axis.J_m = J_m;
  const double motor = J_m / std::pow(motor_radius(job.model), 2);
  const auto without_motor = [&](double mass) {
    return std::max(mass - motor, kOptions.least_arm_part * mass);
  };
  axis.M = without_motor(axis.M);
  for (FreeParameter& p : job.free) {
    if (p.quantity != index_of("M")) continue;
    p.initial = without_motor(p.initial);
    p.lower = std::min(p.lower, 0.01 * p.initial);  // it was one of motor and arm, as what is known
    p.prior.reset();
  }
}

void limit_stiffness(Job& job) {
  const auto free = [&](std::string_view quantity) {
    return std::ranges::find(job.free, index_of(quantity), &FreeParameter::quantity);
  };
  const auto stiffness = free("k_g");
  if (stiffness == job.free.end()) return;
  double interval = INFINITY;
  for (const Recording& r : job.recordings)
    if (r.role == Role::fit) interval = std::min(interval, sampling(r.times).interval);
  const auto M = free("M");
  const double arm = M == job.free.end() ? job.model.axis.M : M->initial;
  const double motor = job.model.axis.J_m / std::pow(motor_radius(job.model), 2);
  const double stiffest = coupling(motor, arm, 0.5 / interval).stiffness;
  if (!(stiffest > stiffness->lower)) return;
  stiffness->upper = std::min(stiffness->upper, stiffest);
  stiffness->initial = std::min(stiffness->initial, stiffness->upper);
}

double mass_of_motor(const Structure& declared, const Model<double>& fitted) {
  const bool splits = capabilities(declared).is_force_driven &&
                      declared.transmission == Transmission::rigid &&
                      fitted.structure.transmission == Transmission::backlash;
  return splits ? fitted.axis.J_m / std::pow(motor_radius(fitted), 2) : 0.0;
}

}  // namespace axisfit
