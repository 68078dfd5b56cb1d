// Axis files to start from, for recordings whose axis nobody has described.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fit/first_look/first_look.h"
#include "sim/model.h"

namespace axisfit {

struct StarterAxis {
  std::string text;  ///< of the axis file; what is guessed in it is marked
  Structure structure;
  double largest_force = 0.0;  ///< N, of the drive, either way; of a force source alone
  bool gain_guessed = false;   ///< K_f is the user's to put, and what is fitted goes with it
};

/// The axis file of a kind of machine, with starting values.
struct MachineAxis {
  std::string_view name;  ///< "screw"
  std::string_view text;
};
const std::vector<MachineAxis>& machine_axes();
std::vector<std::string> machine_names();

/// One with a velocity loop: the paper's. `recording` is the file that it is for.
StarterAxis velocity_loop_starter(const std::string& recording);

/// What a recording shows of a mass that a force moves.
struct DrivenMass {
  std::string column;          ///< that drives it, as messages call it
  Structure structure;         ///< by force, rigid
  bool is_force = false;       ///< the column is the force itself
  double largest_input = 0.0;  ///< either way
  double largest_speed = 1.0;  ///< m/s
  std::optional<FirstLook> look;
  std::optional<double> gain{};  ///< K_f, of an input that is no force, where the user knows it
};

/// A force source that moves one mass with viscous and Coulomb friction and a constant force. Where
/// the input is no force and its gain not known, that is the power of ten, at least 1 N/V, that
/// makes the mass 0.1 kg or more: motion does not show the gain. On a revolute joint it is 1 N m/V,
/// and the axis has the gravity that the first look has.
StarterAxis mass_starter(const std::string& recording, const DrivenMass& seen);

}  // namespace axisfit
