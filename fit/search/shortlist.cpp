#include "fit/search/shortlist.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "fit/search/acceptance.h"

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

std::vector<ResidualSeries> series_of(const ScoreTest& test, const Eigen::VectorXd& residuals) {
  std::vector<ResidualSeries> list;
  for (const SeriesRows& rows : test.series) {
    ResidualSeries& series = list.emplace_back();
    static_cast<SeriesKey&>(series) = {rows.recording, rows.measurement, true};
    const auto own = residuals.segment(rows.first, rows.count);
    series.values.assign(own.begin(), own.end());
  }
  return list;
}

/// The best of the scores: no more than `length`, but for those that nearly gain as much.
std::vector<ShortlistEntry> best_of(const ScoreTest& test, std::size_t length) {
  constexpr double kMinGain = 6.0;  // of a sum of squares: below is chance
  constexpr double kNearly = 0.9;   // of the best gain: heard even beyond the length
  constexpr double kWorth = 0.5;    // of the best gain: heard beyond the first three
  constexpr std::size_t kFirst = 3;
  // Constants are many, and alike: they crowd no effect out.
  const std::size_t most_constants = (length + 1) / 2;
  const double unit = std::max(1.0, test.mean_square);
  const double samples = test.sum_of_squares / std::max(1e-300, test.mean_square);
  const std::vector<ResidualSeries> before = series_of(test, test.residuals);
  std::vector<ShortlistEntry> taken;
  std::size_t constants = 0;
  for (const Score& score : test.scores) {
    const Candidate& candidate = test.candidates[score.candidate];
    if (score.gain < kMinGain) break;
    const double best = taken.empty() ? score.gain : taken.front().score.gain;
    const std::size_t effects = taken.size() - constants;
    bool beyond = candidate.is_constant
                      ? constants >= most_constants
                      : effects >= 2 * length || (effects >= length && score.gain < kNearly * best);
    beyond = beyond || (taken.size() >= kFirst && score.gain < kWorth * best);
    // A clock that is a little off is heard before anything else is blamed.
    if (beyond && !(candidate.is_timing && score.gain >= kWorth * best)) continue;
    if (std::ranges::any_of(
            taken, [&](const ShortlistEntry& p) { return same_effect(p.candidate, candidate); }))
      continue;
    constants += candidate.is_constant ? 1 : 0;
    const double promise =
        improvement(before, series_of(test, test.residuals + score.change)).fit_gain;
    taken.push_back({candidate, score, score.gain / unit, promise});
    taken.back().score.change.resize(0);
  }
  // What a simpler one gains as well, more parameters gain by chance.
  for (ShortlistEntry& entry : taken)
    for (const ShortlistEntry& simple : taken) {
      const std::size_t own = entry.candidate.parameters(), fewer = simple.candidate.parameters();
      if (fewer >= own || entry.candidate.is_timing) continue;
      const double price = static_cast<double>(own - fewer) * std::log(std::max(2.0, samples));
      entry.is_second = entry.is_second || entry.gain < simple.gain + price;
    }
  return taken;
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
    // Beside simulations that track, the free run is heard for its best, and what nearly equals it.
    const bool is_beside = rates[i] == 0.0 && rates.size() > 1;
    of_rate[i].entries = best_of(test, is_beside ? 1 : static_cast<std::size_t>(length));
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
