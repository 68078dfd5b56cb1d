// The gains of a feed-forward in volts, as robots of FRC take them.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>

#include "exports/rigid_axis.h"
#include "exports/targets.h"
#include "io/config/axis_file.h"

namespace axisfit {
namespace {

struct Gain {
  const char* name;
  std::string unit;
  double value;
};

bool is_arm(const Structure& structure) {
  return structure.effects[*effect_named("pendulum_gravity")];
}

/// What the gains stand for; those that are constant last.
constexpr std::array<std::string_view, 5> kEffects{
    "coulomb_friction", "added_mass", "pendulum_gravity", "constant_force", "command_offset"};

/// WPILib's arm has no constant voltage.
std::vector<std::string_view> effects_of(const Structure& structure) {
  return {kEffects.begin(), kEffects.end() - (is_arm(structure) ? 2 : 0)};
}

/// Throws std::runtime_error where the command is no voltage, or an effect would change the gains.
void refuse_what_has_no_gain(const Structure& structure) {
  const Vocabulary vocabulary = vocabulary_of(structure);
  if (vocabulary.command != Command::voltage)
    throw std::runtime_error(fmt::format(
        "FRC cannot express this axis: its gains are in volts, and the command of drive: {} is not",
        drive_name(structure.drive, structure.joint)));
  std::vector<std::string_view> others;
  for (std::size_t e = 0; e < kEffectTable.size(); ++e)
    if (structure.effects[e] && std::ranges::find(kEffects, kEffectTable[e].name) == kEffects.end())
      others.push_back(words_on(vocabulary, kEffectTable[e].name));
  if (!others.empty())
    throw std::runtime_error(
        fmt::format("FRC cannot express this axis: none of its gains stands for {}; export an axis "
                    "that was fitted without",
                    fmt::join(others, ", ")));
}

std::vector<Gain> gains_of(const Rig& rig) {
  const Structure& structure = rig.model.structure;
  const RigidAxis axis = reduced_to(rig, effects_of(structure), "FRC").axis;
  const std::string length = axis.turns ? "rad" : "m";
  std::vector<Gain> gains{{"kS", "V", axis.friction / axis.gain},
                          {"kV", "V s/" + length, axis.damping / axis.gain},
                          {"kA", "V s^2/" + length, (axis.arm + axis.armature) / axis.gain}};
  if (is_arm(structure)) {
    // kG cos(y + offset) = (c cos y + s sin y) / gain
    gains.push_back({"kG", "V", std::hypot(axis.gravity_cos, axis.gravity_sin) / axis.gain});
    gains.push_back({"offset", "rad", std::atan2(-axis.gravity_sin, axis.gravity_cos)});
  } else {
    gains.push_back({"kG", "V", -axis.force / axis.gain});
  }
  return gains;
}

/// Standard errors of the gains, of what was fitted; zero for a gain that depends on none of that.
Eigen::VectorXd errors_of(const Rig& rig, std::size_t gains) {
  const auto columns = static_cast<Eigen::Index>(gains);
  if (!rig.uncertainty) return Eigen::VectorXd::Zero(columns);
  const auto& [fitted, by_rows, missing_force] = *rig.uncertainty;
  const auto rows = static_cast<Eigen::Index>(fitted.size());
  Eigen::MatrixXd changes(rows, columns);  // per standard error of each quantity
  for (Eigen::Index i = 0; i < rows; ++i) {
    const UncertainQuantity& q = fitted[static_cast<std::size_t>(i)];
    constexpr double kPart = 1e-3;  // of a standard error, for differences
    const auto moved = [&](double part) {
      Rig other = rig;
      double& value = *members(other.model)[q.quantity];
      value = q.logarithmic ? value * std::exp(part * q.error) : value + part * q.error;
      return gains_of(other);
    };
    const std::vector<Gain> more = moved(kPart), less = moved(-kPart);
    for (std::size_t g = 0; g < gains; ++g) {
      double difference = more[g].value - less[g].value;
      // An angle may have gone round.
      if (more[g].unit == "rad") difference = std::remainder(difference, 2.0 * std::numbers::pi);
      changes(i, static_cast<Eigen::Index>(g)) = difference / (2.0 * kPart);
    }
  }
  const Eigen::Map<const Eigen::MatrixXd> correlation(by_rows.data(), rows, rows);
  return (changes.transpose() * correlation * changes).diagonal().cwiseMax(0.0).cwiseSqrt();
}

}  // namespace

Export frc(const Rig& rig, const std::string& name, const std::string& origin) {
  const Structure& structure = rig.model.structure;
  refuse_what_has_no_gain(structure);
  Reduced reduced = reduced_to(rig, effects_of(structure), "FRC");
  std::erase(reduced.lost, kUncertaintyIsLost);
  const std::vector<Gain> gains = gains_of(rig);
  const Eigen::VectorXd errors = errors_of(rig, gains.size());
  using Json = nlohmann::ordered_json;
  Json json{{"origin", origin},
            {"law", fmt::format("V = kS sign(v) + kV v + kA a + kG{}",
                                is_arm(structure) ? " cos(position + offset)" : "")}};
  for (std::size_t g = 0; g < gains.size(); ++g) {
    const double error = errors[static_cast<Eigen::Index>(g)];
    json[gains[g].name] = {{"value", gains[g].value},
                           {"standard_error", error > 0.0 ? Json(error) : Json(nullptr)},
                           {"unit", gains[g].unit}};
  }
  json["left_out"] = reduced.lost;
  return {{{name + ".json", json.dump(2) + "\n"}}, std::move(reduced.rig), std::move(reduced.lost)};
}

}  // namespace axisfit
