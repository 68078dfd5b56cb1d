#include "fit/search/hypothesis.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <tuple>
#include <utility>

#include "fit/search/transmission.h"
#include "fit/solve/parameters.h"

namespace axisfit {
namespace {

using enum HypothesisKind;

/// An effect that has been absent has no values yet: its quantities get their defaults.
void set_defaults(Model<double>& model, std::string_view group) {
  const auto member = members(model);
  for (const QuantityEntry& entry : quantity_list())
    if (entry.group == group) *member[entry.index] = neutral_value(entry.quantity);
}

/// One of the shapes; NaN where there is none of that name.
double shape_named(std::string_view name, const Hypothesis& hypothesis,
                   std::span<const double> shapes) {
  for (std::size_t i = 0; i < shapes.size(); ++i)
    if (quantity_list()[hypothesis.shapes[i]].name == name) return shapes[i];
  return NAN;
}

/// The range of a shape that may be negative, such as a place: it has no scale of its own, and is
/// sought where its settings lie, and a tenth of their span beyond.
std::pair<double, double> range_of_place(const Quantity& quantity, const Hypothesis& hypothesis,
                                         std::size_t shape) {
  double least = INFINITY, most = -INFINITY;
  for (const auto& setting : hypothesis.settings) {
    least = std::min(least, setting[shape]);
    most = std::max(most, setting[shape]);
  }
  if (!(most > least)) return {quantity.lower, quantity.upper};
  const double beyond = 0.1 * (most - least);
  return {std::max(quantity.lower, least - beyond), std::min(quantity.upper, most + beyond)};
}

FreeParameter free_strength(const Job& job, const Hypothesis& hypothesis, std::size_t i,
                            double initial) {
  const QuantityEntry& entry = job.entry(hypothesis.strengths[i]);
  FreeParameter p;
  if (hypothesis.kind == constant) {
    p = free_parameter(entry, hypothesis.neutral[i]);
  } else if (std::isinf(hypothesis.neutral[i])) {
    p = free_parameter(entry, initial);
  } else {
    p.quantity = entry.index;
    p.lower = entry.quantity.lower;
    p.upper = entry.quantity.upper;
    p.scale = Scale::linear;
  }
  p.initial = std::clamp(initial, p.lower, p.upper);
  p.recording = hypothesis.recording;
  return p;
}

FreeParameter free_shape(const Job& job, const Hypothesis& hypothesis, std::size_t i,
                         double initial) {
  const QuantityEntry& entry = job.entry(hypothesis.shapes[i]);
  if (hypothesis.kind == transmission) {
    FreeParameter p = free_parameter(entry, initial);
    if (p.scale == Scale::linear) p.scale = Scale::from_zero;
    return p;
  }
  const Quantity& q = entry.quantity;
  FreeParameter p;
  p.quantity = entry.index;
  p.recording = hypothesis.recording;
  p.scale = q.lower > 0.0 ? Scale::logarithmic : Scale::linear;
  std::tie(p.lower, p.upper) = p.scale == Scale::logarithmic ? std::pair(q.lower, q.upper)
                                                             : range_of_place(q, hypothesis, i);
  if (!hypothesis.largest.empty()) p.upper = std::min(p.upper, hypothesis.largest[i]);
  p.initial = std::clamp(initial, p.lower, p.upper);
  return p;
}

}  // namespace

bool Hypothesis::is_of_instrument() const {
  return quantity_list()[strengths.front()].signal.has_value();
}

std::pair<double, double> Hypothesis::range_tried(std::size_t shape) const {
  double least = INFINITY, most = -INFINITY;
  for (const std::vector<double>& setting : settings) {
    least = std::min(least, setting[shape]);
    most = std::max(most, setting[shape]);
  }
  return {least, most};
}

bool is_plain_beside(const Hypothesis& hypothesis, const Hypothesis& other) {
  return hypothesis.kind == effect && hypothesis.parameters() == 1 && other.parameters() > 1 &&
         hypothesis.acts_on == other.acts_on;
}

bool is_part_of(const Hypothesis& part, const Hypothesis& whole) {
  return part.extends == whole.name && whole.extends.empty() &&
         (whole.kind == transmission || quantity_list()[part.strengths.front()].effect ==
                                            quantity_list()[whole.strengths.front()].effect);
}

double distance_from_neutral(double value, double neutral) {
  return std::isinf(neutral) ? 1.0 / value : value - neutral;
}

double neutral_value(const Quantity& quantity) {
  return std::isnan(quantity.default_value) ? 0.0 : quantity.default_value;
}

Structure with_effect_of(Structure structure, std::size_t quantity) {
  if (const auto effect = quantity_list()[quantity].effect) structure.effects.set(*effect);
  return structure;
}

Job with_hypothesis(const Job& job, const Hypothesis& hypothesis, std::span<const double> others,
                    const HypothesisValues& own, bool fixed_shapes) {
  Job extended = job;
  set_initial_values(extended, others);
  extended.model.structure = with_effect_of(extended.model.structure, hypothesis.strengths.front());
  if (hypothesis.kind == transmission)
    give_backlash(extended, shape_named("J_m", hypothesis, own.shapes));
  if (extended.model.structure.effects != job.model.structure.effects)
    set_defaults(extended.model, quantity_list()[hypothesis.strengths.front()].group);
  for (std::size_t i = 0; i < hypothesis.strengths.size(); ++i)
    extended.free.push_back(free_strength(job, hypothesis, i, own.strengths[i]));
  const auto member = members(extended.model);
  for (std::size_t i = 0; i < hypothesis.shapes.size(); ++i) {
    *member[hypothesis.shapes[i]] = own.shapes[i];
    if (i < hypothesis.estimated_shapes().size() && !fixed_shapes)
      extended.free.push_back(free_shape(job, hypothesis, i, own.shapes[i]));
  }
  if (hypothesis.kind == transmission) limit_stiffness(extended);
  return extended;
}

HypothesisValues values_in(const Job& job, const FitResult& fit, const Hypothesis& hypothesis) {
  Model<double> model = fitted_model(job, fit, hypothesis.recording);
  const auto member = members(model);
  HypothesisValues own;
  for (const std::size_t q : hypothesis.strengths) own.strengths.push_back(*member[q]);
  for (const std::size_t q : hypothesis.shapes) own.shapes.push_back(*member[q]);
  return own;
}

HypothesisValues held_at_settings(const Hypothesis& hypothesis, HypothesisValues own) {
  for (std::size_t k = hypothesis.estimated_shapes().size(); k < own.shapes.size(); ++k) {
    const auto distance = [&](const std::vector<double>& setting) {
      return std::abs(setting[k] - own.shapes[k]);
    };
    own.shapes[k] = (*std::ranges::min_element(hypothesis.settings, {}, distance))[k];
  }
  return own;
}

}  // namespace axisfit
