#include "fit/search/elsewhere.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <mutex>
#include <span>
#include <string>
#include <utility>

#include "base/parallel.h"
#include "fit/data/partition.h"
#include "sim/effects/effects.h"

namespace axisfit {
namespace {

bool is_of_validation(const Rejection& rejection) {
  return rejection.test == Rejection::Test::validation || rejection.test == Rejection::Test::power;
}

/// Whether the recordings to validate could not have shown it and blocks could: a disturbance goes
/// on from one block to the next, and only another recording tells it from a law.
bool wants_blocks(const Tried* refit) {
  static const std::size_t kOverTime = *effect_named(ForceOverTime<double>::name);
  return refit->rejection && refit->rejection->test == Rejection::Test::power &&
         quantity_list()[refit->hypothesis.strengths.front()].effect != kOverTime;
}

class Elsewhere {
 public:
  Elsewhere(const FittedModel& model, const Strictness& strictness, ElsewhereMemory& memory,
            const SearchContext& context)
      : model_(model), strictness_(strictness), memory_(memory), context_(context) {}

  void ask(std::vector<Tried>& refits) {
    const SearchOptions::Round& limits = context_.options.round;
    std::vector<Tried*> order;
    for (Tried& e : refits)
      if (e.fit.is_usable() && is_of_validation(*e.rejection)) order.push_back(&e);
    std::ranges::stable_sort(order, std::greater{},
                             [](const Tried* e) { return e->gain.fit_gain; });
    const auto at_once = static_cast<std::size_t>(limits.at_once);
    if (leaves_little(model_, context_.options)) order.resize(std::min(order.size(), at_once));
    const Tried* best = nullptr;
    for (std::size_t first = 0; first < order.size(); first += at_once) {
      std::span<Tried*> next(order);
      next = next.subspan(first, std::min(at_once, order.size() - first));
      if (best != nullptr &&
          is_clearly_worse(bic_advantage(*best, *next.front()), context_.options))
        return;
      report_progress("does " + next.front()->hypothesis.name + " replicate?");
      parallel_for(next.size(), [&](std::size_t i) { try_to_replicate(*next[i]); });
      std::vector<Tried*> asked;
      std::ranges::copy_if(next, std::back_inserter(asked), wants_blocks);
      try_on_blocks(asked);
      for (const Tried* e : next)
        if (best == nullptr && !e->rejection) best = e;
    }
  }

 private:
  void report_progress(const std::string& phase) const {
    context_.run.report(
        {.phase = phase, .best = model_.fit.reduced_chi_square, .work = Work::trials});
  }

  std::optional<Rejection> rejection(const Tried& e, const Improvement& gain,
                                     bool replicates) const {
    Strictness strictness = strictness_;
    strictness.replicates = replicates;
    return rejection_of(e.hypothesis, gain,
                        determination(e.job, e.fit, e.hypothesis, e.residuals, context_.options),
                        strictness, context_.options);
  }

  /// An effect that lowers the error of one recording and not that of another may yet be in both,
  /// where something else differs between them.
  void try_to_replicate(Tried& e) {
    if (e.hypothesis.kind == HypothesisKind::curve) return;  // proves nothing, see replication()
    const std::optional<FitResult> elsewhere = fitted_elsewhere(e);
    if (!elsewhere) return;
    Replication found = replication(e.job, e.fit, *elsewhere, e.hypothesis, context_.options);
    if (!found.is_alike) return;
    e.rejection = rejection(e, e.gain, true);
    if (!e.rejection) e.replication = std::move(found);
  }

  std::optional<FitResult> fitted_elsewhere(const Tried& e) {
    const std::vector<double> values = values_of(e.fit);
    const auto known = [&] {
      const std::lock_guard lock(mutex_);
      const auto found = memory_.fits.find(values);
      return found == memory_.fits.end() ? std::nullopt : std::optional(found->second);
    };
    if (auto found = known()) return *std::move(found);
    std::optional<FitResult> fit = fit_elsewhere(e.job, e.fit, context_);
    const std::lock_guard lock(mutex_);
    return memory_.fits.emplace(values, std::move(fit)).first->second;
  }

  /// What a model leaves of the blocks that are held out from its fit.
  std::vector<ResidualSeries> on_blocks(FittedModel model) const {
    model = with_held_out_blocks(std::move(model), context_);
    auto series = residual_series(model.job, model.fit);
    std::erase_if(series, [&](const ResidualSeries& s) {
      return model.job.recordings[s.recording].role != Role::fit;
    });
    return series;
  }

  /// Effects that the recordings to validate could not have shown are judged by blocks of the
  /// fitted ones, held out from both fits.
  void try_on_blocks(const std::vector<Tried*>& asked) {
    if (asked.empty()) return;
    report_progress("do held-out blocks show " + asked.front()->hypothesis.name + "?");
    std::vector<std::vector<ResidualSeries>> with(asked.size());
    parallel_for(asked.size() + 1, [&](std::size_t i) {
      if (i > 0)
        with[i - 1] = on_blocks({"", asked[i - 1]->job, asked[i - 1]->fit});
      else if (!memory_.on_blocks)
        memory_.on_blocks = on_blocks(model_);
    });
    for (std::size_t i = 0; i < asked.size(); ++i) {
      Tried& e = *asked[i];
      Improvement gain = improvement(*memory_.on_blocks, with[i]);
      gain.fit_gain = e.gain.fit_gain;
      gain.samples = e.gain.samples;
      if (rejection(e, gain, false)) continue;
      e.rejection.reset();
      e.gain = gain;
      e.on_blocks = true;
    }
  }

  const FittedModel& model_;
  const Strictness& strictness_;
  ElsewhereMemory& memory_;
  std::mutex mutex_;  // of its fits
  const SearchContext& context_;
};

}  // namespace

void ask_elsewhere(const FittedModel& model, std::vector<Tried>& refits,
                   const Strictness& strictness, ElsewhereMemory& memory,
                   const SearchContext& context) {
  Elsewhere(model, strictness, memory, context).ask(refits);
}

FittedModel with_held_out_blocks(FittedModel model, const SearchContext& context) {
  for (Recording& r : model.job.recordings) {
    const Partition blocks(r.times.size(), context.options.round.blocks);
    r.held_out.clear();
    // Counted from the end, so that a block begins with the first sample that is wholly in it.
    for (std::size_t k = 0; k < blocks.parts(); ++k)
      r.held_out.resize(r.times.size() - blocks.first(blocks.parts() - 1 - k), k % 2 == 1);
  }
  model.fit = refit_from(model.job, values_of(model.fit), context);
  return model;
}

}  // namespace axisfit
