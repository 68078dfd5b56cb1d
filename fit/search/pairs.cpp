#include "fit/search/pairs.h"

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

#include "base/linear_algebra.h"
#include "base/parallel.h"
#include "fit/search/effect_columns.h"
#include "fit/search/scorer.h"
#include "fit/solve/parameters.h"

namespace axisfit {
namespace {

using Eigen::Index;

/// What one hypothesis does that the free parameters cannot.
struct Block {
  std::size_t setting = 0;
  Eigen::MatrixXd basis{};
  Index first = 0;    ///< of its columns among those of all
  double gain = 0.0;  ///< alone
};

/// The gains of all pairs of some blocks.
class JointGains {
 public:
  JointGains(std::vector<Block>& blocks, const Eigen::VectorXd& residuals) {
    Index columns = 0;
    for (Block& b : blocks) {
      b.first = columns;
      columns += b.basis.cols();
    }
    Eigen::MatrixXd all(residuals.size(), columns);
    for (const Block& b : blocks) all.middleCols(b.first, b.basis.cols()) = b.basis;
    gram_ = all.transpose() * all;
    shares_ = all.transpose() * residuals;
    for (Block& b : blocks) b.gain = shares_.segment(b.first, b.basis.cols()).squaredNorm();
  }

  double of(const Block& a, const Block& b) const {
    const Index m = a.basis.cols(), n = b.basis.cols();
    Eigen::MatrixXd small = Eigen::MatrixXd::Identity(m + n, m + n);
    small.topRightCorner(m, n) = gram_.block(a.first, b.first, m, n);
    small.bottomLeftCorner(n, m) = small.topRightCorner(m, n).transpose();
    Eigen::VectorXd shares(m + n);
    shares << shares_.segment(a.first, m), shares_.segment(b.first, n);
    return shares.dot(LeastSquaresSolver(small, kCollinear).solve(shares).col(0));
  }

 private:
  static constexpr double kCollinear = 1e-6;  // nothing tells them apart

  Eigen::MatrixXd gram_;
  Eigen::VectorXd shares_;
};

struct Candidate {
  std::size_t first = 0, second = 0;  ///< settings
  double gain = 0.0;
  bool is_hidden = false;
};

/// The pairs that gain more, beyond what the better of them does alone, than the best of so many
/// does by chance; the best first. The unit is that of one sample.
std::vector<Candidate> candidates(const std::vector<Block>& blocks, const JointGains& joint,
                                  const std::vector<EffectSetting>& settings, double unit,
                                  double samples) {
  const std::size_t all = blocks.size() * (blocks.size() - 1) / 2;
  std::vector<Candidate> found;
  for (std::size_t i = 0; i < blocks.size(); ++i)
    for (std::size_t j = i + 1; j < blocks.size(); ++j) {
      const Block &a = blocks[i], &b = blocks[j];
      const Hypothesis &one = *settings[a.setting].hypothesis,
                       &other = *settings[b.setting].hypothesis;
      const double least = least_gain(one, samples, all) + least_gain(other, samples, 1);
      const double gain = joint.of(a, b);
      if (gain - std::max(a.gain, b.gain) > unit * least)
        found.push_back({a.setting, b.setting, gain, gain - a.gain - b.gain > unit * least});
    }
  std::ranges::stable_sort(found, std::greater{}, &Candidate::gain);
  return found;
}

std::vector<ScoredPair> pairs_at(const FittedModel& model, double observer_gain,
                                 const std::vector<Shortlist::Promise>& hypotheses, double samples,
                                 const SearchContext& context) {
  const Job job = with_coarse_steps(model.job);
  const auto point = score_point(job, values_of(model.fit), observer_gain, context);
  if (!point) return {};
  const Job fixed = fixed_at(job, point->values);
  const EffectColumns columns(fixed, observer_gain, context.run);
  const Scorer scorer(job, *point, context.options.scoring);
  std::vector<EffectSetting> settings;
  for (const Shortlist::Promise& p : hypotheses)
    settings.push_back({p.hypothesis.get(), {p.hypothesis->neutral, p.shapes}});
  const std::vector<Eigen::MatrixXd> derivatives = columns.derivatives(settings);
  std::vector<Block> blocks;
  for (std::size_t i = 0; i < settings.size(); ++i)
    if (Eigen::MatrixXd own = scorer.own_basis(derivatives[i]); own.size() > 0)
      blocks.push_back({.setting = i, .basis = std::move(own)});
  const JointGains joint(blocks, point->residuals);

  const SearchOptions::Pairs& limits = context.options.pairs;
  const double sum_of_squares = point->residuals.squaredNorm(),
               unit = std::max(1.0, point->mean_square());
  std::vector<ScoredPair> pairs;
  for (const Candidate& c : candidates(blocks, joint, settings, unit, samples)) {
    if (std::ranges::count(pairs, c.is_hidden, &ScoredPair::is_hidden) ==
        static_cast<std::ptrdiff_t>(limits.refitted))
      continue;
    const std::array both{settings[c.first], settings[c.second]};
    const std::array rows{derivatives[c.first], derivatives[c.second]};
    std::optional<ScoreStep> step = scorer.step(both, rows, 0.0);
    if (!step) continue;  // a strength would leave its range
    pairs.push_back(
        {{.hypothesis = hypotheses[c.first].hypothesis,
          .own = std::move(step->own[0]),
          .others = step->others},
         {.hypothesis = hypotheses[c.second].hypothesis,
          .own = std::move(step->own[1]),
          .others = step->others},
         c.gain / unit,
         c.is_hidden,
         is_most(c.gain, sum_of_squares, sum_of_squares / std::max(1e-300, point->mean_square()),
                 context.options.shortlist)});
  }
  return pairs;
}

/// The second in the model with the first.
Tried together(const FittedModel& model, const ScoredPair& pair, const SearchContext& context) {
  const Scored& first = pair.first;
  const Job with_first = with_hypothesis(model.job, *first.hypothesis, first.others, first.own);
  Scored second = pair.second;
  second.others = initial_values(with_first);
  return try_hypothesis(with_first, second, context, {.give_up_above = reduced_cost(model.fit)});
}

}  // namespace

std::vector<ScoredPair> score_pairs(const FittedModel& model,
                                    std::span<const double> observer_gains,
                                    std::span<const Shortlist::Promise> hypotheses,
                                    const SearchContext& context) {
  std::vector<Shortlist::Promise> smooth;  // whose derivatives need no simulations of their own
  std::ranges::copy_if(hypotheses, std::back_inserter(smooth), [](const Shortlist::Promise& p) {
    return p.hypothesis->probes.empty() && p.hypothesis->kind != HypothesisKind::transmission;
  });
  const double samples = samples_of(residual_series(model.job, model.fit));
  std::vector<ScoredPair> all;
  for (const double gain : observer_gains)
    for (ScoredPair& pair : pairs_at(model, gain, smooth, samples, context)) {
      const bool is_known = std::ranges::any_of(all, [&](const ScoredPair& other) {
        return is_same(*other.first.hypothesis, *pair.first.hypothesis) &&
               is_same(*other.second.hypothesis, *pair.second.hypothesis);
      });
      if (!is_known) all.push_back(std::move(pair));
    }
  std::ranges::stable_sort(all, std::greater{}, [](const ScoredPair& pair) {
    return std::pair(pair.is_hidden, pair.gain);
  });
  std::size_t of_kind[2] = {};
  std::erase_if(all, [&](const ScoredPair& pair) {
    return ++of_kind[pair.is_hidden] > context.options.pairs.refitted;
  });
  return all;
}

std::optional<TriedPair> try_pair(const FittedModel& model, const ScoredPair& pair,
                                  const SearchContext& context) {
  const Strictness strictness{1, context.options.acceptance.chance};
  Tried second = together(model, pair, context);
  const Improvement both = improvement(residual_series(model.job, model.fit), second.residuals);
  if (!second.fit.is_usable() || !both.comparable || !(both.p_value < strictness.chance) ||
      rejection_by_free_run(model.fit, second.fit) ||
      rejection_by_force(missing_percents(model.job, model.fit),
                         missing_percents(second.job, second.fit), context.options.acceptance))
    return std::nullopt;
  std::array<Tried, 2> alone;
  parallel_for(2, [&](std::size_t i) {
    alone[i] = try_hypothesis(model.job, i == 0 ? pair.first : pair.second, context);
  });
  if (!alone[0].fit.is_usable() || !alone[1].fit.is_usable()) return std::nullopt;
  Tried first = second;
  first.hypothesis = *pair.first.hypothesis;
  judge(first, alone[1].residuals, strictness, context.options);
  judge(second, alone[0].residuals, strictness, context.options);
  if (first.rejection || second.rejection) return std::nullopt;
  alone[0].gain = first.gain;
  return TriedPair{std::move(alone[0]), std::move(second)};
}

}  // namespace axisfit
