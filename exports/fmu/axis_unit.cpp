#include "exports/fmu/axis_unit.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <type_traits>

namespace axisfit {
namespace {

template <class... Parts>
[[noreturn]] void fail(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  throw std::runtime_error(text.str());
}

[[noreturn]] void fail_without_variable(std::uint32_t reference) {
  fail("no variable has the value reference ", reference);
}

const ChannelList& channels_of(const Model<double>& model) {
  static const ChannelList kNone;
  return model.structure.channels != nullptr ? *model.structure.channels : kNone;
}

}  // namespace

/// The part of a snapshot whose size never changes.
struct AxisUnit::Fixed {
  double time;
  bool has_moved, has_axis;
  double command;
  std::array<double, kChannels> channels;
  std::size_t quantities, pending;
  Axis::Snapshot axis;
};

AxisUnit::AxisUnit(Model<double> model)
    : initial_(std::move(model)), model_(initial_), quantities_(members(model_)) {
  if (const std::string error = model_error(model_); !error.empty()) fail(error);
}

void AxisUnit::reset() {
  model_ = initial_;
  time_ = command_ = 0.0;
  has_moved_ = has_new_quantities_ = false;
  axis_.reset();
  channels_ = {};
  pending_.clear();
}

void AxisUnit::set_start(double time) {
  if (has_moved_) fail("the start cannot be set any more: the axis has moved");
  if (!std::isfinite(time)) fail("the start is not finite");
  time_ = time;
  axis_.reset();
}

void AxisUnit::set(std::uint32_t reference, double value) {
  if (!std::isfinite(value))
    fail("the value for the value reference ", reference, " is not finite");
  const ChannelList& channels = channels_of(model_);
  if (reference == kCommandVariable) {
    command_ = value;
  } else if (reference >= kChannelVariables && reference - kChannelVariables < channels.size()) {
    const std::size_t j = reference - kChannelVariables;
    channels_[j] = value - channels[j].zero;
  } else if (reference >= kQuantityVariables &&
             reference - kQuantityVariables < quantities_.size()) {
    const std::size_t i = reference - kQuantityVariables;
    const QuantityEntry& entry = quantity_list(vocabulary_of(model_.structure))[i];
    if (!is_used(entry, model_.structure) || entry.group == "controller")
      fail_without_variable(reference);
    const Quantity& quantity = entry.quantity;
    if (value < quantity.lower || value > quantity.upper)
      fail(entry.name, " must be from ", quantity.lower, " to ", quantity.upper, ' ', quantity.unit,
           ", not ", value);
    if (has_moved_ && entry.group == "initial")
      fail(entry.name, " cannot be set any more: the axis has moved");
    const double before = std::exchange(*quantities_[i], value);
    if (const std::string error = model_error(model_); !error.empty()) {
      *quantities_[i] = before;
      fail(error);
    }
    has_new_quantities_ = true;
  } else {
    fail_without_variable(reference);
  }
  if (!has_moved_) axis_.reset();
}

/// Makes the integrator anew, which goes on where it was.
void AxisUnit::renew_axis() {
  Axis::Snapshot before = axis_->snapshot();
  const Equations<double>& equations = axis_->equations();
  // What a lag that begins now has followed so far.
  if (!equations.parts().lagging)
    before.state[7] = equations.parts().has.is_electric
                          ? equations.power_stage_input(before.mode, before.state, before.input)
                          : equations.followed_command(before.state, before.input);
  axis_ = std::make_unique<Axis>(model_, Observer{}, IntegratorOptions{});
  if (std::exchange(has_new_quantities_, false))
    axis_->resume(before);
  else
    axis_->restore(before);
}

AxisUnit::Axis& AxisUnit::axis() {
  if (!axis_) {
    axis_ = std::make_unique<Axis>(model_, Observer{}, IntegratorOptions{});
    axis_->start(time_, 0.0, {});
    has_new_quantities_ = false;
    take_inputs();
  } else if (has_new_quantities_) {
    renew_axis();
  }
  return *axis_;
}

void AxisUnit::take_inputs() {
  const auto is_new = [&](std::size_t j) {
    return axis_->input().channels.value[j] != channels_[j];
  };
  bool any = false;
  for (std::size_t j = 0; j < kChannels; ++j) any |= is_new(j);
  if (any) axis_->set_channels({time_, channels_, {}});
  const double last = pending_.empty() ? axis_->input().command : pending_.back().second;
  if (command_ == last) return;
  if (const double delay = axis_->command_delay(); delay > 0.0)
    pending_.emplace_back(time_ + delay, command_);
  else
    axis_->set_command(command_);
}

void AxisUnit::step(double from, double length) {
  if (!(length >= 0.0) || !std::isfinite(length)) fail("a step of ", length, " s is not possible");
  if (!(std::abs(from - time_) <= 1e-6 * length + 1e-9 * (1.0 + std::abs(time_))))
    fail("a step from ", from, " s is not possible, since the axis is at ", time_, " s");
  axis();
  take_inputs();
  has_moved_ = true;
  const double end = from + length;
  // The budgets of the integrator are for one step from outside, not for all.
  const IntegratorOptions budgets;
  if (2 * axis_->steps() > budgets.step_budget || 2 * axis_->events() > budgets.event_budget)
    renew_axis();
  const auto advance = [&](double to) {
    if (!axis_->advance_to(to))
      fail("the axis cannot be moved from ", time_, " s to ", end,
           " s: it swings too fast to be followed, or events accumulate without end");
  };
  std::size_t acted = 0;
  for (; acted < pending_.size() && pending_[acted].first < end; ++acted) {
    advance(std::max(pending_[acted].first, axis_->time()));
    axis_->set_command(pending_[acted].second);
  }
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(acted));
  advance(end);
  time_ = end;
}

double AxisUnit::value(std::uint32_t reference) {
  const Structure& structure = model_.structure;
  const ChannelList& channels = channels_of(model_);
  if (reference == kTimeVariable) return time_;
  if (reference == kCommandVariable) return command_;
  if (reference >= kChannelVariables && reference - kChannelVariables < channels.size())
    return channels_[reference - kChannelVariables] + channels[reference - kChannelVariables].zero;
  if (reference >= kSignalVariables && reference - kSignalVariables < kSignals) {
    const Signal signal = static_cast<Signal>(reference - kSignalVariables);
    if (!has_signal(signal, structure)) fail_without_variable(reference);
    const Axis& now = axis();
    return reading(now.equations(), signal, now.mode(), now.state(), now.input());
  }
  if (reference >= kStateVariables && reference - kStateVariables < kStates)
    return axis().state()[reference - kStateVariables];
  if (reference >= kQuantityVariables && reference - kQuantityVariables < quantities_.size())
    return *quantities_[reference - kQuantityVariables];
  fail_without_variable(reference);
}

std::vector<char> AxisUnit::snapshot() {
  static_assert(std::is_trivially_copyable_v<Axis::Snapshot>);
  Fixed fixed{};
  fixed.time = time_;
  fixed.has_moved = has_moved_;
  fixed.has_axis = axis_ != nullptr;
  fixed.command = command_;
  fixed.channels = channels_;
  fixed.quantities = quantities_.size();
  fixed.pending = pending_.size();
  if (axis_) fixed.axis = axis().snapshot();
  std::vector<char> bytes(sizeof fixed +
                          sizeof(double) * (quantities_.size() + 2 * pending_.size()));
  char* at = bytes.data();
  const auto put = [&](const auto& value) {
    std::memcpy(at, &value, sizeof value);
    at += sizeof value;
  };
  put(fixed);
  for (const double* quantity : quantities_) put(*quantity);
  for (const auto& [when, command] : pending_) {
    put(when);
    put(command);
  }
  return bytes;
}

void AxisUnit::restore(std::span<const char> snapshot) {
  const auto get = [&](auto& value) {
    if (snapshot.size() < sizeof value) fail("this is no state of the axis");
    std::memcpy(&value, snapshot.data(), sizeof value);
    snapshot = snapshot.subspan(sizeof value);
  };
  Fixed fixed;
  get(fixed);
  if (fixed.quantities != quantities_.size() ||
      snapshot.size() != sizeof(double) * (fixed.quantities + 2 * fixed.pending))
    fail("this is no state of the axis");
  bool is_same_axis = axis_ != nullptr && !has_new_quantities_;
  for (double* quantity : quantities_) {
    double value = 0.0;
    get(value);
    is_same_axis &= value == *quantity;
    *quantity = value;
  }
  pending_.resize(fixed.pending);
  for (auto& [when, command] : pending_) {
    get(when);
    get(command);
  }
  time_ = fixed.time;
  has_moved_ = fixed.has_moved;
  command_ = fixed.command;
  channels_ = fixed.channels;
  if (!is_same_axis || !fixed.has_axis) axis_.reset();
  if (!fixed.has_axis) return;
  if (!axis_) axis_ = std::make_unique<Axis>(model_, Observer{}, IntegratorOptions{});
  has_new_quantities_ = false;
  axis_->restore(fixed.axis);
}

}  // namespace axisfit
