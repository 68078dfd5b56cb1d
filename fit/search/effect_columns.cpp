#include "fit/search/effect_columns.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "base/parallel.h"
#include "fit/criterion/gains.h"
#include "fit/solve/jet.h"
#include "fit/solve/parameters.h"
#include "fit/solve/solve.h"

namespace axisfit {
namespace {

/// The effect that a quantity belongs to, if it does.
std::optional<std::size_t> effect_of(std::size_t quantity) {
  return quantity_list()[quantity].effect;
}

/// Whether a quantity acts by the affine slots of its effect, or has none.
bool is_affine(std::size_t quantity) {
  const auto effect = effect_of(quantity);
  if (!effect) return true;
  EffectSet alone;
  alone.set(*effect);
  Model<double> with{};
  const Slots<double> without = slots::affine(with.effects, alone);
  *members(with)[quantity] = 1.0;
  return !slots::needs(alone).is_smooth() || !(slots::affine(with.effects, alone) == without);
}

/// Whether a hypothesis's forces can be read off a trajectory without it.
bool is_smooth_force(const Hypothesis& hypothesis) {
  return hypothesis.probes.empty() && std::ranges::none_of(hypothesis.strengths, is_affine);
}

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

/// Derivatives of the smooth accelerations along a trajectory, with respect to up to two quantities
/// of a model.
class SmoothForce {
 public:
  using T = ceres::Jet<double, 2>;

  /// `sticks`: whether the trajectory is that of an arm with dry friction; else its mode knows no
  /// direction.
  SmoothForce(const Model<double>& model, std::span<const std::size_t> quantities, bool sticks)
      : model_(seeded(model, quantities)), equations_(model_), sticks_(sticks) {}

  /// Calls write(instant, rates) with the derivatives of y1' and y3'.
  template <class Write>
  void along(const std::vector<AxisInstant>& trajectory, Write&& write) const {
    RestMemory<T> memory{T(trajectory.front().state[0]), {}};
    Mode before;
    before.sliding = 0;
    for (std::size_t i = 0; i < trajectory.size(); ++i) {
      const AxisInstant& at = trajectory[i];
      Mode mode = at.mode;
      if (!sticks_ || mode.sliding != 0) mode.sliding = direction(at.state[1]);
      if (mode.sliding != before.sliding && before.sliding != 0 && needs_memory())
        memory = memory_after(before, trajectory[i - 1], memory);
      before = mode;
      write(i, equations_.smooth_rate(mode, state(at), input(at, memory)));
    }
  }

 private:
  static Model<T> seeded(const Model<double>& model, std::span<const std::size_t> quantities) {
    Model<T> with = convert<T>(model);
    const std::vector<T*> member = members(with);
    for (std::size_t k = 0; k < quantities.size(); ++k)
      member[quantities[k]]->v[static_cast<Eigen::Index>(k)] = 1.0;
    return with;
  }
  static std::int8_t direction(double velocity) {
    return static_cast<std::int8_t>(velocity > 0.0 ? 1 : velocity < 0.0 ? -1 : 0);
  }
  static State<T> state(const AxisInstant& at) {
    State<T> y;
    for (std::size_t i = 0; i < kStates; ++i) y[i] = T(at.state[i]);
    return y;
  }
  static Input<T> input(const AxisInstant& at, const RestMemory<T>& memory) {
    Input<T> input;
    input.command = T(at.input.command);
    input.time = T(at.input.time);
    input.memory = memory;
    input.channels = at.input.channels;
    return input;
  }
  bool needs_memory() const { return equations_.parts().needs.hysteresis; }
  /// The memory at the place where the motion turned: between two instants, nearly at the first.
  RestMemory<T> memory_after(const Mode& mode, const AxisInstant& at,
                             const RestMemory<T>& memory) const {
    State<T> y = state(at);
    Input<T> there = input(at, memory);
    equations_.cross(mode, Guard::stop, y, there);
    return there.memory;
  }

  const Model<T> model_;
  const Equations<T> equations_;
  const bool sticks_;
};

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
    if (!hypothesis.shapes.empty() && !is_smooth_force(hypothesis)) {
      alone.push_back(s);
      continue;
    }
    std::vector<std::size_t> quantities = hypothesis.strengths;
    if (setting.with_shapes)
      std::ranges::copy(hypothesis.estimated_shapes(), std::back_inserter(quantities));
    result[s].resize(rows_, static_cast<Eigen::Index>(quantities.size()));
    for (std::size_t k = 0; k < quantities.size(); ++k) {
      const std::size_t q = quantities[k];
      const bool is_force = !hypothesis.shapes.empty() || !is_affine(q);
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
  const Model<double> plain = model_at(job_, space_, nullptr, recordings_[place]);
  const bool sticks = Equations<double>(plain).parts().directions;
  // Two columns of one setting at a time.
  std::vector<std::size_t> firsts;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const bool second = !firsts.empty() && firsts.back() + 1 == c &&
                        columns[firsts.back()].setting == columns[c].setting;
    if (!second) firsts.push_back(c);
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
    SmoothForce(model, quantities, sticks)
        .along(trajectory, [&](std::size_t i, const State<SmoothForce::T>& rates) {
          for (std::size_t k = 0; k < quantities.size(); ++k) {
            const auto row = static_cast<Eigen::Index>(i);
            const auto column = static_cast<Eigen::Index>(first + k);
            const auto part = static_cast<Eigen::Index>(k);
            d.arm(row, column) = scales[k] * rates[1].v[part];
            d.motor(row, column) = scales[k] * rates[3].v[part];
          }
        });
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
