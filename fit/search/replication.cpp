#include "fit/search/replication.h"

#include <algorithm>
#include <cmath>

#include "fit/search/tried.h"

namespace axisfit {
namespace {

struct Estimate {
  double value = 0.0, error = 0.0;
};

/// A stiffness itself, for its relative error is that of the compliance.
double from_neutral(const Estimate& e, double neutral) {
  return std::abs(std::isinf(neutral) ? e.value : e.value - neutral);
}

bool is_near(const Estimate& a, const Estimate& b, double errors, double least) {
  return std::abs(a.value - b.value) <= std::max(errors * std::hypot(a.error, b.error), least);
}

/// The length of two strengths that are sine and cosine of a phase.
Estimate amplitude(const Estimate& sine, const Estimate& cosine) {
  return {std::hypot(sine.value, cosine.value),
          std::hypot(sine.error, cosine.error) / std::sqrt(2)};
}

}  // namespace

std::optional<FitResult> fit_elsewhere(const Job& job, const FitResult& fit,
                                       const SearchContext& context) {
  std::optional<Job> other = with_exchanged_roles(job);
  if (!other) return std::nullopt;
  FitResult result = refit_from(*std::move(other), values_of(fit), context);
  if (!result.is_usable()) return std::nullopt;
  return result;
}

Replication replication(const Job& job, const FitResult& fit, const FitResult& elsewhere,
                        const Hypothesis& hypothesis, const SearchOptions& options) {
  Replication result;
  bool determined = hypothesis.kind != HypothesisKind::curve;
  std::vector<Estimate> here, there;
  const auto read = [&](std::size_t quantity) {
    const auto free = std::ranges::find(job.free, ParameterId{quantity, hypothesis.recording},
                                        &FreeParameter::id);
    if (free == job.free.end()) return;
    const auto i = static_cast<std::size_t>(free - job.free.begin());
    for (const FitResult* f : {&fit, &elsewhere}) {
      const ParameterResult& p = f->parameters[i];
      determined = determined && p.uncertainty.standard_error > 0.0;
      (f == &fit ? here : there).push_back({p.value, p.uncertainty.standard_error});
    }
    result.parameters.push_back(elsewhere.parameters[i]);
  };
  for (const std::size_t q : hypothesis.strengths) read(q);
  const std::size_t strengths = here.size();
  for (const std::size_t q : hypothesis.estimated_shapes()) read(q);
  if (!determined || strengths != hypothesis.strengths.size()) return result;

  std::vector<double> neutral = hypothesis.neutral;
  neutral.resize(here.size(), 0.0);
  if (hypothesis.has_phase) {
    for (auto* list : {&here, &there}) {
      (*list)[0] = amplitude((*list)[0], (*list)[1]);
      list->erase(list->begin() + 1);
    }
    neutral.erase(neutral.begin());
  }
  const SearchOptions::Replication& limits = options.replication;
  const auto is_far_from_zero = [&](const Estimate& e, double zero) {
    return from_neutral(e, zero) > limits.far * e.error;
  };
  const std::size_t first_shape = strengths - (hypothesis.has_phase ? 1 : 0);
  bool far_here = false, far_there = false;
  result.is_near = true;
  for (std::size_t i = 0; i < here.size(); ++i) {
    const double part = hypothesis.has_phase && i > 0 ? limits.part_of_period : limits.part;
    result.is_near = result.is_near && is_near(here[i], there[i], limits.errors,
                                               part * from_neutral(here[i], neutral[i]));
    if (i >= first_shape) continue;
    far_here = far_here || is_far_from_zero(here[i], neutral[i]);
    far_there = far_there || is_far_from_zero(there[i], neutral[i]);
  }
  result.is_alike = result.is_near && far_here && far_there;
  if (hypothesis.has_phase && here.size() == 2)
    result.has_other_period = far_here && far_there &&
                              !is_near(here[1], there[1], limits.other_errors,
                                       limits.other_part * std::abs(here[1].value));
  return result;
}

}  // namespace axisfit
