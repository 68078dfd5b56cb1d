#include "fit/search/model_chain.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "fit/estimate/recipes.h"
#include "fit/search/transmission.h"
#include "fit/solve/parameters.h"

namespace axisfit {

std::vector<double> FittedModel::values() const {
  std::vector<double> values = values_of(fit);
  values.push_back(fit.observer_gain);
  return values;
}

Improvement improvement(const FittedModel& before, const FittedModel& after) {
  return improvement(residual_series(before.job, before.fit),
                     residual_series(after.job, after.fit));
}

double loss_of(const FittedModel& a, const FittedModel& b) {
  return bic_difference(residual_series(a.job, a.fit), a.job.free.size(),
                        residual_series(b.job, b.fit), b.job.free.size());
}

bool explains(const FittedModel& model) {
  auto series = residual_series(model.job, model.fit);
  const auto is_noise = [](const ResidualSeries& s) { return is_explained(s); };
  if (std::ranges::all_of(series, is_noise)) return !series.empty();
  if (!is_fitted_to_noise(series)) return false;  // nothing is allowed these
  allow_for_parameters(model.job, model.fit, series);
  return !series.empty() && std::ranges::all_of(series, is_noise);
}

namespace {

/// Whether no estimate has moved by more than its standard errors allow.
bool is_within_errors(const FitResult& moved, const FitResult& from) {
  constexpr double kErrors = 4.0;
  for (std::size_t i = 0; i < from.parameters.size(); ++i) {
    const ParameterUncertainty& known = from.parameters[i].uncertainty;
    if (known.determined && std::abs(moved.parameters[i].value - from.parameters[i].value) >
                                kErrors * known.standard_error)
      return false;
  }
  return true;
}

/// Whether a fit to the recordings to validate, too, from where that of the others ended, leaves
/// nothing but noise, with estimates that those do not rule out.
bool is_explained_by_one_fit(const FittedModel& model, const SearchContext& context) {
  if (!model.fit.is_usable()) return false;
  const auto series = residual_series(model.job, model.fit);
  if (!is_fitted_to_noise(series) || std::ranges::all_of(series, &ResidualSeries::fitted))
    return false;
  FittedModel all = model;
  for (Recording& r : all.job.recordings) {
    r.role = Role::fit;
    r.held_out.clear();
  }
  all.job.options = recipe::polish(all.job.options);
  all.fit = refit_from(all.job, values_of(model.fit), context);
  return all.fit.is_usable() && is_within_errors(all.fit, model.fit) && explains(all);
}

}  // namespace

FittedModel settled(FittedModel model, const SearchContext& context) {
  if (!leaves_little(model, context.options) || explains(model)) return model;
  FitResult exact = polished_fit(model.job, values_of(model.fit), context);
  if (exact.is_usable() && reduced_cost(exact) < reduced_cost(model.fit))
    model.fit = std::move(exact);
  return model;
}

bool is_close(const FittedModel& model, const SearchOptions& options) {
  return model.fit.reduced_chi_square < options.round.close_chi_square;
}

bool is_near(const FittedModel& model, const SearchOptions& options) {
  return model.fit.is_usable() && model.fit.reduced_chi_square < options.near_data;
}

bool leaves_little(const FittedModel& model, const SearchOptions& options) {
  return model.fit.is_usable() && model.fit.reduced_chi_square < options.near_noise;
}

bool has_contacts(const FittedModel& model) {
  return capabilities(model.job.model.structure).has_backlash;
}

bool is_lost(const FittedModel& model, const SearchOptions& options) {
  return has_contacts(model) && model.job.options.is_continued() && !is_close(model, options);
}

bool is_near_noise(const std::vector<ResidualSeries>& residuals, const SearchOptions& options) {
  return std::ranges::all_of(residuals, [&](const ResidualSeries& s) {
    return mean_square(s.values) < options.round.exact_mean_square;
  });
}

void ModelChain::append(Accepted effect, Job job, FitResult fit) {
  models_.push_back({effect.hypothesis.name, std::move(job), std::move(fit)});
  accepted_.push_back(std::move(effect));
  neighbours_ = {};  // of the model before, not to be copied with every state put aside
}

void ModelChain::restart(FittedModel declared) {
  models_ = {std::move(declared)};
  accepted_.clear();
}

void ModelChain::replace(FittedModel declared, FittedModel last) {
  models_.front() = std::move(declared);
  set_last(std::move(last));
}

ModelChain::Neighbours& ModelChain::neighbours() {
  std::vector<double> values = current().values();
  if (values != neighbours_.of || neighbours_.reduced.size() != accepted_.size())
    // In parentheses: in braces a size would be the first element of a list of bools.
    neighbours_ = {.of = std::move(values),
                   .reduced = std::vector<std::optional<FittedModel>>(accepted_.size()),
                   .is_far = std::vector<std::optional<bool>>(accepted_.size())};
  return neighbours_;
}

bool ModelChain::explained() {
  std::optional<bool>& known = neighbours().explained;
  if (!known)
    known = explains(current()) ||
            (has_contacts(current()) &&
             (is_explained_freely() || is_explained_by_one_fit(current(), *context_)));
  return *known;
}

bool ModelChain::is_explained_freely() {
  const FittedModel& tracked = current();
  return free_ && tracks(tracked.job.options.criterion) && !accepted_.empty() &&
         leaves_little(tracked, context_->options) && free_run().fit.is_usable() &&
         (explains(free_run()) || is_explained_by_one_fit(free_run(), *context_));
}

const FittedModel& ModelChain::free_run() {
  std::optional<FittedModel>& known = neighbours().free_run;
  if (!known) known = settled(with_accepted(*free_), *context_);
  return *known;
}

const FittedModel& ModelChain::without(std::size_t place) {
  std::optional<FittedModel>& reduced = neighbours().reduced[place];
  if (!reduced) reduced = reduce(place);
  return *reduced;
}

bool ModelChain::is_far_without(std::size_t place) {
  std::optional<bool>& known = neighbours().is_far[place];
  if (known || accepted_.size() == 1) return known.value_or(false);
  const FittedModel& whole = current();
  Job job = job_with_accepted(declared().job, place);
  job.options = recipe::polish(job.options);
  job.options.give_up_above =
      worthless_cost(whole.fit, residual_series(whole.job, whole.fit),
                     accepted_[place].hypothesis.parameters(), context_->options);
  const FitResult fit = refit(job, *context_);
  known = fit.verdict.kind != FitVerdict::Kind::not_simulated &&
          reduced_cost(fit) > job.options.give_up_above;
  return *known;
}

void ModelChain::fit_without(const std::vector<std::size_t>& places) {
  auto& all = neighbours().reduced;
  parallel_for(places.size(), [&](std::size_t i) {
    if (!all[places[i]]) all[places[i]] = reduce(places[i]);
  });
}

FittedModel ModelChain::before(std::size_t place) const {
  if (place == 0) return declared();
  if (models_.size() == accepted_.size() + 1) return models_[place];
  return refitted_up_to(place);
}

FittedModel ModelChain::refitted_up_to(std::size_t place) const {
  Job job = job_with(declared().job, [&](std::size_t a) { return a < place; });
  FitResult fit = refit(job, *context_);
  return {accepted_[place - 1].hypothesis.name, std::move(job), std::move(fit)};
}

FittedModel ModelChain::reduce(std::size_t place) const {
  if (accepted_.size() == 1) return declared();
  FittedModel reduced = with_accepted(declared().job, place);
  // From where the present model is, all at once may be too far, or a derivative not exist.
  if (!reduced.fit.is_usable() && declared().fit.is_usable()) {
    set_initial_values(reduced.job, values_of(declared().fit));
    reduced.fit = refit(reduced.job, *context_);
  }
  return reduced;
}

template <class Kept>
Job ModelChain::job_with(const Job& declared, Kept&& kept) const {
  Job job = declared;
  std::vector<double> values;
  const Model<double> fitted = fitted_model(current().job, current().fit);
  const double motor = mass_of_motor(job.model.structure, fitted);
  for (std::size_t i = 0; i < job.free.size(); ++i) {
    const bool is_mass = quantity_list()[job.free[i].quantity].name == "M";
    values.push_back(current().fit.parameters[i].value + (is_mass ? motor : 0.0));
  }
  for (std::size_t a = 0; a < accepted_.size(); ++a) {
    const Hypothesis& hypothesis = accepted_[a].hypothesis;
    if (!kept(a)) continue;
    job = with_hypothesis(
        job, hypothesis, values,
        held_at_settings(hypothesis, values_in(current().job, current().fit, hypothesis)));
    values = initial_values(job);
  }
  set_initial_values(job, values);
  return job;
}

Job ModelChain::job_with_accepted(const Job& declared, std::optional<std::size_t> except) const {
  return job_with(declared, [&](std::size_t a) {
    return !except ||
           (a != *except && !is_part_of(accepted_[a].hypothesis, accepted_[*except].hypothesis));
  });
}

FittedModel ModelChain::with_accepted(const Job& declared,
                                      std::optional<std::size_t> except) const {
  Job job = job_with_accepted(declared, except);
  FitResult fit = refit(job, *context_);
  return {"", std::move(job), std::move(fit)};
}

std::vector<Hypothesis> ModelChain::erase(std::size_t place) {
  const Hypothesis whole = accepted_[place].hypothesis;
  std::vector<Hypothesis> parts;
  std::erase_if(accepted_, [&](const Accepted& a) {
    if (!is_part_of(a.hypothesis, whole)) return is_same(a.hypothesis, whole);
    parts.push_back(a.hypothesis);
    return true;
  });
  return parts;
}

void ModelChain::set_last(FittedModel last) {
  models_.resize(1);
  if (accepted_.empty()) return;
  last.added = accepted_.back().hypothesis.name;
  models_.push_back(std::move(last));
}

std::vector<FittedModel> ModelChain::models() const {
  if (models_.size() == accepted_.size() + 1) return models_;
  std::vector<FittedModel> all(accepted_.size() + 1);
  all.front() = declared();
  all.back() = current();
  parallel_for(accepted_.size() - 1, [&](std::size_t i) { all[i + 1] = refitted_up_to(i + 1); });
  return all;
}

const std::optional<FitResult>& ModelChain::elsewhere() {
  Neighbours& known = neighbours();
  if (!known.has_elsewhere) {
    known.elsewhere = fit_elsewhere(current().job, current().fit, *context_);
    known.has_elsewhere = true;
  }
  return known.elsewhere;
}

}  // namespace axisfit
