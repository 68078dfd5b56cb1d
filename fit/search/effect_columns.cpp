#include "fit/search/effect_columns.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "base/parallel.h"
#include "fit/criterion/gains.h"
#include "fit/search/trajectory_forces.h"
#include "fit/solve/parameters.h"
#include "fit/solve/solve.h"
#include "sim/sampling.h"

namespace axisfit {
namespace {

/// The readings of an instrument that is late are taken more densely.
bool is_late_instrument(std::size_t quantity) {
  const QuantityEntry& entry = quantity_list()[quantity];
  return entry.signal && (entry.quantity.symbol == "lag" || entry.quantity.symbol == "delay");
}

/// From derivatives with respect to u to those per unit, but of logarithmic parameters.
Eigen::MatrixXd per_unit(Eigen::MatrixXd columns, const ParameterSpace& space,
                         const Eigen::VectorXd& u) {
  for (std::size_t i = 0; i < space.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (space[i].scale != Scale::logarithmic) columns.col(k) /= space.slope(i, u[k]);
  }
  return columns;
}

Job with_setting(const Job& job, const EffectSetting& setting) {
  return with_hypothesis(job, *setting.hypothesis, {}, setting.own, !setting.with_shapes);
}

}  // namespace

EffectColumns::EffectColumns(const Job& job, double observer_gain, const RunContext& context)
    : job_(job), space_(job), observer_gain_(observer_gain), context_(context) {
  for (std::size_t r = 0; r < job.recordings.size(); ++r) {
    if (job.recordings[r].role != Role::fit) continue;
    recordings_.push_back(r);
    costs_.emplace_back(job, space_, r, observer_for(job.recordings[r], observer_gain),
                        context.stop);
    first_rows_.push_back(rows_);
    rows_ += costs_.back().num_residuals();
    interval_ = std::max(interval_, mean_interval(job.recordings[r].times));
  }
  trajectories_.resize(costs_.size());
  parallel_for(costs_.size(),
               [&](std::size_t i) { trajectories_[i] = costs_[i].trajectory(nullptr); });
}

std::vector<Eigen::MatrixXd> EffectColumns::derivatives(
    const std::vector<EffectSetting>& settings) const {
  std::vector<Eigen::MatrixXd> result(settings.size());
  std::vector<Column> batch, late, forces;
  std::vector<std::size_t> alone;
  for (std::size_t s = 0; s < settings.size(); ++s) {
    const EffectSetting& setting = settings[s];
    const Hypothesis& hypothesis = *setting.hypothesis;
    if (!hypothesis.shapes.empty() && !is_read_off(hypothesis, setting.own.shapes, interval_)) {
      alone.push_back(s);
      continue;
    }
    std::vector<std::size_t> quantities = hypothesis.strengths;
    if (setting.with_shapes)
      std::ranges::copy(hypothesis.estimated_shapes(), std::back_inserter(quantities));
    result[s].resize(rows_, static_cast<Eigen::Index>(quantities.size()));
    for (std::size_t k = 0; k < quantities.size(); ++k) {
      const std::size_t q = quantities[k];
      const bool is_force = !hypothesis.shapes.empty() || is_smooth_force(q);
      (is_force ? forces : is_late_instrument(q) ? late : batch).push_back({s, k, q});
    }
  }
  const std::size_t groups = 3;
  parallel_for(groups + alone.size(), [&](std::size_t i) {
    context_.check_stop();
    if (i == 0) add_forces(settings, forces, result);
    if (i == 1) add_batch(settings, batch, result);
    if (i == 2) add_batch(settings, late, result);
    if (i >= groups) result[alone[i - groups]] = exact(settings[alone[i - groups]]);
  });
  context_.check_stop();
  for (std::size_t s = 0; s < settings.size(); ++s)
    if (const auto only = settings[s].hypothesis->recording; only && result[s].size() > 0)
      for (std::size_t r = 0; r < costs_.size(); ++r)
        if (recordings_[r] != *only)
          result[s].middleRows(first_rows_[r], costs_[r].num_residuals()).setZero();
  return result;
}

Eigen::MatrixXd EffectColumns::exact(const EffectSetting& setting) const {
  const Job job = with_setting(job_, setting);
  const ParameterSpace space(job);
  const Eigen::VectorXd u = space.internal(initial_values(job));
  Linearization at = linearize(job, space, u, observer_gain_);
  return at.finite ? per_unit(std::move(at.jacobian), space, u) : Eigen::MatrixXd();
}

void EffectColumns::add_batch(const std::vector<EffectSetting>& settings,
                              const std::vector<Column>& columns,
                              std::vector<Eigen::MatrixXd>& result) const {
  if (columns.empty()) return;
  Job job = job_;
  std::map<std::size_t, Eigen::Index> place;  // of each quantity
  for (const Column& c : columns) {
    if (place.contains(c.quantity)) continue;
    place.emplace(c.quantity, static_cast<Eigen::Index>(job.free.size()));
    Hypothesis one = *settings[c.setting].hypothesis;
    one.strengths = {c.quantity};
    one.neutral = {one.neutral[c.index]};
    one.recording.reset();
    job = with_hypothesis(job, one, {}, {one.neutral, {}});
  }
  const ParameterSpace space(job);
  const Eigen::VectorXd u = space.internal(initial_values(job));
  Linearization at = linearize(job, space, u, observer_gain_);
  if (at.finite) at.jacobian = per_unit(std::move(at.jacobian), space, u);
  for (const Column& c : columns) {
    Eigen::MatrixXd& own = result[c.setting];
    if (at.finite)
      own.col(static_cast<Eigen::Index>(c.index)) = at.jacobian.col(place.at(c.quantity));
    else
      own.resize(0, 0);
  }
}

Disturbances EffectColumns::disturbances(std::size_t place,
                                         const std::vector<EffectSetting>& settings,
                                         const std::vector<Column>& columns) const {
  const std::vector<AxisInstant>& trajectory = trajectories_[place];
  Disturbances d;
  d.arm.resize(static_cast<Eigen::Index>(trajectory.size()),
               static_cast<Eigen::Index>(columns.size()));
  d.motor.resizeLike(d.arm);
  d.arm_mean.resizeLike(d.arm);
  const Model<double> plain = model_at(job_, space_, nullptr, recordings_[place]);
  const Observer observer = observer_for(job_.recordings[recordings_[place]], observer_gain_);
  // Columns of one setting, as many as go at a time.
  std::vector<std::size_t> firsts;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const bool goes_along = !firsts.empty() && c < firsts.back() + kMostQuantities &&
                            columns[firsts.back()].setting == columns[c].setting;
    if (!goes_along) firsts.push_back(c);
  }
  parallel_for(firsts.size(), [&](std::size_t f) {
    const std::size_t first = firsts[f];
    const std::size_t end = f + 1 < firsts.size() ? firsts[f + 1] : columns.size();
    const EffectSetting& setting = settings[columns[first].setting];
    const Job job = with_setting(job_, setting);
    std::vector<std::size_t> quantities;
    std::vector<double> scales;
    for (std::size_t c = first; c < end; ++c) {
      quantities.push_back(columns[c].quantity);
      const auto p = std::ranges::find(job.free, columns[c].quantity, &FreeParameter::quantity);
      scales.push_back(p->scale == Scale::logarithmic ? p->initial : 1.0);
    }
    const ParameterSpace space(job);
    const Model<double> model =
        model_at(job, space, space.internal(initial_values(job)).data(), recordings_[place]);
    const Disturbances own = disturbances_of(model, plain, quantities, observer, trajectory);
    for (std::size_t k = 0; k < quantities.size(); ++k) {
      const auto column = static_cast<Eigen::Index>(first + k), part = static_cast<Eigen::Index>(k);
      d.arm.col(column) = scales[k] * own.arm.col(part);
      d.arm_mean.col(column) = scales[k] * own.arm_mean.col(part);
      d.motor.col(column) = scales[k] * own.motor.col(part);
    }
  });
  return d;
}

void EffectColumns::add_forces(const std::vector<EffectSetting>& settings,
                               const std::vector<Column>& columns,
                               std::vector<Eigen::MatrixXd>& result) const {
  if (columns.empty()) return;
  parallel_for(costs_.size(), [&](std::size_t r) {
    Eigen::MatrixXd response;
    if (!trajectories_[r].empty())
      response = costs_[r].disturbance_response(nullptr, disturbances(r, settings, columns));
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const Column& c = columns[k];
      auto own = result[c.setting]
                     .col(static_cast<Eigen::Index>(c.index))
                     .segment(first_rows_[r], costs_[r].num_residuals());
      if (response.size() == 0)
        own.setConstant(NAN);
      else
        own = response.col(static_cast<Eigen::Index>(k));
    }
  });
  for (const Column& c : columns)
    if (!result[c.setting].allFinite()) result[c.setting].resize(0, 0);
}

}  // namespace axisfit
