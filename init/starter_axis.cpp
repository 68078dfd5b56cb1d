#include "init/starter_axis.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/plain_text.h"
#include "base/units.h"
#include "base/version.h"
#include "io/config/yaml_text.h"

namespace axisfit {
namespace {

std::string origin(const std::string& recording) {
  return comment(fmt::format("Written by axisfit {} --init, for {}. It is a start, not a "
                             "description of your axis: what the job does not fit, take from data "
                             "sheets.",
                             version(), recording),
                 0) +
         "#\n";
}

/// What stands above K_f.
std::string gain_comment(const DrivenMass& seen) {
  if (seen.input == DrivenMass::Input::force)
    return comment("No part where the recordings hold the force itself.", 2);
  const bool current = seen.input == DrivenMass::Input::current;
  return comment(
      fmt::format("{}newtons for each {} of {}. Motion shows only the ratios of the mass and the "
                  "frictions to it, so that it is not fitted: put {} here, and M, B_a, F_c and F_0 "
                  "come out right. Multiply their initial values alike, and --check is right, too.",
                  kGuessed, current ? "ampere" : "volt (or what its unit is)", seen.column,
                  current ? "torque constant / pinion radius, or 2 pi torque constant / spindle "
                            "lead,"
                          : "the gain of the drive"),
      2);
}

}  // namespace

StarterAxis velocity_loop_starter(const std::string& recording) {
  StarterAxis starter;
  starter.structure = {Drive::velocity_loop, Transmission::backlash, {}};
  starter.text = fmt::format(
      "{}# GUESSED: all of it. The recordings look like those of a velocity loop, so these\n"
      "# are the values of a published one. Put yours; docs/axis-file.md.\n#\n{}",
      origin(recording), paper_axis());
  return starter;
}

StarterAxis mass_starter(const std::string& recording, const DrivenMass& seen) {
  const bool sound = seen.balance && seen.balance->mass > 0.0 && seen.balance->correlation > 0.3;
  const ForceBalance balance = sound ? *seen.balance : ForceBalance{.mass = 1.0};
  const bool gain_guessed = seen.input != DrivenMass::Input::force;
  double gain = 1.0;
  if (gain_guessed)
    while (balance.mass * gain < 0.1 && gain < 1e6) gain *= 10.0;
  const double input = seen.largest_input > 0.0 ? seen.largest_input : 1.0;

  StarterAxis starter;
  starter.structure = {Drive::force_source, Transmission::rigid, {}};
  starter.gain_guessed = gain_guessed;
  for (const char* effect : {"coulomb_friction", "constant_force"})
    starter.structure.effects.set(*effect_named(effect));
  const double most = starter.largest_force = two_digits(input * gain);
  const auto within = [](double value, double lower, double upper) {
    return std::clamp(two_digits(value), lower, upper);
  };
  // A fit on a logarithmic scale must not start at zero.
  const double viscous = balance.viscous > 0.0 ? balance.viscous * gain
                                               : 0.1 * most / std::max(seen.largest_speed, 1e-3);
  starter.text = fmt::format(
      "{}# One mass with viscous and Coulomb friction that a force moves: the least that a\n"
      "# driven axis has. What it lacks fit-params tells, and --close-loop adds. All\n"
      "# keys: docs/axis-file.md.\n"
      "name: starter axis\n"
      "drive: force_source   # {} moves it\n"
      "transmission: rigid   # motor and arm move as one; backlash needs a motor\n"
      "parameters:\n"
      "{}"
      "  K_f: {}\n"
      "  # {}\n"
      "  M: {}\n"
      "  B_a: {}\n"
      "effects:   # likewise\n"
      "  coulomb_friction: {{F_c: {}}}\n"
      "  constant_force: {{F_0: {}}}   # gravity, or an offset of the drive\n",
      origin(recording), harmless(seen.column), gain_comment(seen), with_unit(gain, "N/V"),
      sound ? "Fitted by the job; these are where it starts, from a balance of impulses."
            : "GUESSED, for the recording has no balance of impulses; fitted by the job.",
      with_unit(within(balance.mass * gain, 1e-3, 1e5), "kg"),
      with_unit(within(viscous, 1e-6, 1e6), "N s/m"),
      with_unit(within(std::max(balance.coulomb * gain, 0.01 * most), 0.0, most), "N"),
      with_unit(within(-balance.constant * gain, -most, most), "N"));
  return starter;
}

}  // namespace axisfit
