// Effects that recordings hold and their job does not declare: of every slot at least one.
#pragma once

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/fit/example.h"

namespace axisfit {

struct HiddenEffect {
  std::string acts_on;
  std::string name;                                       ///< as in the catalogue
  std::vector<std::pair<std::string, double>> strengths;  ///< full names of quantities
  std::vector<std::pair<std::string, double>> shapes = {};
  bool motor = false;     ///< whether the axis has a motor
  bool linear = true;     ///< whether one step of least squares comes close to the strength
  std::string twin = {};  ///< another effect that does exactly the same to this axis
  std::vector<const char*> free = {"M", "B_a"};  ///< of the declared model

  Model<double> declared() const { return motor ? motor_axis() : slide(); }
  Model<double> truth() const {
    Model<double> model = declared();
    put_into(model);
    return model;
  }
  void put_into(Model<double>& model) const {
    for (const auto& list : {strengths, shapes}) {
      for (const auto& [quantity, value] : list) {
        if (const auto effect = quantity_list()[quantity_index(quantity)].effect)
          model.structure.effects.set(*effect);
        *members(model)[quantity_index(quantity)] = value;
      }
    }
  }
  Job job() const { return two_recordings(truth(), declared(), free); }
  double neutral(std::size_t strength) const {
    const double default_value =
        quantity_list()[quantity_index(strengths[strength].first)].quantity.default_value;
    return std::isnan(default_value) ? 0.0 : default_value;
  }
  /// Letters and underscores only.
  std::string label() const {
    std::string text = acts_on + "_" + name;
    for (char& c : text)
      if (c == ' ' || c == '.') c = '_';
    return text;
  }
  friend void PrintTo(const HiddenEffect& secret, std::ostream* out) { *out << secret.name; }
};

inline std::vector<HiddenEffect> hidden_effects() {
  std::vector<HiddenEffect> list{
      {"friction", "coulomb_friction", {{"coulomb_friction.F_c", 5.0}}},
      {"arm force", "stroke_spring", {{"stroke_spring.k_s", 20.0}}},
      {"arm force",
       "periodic_force",
       {{"periodic_force.F_s1", 4.0}, {"periodic_force.F_c1", 3.0}},
       {{"periodic_force.period", 0.05}}},
      {"arm force", "constant_force", {{"constant_force.F_0", 3.0}}},
      {"arm force", "end_stops", {{"end_stops.k_h", 6e3}}, {{"end_stops.y_h", 0.33}}},
      {"inertia", "added_mass", {{"added_mass.dM", 0.5}}},
      {"inertia", "payload_change", {{"payload_change.dM", 0.5}}, {{"payload_change.t_c", 0.5}}},
      {"inertia",
       "elastic_mode",
       {{"elastic_mode.m_e", 0.3}},
       {{"elastic_mode.f_e", 23.0}, {"elastic_mode.zeta_e", 0.02}}},
      {"motor torque",
       "cogging_torque",
       {{"cogging_torque.T_s", 0.1}, {"cogging_torque.T_c", 0.1}},
       {{"cogging_torque.order", 2.0}}},
      {"motor torque",
       "torque_ripple",
       {{"torque_ripple.r_s", 0.03}, {"torque_ripple.r_c", -0.04}},
       {{"torque_ripple.order", 3.0}}},
      {"drive", "drive_lag", {{"drive_lag.T_l", 2e-3}}},
      {"drive", "dead_time", {{"T_d", 2e-3}}},
      {"sensor", "acceleration.lag", {{"acceleration.lag", 1e-3}}},
      {"sensor", "acceleration.bias", {{"acceleration.bias", 0.1}}},
      {"sensor", "velocity.gain", {{"velocity.gain", 1.02}}},
      {"sensor", "velocity.lag", {{"velocity.lag", 3e-3}}},
  };
  const auto secret = [&](std::string_view name) -> HiddenEffect& {
    return *std::ranges::find(list, name, &HiddenEffect::name);
  };
  // With M free as well it would be the same twice.
  secret("added_mass").free = {"B_a"};
  // Of a slide with one free parameter, twice the force does what half the mass does.
  secret("added_mass").twin = "K_f";
  secret("cogging_torque").motor = secret("torque_ripple").motor = true;
  secret("cogging_torque").twin = "periodic_force";
  secret("velocity.gain").twin = "acceleration.gain";
  // A ripple in which the current changes its sign has no one period along the stroke, and a
  // simulation that is held to a late velocity is late itself. How stiff a buffer is depends on
  // where it begins, of which three places are tried.
  secret("torque_ripple").linear = secret("velocity.lag").linear = false;
  secret("end_stops").linear = false;
  return list;
}

/// Those that have a twin, or those that have none.
inline std::vector<HiddenEffect> hidden_effects(bool with_twin) {
  std::vector<HiddenEffect> list = hidden_effects();
  std::erase_if(list, [&](const HiddenEffect& s) { return s.twin.empty() == with_twin; });
  return list;
}

}  // namespace axisfit
