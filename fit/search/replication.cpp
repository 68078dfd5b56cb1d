#include "fit/search/replication.h"

#include <algorithm>
#include <cmath>

#include "fit/search/extended_model.h"

namespace axisfit {
namespace {

struct Estimate {
  double value = 0.0, error = 0.0;
};

/// Of a stiffness itself, for its relative error is that of the compliance.
double from_neutral(const Estimate& e, double neutral) {
  return std::abs(std::isinf(neutral) ? e.value : e.value - neutral);
}

bool is_far_from_zero(const Estimate& e, double neutral) {
  constexpr double kFar = 4.0;  // standard errors
  return from_neutral(e, neutral) > kFar * e.error;
}

/// Within their errors, or this part of what they are.
bool is_near(const Estimate& a, const Estimate& b, double neutral, double part) {
  constexpr double kErrors = 3.0;
  return std::abs(a.value - b.value) <=
         std::max(kErrors * std::hypot(a.error, b.error), part * from_neutral(a, neutral));
}

/// By more than estimates differ that say alike of the same thing.
bool is_far_apart(const Estimate& a, const Estimate& b) {
  constexpr double kErrors = 5.0, kPart = 0.1;
  return std::abs(a.value - b.value) >
         std::max(kErrors * std::hypot(a.error, b.error), kPart * std::abs(a.value));
}

/// The length of two strengths that are sine and cosine of a phase.
Estimate amplitude(const Estimate& sine, const Estimate& cosine) {
  return {std::hypot(sine.value, cosine.value),
          std::hypot(sine.error, cosine.error) / std::sqrt(2)};
}

}  // namespace

std::optional<FitResult> fit_elsewhere(const Job& job, const FitResult& fit,
                                       const RunContext& context) {
  std::optional<Job> other = with_exchanged_roles(job);
  if (!other) return std::nullopt;
  FitResult result = refit_from(*std::move(other), values_of(fit), context);
  if (!result.usable) return std::nullopt;
  return result;
}

Replication replication(const Job& job, const FitResult& fit, const FitResult& elsewhere,
                        const Candidate& candidate) {
  Replication result;
  bool determined = !candidate.is_curve;
  std::vector<Estimate> here, there;
  const auto read = [&](std::size_t quantity) {
    const auto free = std::ranges::find(job.free, quantity, &FreeParameter::quantity);
    if (free == job.free.end()) return;
    const auto i = static_cast<std::size_t>(free - job.free.begin());
    for (const FitResult* f : {&fit, &elsewhere}) {
      const ParameterResult& p = f->parameters[i];
      determined = determined && p.uncertainty.standard_error > 0.0;
      (f == &fit ? here : there).push_back({p.value, p.uncertainty.standard_error});
    }
    result.parameters.push_back(elsewhere.parameters[i]);
  };
  for (const std::size_t q : candidate.strengths) read(q);
  const std::size_t strengths = here.size();
  if (candidate.shapes_are_free)
    for (const std::size_t q : candidate.shapes) read(q);
  if (!determined || strengths != candidate.strengths.size()) return result;

  std::vector<double> neutral = candidate.neutral;
  neutral.resize(here.size(), 0.0);
  if (candidate.has_phase) {
    for (auto* list : {&here, &there}) {
      (*list)[0] = amplitude((*list)[0], (*list)[1]);
      list->erase(list->begin() + 1);
    }
    neutral.erase(neutral.begin());
  }
  bool far_here = false, far_there = false;
  result.is_near = true;
  for (std::size_t i = 0; i < here.size(); ++i) {
    // A ripple is known by its period: with another one it is another ripple.
    constexpr double kPart = 0.1, kPartOfPeriod = 0.02;
    const double part = candidate.has_phase && i > 0 ? kPartOfPeriod : kPart;
    result.is_near = result.is_near && is_near(here[i], there[i], neutral[i], part);
    if (i + (candidate.has_phase ? 1 : 0) >= strengths) continue;
    far_here = far_here || is_far_from_zero(here[i], neutral[i]);
    far_there = far_there || is_far_from_zero(there[i], neutral[i]);
  }
  result.is_alike = result.is_near && far_here && far_there;
  if (candidate.has_phase && here.size() == 2)
    result.has_other_period = far_here && far_there && is_far_apart(here[1], there[1]);
  return result;
}

}  // namespace axisfit
