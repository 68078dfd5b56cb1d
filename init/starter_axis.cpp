#include "init/starter_axis.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/plain_text.h"
#include "base/rounding.h"
#include "base/units.h"
#include "base/version.h"
#include "io/config/yaml_text.h"

namespace axisfit {
namespace {

std::string origin(const std::string& recording) {
  return comment(fmt::format(
                     "Written by axisfit {} --init, for {}. This is a starting point, not a "
                     "description of your axis: take what the job does not fit from data sheets.",
                     version(), recording),
                 0) +
         "#\n";
}

/// What stands above K_f.
std::string gain_comment(const DrivenMass& seen) {
  if (seen.input == DrivenMass::Input::force)
    return comment("Not used where the recordings contain the force itself.", 2);
  const bool current = seen.input == DrivenMass::Input::current;
  if (seen.gain) return comment(fmt::format("As given, per unit of {}.", seen.column), 2);
  return comment(
      fmt::format("{}newtons per {} of {}. A motion shows only the ratios of mass and friction to "
                  "it, so it is not fitted: put {} here, and M, B_a, F_c and F_0 will be correct. "
                  "Scale their initial values likewise, so that --check is correct too.",
                  kGuessed, current ? "ampere" : "volt (or whatever its unit is)", seen.column,
                  current
                      ? "torque constant / pinion radius, or 2 pi * torque constant / screw lead,"
                      : "the drive gain"),
      2);
}

}  // namespace

StarterAxis velocity_loop_starter(const std::string& recording) {
  StarterAxis starter;
  starter.structure = {Drive::velocity_loop, Transmission::backlash, {}};
  std::vector<std::string> guessed;
  for (const QuantityEntry& entry : quantity_list())
    if (entry.group.empty() && is_used(entry, starter.structure)) guessed.push_back(entry.name);
  starter.text = fmt::format(
      "{}# GUESSED: everything. The recordings look like those of a velocity loop, so these\n# are "
      "the values of a published axis. Replace them by yours; docs/axis-file.md.\n#\n{}guessed:   "
      "# "
      "delete what you have replaced\n  [{}]\n",
      origin(recording), paper_axis(), fmt::join(guessed, ", "));
  return starter;
}

StarterAxis mass_starter(const std::string& recording, const DrivenMass& seen) {
  const bool sound = seen.balance && seen.balance->mass > 0.0 && seen.balance->correlation > 0.3;
  const ForceBalance balance = sound ? *seen.balance : ForceBalance{.mass = 1.0};
  const bool gain_guessed = seen.input != DrivenMass::Input::force && !seen.gain;
  double gain = seen.gain.value_or(1.0);
  if (gain_guessed)
    while (balance.mass * gain < 0.1 && gain < 1e6) gain *= 10.0;
  const double input = seen.largest_input > 0.0 ? seen.largest_input : 1.0;

  StarterAxis starter;
  starter.structure = {Drive::force_source, Transmission::rigid, {}};
  starter.gain_guessed = gain_guessed;
  for (const char* effect : {"coulomb_friction", "constant_force"})
    starter.structure.effects.set(*effect_named(effect));
  const double most = starter.largest_force = std::min(
      round_to_digits(input * gain, 2), find_quantity("constant_force.F_0")->quantity.upper);
  const auto within = [](double value, double lower, double upper) {
    return std::clamp(round_to_digits(value, 2), lower, upper);
  };
  // A fit on a logarithmic scale must not start at zero.
  const double viscous = balance.viscous > 0.0 ? balance.viscous * gain
                                               : 0.1 * most / std::max(seen.largest_speed, 1e-3);
  starter.text = fmt::format(
      "{}# One mass with viscous and Coulomb friction, driven by a force: the simplest model\n# of "
      "an axis. fit-params reports what it lacks, and --close-loop adds it. All\n# keys: "
      "docs/axis-file.md.\nname: starter axis\ndrive: force_source   # driven by {}\ntransmission: "
      "rigid   # motor and arm move as one; backlash needs a motor\n{}parameters:\n{}  K_f: {}\n  "
      "# "
      "{}\n  M: {}\n  B_a: {}\neffects:   # initial values, as above\n  coulomb_friction: {{F_c: "
      "{}}}\n  constant_force: {{F_0: {}}}   # gravity, or an offset of the drive\n",
      origin(recording), sanitized(seen.column),
      gain_guessed ? "guessed: [K_f]   # delete this line when it is that of a data sheet\n" : "",
      gain_comment(seen), with_unit(gain, "N/V"),
      sound ? "Fitted by the job; initial values from an impulse balance."
            : "GUESSED, because no impulse balance could be computed; fitted by the job.",
      with_unit(within(balance.mass * gain, 1e-3, 1e5), "kg"),
      with_unit(within(viscous, 1e-6, 1e6), "N s/m"),
      with_unit(within(std::max(balance.coulomb * gain, 0.01 * most), 0.0, most), "N"),
      with_unit(within(-balance.constant * gain, -most, most), "N"));
  return starter;
}

}  // namespace axisfit
