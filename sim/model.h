// One axis with everything that can be fitted: its parameters, effects, instruments and initial
// state, in one list of named quantities.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include "sim/axis.h"
#include "sim/controller_settings.h"
#include "sim/effects/effects.h"
#include "sim/scalar.h"
#include "sim/signal.h"
#include "sim/vocabulary.h"

namespace axisfit {

/// The variant of the model: everything that is chosen, not measured.
struct Structure {
  Drive drive = Drive::velocity_loop;
  Transmission transmission = Transmission::backlash;
  EffectSet effects{};
  Joint joint = Joint::prismatic;
  bool closed_loop = false;  ///< the controller is part of what is simulated
  Channels channels = nullptr;
  Gearing gearing = Gearing::radius;
};

/// What an axis has by its drive and its transmission.
struct Capabilities {
  bool is_electric;       ///< set-velocity input, preamplifier, tachometer and motor current
  bool has_voltage_loop;  ///< armature circuit, with V_m and its limit
  bool is_force_driven;   ///< the command is the force K_f U, and may be recorded in newtons
  bool has_back_emf;      ///< the command is the voltage of a motor that R and K_m describe
  bool has_backlash;      ///< gear of finite stiffness: motor and arm move each for itself
  bool has_motor;         ///< a motor angle and a pinion, so that J_m, B_m and r_g count
  Command command;

  /// Whether a motor turns the current, which is known, into its torque.
  constexpr bool has_current() const { return is_electric || has_back_emf; }
  /// Whether the command drives the motor itself, without a controller between them.
  constexpr bool is_direct() const { return !is_electric; }
};

/// By drive and transmission.
inline constexpr std::array<std::array<Capabilities, 2>, kDrives> kCapabilities = [] {
  using enum Command;
  // electric, voltage loop, force driven, back EMF, backlash, motor, command
  const std::array<Capabilities, kDrives> with_backlash{{
      {true, true, false, false, true, true, voltage},          // velocity_loop
      {true, false, false, false, true, true, voltage},         // current_source
      {false, false, true, false, true, true, voltage},         // force_source
      {false, false, true, false, true, true, current},         // motor_current
      {false, false, true, false, true, true, share_of_rated},  // rated_force
      {false, false, false, true, true, true, voltage},         // motor_voltage
  }};
  std::array<std::array<Capabilities, 2>, kDrives> all{};
  for (std::size_t drive = 0; drive < kDrives; ++drive) {
    Capabilities rigid = with_backlash[drive];
    rigid.has_backlash = false;
    rigid.has_motor = !rigid.is_force_driven;
    all[drive] = {with_backlash[drive], rigid};
  }
  return all;
}();

constexpr const Capabilities& capabilities(const Structure& structure) {
  return kCapabilities[static_cast<std::size_t>(structure.drive)]
                      [static_cast<std::size_t>(structure.transmission)];
}

/// How its quantities are called.
constexpr Vocabulary vocabulary_of(const Structure& structure) {
  return {structure.joint, capabilities(structure).command, structure.channels, structure.gearing};
}

template <class T>
struct Model {
  Structure structure;
  Axis<T> axis{};
  Effects<T> effects{};
  Instruments<T> instruments{};
  Controller<T> controller{};
  std::array<T, kPaperStates>
      initial{};  ///< with x = r_g y2 - y0 and its rate in place of y2 and y3
};

/// Metres (radians) of the load per radian of the motor.
template <class T>
T motor_radius(const Model<T>& model) {
  const T& given = model.axis.r_g;
  if (model.structure.gearing == Gearing::radius) return given;
  return model.structure.joint == Joint::prismatic ? T(given / (2.0 * std::numbers::pi))
                                                   : T(1.0 / given);
}

/// The state at the start. The motor's place is given relative to the arm, so that an initial
/// position that is estimated moves both and does not tear the gear apart.
template <class T>
State<T> initial_state(const Model<T>& model) {
  State<T> y{};
  std::ranges::copy(model.initial, y.begin());
  const T radius = motor_radius(model);
  y[2] = (model.initial[0] + model.initial[2]) / radius;
  y[3] = (model.initial[1] + model.initial[3]) / radius;
  return y;
}

/// Calls visit(group, quantity, member) for every quantity of the model, always in the same order.
/// Groups: "" for the axis, the effect's name, the signal's name, "controller", "initial". All are
/// named as on a prismatic joint.
template <class ModelOfT, class Visitor>
void visit_quantities(ModelOfT& model, Visitor&& visit) {
  visit_axis(model.axis, [&](const Quantity& quantity, auto& member) {
    visit(std::string_view(), quantity, member);
  });
  visit_effects(model.effects, [&](std::size_t, auto& effect) {
    effect.visit(effect, [&](const Quantity& quantity, auto& member) {
      visit(effect.name, quantity, member);
    });
  });
  for (const SignalInfo& entry : kSignalTable) {
    auto& instrument = model.instruments[index_of(entry.signal)];
    visit(entry.name, Quantity{"gain", "1", "gain of the instrument", -1e6, 1e6, 1.0},
          instrument.gain);
    visit(entry.name, Quantity{"bias", entry.unit, "bias of the instrument", -1e9, 1e9, 0.0},
          instrument.bias);
    visit(entry.name, Quantity{"lag", "s", "time constant of the instrument", 0, 1, 0.0},
          instrument.lag);
    visit(entry.name, Quantity{"delay", "s", "delay of the instrument", -1, 1, 0.0},
          instrument.delay);
    visit(entry.name, Quantity{"drift", "1", "growth of the delay per time", -0.1, 0.1, 0.0},
          instrument.drift);
  }
  visit_gains(model.controller.gains, [&](const Quantity& quantity, auto& member) {
    visit(std::string_view("controller"), quantity, member);
  });
  using enum UsedBy;
  constexpr Quantity kInitial[kPaperStates] = {
      {"y0", "m", "initial arm position", -1e3, 1e3, 0.0},
      {"y1", "m/s", "initial arm velocity", -1e3, 1e3, 0.0},
      {"x", "m", "initial r_g y2 - y0, zero: pinion centred", -1, 1, 0.0, backlash},
      {"dx", "m/s", "initial r_g y3 - y1", -1e3, 1e3, 0.0, backlash},
      {"y4", "V", "initial preamplifier variable", -1e6, 1e6, 0.0, electric_drive},
      {"y5", "V/s", "initial preamplifier rate", -1e9, 1e9, 0.0, electric_drive},
      {"y6", "A", "initial motor current", -1e4, 1e4, 0.0, velocity_loop},
  };
  for (std::size_t i = 0; i < kPaperStates; ++i) visit("initial", kInitial[i], model.initial[i]);
}

/// What can be said of a quantity without its value; `index` is its place in the list.
struct QuantityEntry {
  std::string name;  ///< "B_a", "coulomb_friction.F_c", "velocity.bias", "initial.y1"
  std::string group;
  Quantity quantity;
  std::size_t index;
  std::optional<std::size_t> effect;  ///< that it belongs to, in the list of effects
  std::optional<Signal> signal;       ///< the instrument of which it is part
};

/// The list of all quantities, in the order of visit_quantities, with the names, units and ranges
/// that they have on the joint.
const std::vector<QuantityEntry>& quantity_list(Vocabulary vocabulary);
/// The same in kSourceVocabulary: for what does not depend on it, and for names that are not shown.
const std::vector<QuantityEntry>& quantity_list();

/// The entry with this name, or null.
const QuantityEntry* find_quantity(std::string_view name, Vocabulary vocabulary);

/// The place in the list of the quantity that the sources call so. Throws std::logic_error for a
/// name that they do not know.
std::size_t quantity_index(std::string_view name);

/// The model in another scalar type, without derivatives.
template <class To, class From>
Model<To> convert(const Model<From>& from) {
  std::vector<double> values;
  visit_quantities(from, [&](std::string_view, const Quantity&, const From& member) {
    values.push_back(value_of(member));
  });
  Model<To> to;
  to.structure = from.structure;
  to.controller.timing = from.controller.timing;
  std::size_t index = 0;
  visit_quantities(
      to, [&](std::string_view, const Quantity&, To& member) { member = To(values[index++]); });
  return to;
}

/// Pointers to all quantities of a model, in the order of quantity_list().
template <class T>
std::vector<T*> members(Model<T>& model) {
  std::vector<T*> pointers;
  visit_quantities(
      model, [&](std::string_view, const Quantity&, T& member) { pointers.push_back(&member); });
  return pointers;
}

/// Whether an axis of this structure has what such quantities belong to.
bool is_used(UsedBy used_by, const Structure& structure);

/// Whether a model of this structure makes use of the quantity.
bool is_used(const QuantityEntry& entry, const Structure& structure);

/// Whether an axis of this structure has the signal at all: a force source has no tachometer.
bool has_signal(Signal signal, const Structure& structure);

/// Sets the parameters of the axis and the initial values that its structure does not use to those
/// with which the equations leave them out: r_g to 1, all others to 0. Effects and instruments
/// stay.
void normalize(Model<double>& model);

/// Why a model of this structure cannot be simulated; empty when it can.
std::string model_error(const Model<double>& model);

}  // namespace axisfit
