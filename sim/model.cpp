#include "sim/model.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "sim/controller.h"

namespace axisfit {

namespace {

std::vector<QuantityEntry> make_list(Vocabulary vocabulary) {
  std::vector<QuantityEntry> entries;
  const Model<double> model;
  visit_quantities(model, [&](std::string_view group, const Quantity& quantity, double) {
    const std::string_view group_on = words_on(vocabulary, group);
    const Quantity on = quantity_on(vocabulary, quantity);
    entries.push_back({full_name(group_on, on), std::string(group_on), on, entries.size(),
                       effect_named(group), signal_by_name(group, kSourceVocabulary)});
  });
  return entries;
}

}  // namespace

const std::vector<QuantityEntry>& quantity_list(Vocabulary vocabulary) {
  static const auto lists = for_all_vocabularies(make_list);
  if (vocabulary.channels == nullptr) return lists[index_of(vocabulary)];
  static PerVocabulary<std::vector<QuantityEntry>> with_channels;
  return with_channels.of(vocabulary, make_list);
}

const std::vector<QuantityEntry>& quantity_list() { return quantity_list(kSourceVocabulary); }

const QuantityEntry* find_quantity(std::string_view name, Vocabulary vocabulary) {
  const auto& list = quantity_list(vocabulary);
  const auto found = std::ranges::find(list, name, &QuantityEntry::name);
  return found == list.end() ? nullptr : &*found;
}

std::size_t quantity_index(std::string_view name) {
  const QuantityEntry* entry = find_quantity(name, kSourceVocabulary);
  if (entry == nullptr) throw std::logic_error("no quantity '" + std::string(name) + "'");
  return entry->index;
}

bool is_used(UsedBy used_by, const Structure& structure) {
  const Capabilities& has = capabilities(structure);
  switch (used_by) {
    case UsedBy::every_axis:
      return true;
    case UsedBy::velocity_loop:
      return has.has_voltage_loop;
    case UsedBy::electric_drive:
      return has.is_electric;
    case UsedBy::force_source:
      return has.is_force_driven;
    case UsedBy::motor_constant:
      return has.has_current();
    case UsedBy::armature:
      return has.has_voltage_loop || has.has_back_emf;
    case UsedBy::controller:
      return structure.closed_loop;
    case UsedBy::backlash:
      return has.has_backlash;
    case UsedBy::rigid:
      return !has.has_backlash;
    case UsedBy::motor:
      return has.has_motor;
  }
  return true;
}

bool is_used(const QuantityEntry& entry, const Structure& structure) {
  if (entry.effect && !structure.effects[*entry.effect]) return false;
  if (const auto channel = entry.quantity.channel;
      channel && (structure.channels == nullptr || *channel >= structure.channels->size()))
    return false;
  return is_used(entry.quantity.used_by, structure);
}

bool has_signal(Signal signal, const Structure& structure) {
  switch (signal) {
    case Signal::position:
    case Signal::velocity:
    case Signal::acceleration:
    case Signal::load_position:
      return true;
    case Signal::tachometer:
    case Signal::preamplifier_voltage:
      return capabilities(structure).is_electric;
    case Signal::motor_current:
    case Signal::drive_force:
      return capabilities(structure).has_current();
    case Signal::motor_voltage:
      return capabilities(structure).has_voltage_loop;
  }
  return false;
}

void normalize(Model<double>& model) {
  const std::vector<double*> member = members(model);
  for (const QuantityEntry& entry : quantity_list()) {
    const bool of_axis = entry.group.empty() || entry.group == "initial";
    if (of_axis && !is_used(entry, model.structure))
      *member[entry.index] = entry.quantity.symbol == "r_g" ? 1.0 : 0.0;
  }
}

std::string model_error(const Model<double>& model) {
  const Axis<double>& a = model.axis;
  if (capabilities(model.structure).has_backlash && a.J_m <= 0.0)
    return "J_m must be above zero with backlash: while the teeth are apart, the motor torque acts "
           "on J_m alone";
  if (model.structure.closed_loop &&
      whole_periods(model.controller.timing, a.T_d).first > kMostPeriodsLate)
    return "T_d must be below " + std::to_string(kMostPeriodsLate + 1) +
           " periods of the controller's commands, whose loop is simulated";
  return {};
}

}  // namespace axisfit
