#include "fit/search/shortlist.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "fit/search/acceptance.h"
#include "fit/search/scorer.h"

namespace axisfit {
namespace {

/// Whether the refits of both would end in the same place: shapes that differ by no more than this
/// part, and strengths by no more than a factor of two.
bool nearly_same(const Scored& a, const Scored& b, double part) {
  const auto within = [](double most) {
    return [most](double x, double y) {
      return x == y || std::abs(x - y) <= most * std::max(std::abs(x), std::abs(y));
    };
  };
  return is_same(*a.hypothesis, *b.hypothesis) &&
         std::ranges::equal(a.own.shapes, b.own.shapes, within(part)) &&
         std::ranges::equal(a.own.strengths, b.own.strengths, within(0.5));
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
  for (Scored& entry : entries) {
    entry.is_second = false;
    for (const Scored& simple : entries) {
      const std::size_t own = entry.hypothesis->parameters(),
                        fewer = simple.hypothesis->parameters();
      if (fewer >= own || entry.hypothesis->kind == HypothesisKind::clock) continue;
      const double price = static_cast<double>(own - fewer) * std::log(std::max(2.0, samples));
      entry.is_second = entry.is_second || entry.scaled_gain < simple.scaled_gain + price;
    }
  }
}

/// Whether it is the best of the plain laws beside what gains more.
bool is_best_plain(const std::vector<Scored>& taken, const Hypothesis& hypothesis) {
  const auto is_richer = [&](const Scored& s) {
    return is_plain_beside(hypothesis, *s.hypothesis);
  };
  const auto is_plain = [&](const Scored& s) {
    return s.hypothesis->acts_on == hypothesis.acts_on && s.hypothesis->parameters() == 1;
  };
  return std::ranges::any_of(taken, is_richer) && std::ranges::none_of(taken, is_plain);
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
        (score.gain >= options.worth_plain * best && is_best_plain(taken, hypothesis));
    if ((is_many || is_little) && !is_heard) continue;
    if (std::ranges::any_of(taken, [&](const Scored& s) { return is_same_law(s, score); }))
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

/// Drops fits that ended where an earlier one of the hypothesis did, or far from doing as well.
void drop_worse_ends(std::vector<Scored>& entries, const SearchOptions& options) {
  std::vector<Scored> kept;
  for (Scored& entry : entries) {
    const bool is_needless =
        entry.is_fitted && std::ranges::any_of(kept, [&](const Scored& other) {
          return other.is_fitted && is_same_law(other, entry) &&
                 (nearly_same(other, entry, options.shortlist.same_shape) ||
                  entry.scaled_gain < options.round.rival_part * other.scaled_gain);
        });
    if (!is_needless) kept.push_back(std::move(entry));
  }
  entries = std::move(kept);
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

bool has_most(const ScoreTest& test, const SearchOptions::Shortlist& options) {
  return !test.scores.empty() &&
         is_most(test.scores.front().gain, test.sum_of_squares,
                 test.sum_of_squares / std::max(1e-300, test.mean_square), options);
}

}  // namespace

bool is_most(double gain, double sum_of_squares, double samples,
             const SearchOptions::Shortlist& options) {
  const double beyond = sum_of_squares - samples;
  return beyond > 0.0 && gain >= options.most * beyond;
}

std::optional<double> Shortlist::promised_by(const Hypothesis& hypothesis) const {
  const auto found = std::ranges::find_if(
      promises, [&](const Promise& p) { return is_same(*p.hypothesis, hypothesis); });
  return found == promises.end() ? std::nullopt : std::optional(found->gain);
}

void Shortlist::add(Shortlist other, const SearchOptions& options) {
  observer_gains.insert(observer_gains.end(), other.observer_gains.begin(),
                        other.observer_gains.end());
  tried = std::max(tried, other.tried);
  has_most = has_most || other.has_most;
  for (const Promise& promise : other.promises) note(promises, promise);
  for (Scored& entry : other.entries) {
    const auto known = std::ranges::find_if(entries, [&](const Scored& s) {
      return nearly_same(s, entry, options.shortlist.same_shape);
    });
    if (known == entries.end())
      entries.push_back(std::move(entry));
    else if (!known->is_fitted && entry.scaled_gain > known->scaled_gain)
      *known = std::move(entry);
  }
}

Shortlist shortlist(const Job& job, const std::vector<double>& values,
                    const std::vector<double>& gains, bool curves, const SearchContext& context,
                    bool is_added) {
  const SearchOptions::Shortlist& options = context.options.shortlist;
  // A high gain may hide what a low one shows: each has its own best.
  std::vector<Shortlist> of_gain(gains.size());
  parallel_for(gains.size(), [&](std::size_t i) {
    ScoreTest test = score_test(job, values, gains[i], curves, context);
    of_gain[i].observer_gains = {gains[i]};
    of_gain[i].tried = test.scores.size();
    of_gain[i].has_most = has_most(test, options);
    for (const Scored& score : test.scores)
      note(of_gain[i].promises,
           {score.hypothesis, score.own.shapes, score.gain / std::max(1.0, test.mean_square)});
    // Beside simulations that track, the free run is heard for its best, and what nearly equals it.
    const bool is_beside = gains[i] == 0.0 && (is_added || gains.size() > 1);
    of_gain[i].entries =
        best_of(test, is_beside ? 1 : static_cast<std::size_t>(options.length), options);
  });
  Shortlist result;
  for (Shortlist& one : of_gain) result.add(std::move(one), context.options);
  return result;
}

void fit_entries(Shortlist& list, const Job& job, const std::vector<double>& values,
                 double observer_gain, const SearchContext& context) {
  const Job coarse = with_coarse_steps(job);
  const auto fit = [&](const Job& model, const std::vector<double>& from) {
    return tracking_fit(model, ParameterSpace(model), from, observer_gain, context);
  };
  const SolveResult without = fit(coarse, values);
  if (!without.usable) return;
  const double samples = 2.0 * without.cost / without.reduced_cost,
               unit = std::max(1.0, without.reduced_cost);
  parallel_for(list.entries.size(), [&](std::size_t i) {
    Scored& entry = list.entries[i];
    if (entry.is_fitted || entry.hypothesis->is_of_instrument() ||
        entry.hypothesis->kind == HypothesisKind::transmission)
      return;
    const Job extended = with_hypothesis(coarse, *entry.hypothesis, entry.others, entry.own);
    const SolveResult with = fit(extended, initial_values(extended));
    if (!with.usable) return;
    const std::vector<double> found = ParameterSpace(extended).values(with.u);
    const auto own = found.begin() + static_cast<std::ptrdiff_t>(job.free.size()),
               shapes = own + static_cast<std::ptrdiff_t>(entry.own.strengths.size());
    entry.others.assign(found.begin(), own);
    entry.own.strengths.assign(own, shapes);
    std::copy(shapes, found.end(), entry.own.shapes.begin());
    entry.scaled_gain = 2.0 * (without.cost - with.cost) / unit;
    entry.is_fitted = true;
  });
  drop_worse_ends(list.entries, context.options);
  for (const Scored& entry : list.entries)
    list.has_most = list.has_most || is_most(entry.scaled_gain * unit, 2.0 * without.cost, samples,
                                             context.options.shortlist);
  mark_seconds(list.entries, samples);
}

}  // namespace axisfit
