// Axes for exports that are simulated elsewhere.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <utility>

#include "exports/export.h"
#include "sim/rig.h"
#include "tests/sim/axes.h"

namespace axisfit {

inline Rig of_model(Model<double> model) {
  Rig rig;
  rig.name = "an axis";
  rig.model = std::move(model);
  normalize(rig.model);
  return rig;
}

/// Axes with all that events come from.
inline std::map<std::string, Rig> axes() {
  std::map<std::string, Rig> all;
  Model<double> paper = paper_axis();
  paper.axis.F_s = 20.0;
  all.emplace("paper", of_model(paper));
  add_effect<ElasticMode>(paper) = {12.0, 25.0, 0.03};
  add_effect<DriveLag>(paper).T_l = 2e-3;
  add_effect<CoulombFriction>(paper).F_c = 15.0;
  paper.axis.T_d = 3.3e-3;
  all.emplace("late and elastic", of_model(paper));
  Model<double> mass = driven_mass(20.0);
  mass.axis.K_f = 10.0;
  mass.axis.B_a = 30.0;
  add_effect<CoulombFriction>(mass).F_c = 4.0;
  mass.axis.T_d = 12.3e-3;
  all.emplace("mass", of_model(mass));
  mass.structure.joint = Joint::revolute;
  add_effect<LoadFriction>(mass).mu = 0.05;
  all.emplace("joint", of_model(mass));
  Model<double> smooth = driven_mass(20.0);
  smooth.axis.K_f = 10.0;
  add_effect<CoulombFriction>(smooth).F_c = 4.0;
  add_effect<StribeckFriction>(smooth) = {3.0, 0.05, 1.0};
  add_effect<QuadraticDrag>(smooth).c = 5.0;
  add_effect<PeriodicForce>(smooth) = {2.0, -1.0, 0.4, 0.3, 0.2, -0.15, 0.036};
  add_effect<SecondPeriodicForce>(smooth) = {0.7, 0.5, -0.2, 0.1, 0.0, 0.3, 0.0047};
  add_effect<DahlFriction>(smooth) = {2.0, 2e-4, 0.0};
  add_effect<EndStops>(smooth) = {2e4, 0.05, 3e4, -0.05, 0.5};
  add_effect<PayloadChange>(smooth) = {5.0, -2.0, 0.3};
  all.emplace("smooth", of_model(smooth));
  Model<double> voltage = paper_axis();
  voltage.structure.drive = Drive::motor_voltage;
  voltage.axis.F_s = 30.0;
  all.emplace("voltage", of_model(voltage));
  return all;
}

/// A slide that a current moves, 20 kg and 2 kg of its motor.
inline Rig slide() {
  Rig rig;
  rig.name = "slide";
  rig.model = driven_mass(20.0);
  rig.model.axis.K_f = 40.0;
  rig.model.axis.B_a = 30.0;
  return rig;
}

/// It with dry friction.
inline Rig rubbing_slide() {
  Rig rig = slide();
  add_effect<CoulombFriction>(rig.model).F_c = 4.0;
  return rig;
}

/// Of an export that is one file.
inline std::string only_file(const Export& made) {
  EXPECT_EQ(made.files.size(), 1u);
  return made.files.front().second;
}

}  // namespace axisfit
