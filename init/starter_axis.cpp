#include "init/starter_axis.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "base/rounding.h"
#include "base/units.h"
#include "base/version.h"
#include "io/config/axis_file.h"
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
  if (seen.is_force) return comment("Not used where the recordings contain the force itself.", 2);
  const Vocabulary vocabulary = vocabulary_of(seen.structure);
  const bool turns = vocabulary.joint == Joint::revolute;
  const auto say = [&](const char* text) { return words_on(vocabulary, text); };
  const auto [per, is] = [&]() -> std::pair<const char*, std::string_view> {
    switch (vocabulary.command) {
      case Command::share_of_rated:
        return {"at 100 %", turns
                                ? "the rated torque, times the gear ratio if the joint has a gear,"
                                : "the rated force, or rated torque / pinion radius,"};
      case Command::current:
        return {"per ampere",
                turns ? "the torque constant, times the gear ratio if the joint has a gear,"
                      : "torque constant / pinion radius, or 2 pi * torque constant / screw lead,"};
      case Command::voltage:
        break;
    }
    return {"per volt (or whatever its unit is)", "the drive gain"};
  }();
  if (seen.gain) return comment(fmt::format("As given, {} of {}.", per, seen.column), 2);
  return comment(
      fmt::format("{}{} {} of {}. A motion shows only the ratios of {} and friction to it, so "
                  "it is not fitted: put {} here, and {} will be correct. "
                  "Scale their initial values likewise, so that --check is correct too.",
                  kGuessed, say("newtons"), per, seen.column, say("mass"), is,
                  turns ? "J, B_a, T_c and T_0" : "M, B_a, F_c and F_0"),
      2);
}

}  // namespace

std::vector<std::string> machine_names() {
  std::vector<std::string> names;
  for (const MachineAxis& machine : machine_axes()) names.emplace_back(machine.name);
  return names;
}

StarterAxis velocity_loop_starter(const std::string& recording) {
  StarterAxis starter;
  starter.structure = {Drive::velocity_loop, Transmission::backlash, {}, Joint::prismatic};
  std::vector<std::string> guessed;
  for (const QuantityEntry& entry : quantity_list())
    if (entry.group.empty() && is_used(entry, starter.structure)) guessed.push_back(entry.name);
  starter.text = fmt::format(
      "{}# GUESSED: everything. The recordings look like those of a velocity loop, so these\n# are "
      "the values of a published axis. Replace them by yours; docs/axis-file.md.\n#\n{}guessed:   "
      "# "
      "delete what you have replaced\n  [{}]\n",
      origin(recording), machine_axes().front().text, fmt::join(guessed, ", "));
  return starter;
}

StarterAxis mass_starter(const std::string& recording, const DrivenMass& seen) {
  const bool sound = seen.look && seen.look->shows_mass();
  const Vocabulary vocabulary = vocabulary_of(seen.structure);
  const bool turns = vocabulary.joint == Joint::revolute;
  // A mass that does not show takes little of the input.
  constexpr double kLittle = 0.1;
  FirstLook look = seen.look.value_or(FirstLook{});
  if (!seen.look)
    look.mass.value = turns ? 0.01 : 1.0;
  else if (!sound)
    look.mass.value = kLittle * look.largest_mass;
  const bool has_gravity = look.gravity_sine.value != 0.0 || look.gravity_cosine.value != 0.0;
  const bool gain_guessed = !seen.is_force && !seen.gain;
  double gain = seen.gain.value_or(1.0);
  if (gain_guessed && !turns)
    while (look.mass.value * gain < 0.1 && gain < 1e6) gain *= 10.0;
  const double input = seen.largest_input > 0.0 ? seen.largest_input : 1.0;

  StarterAxis starter;
  starter.structure = seen.structure;
  starter.gain_guessed = gain_guessed;
  const bool builds_up = look.presliding > 0.0;
  for (const char* effect : {builds_up ? "dahl_friction" : "coulomb_friction", "constant_force"})
    starter.structure.effects.set(*effect_named(effect));
  const auto quantity = [&](const char* name) -> const Quantity& {
    return quantity_list(vocabulary)[quantity_index(name)].quantity;
  };
  if (has_gravity) starter.structure.effects.set(*effect_named("pendulum_gravity"));
  const double most = starter.largest_force =
      std::min(round_to_digits(input * gain, 2), quantity("constant_force.F_0").upper);
  const auto within = [](double value, double lower, double upper) {
    return std::clamp(round_to_digits(value, 2), lower, upper);
  };
  const auto initial = [&](const char* name, double value) {
    const Quantity& q = quantity(name);
    const double lower = q.lower > 0.0 ? q.lower : turns ? 1e-9 : 1e-6;
    return fmt::format("{}: {}", q.symbol, with_unit(within(value, lower, q.upper), q.unit));
  };
  const auto force = [&](const char* name, double value, double lower) {
    const Quantity& q = quantity(name);
    return fmt::format("{}: {}", q.symbol, with_unit(within(value, lower, most), q.unit));
  };
  const auto say = [&](const char* text) { return words_on(vocabulary, text); };
  // The scale of the fit goes by the initial value, which must not be next to nothing.
  const double viscous =
      std::max(look.viscous.value * gain, 0.01 * most / std::max(seen.largest_speed, 1e-3));
  const double dry = std::max(look.coulomb.value * gain, 0.01 * most);
  const std::string friction =
      builds_up ? fmt::format("dahl_friction: {{{}, {}}}   # it builds up over {} after a reversal",
                              force("dahl_friction.F_d", dry, 0.0),
                              initial("dahl_friction.l_d", look.presliding),
                              quantity("dahl_friction.l_d").symbol)
                : fmt::format("coulomb_friction: {{{}}}", force("coulomb_friction.F_c", dry, 0.0));
  starter.text = fmt::format(
      "{}{}name: starter axis\n{}drive: {}   # driven by {}\ntransmission: rigid   "
      "# motor and {} move as one; backlash needs a motor\n{}parameters:\n{}  K_f: {}\n  # {}\n  "
      "{}\n  {}\neffects:   # initial values, as above\n  {}\n  {}: {{{}}}   "
      "# gravity, or an offset of the drive\n",
      origin(recording),
      comment(fmt::format("One {} with viscous and {} friction, driven by a {}: the simplest model "
                          "of an axis. fit-params reports what it lacks, and --close-loop adds it. "
                          "All keys: docs/axis-file.md.",
                          say("mass"), builds_up ? "dry" : "Coulomb", say("force")),
              0),
      turns ? "joint: revolute\n" : "", drive_name(seen.structure.drive, vocabulary.joint),
      seen.column, say("arm"),
      gain_guessed ? "guessed: [K_f]   # delete this line when it is that of a data sheet\n" : "",
      gain_comment(seen), with_unit(gain, quantity("K_f").unit),
      seen.look ? "Fitted by the job; initial values from the balance of forces."
                : "GUESSED, because no balance of forces could be computed; fitted by the job.",
      initial("M", look.mass.value * gain), initial("B_a", viscous), friction,
      say("constant_force"), force("constant_force.F_0", -look.constant.value * gain, -most));
  if (has_gravity)
    starter.text += fmt::format(
        "  pendulum_gravity: {{{}, {}}}   # weight times lever; where it hangs is found\n",
        force("pendulum_gravity.G_s", look.gravity_sine.value * gain, -most),
        force("pendulum_gravity.G_c", look.gravity_cosine.value * gain, -most));
  return starter;
}

}  // namespace axisfit
