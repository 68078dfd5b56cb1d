#include "sim/model.h"

#include <algorithm>

namespace axisfit {

const std::vector<QuantityEntry>& quantity_list() {
  static const std::vector<QuantityEntry> list = [] {
    std::vector<QuantityEntry> entries;
    const Model<double> model;
    visit_quantities(model, [&](std::string_view group, const Quantity& quantity, double) {
      entries.push_back({full_name(group, quantity), std::string(group), quantity, entries.size()});
    });
    return entries;
  }();
  return list;
}

const QuantityEntry* find_quantity(std::string_view name) {
  const auto& list = quantity_list();
  const auto found = std::ranges::find(list, name, &QuantityEntry::name);
  return found == list.end() ? nullptr : &*found;
}

bool is_used(const QuantityEntry& entry, const Structure& structure) {
  const bool electric = structure.drive != Drive::force_source;
  const bool backlash = structure.transmission == Transmission::backlash;
  const auto effect = effect_named(entry.group);
  if (effect && !structure.effects[*effect]) return false;
  switch (entry.quantity.used_by) {
    case UsedBy::every_axis:
      return true;
    case UsedBy::velocity_loop:
      return structure.drive == Drive::velocity_loop;
    case UsedBy::electric_drive:
      return electric;
    case UsedBy::force_source:
      return !electric;
    case UsedBy::backlash:
      return backlash;
    case UsedBy::motor:
      return electric || backlash;
  }
  return true;
}

bool has_signal(Signal signal, const Structure& structure) {
  switch (signal) {
    case Signal::position:
    case Signal::velocity:
    case Signal::acceleration:
      return true;
    case Signal::tachometer:
    case Signal::motor_current:
    case Signal::preamplifier_voltage:
    case Signal::drive_force:
      return structure.drive != Drive::force_source;
    case Signal::motor_voltage:
      return structure.drive == Drive::velocity_loop;
  }
  return false;
}

std::string model_error(const Model<double>& model) {
  const Axis<double>& a = model.axis;
  const bool backlash = model.structure.transmission == Transmission::backlash;
  if (backlash && a.J_m <= 0.0)
    return "J_m must be above zero with backlash: while the teeth are apart, the motor torque acts "
           "on J_m alone";
  return {};
}

}  // namespace axisfit
