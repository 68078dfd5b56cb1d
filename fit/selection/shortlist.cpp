#include "fit/selection/shortlist.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel.h"

namespace axisfit {
namespace {

/// Whether the fits of both would end in the same place.
bool nearly_same(const ShortlistEntry& a, const ShortlistEntry& b) {
  constexpr double kNearly = 0.05;
  return same_effect(a.candidate, b.candidate) &&
         std::ranges::equal(a.score.shapes, b.score.shapes, [](double x, double y) {
           return std::abs(x - y) <= kNearly * std::max(std::abs(x), std::abs(y));
         });
}

/// The best constants, or the best of the others.
std::vector<ShortlistEntry> best_of(const ScoreTest& test, std::size_t length, bool constants) {
  constexpr double kMinGain = 6.0;  // of a sum of squares: below is chance
  constexpr double kNearly = 0.9;   // of the best gain: heard even beyond the length
  constexpr int kSettings = 2;      // of one candidate: no crowding out of the others
  std::vector<ShortlistEntry> taken;
  for (const Score& score : test.scores) {
    const Candidate& candidate = test.candidates[score.candidate];
    if (candidate.is_constant != constants) continue;
    if (score.gain < kMinGain) break;
    const bool beyond = taken.size() >= 2 * length ||
                        (taken.size() >= length && score.gain < kNearly * taken.front().score.gain);
    // A clock that is a little off is heard before anything else is blamed.
    if (beyond && !candidate.is_timing) continue;
    const auto same = std::ranges::count_if(
        taken, [&](const ShortlistEntry& p) { return same_effect(p.candidate, candidate); });
    if (same < kSettings)
      taken.push_back({candidate, score, score.gain / std::max(1.0, test.mean_square)});
  }
  return taken;
}

/// Fits each while tracking with the gain `rate`, and keeps those that may yet turn out the best.
std::vector<ShortlistEntry> screened(const Job& job, std::vector<ShortlistEntry> list, double rate,
                                     const RunContext& context) {
  constexpr std::size_t kKept = 3;
  constexpr double kMaxCostRatio =
      1.05;  // of the best cost: the free run will not make up for more
  if (list.size() <= kKept) return list;
  struct Run {
    double cost = INFINITY;
    std::vector<double> values;
  };
  std::vector<Run> runs(list.size());
  parallel_for(list.size(), [&](std::size_t i) {
    const ShortlistEntry& p = list[i];
    const Job extended =
        with_candidate(job, p.candidate, p.score.values, p.score.strengths, p.score.shapes);
    const ParameterSpace space(extended);
    std::vector<double> start;
    for (const FreeParameter& free : extended.free) start.push_back(free.initial);
    SolveOptions options;
    options.max_iterations = 8;
    options.function_tolerance = 1e-4;
    options.penalize_distance_from_start = true;
    const SolveResult solved =
        solve(extended, space, space.internal(start), rate, options, context);
    if (solved.usable) runs[i] = {solved.cost, space.values(solved.u)};
  });
  std::vector<std::size_t> order(list.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return runs[i].cost; });
  std::vector<ShortlistEntry> kept;
  for (const std::size_t i : order) {
    if (!std::isfinite(runs[i].cost)) break;
    const bool far =
        kept.size() >= kKept && runs[i].cost > kMaxCostRatio * runs[order.front()].cost;
    if (far && !list[i].candidate.is_timing) continue;
    ShortlistEntry& p = kept.emplace_back(std::move(list[i]));
    const auto base = runs[i].values.begin() + static_cast<std::ptrdiff_t>(job.free.size());
    const auto shapes = base + static_cast<std::ptrdiff_t>(p.candidate.strengths.size());
    p.score.values.assign(runs[i].values.begin(), base);
    p.score.strengths.assign(base, shapes);
    if (p.candidate.shapes_are_free) p.score.shapes.assign(shapes, runs[i].values.end());
  }
  return kept;
}

}  // namespace

Shortlist shortlist(const Job& job, const std::vector<double>& values,
                    const std::vector<double>& rates, bool curves, int length,
                    const RunContext& context) {
  // What a low gain shows may be hidden by a high one: each has its own best.
  std::vector<Shortlist> of_rate(rates.size());
  parallel_for(rates.size(), [&](std::size_t i) {
    const ScoreTest test = score_test(job, values, rates[i], curves, context);
    of_rate[i].tried = test.scores.size();
    const auto most = static_cast<std::size_t>(length);
    of_rate[i].entries = best_of(test, most, false);
    // Constants are many, and alike: they crowd no effect out.
    for (ShortlistEntry& entry : best_of(test, (most + 1) / 2, true))
      of_rate[i].entries.push_back(std::move(entry));
    of_rate[i].entries = screened(job, std::move(of_rate[i].entries), rates[i], context);
  });
  Shortlist result;
  for (Shortlist& list : of_rate) {
    result.tried = std::max(result.tried, list.tried);
    for (ShortlistEntry& entry : list.entries) {
      const bool known = std::ranges::any_of(
          result.entries, [&](const ShortlistEntry& p) { return nearly_same(p, entry); });
      if (!known) result.entries.push_back(std::move(entry));
    }
  }
  return result;
}

}  // namespace axisfit
