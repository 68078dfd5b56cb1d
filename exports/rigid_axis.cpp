#include "exports/rigid_axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "exports/targets.h"
#include "sim/model.h"

namespace axisfit {

Reduced reduced_to(const Rig& rig, const std::vector<std::string_view>& effects,
                   std::string_view target) {
  Reduced reduced;
  reduced.rig = rig;
  Model<double>& model = reduced.rig.model;
  Structure& structure = model.structure;
  const Vocabulary vocabulary = vocabulary_of(structure);
  const Capabilities has = capabilities(structure);
  if (has.is_electric)
    throw std::runtime_error(fmt::format(
        "{} cannot express this axis: between its command and the motor there are the "
        "preamplifier and the current loop of drive: {}; export an axis with a force, "
        "current or motor voltage as its command",
        target, structure.drive == Drive::velocity_loop ? "velocity_loop" : "current_source"));
  const auto lose = [&](std::string sentence) { reduced.lost.push_back(std::move(sentence)); };
  if (structure.transmission == Transmission::backlash) {
    lose("The backlash and the stiffness of the gear are left out: arm and motor are one mass.");
    structure.transmission = Transmission::rigid;
  }
  for (std::size_t e = 0; e < kEffectTable.size(); ++e) {
    if (!structure.effects[e] || std::ranges::find(effects, kEffectTable[e].name) != effects.end())
      continue;
    structure.effects.reset(e);
    lose(fmt::format("{} is left out: {}.", words_on(vocabulary, kEffectTable[e].name),
                     words_on(vocabulary, kEffectTable[e].meaning)));
  }
  Axis<double>& a = model.axis;
  if (a.F_s != 0.0) lose("The static friction beyond the Coulomb friction (F_s) is left out.");
  if (a.T_d != 0.0) lose("The dead time of the command (T_d) is left out.");
  a.F_s = a.T_d = 0.0;
  structure.channels = nullptr;
  if (rig.uncertainty) lose(kUncertaintyIsLost);

  const std::vector<double*> values = members(model);
  const auto value = [&](std::string_view effect, std::string_view symbol) {
    const auto e = effect_named(effect);
    return e && structure.effects[*e]
               ? *values[quantity_index(fmt::format("{}.{}", effect, symbol))]
               : 0.0;
  };
  RigidAxis& axis = reduced.axis;
  axis.turns = structure.joint == Joint::revolute;
  const double r = motor_radius(model);
  axis.arm = a.M + value("added_mass", "dM");
  axis.damping = a.B_a;
  const bool has_motor = !has.is_force_driven || a.J_m != 0.0 || a.B_m != 0.0;
  if (has_motor) {
    axis.armature = a.J_m / (r * r);
    axis.damping += a.B_m / (r * r);
  }
  if (has.has_back_emf) {
    axis.damping += a.K_m * a.K_m / (a.R * r * r);
    axis.gain = a.K_m / (a.R * r);
  } else {
    axis.gain = a.K_f;
  }
  axis.friction = value("coulomb_friction", "F_c");
  axis.stiffness = value("stroke_spring", "k_s");
  axis.force = value("constant_force", "F_0") + axis.gain * value("command_offset", "U_0");
  axis.lag = value("drive_lag", "T_l");
  axis.gravity_sin = value("pendulum_gravity", "G_s");
  axis.gravity_cos = value("pendulum_gravity", "G_c");
  return reduced;
}

}  // namespace axisfit
