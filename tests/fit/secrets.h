// Effects that a recording holds and its job does not declare: one of every slot.
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/fit/example.h"

namespace axisfit {

struct Secret {
  std::string slot;
  std::string name;                                        ///< as in the catalogue
  std::vector<std::pair<std::string, double>> strengths;   ///< full names of quantities
  std::vector<std::pair<std::string, double>> shapes = {};
  std::vector<const char*> free = {"M", "B_a"};            ///< of the declared model
  bool motor = false;                                      ///< whether the axis needs to have one

  Model<double> declared() const { return motor ? motor_axis() : slide(); }
  Model<double> truth() const {
    Model<double> model = declared();
    for (const auto& list : {strengths, shapes}) {
      for (const auto& [quantity, value] : list) {
        visit_effects(model.effects, [&](std::size_t index, const auto& effect) {
          if (find_quantity(quantity)->group == effect.name) model.structure.effects.set(index);
        });
        *members(model)[find_quantity(quantity)->index] = value;
      }
    }
    return model;
  }
  Job job() const { return two_recordings(truth(), declared(), free); }
  double neutral(std::size_t strength) const {
    const double standard = find_quantity(strengths[strength].first)->quantity.standard;
    return std::isnan(standard) ? 0.0 : standard;
  }
  std::string label() const {
    std::string text = slot + "_" + name;
    for (char& c : text)
      if (c == ' ' || c == '.') c = '_';
    return text;
  }
};

inline std::vector<Secret> secrets() {
  return {
      {"friction", "coulomb_friction", {{"coulomb_friction.F_c", 5.0}}},
      {"arm force", "stroke_spring", {{"stroke_spring.k_s", 20.0}}},
      {"arm force",
       "periodic_force",
       {{"periodic_force.F_s1", 4.0}, {"periodic_force.F_c1", 3.0}},
       {{"periodic_force.period", 0.05}}},
      {"inertia", "added_mass", {{"added_mass.dM", 0.5}}, {}, {"B_a"}},
      {"inertia",
       "elastic_mode",
       {{"elastic_mode.m_e", 0.3}},
       {{"elastic_mode.f_e", 23.0}, {"elastic_mode.zeta_e", 0.02}}},
      {"motor torque",
       "cogging_torque",
       {{"cogging_torque.T_s", 0.1}, {"cogging_torque.T_c", 0.1}},
       {{"cogging_torque.order", 2.0}},
       {"M", "B_a"},
       true},
      {"motor torque", "torque_droop", {{"torque_droop.c_i", 0.01}}, {}, {"M", "B_a"}, true},
      {"motor torque",
       "torque_ripple",
       {{"torque_ripple.r_s", 0.03}, {"torque_ripple.r_c", -0.04}},
       {{"torque_ripple.order", 3.0}},
       {"M", "B_a"},
       true},
      {"drive", "drive_lag", {{"drive_lag.T_l", 2e-3}}},
      {"drive", "dead_time", {{"T_d", 2e-3}}},
      {"sensor", "acceleration.lag", {{"acceleration.lag", 1e-3}}},
      {"sensor", "velocity.gain", {{"velocity.gain", 1.02}}},
      {"sensor", "acceleration.bias", {{"acceleration.bias", 0.1}}},
      {"sensor", "velocity.lag", {{"velocity.lag", 3e-3}}},
  };
}

}  // namespace axisfit
