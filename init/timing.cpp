#include "init/timing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

#include "base/rounding.h"
#include "base/units.h"
#include "fit/data/filter_check.h"
#include "fit/data/recording_check.h"
#include "fit/estimate/estimate.h"
#include "fit/estimate/recipes.h"
#include "init/busiest.h"
#include "init/free_choice.h"
#include "io/config/yaml_text.h"

namespace axisfit {
namespace {

/// Whether the values stay for most of the time, as those that somebody chose, or come in frames.
bool stays_in_steps(std::span<const double> values) {
  if (repetition_of(values) > 1) return true;
  constexpr double kMostly = 0.8;
  std::size_t equal = 0;
  for (std::size_t i = 1; i < values.size(); ++i) equal += values[i] == values[i - 1] ? 1 : 0;
  return static_cast<double>(equal) > kMostly * static_cast<double>(values.size());
}

/// s, between samples.
double interval_of(const JobDraft& draft) {
  return sampling(draft.recordings.front().guess.time.values).interval;
}

/// T_d, free from here on.
DraftParameter free_delay(const JobDraft& draft, double delay) {
  const Quantity& quantity = draft.quantity("T_d").quantity;
  const double most =
      std::min(quantity.upper,
               round_to_digits(std::max(20.0 * interval_of(draft), 2.0 * std::abs(delay)), 2));
  return {"T_d", fmt::format(
                     "{{initial: {}, bounds: [{}, {}]}}", with_unit(round_to_digits(delay, 2), "s"),
                     with_unit(std::max(quantity.lower, -most), "s"), with_unit(most, "s"))};
}

/// One way in which input and motion may go from sample to sample, and what a short fit makes of
/// it.
struct Timing {
  bool is_held = false;
  std::size_t averaged = 1;      ///< samples of which the velocity is the mean
  FirstLook::Term delay{};       ///< s, by which the motion then follows the input
  double chi_square = INFINITY;  ///< reduced; infinite without a fit

  /// With the wrong hold, a motion that is not late seems to be so by half a sample. Otherwise the
  /// smaller residual tells: thousands of samples make less than a hundredth by chance, but what
  /// the model lacks makes more.
  bool is_better_than(const Timing& other, double interval) const {
    constexpr double kNone = 0.2, kHalf = 0.4, kClearly = 0.5, kBetter = 0.99, kExplained = 100.0;
    const auto needs_none = [=](const Timing& one, const Timing& with_half) {
      return std::abs(one.delay.value) < kNone * interval &&
             std::abs(with_half.delay.value) > kHalf * interval;
    };
    const double factor = needs_none(*this, other) ? 1.0 / kClearly
                          : needs_none(other, *this) || other.chi_square > kExplained ? kClearly
                                                                                      : kBetter;
    return chi_square < factor * other.chi_square;
  }

  /// Whether there is a delay that hold and noise do not make.
  bool is_late(double interval) const {
    return std::abs(delay.value) >= std::max(0.5 * interval, FirstLook::kSure * delay.error);
  }
};

void set_hold(JobDraft& draft, bool is_held, const std::string& reason) {
  for (DraftRecording& recording : draft.recordings) {
    recording.is_held = is_held;
    recording.hold_reason = reason;
  }
}

void set_averaged(JobDraft& draft, std::size_t samples) {
  for (DraftRecording& recording : draft.recordings)
    recording.guess.find(Kind::velocity)->averaged = samples;
}

/// With the delay of the first look. What is held acts half a sample later than what goes straight.
Timing seen_timing(const JobDraft& draft, bool is_held, std::size_t averaged = 1) {
  Timing timing{is_held, averaged, draft.look->delay};
  timing.delay.value -=
      0.5 * interval_of(draft) * ((is_held ? 1.0 : 0.0) + static_cast<double>(averaged - 1));
  return timing;
}

/// By a fit to the recordings.
Timing fitted_timing(JobDraft draft, bool is_held, std::size_t averaged,
                     const RunContext& context) {
  Timing timing = seen_timing(draft, is_held, averaged);
  set_hold(draft, is_held, " on trial");
  if (averaged > 1) set_averaged(draft, averaged);
  draft.parameters.push_back(free_delay(draft, timing.delay.value));
  Job job = draft_job(draft);
  if (averaged > 1) {
    // The noise of a mean is judged otherwise, and chi-squares would not compare.
    set_averaged(draft, 1);
    const Job plain = draft_job(draft);
    for (std::size_t r = 0; r < job.recordings.size(); ++r)
      for (std::size_t m = 0; m < job.recordings[r].measurements.size(); ++m)
        job.recordings[r].measurements[m].sigma = plain.recordings[r].measurements[m].sigma;
  }
  for (Recording& recording : job.recordings) recording.role = Role::fit;  // all of them tell
  job.options = recipe::quick(job.options);
  job.options.threads = 1;
  const FitResult fit = estimate(job, context);
  if (!fit.verdict.has_minimum()) return timing;
  timing.chi_square = fit.reduced_chi_square;
  const ParameterResult& found = fit.parameters.back();
  timing.delay = {found.value, found.uncertainty.standard_error};
  return timing;
}

/// Whether a mean of samples can be told, and fitted: of a velocity at even times, without a
/// position that would show the motion as it is.
bool may_be_averaged(const JobDraft& draft) {
  return std::ranges::all_of(draft.recordings, [&](const DraftRecording& recording) {
    const GuessedColumn *position = recording.guess.find(Kind::position),
                        *velocity = recording.guess.find(Kind::velocity);
    const Sampling found = sampling(recording.guess.time.values);
    return velocity != nullptr && draft.is_measured(*velocity) &&
           (position == nullptr || !draft.is_measured(*position)) && found.is_even() &&
           found.gaps == 0;
  });
}

/// The same with the velocity as a mean over the last samples, which is late by half of them and
/// smooth; as many as leave the least. `late` as it is where that is no clear gain.
Timing best_average(const JobDraft& draft, const Timing& late, const RunContext& context) {
  constexpr double kClearly = 0.5;
  const auto of = [&](std::size_t samples) {
    return fitted_timing(draft, late.is_held, samples, context);
  };
  const double expected = 1.0 + 2.0 * late.delay.value / interval_of(draft);
  if (expected < 2.0) return late;
  Timing best = of(static_cast<std::size_t>(expected));
  const auto improve = [&](std::size_t samples) {
    const Timing next = of(samples);
    const bool is_better = next.chi_square < best.chi_square;
    if (is_better) best = next;
    return is_better;
  };
  for (std::size_t step = std::max<std::size_t>(1, best.averaged / 8); step > 0; step /= 2) {
    const std::size_t before = best.averaged;
    while (improve(best.averaged + step)) {
    }
    // What is shorter than an improvement was worse.
    if (best.averaged > before) continue;
    while (best.averaged > step + 1 && improve(best.averaged - step)) {
    }
  }
  return best.chi_square < kClearly * late.chi_square ? best : late;
}

/// By fits with both holds, and of a late velocity with means, unless they take more work than that
/// is worth; to the busiest samples, which are enough for a time. Throws Interrupted after a stop.
Timing best_timing(JobDraft draft, bool is_held, const RunContext& context) {
  keep_busiest(draft, kEnoughSamples);
  constexpr long kWork = 10'000'000;  // for the holds, and again for the means: seconds
  Timing best = seen_timing(draft, is_held);
  const auto within_work = [&](const std::function<void(const RunContext&)>& try_out) {
    const StopFlag spent(context.stop, kWork);
    RunContext within = context.quiet();
    within.stop = &spent;
    try {
      try_out(within);
    } catch (const Interrupted&) {
      if (is_set(context.stop)) throw;
    }
  };
  within_work([&](const RunContext& within) {
    const Timing usual = fitted_timing(draft, is_held, 1, within),
                 other = fitted_timing(draft, !is_held, 1, within);
    best = other.is_better_than(usual, interval_of(draft)) ? other : usual;
  });
  if (std::isfinite(best.chi_square) && best.is_late(interval_of(draft)) && may_be_averaged(draft))
    within_work([&](const RunContext& within) { best = best_average(draft, best, within); });
  return best;
}

}  // namespace

void set_timing(JobDraft& draft, const RunContext& context) {
  if (!draft.is_force_driven() || draft.joined) return;
  const bool is_stepped = std::ranges::any_of(draft.recordings, [](const DraftRecording& r) {
    return r.input_column().changes_only || stays_in_steps(r.input_column().values);
  });
  const bool is_held = draft.recordings.front().holds_input() || is_stepped;
  const auto take_hold = [&](bool held, const std::string& reason) {
    if (held != draft.recordings.front().holds_input()) set_hold(draft, held, reason);
  };
  take_hold(is_held, ": it stays in steps");
  if (!draft.look || draft.look->direction == FirstLook::Direction::open) return;
  Timing chosen = seen_timing(draft, is_held);
  try {
    if (!draft.request.is_on_trial) chosen = best_timing(draft, is_held, context);
  } catch (const Interrupted&) {
    draft.guesses.emplace_back(
        "whether the input holds from sample to sample was not looked at, since the run was "
        "stopped");
  }
  take_hold(chosen.is_held, ": the motion goes better with it");
  const double interval = interval_of(draft);
  if (chosen.averaged > 1) {
    set_averaged(draft, chosen.averaged);
    draft.parameters.push_back(free_delay(draft, chosen.delay.value));
    draft.guesses.push_back(
        fmt::format("{} is a mean over the last {:.3g} ms, as motor controllers make it: the "
                    "simulated one is a mean over {} samples, too, and T_d is free for what "
                    "remains of the lag",
                    draft.recordings.front().guess.find(Kind::velocity)->title(),
                    1e3 * interval * static_cast<double>(chosen.averaged), chosen.averaged));
    return;
  }
  // A fit may take a delay for friction that the model lacks: the balance of forces must see it,
  // too.
  if (!chosen.is_late(interval) || !seen_timing(draft, chosen.is_held).is_late(interval)) return;
  draft.parameters.push_back(free_delay(draft, chosen.delay.value));
  const double late = 1e3 * std::abs(chosen.delay.value);
  const std::string column = draft.recordings.front().input_column().title();
  draft.guesses.push_back(
      chosen.delay.value > 0.0
          ? fmt::format("T_d is free: the motion follows {} by {:.2g} ms, the lag of a drive or of "
                        "the motion's log",
                        column, late)
          : fmt::format("T_d is free: {} is logged {:.2g} ms late, probably by its filter", column,
                        late));
}

}  // namespace axisfit
