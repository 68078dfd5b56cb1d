// What a joint lets its load do. The equations are the same for both; the names, units and ranges
// of everything on the load's side follow here from those of a load that slides, in which the
// sources are written.
#pragma once

#include <string_view>

#include "sim/quantity.h"

namespace axisfit {

enum class Joint {
  prismatic,  ///< it slides: m, N, kg
  revolute,   ///< it turns: rad, N m, kg m^2
};
inline constexpr Joint kJoints[]{Joint::prismatic, Joint::revolute};

/// A unit of a load that slides, "N s/m", as it is on the joint: "N m s/rad". Those of motors,
/// instruments and times stay.
std::string_view unit_on(Joint joint, std::string_view unit);

/// A name or sentence about a load that slides as it is said on the joint: "constant_force" is
/// "constant_torque", "arm mass" is "joint inertia". Whole words alone are exchanged.
std::string_view words_on(Joint joint, std::string_view text);

/// A quantity with its symbol ("F_c": "T_c"), unit, meaning and range on the joint.
Quantity quantity_on(Joint joint, const Quantity& quantity);

}  // namespace axisfit
