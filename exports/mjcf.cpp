#include <fmt/format.h>

#include <cmath>

#include "exports/rigid_axis.h"
#include "exports/targets.h"
#include "exports/xml.h"

namespace axisfit {
namespace {

/// MuJoCo's friction creeps under load by default; with these it holds, at the price of stiff
/// constraints, which the integrator of fourth order follows at 1 ms.
constexpr const char* kSolRef = "0.0004 1";
constexpr const char* kSolImp = "0.9999 0.9999 0.001 0.5 2";
constexpr double kGravity = 9.81;  // m/s^2

/// The body's mass, centre and inertia: that of the arm, with the moment of gravity about a hinge.
void add_inertia(pugi::xml_node body, const RigidAxis& axis) {
  if (!axis.turns) {
    // Only its mass counts; the inertia is any that a body can have.
    child(body, "inertial",
          {{"pos", "0 0 0"},
           {"mass", number(axis.arm)},
           {"diaginertia", fmt::format("{0} {0} {0}", 1e-2 * axis.arm)}});
    return;
  }
  const double moment = std::hypot(axis.gravity_sin, axis.gravity_cos);
  double mass = 1.0, lever = 0.0;
  if (moment > 0.0) {  // half the inertia is that of a point
    lever = 0.5 * axis.arm * kGravity / moment;
    mass = moment / (kGravity * lever);
  }
  // Gravity pulls along -y. With the centre at the angle a from x, at the position q the moment is
  // -m g l cos(q + a) = -(s sin q + c cos q) for cos a = c / (m g l), sin a = -s / (m g l).
  const double angle = std::atan2(-axis.gravity_sin, axis.gravity_cos);
  const double own = axis.arm - mass * lever * lever;
  child(body, "inertial",
        {{"pos", moment > 0.0
                     ? fmt::format("{} {} 0", lever * std::cos(angle), lever * std::sin(angle))
                     : "0 0 0"},
         {"mass", number(mass)},
         {"diaginertia", fmt::format("{0} {0} {0}", own)}});
}

}  // namespace

Export mjcf(const Rig& rig, const std::string& name, const std::string& origin) {
  Reduced reduced = reduced_to(rig,
                               {"coulomb_friction", "constant_force", "stroke_spring", "added_mass",
                                "drive_lag", "command_offset", "pendulum_gravity"},
                               "MJCF");
  const RigidAxis& axis = reduced.axis;
  if (axis.friction > 0.0)
    reduced.lost.emplace_back(
        "Stops and break-aways are not located: they happen at the time steps of MuJoCo.");
  pugi::xml_document document;
  add_comments(document, origin, reduced.lost);
  auto root = child(document, "mujoco", {{"model", rig.name.empty() ? name : rig.name}});
  child(root, "compiler", {{"angle", "radian"}, {"autolimits", "true"}});
  child(root, "option",
        {{"timestep", "0.001"},
         {"integrator", "RK4"},
         {"gravity", fmt::format("0 -{} 0", kGravity)}});
  auto body = child(root.append_child("worldbody"), "body", {{"name", "arm"}});
  auto joint = child(body, "joint",
                     {{"name", "axis"},
                      {"type", axis.turns ? "hinge" : "slide"},
                      {"axis", axis.turns ? "0 0 1" : "1 0 0"},
                      {"damping", number(axis.damping)}});
  if (axis.armature > 0.0) joint.append_attribute("armature") = number(axis.armature).c_str();
  if (axis.stiffness != 0.0) {
    joint.append_attribute("stiffness") = number(axis.stiffness).c_str();
    joint.append_attribute("springref") = "0";
  }
  if (axis.friction > 0.0) {
    joint.append_attribute("frictionloss") = number(axis.friction).c_str();
    joint.append_attribute("solreffriction") = kSolRef;
    joint.append_attribute("solimpfriction") = kSolImp;
  }
  add_inertia(body, axis);
  // MuJoCo wants those without a state before those with one.
  auto actuators = root.append_child("actuator");
  if (axis.force != 0.0)
    child(actuators, "general",
          {{"name", "constant_force"},
           {"joint", "axis"},
           {"gainprm", "0"},
           {"biastype", "affine"},
           {"biasprm", fmt::format("{} 0 0", axis.force)}});
  auto drive = child(actuators, "general",
                     {{"name", "drive"}, {"joint", "axis"}, {"gear", number(axis.gain)}});
  if (axis.lag > 0.0) {
    drive.append_attribute("dyntype") = "filter";
    drive.append_attribute("dynprm") = number(axis.lag).c_str();
  }
  auto sensors = root.append_child("sensor");
  child(sensors, "jointpos", {{"name", "position"}, {"joint", "axis"}});
  child(sensors, "jointvel", {{"name", "velocity"}, {"joint", "axis"}});
  return {{{name + ".xml", xml_text(document)}}, std::move(reduced.rig), std::move(reduced.lost)};
}

}  // namespace axisfit
