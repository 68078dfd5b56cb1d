#include "exports/export.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <matio.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <numbers>
#include <pugixml.hpp>
#include <sstream>
#include <stdexcept>

#include "exports/rigid_axis.h"
#include "io/config/axis_file.h"
#include "sim/model.h"

namespace axisfit {
namespace {

std::string number(double value) { return fmt::format("{}", value); }

/// Of an XML document with comments before it.
std::string xml_text(const pugi::xml_document& document) {
  std::ostringstream out;
  document.save(out, "  ");
  return out.str();
}

/// XML comments may not contain two hyphens.
void add_comment(pugi::xml_node node, std::string text) {
  for (std::size_t at = 0; (at = text.find("--", at)) != std::string::npos;)
    text.replace(at, 2, "- ");
  node.append_child(pugi::node_comment).set_value((" " + text + " ").c_str());
}

void add_comments(pugi::xml_node node, const std::string& origin,
                  const std::vector<std::string>& lost) {
  add_comment(node, origin);
  for (const std::string& sentence : lost) add_comment(node, sentence);
}

pugi::xml_node child(pugi::xml_node parent, const char* name,
                     std::initializer_list<std::pair<const char*, std::string>> attributes) {
  pugi::xml_node node = parent.append_child(name);
  for (const auto& [key, value] : attributes) node.append_attribute(key) = value.c_str();
  return node;
}

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

Export mjcf(const Rig& rig, const std::string& name, const std::string& origin) {
  Reduced reduced = reduced_to(rig,
                               {"coulomb_friction", "constant_force", "stroke_spring", "added_mass",
                                "drive_lag", "command_offset", "pendulum_gravity"},
                               "MJCF");
  const RigidAxis& axis = reduced.axis;
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

/// Covariance of the quantities that were fitted, in their units: of the estimates, and of a
/// further recording.
struct Covariance {
  std::vector<std::string> names;
  std::vector<double> values, of_estimates, of_machine;  ///< the latter by rows
};

Covariance covariance_of(const Rig& rig) {
  Covariance found;
  if (!rig.uncertainty) return found;
  Model<double> model = rig.model;
  const std::vector<double*> values = members(model);
  const std::vector<QuantityEntry>& list = quantity_list(vocabulary_of(rig.model.structure));
  const std::vector<UncertainQuantity>& quantities = rig.uncertainty->quantities;
  const std::size_t n = quantities.size();
  for (const UncertainQuantity& q : quantities) {
    found.names.push_back(list[q.quantity].name);
    found.values.push_back(*values[q.quantity]);
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      const auto scale = [&](std::size_t k) {
        return quantities[k].logarithmic ? found.values[k] : 1.0;
      };
      const double c = rig.uncertainty->correlation[i * n + j] * quantities[i].error * scale(i) *
                       quantities[j].error * scale(j);
      const double own = i == j ? std::pow(quantities[i].scatter * scale(i), 2) : 0.0;
      found.of_estimates.push_back(c);
      found.of_machine.push_back(c + own);
    }
  return found;
}

std::string matlab_matrix(const std::vector<double>& values, std::size_t n) {
  std::vector<std::string> rows;
  for (std::size_t i = 0; i < n; ++i)
    rows.push_back(fmt::format(
        "{}", fmt::join(values.begin() + static_cast<std::ptrdiff_t>(i * n),
                        values.begin() + static_cast<std::ptrdiff_t>((i + 1) * n), ", ")));
  return fmt::format("[{}]", fmt::join(rows, "; "));
}

/// A text in MATLAB's quotes.
std::string quoted(std::string text) {
  for (std::size_t at = 0; (at = text.find('\'', at)) != std::string::npos; at += 2)
    text.insert(at, 1, '\'');
  return "'" + text + "'";
}

std::string matlab_function(const Rig& rig, const std::string& name, const std::string& origin) {
  const Structure& structure = rig.model.structure;
  const Vocabulary vocabulary = vocabulary_of(structure);
  std::string text = fmt::format(
      "function axis = {0}()\n% {0}  Parameters of an axis, in SI units, and their covariance.\n",
      name);
  std::istringstream lines(origin);
  for (std::string line; std::getline(lines, line);) text += "% " + line + "\n";
  text += fmt::format(
      "axis.name = {};\naxis.drive = {};\naxis.transmission = {};\naxis.joint = {};\n",
      quoted(rig.name), quoted(drive_name(structure.drive, structure.joint)),
      quoted(transmission_name(structure.transmission)), quoted(joint_name(structure.joint)));
  Model<double> model = rig.model;
  const std::vector<double*> values = members(model);
  for (const QuantityEntry& entry : quantity_list(vocabulary)) {
    const bool own = entry.group.empty() || entry.effect;
    if (!own || !is_used(entry, structure)) continue;
    text +=
        fmt::format("axis.{}{} = {};  % {}: {}\n", entry.effect ? "effects." : "parameters.",
                    entry.name, *values[entry.index], entry.quantity.unit, entry.quantity.meaning);
  }
  const Covariance known = covariance_of(rig);
  std::vector<std::string> names;
  for (const std::string& n : known.names) names.push_back(quoted(n));
  text += fmt::format("axis.fitted.names = {{{}}};\naxis.fitted.values = [{}];\n",
                      fmt::join(names, ", "), fmt::join(known.values, ", "));
  text += "% of the estimates, and of a further recording, scatter included\n";
  text +=
      fmt::format("axis.fitted.covariance = {};\naxis.fitted.covariance_of_machine = {};\nend\n",
                  matlab_matrix(known.of_estimates, names.size()),
                  matlab_matrix(known.of_machine, names.size()));
  return text;
}

/// What a MAT-file holds of the covariance. The library writes to files only.
std::string mat_file(const Rig& rig) {
  namespace fs = std::filesystem;
  struct Folder {
    fs::path path;
    Folder() {
      std::string pattern = (fs::temp_directory_path() / "axisfit-XXXXXX").string();
      if (mkdtemp(pattern.data()) == nullptr)
        throw std::runtime_error("no folder for temporary files can be made in " +
                                 fs::temp_directory_path().string());
      path = pattern;
    }
    ~Folder() {
      std::error_code ignored;
      fs::remove_all(path, ignored);
    }
  } const folder;
  const std::string path = (folder.path / "axis.mat").string();
  Covariance known = covariance_of(rig);  // the library takes what it only reads as if it wrote
  const std::size_t n = known.names.size();
  {
    const std::unique_ptr<mat_t, decltype(&Mat_Close)> file(
        Mat_CreateVer(path.c_str(), "MATLAB 5.0 MAT-file, by axisfit", MAT_FT_MAT5), &Mat_Close);
    if (!file) throw std::runtime_error("the MAT-file cannot be written");
    const auto write = [&](matvar_t* variable) {
      const std::unique_ptr<matvar_t, decltype(&Mat_VarFree)> owned(variable, &Mat_VarFree);
      if (!owned || Mat_VarWrite(file.get(), owned.get(), MAT_COMPRESSION_NONE) != 0)
        throw std::runtime_error("the MAT-file cannot be written");
    };
    const auto matrix = [&](const char* name, std::vector<double> values, std::size_t columns) {
      // Columns first, which makes no difference to symmetric ones.
      std::array<std::size_t, 2> size{values.size() / std::max<std::size_t>(1, columns), columns};
      write(Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(), values.data(), 0));
    };
    std::array<std::size_t, 2> size{n, 1};
    matvar_t* names = Mat_VarCreate("names", MAT_C_CELL, MAT_T_CELL, 2, size.data(), nullptr, 0);
    for (std::size_t i = 0; i < n; ++i) {
      std::array<std::size_t, 2> length{1, known.names[i].size()};
      Mat_VarSetCell(names, static_cast<int>(i),
                     Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UINT8, 2, length.data(),
                                   known.names[i].data(), 0));
    }
    write(names);
    matrix("values", known.values, 1);
    matrix("covariance", known.of_estimates, n);
    matrix("covariance_of_machine", known.of_machine, n);
  }
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// What MATLAB takes for the name of a function, and with it of its file.
std::string identifier(std::string name) {
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return std::isalpha(static_cast<unsigned char>(name.front())) != 0 ? name : "axis_" + name;
}

Export matlab(const Rig& rig, const std::string& of_file, const std::string& origin) {
  const std::string name = identifier(of_file);
  return {
      {{name + ".m", matlab_function(rig, name, origin)}, {name + ".mat", mat_file(rig)}}, rig, {}};
}

}  // namespace

Export export_axis(const Rig& rig, ExportTarget target, const std::string& name,
                   const std::string& origin) {
  switch (target) {
    case ExportTarget::mjcf:
      return mjcf(rig, name, origin);
    case ExportTarget::urdf:
      return urdf(rig, name, origin);
    case ExportTarget::matlab:
      return matlab(rig, name, origin);
  }
  throw std::logic_error("no such target");
}

}  // namespace axisfit
