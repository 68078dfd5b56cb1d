#include "fit/search/shortlist.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "fit/search/acceptance.h"

namespace axisfit {
namespace {

/// Whether the refits of both would end in the same place.
bool nearly_same(const Scored& a, const Scored& b, double part) {
  return is_same(*a.hypothesis, *b.hypothesis) &&
         std::ranges::equal(a.own.shapes, b.own.shapes, [part](double x, double y) {
           return std::abs(x - y) <= part * std::max(std::abs(x), std::abs(y));
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

/// Marks what a simpler one gains as well: more parameters gain by chance.
void mark_seconds(std::vector<Scored>& entries, double samples) {
  for (Scored& entry : entries)
    for (const Scored& simple : entries) {
      const std::size_t own = entry.hypothesis->parameters(),
                        fewer = simple.hypothesis->parameters();
      if (fewer >= own || entry.hypothesis->kind == HypothesisKind::clock) continue;
      const double price = static_cast<double>(own - fewer) * std::log(std::max(2.0, samples));
      entry.is_second = entry.is_second || entry.scaled_gain < simple.scaled_gain + price;
    }
}

/// Whether it is a law of one number beside a richer one that acts on the same. What is large is
/// told wrongly to first order: there a bump as wide as the stroke gains more than the plain
/// friction that it stands for.
bool is_plain_beside(const std::vector<Scored>& taken, const Hypothesis& hypothesis) {
  return hypothesis.kind == HypothesisKind::effect && hypothesis.parameters() == 1 &&
         std::ranges::any_of(taken, [&](const Scored& s) {
           return s.hypothesis->acts_on == hypothesis.acts_on && s.hypothesis->parameters() > 1;
         });
}

/// The best of the scores: no more than `length`, but for those that nearly gain as much.
std::vector<Scored> best_of(ScoreTest& test, std::size_t length,
                            const SearchOptions::Shortlist& options) {
  using enum HypothesisKind;
  // Constants are many, and alike: they crowd no effect out.
  const std::size_t most_constants = (length + 1) / 2;
  const double unit = std::max(1.0, test.mean_square);
  const std::vector<ResidualSeries> before = series_of(test, test.residuals);
  std::vector<Scored> taken;
  std::size_t constants = 0;
  for (Scored& score : test.scores) {
    const Hypothesis& hypothesis = *score.hypothesis;
    if (score.gain < options.least_gain) break;
    const double best = taken.empty() ? score.gain : taken.front().gain;
    const std::size_t effects = taken.size() - constants;
    const bool is_many = hypothesis.kind == constant
                             ? constants >= most_constants
                             : effects >= 2 * length ||
                                   (effects >= length && score.gain < options.nearly_best * best);
    const bool is_little = taken.size() >= options.first && score.gain < options.worth * best;
    // A clock that is a little off is heard before anything else is blamed.
    const bool is_heard =
        (hypothesis.kind == clock && score.gain >= options.worth * best) ||
        (score.gain >= options.worth_plain * best && is_plain_beside(taken, hypothesis));
    if ((is_many || is_little) && !is_heard) continue;
    if (std::ranges::any_of(
            taken, [&](const Scored& s) { return is_same_form(*s.hypothesis, hypothesis); }))
      continue;
    constants += hypothesis.kind == constant ? 1 : 0;
    score.scaled_gain = score.gain / unit;
    score.promise = improvement(before, series_of(test, test.residuals + score.change)).fit_gain;
    score.change.resize(0);
    taken.push_back(score);
  }
  mark_seconds(taken, test.sum_of_squares / std::max(1e-300, test.mean_square));
  return taken;
}

/// Keeps the best of each hypothesis.
void note(std::vector<Shortlist::Promise>& promises, const Shortlist::Promise& promise) {
  const auto known = std::ranges::find_if(promises, [&](const Shortlist::Promise& p) {
    return is_same(*p.hypothesis, *promise.hypothesis);
  });
  if (known == promises.end())
    promises.push_back(promise);
  else if (promise.gain > known->gain)
    *known = promise;
}

}  // namespace

std::optional<double> Shortlist::promised_by(const Hypothesis& hypothesis) const {
  const auto found = std::ranges::find_if(
      promises, [&](const Promise& p) { return is_same(*p.hypothesis, hypothesis); });
  return found == promises.end() ? std::nullopt : std::optional(found->gain);
}

Shortlist shortlist(const Job& job, const std::vector<double>& values,
                    const std::vector<double>& gains, bool curves, const SearchContext& context) {
  const SearchOptions::Shortlist& options = context.options.shortlist;
  // A high gain may hide what a low one shows: each has its own best.
  std::vector<Shortlist> of_gain(gains.size());
  parallel_for(gains.size(), [&](std::size_t i) {
    ScoreTest test = score_test(job, values, gains[i], curves, context);
    of_gain[i].tried = test.scores.size();
    for (const Scored& score : test.scores)
      note(of_gain[i].promises,
           {score.hypothesis, score.own.shapes, score.gain / std::max(1.0, test.mean_square)});
    // Beside simulations that track, the free run is heard for its best, and what nearly equals it.
    const bool is_beside = gains[i] == 0.0 && gains.size() > 1;
    of_gain[i].entries =
        best_of(test, is_beside ? 1 : static_cast<std::size_t>(options.length), options);
  });
  Shortlist result;
  result.observer_gains = gains;
  for (Shortlist& list : of_gain) {
    result.tried = std::max(result.tried, list.tried);
    for (const Shortlist::Promise& promise : list.promises) note(result.promises, promise);
    for (Scored& entry : list.entries) {
      const bool known = std::ranges::any_of(result.entries, [&](const Scored& s) {
        return nearly_same(s, entry, options.same_shape);
      });
      if (!known) result.entries.push_back(std::move(entry));
    }
  }
  return result;
}

}  // namespace axisfit
