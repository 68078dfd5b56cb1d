// The declared model and the effects accepted one after another.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "fit/search/tried.h"

namespace axisfit {

/// One intermediate model: the declared one, and one after each accepted effect.
struct FittedModel {
  std::string added;  ///< the effect; empty for the declared model
  Job job;
  FitResult fit;

  /// The estimates, and last the observer gain: two models of a search that agree in them are the
  /// same.
  std::vector<double> values() const;
};

/// By how much the second lowers the errors of the first, see acceptance.h.
Improvement improvement(const FittedModel& before, const FittedModel& after);

/// By how much the second explains the recordings worse, parameters counted.
double loss_of(const FittedModel& a, const FittedModel& b);

/// Whether the model leaves nothing but noise in any signal.
bool explains(const FittedModel& model);

/// Where a quick fit leaves little more than noise, a part of that may be its own: the model with
/// an exact fit there, which tells what is missing.
FittedModel settled(FittedModel model, const SearchContext& context);

/// Whether the free run stays near the data.
bool is_close(const FittedModel& model, const SearchOptions& options);

/// Whether it is so near the data that the free run tells by itself what is missing.
bool is_near(const FittedModel& model, const SearchOptions& options);

/// Whether it leaves so little, of all signals together, that next to nothing may be missing.
bool leaves_little(const FittedModel& model, const SearchOptions& options);

/// Whether teeth meet: when they do depends on more digits than a quick fit has.
bool has_contacts(const FittedModel& model);

/// Whether the free run is lost: far from the data, and with teeth whose contacts come at other
/// instants, so that a refit takes a whole continuation and often ends in a wrong valley.
bool is_lost(const FittedModel& model, const SearchOptions& options);

/// Whether every signal, of recordings that validate, too, leaves so little that a score is exact.
bool is_near_noise(const std::vector<ResidualSeries>& residuals, const SearchOptions& options);

/// A hypothesis that became part of the model.
struct Accepted {
  Hypothesis hypothesis;
  /// Others that explained as much when it was chosen, and where their refits start: without
  /// strengths, one that has not been fitted; without others, from where all else is.
  std::vector<Scored> rivals{};
  bool is_seen_elsewhere = false;  ///< it replicates, or held-out blocks show it
};

/// A value that may be copied, put aside and taken up again. What was found beside the last model
/// (fits without one of its effects, or to other recordings) is kept until that changes. Not to be
/// used by several threads at once; its fits share the thread pool.
class ModelChain {
 public:
  /// The context must outlive it.
  ModelChain(FittedModel declared, const SearchContext& context)
      : context_(&context), models_{std::move(declared)} {}

  const FittedModel& declared() const { return models_.front(); }
  const FittedModel& current() const { return models_.back(); }
  const std::vector<Accepted>& accepted() const { return accepted_; }
  std::vector<Accepted>& accepted() { return accepted_; }

  void append(Accepted effect, Job job, FitResult fit);
  /// Puts another fit of the last model in the place of the present one.
  void set_fit(FitResult fit) { models_.back().fit = std::move(fit); }
  /// Begins anew with a declared model.
  void restart(FittedModel declared);
  /// Puts another declared model in the place of the present one, and the last model with the
  /// accepted effects that follow from it.
  void replace(FittedModel declared, FittedModel last);

  /// The last model without one accepted effect, and what is part of it, refitted.
  const FittedModel& without(std::size_t place);
  /// The model to which that effect was added, refitted where it is not known any more.
  FittedModel before(std::size_t place) const;
  /// Whether a fit without one accepted effect, from where the last model is, does not come near
  /// that; it is given up as soon as this is plain.
  bool is_far_without(std::size_t place);
  /// Fits without each of these, side by side.
  void fit_without(const std::vector<std::size_t>& places);

  /// A declared job with the accepted effects, but for one, that starts from where they are.
  Job job_with_accepted(const Job& declared, std::optional<std::size_t> except = {}) const;
  /// That, refitted.
  FittedModel with_accepted(const Job& declared, std::optional<std::size_t> except = {}) const;

  /// Strikes an accepted effect off the list, and what is part of it; returns the latter. The
  /// models are as before, until set_last().
  std::vector<Hypothesis> erase(std::size_t place);
  /// Replaces the last model by one with all accepted effects, after some were removed or
  /// exchanged.
  void set_last(FittedModel last);

  /// The declared model, and with one accepted effect more each, the last. Refits those between
  /// where effects were removed or exchanged.
  std::vector<FittedModel> models() const;

  /// Whether the last model leaves nothing but noise, see explains(), or would with other
  /// estimates within the errors: a fit to all recordings does. Then nothing is missing, though the
  /// recordings that are fitted leave open what those to validate show. Of a model that tracks the
  /// free run is asked, too, where there is one: noise of the readings drives a simulation that
  /// tracks.
  bool explained();

  /// Says by which declared job the accepted effects run freely while the models of the chain
  /// track; none: by none.
  void set_free(std::optional<Job> declared) { free_ = std::move(declared); }
  /// The effects in that job, refitted from where they are.
  const FittedModel& free_run();

  /// The last model fitted to the recordings to validate alone, see fit_elsewhere().
  const std::optional<FitResult>& elsewhere();
  /// Whether it was already.
  bool has_elsewhere() { return neighbours().has_elsewhere; }

 private:
  /// What was found beside the present model.
  struct Neighbours {
    std::vector<double> of;           ///< values and gain of that model
    std::optional<bool> explained{};  ///< takes simulations
    std::optional<FittedModel> free_run{};
    std::vector<std::optional<FittedModel>> reduced;  ///< without each of the accepted effects
    std::vector<std::optional<bool>> is_far;          ///< what is left without each
    bool has_elsewhere = false;
    std::optional<FitResult> elsewhere{};
  };
  Neighbours& neighbours();
  bool is_explained_freely();
  FittedModel refitted_up_to(std::size_t place) const;  ///< with the first so many effects
  FittedModel reduce(std::size_t place) const;
  /// A declared job with those accepted effects that are `kept`.
  template <class Kept>
  Job job_with(const Job& declared, Kept&& kept) const;

  const SearchContext* context_;
  std::vector<FittedModel> models_;  ///< the declared one, the last, and some between
  std::vector<Accepted> accepted_;
  std::optional<Job> free_{};
  Neighbours neighbours_;
};

}  // namespace axisfit
