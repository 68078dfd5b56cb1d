#include "fit/search/verdict.h"

#include <algorithm>

#include "fit/judge/grade.h"
#include "fit/judge/missing_force.h"
#include "fit/solve/parameters.h"

namespace axisfit {
namespace {

/// At a bound that is not the lower end of the quantity, where it has as good as no part in the
/// axis.
bool is_stuck(const Job& job, const FreeParameter& free, const ParameterResult& found) {
  const double end = job.entry(free.quantity).quantity.lower;
  const bool is_at_end = end >= 0.0 && free.lower == end && found.value == end;
  return found.uncertainty.verdict() == ParameterVerdict::at_bound && !is_at_end;
}

}  // namespace

bool is_misfit(const SearchState& state, SelectionVerdict& verdict) {
  const Job& declared = state.chain.declared().job;
  const FittedModel& last = state.current();
  for (std::size_t i = 0; i < declared.free.size() && !verdict.at_bound; ++i)
    if (is_stuck(declared, last.job.free[i], last.fit.parameters[i]))
      verdict.at_bound = last.fit.parameters[i].id;
  for (std::size_t r = 0; r < last.job.recordings.size(); ++r) {
    const double percent = percent_of_drive(missing_force(last.job, last.fit, r));
    if (percent <= std::max(GradeOptions().largest_force, verdict.force_percent)) continue;
    verdict.force_percent = percent;
    verdict.recording = r;
  }
  return verdict.at_bound || verdict.recording;
}

void enter_effects(const SearchState& state, const FittedModel& result, SelectionVerdict& verdict) {
  Model<double> model = fitted_model(result.job, result.fit);
  for (const Outcome& o : state.outcomes.list())
    if (o.decision() == Decision::undecided) verdict.undecided.push_back(o.hypothesis.name);
  for (const Accepted& a : state.accepted()) {
    if (std::ranges::find(verdict.undecided, a.hypothesis.name) != verdict.undecided.end())
      continue;
    verdict.accepted.push_back(a.hypothesis.name);
    if (a.hypothesis.kind == HypothesisKind::constant)
      verdict.corrections.push_back({{a.hypothesis.strengths.front()},
                                     a.hypothesis.neutral.front(),
                                     *members(model)[a.hypothesis.strengths.front()]});
  }
  if (!state.accepted().empty())
    verdict.validate_percent =
        improvement(state.chain.declared(), state.current()).validate_percent;
}

SelectionVerdict::Kind kind_of(const EffectSelection& selection, bool is_noise) {
  using enum SelectionVerdict::Kind;
  const SelectionVerdict& verdict = selection.verdict;
  if (!verdict.accepted.empty()) return effects_accepted;
  if (verdict.undecided.empty() && is_noise)
    return verdict.small.empty() ? nothing_missing : hardly_anything;
  if (selection.interrupted || selection.cut_short) return stopped;
  if (verdict.at_bound || verdict.recording) return misfit;
  return verdict.undecided.empty() ? none_passes : undecided;
}

}  // namespace axisfit
