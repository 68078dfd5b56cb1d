// Axis files: an axis, its effects, controller and instruments, in YAML. docs/axis-file.md tells of
// every key; nearly all come from the model's list of quantities.
#pragma once

#include <optional>
#include <string>

#include "io/config/config.h"
#include "sim/rig.h"

namespace axisfit {

/// The keys of an axis file. Among the parameters, effects and initial states are all that an axis
/// with that joint can have; which of them one has depends on its drive and transmission.
const Section& axis_keys(Vocabulary vocabulary);

/// The words of axis files for what is chosen.
const std::string& joint_name(Joint joint);
const std::string& drive_name(Drive drive, Joint joint);
const std::string& transmission_name(Transmission transmission);

/// The keys for all quantities under their full names, and for all effects, in every vocabulary.
Section quantity_keys();
Section effect_keys();

/// Reads an axis file. Nothing, with diagnostics, when anything in it is wrong.
std::optional<Rig> read_axis_file(const std::string& path, Diagnostics& diagnostics);
std::optional<Rig> read_axis(const ConfigNode& root, Diagnostics& diagnostics);

/// Reads `effects: {name: {symbol: quantity}}` into a model: an effect is on because it is written.
void read_effects(const ConfigNode& node, Model<double>& model);

/// The quantity that a key names, or null with a diagnostic that suggests one.
const QuantityEntry* quantity_named(const ConfigNode& key, const Structure& structure);

/// Reads the value of a quantity within its natural range.
std::optional<double> read_value(const ConfigNode& node, const Quantity& quantity);

/// An axis file that reads back as the same rig, digit for digit; of its uncertainty six digits.
/// `comment` becomes its first lines.
std::string format_axis_file(const Rig& rig, const std::string& comment);

}  // namespace axisfit
