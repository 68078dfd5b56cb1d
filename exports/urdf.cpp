#include "exports/rigid_axis.h"
#include "exports/targets.h"
#include "exports/xml.h"

namespace axisfit {

Export urdf(const Rig& rig, const std::string& name, const std::string& origin) {
  Reduced reduced = reduced_to(rig, {"coulomb_friction", "added_mass"}, "URDF");
  const RigidAxis& axis = reduced.axis;
  const double mass = axis.arm + axis.armature;
  if (axis.armature > 0.0)
    reduced.lost.emplace_back(
        "URDF knows no armature: the link has the motor's inertia as well, and would weigh more.");
  pugi::xml_document document;
  add_comments(document, origin, reduced.lost);
  auto robot = child(document, "robot", {{"name", name}});
  child(robot, "link", {{"name", "base"}});
  auto inertial = child(robot, "link", {{"name", "arm"}}).append_child("inertial");
  child(inertial, "origin", {{"xyz", "0 0 0"}, {"rpy", "0 0 0"}});
  child(inertial, "mass", {{"value", axis.turns ? "1" : number(mass)}});
  const std::string own = number(axis.turns ? mass : 1e-2 * mass);
  child(inertial, "inertia",
        {{"ixx", own}, {"ixy", "0"}, {"ixz", "0"}, {"iyy", own}, {"iyz", "0"}, {"izz", own}});
  auto joint =
      child(robot, "joint", {{"name", "axis"}, {"type", axis.turns ? "continuous" : "prismatic"}});
  child(joint, "parent", {{"link", "base"}});
  child(joint, "child", {{"link", "arm"}});
  child(joint, "axis", {{"xyz", axis.turns ? "0 0 1" : "1 0 0"}});
  // A prismatic joint must have limits, which an axis file does not state.
  if (!axis.turns)
    child(joint, "limit",
          {{"lower", "-1000"}, {"upper", "1000"}, {"effort", "1e9"}, {"velocity", "1e3"}});
  child(joint, "dynamics",
        {{"damping", number(axis.damping)}, {"friction", number(axis.friction)}});
  auto transmission = child(robot, "transmission", {{"name", "drive"}});
  transmission.append_child("type").text() = "transmission_interface/SimpleTransmission";
  auto driven = child(transmission, "joint", {{"name", "axis"}});
  driven.append_child("hardwareInterface").text() = "hardware_interface/EffortJointInterface";
  auto actuator = child(transmission, "actuator", {{"name", "drive"}});
  actuator.append_child("mechanicalReduction").text() = number(axis.gain).c_str();
  return {{{name + ".urdf", xml_text(document)}}, std::move(reduced.rig), std::move(reduced.lost)};
}

}  // namespace axisfit
