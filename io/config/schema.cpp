#include "io/config/schema.h"

#include <fmt/format.h>

#include <array>
#include <string>

#include "base/units.h"
#include "io/config/axis_file.h"
#include "io/config/fleet_file.h"
#include "io/config/job_file.h"
#include "io/config/machine_file.h"
#include "io/config/motion_file.h"

namespace axisfit {
namespace {

using Json = nlohmann::ordered_json;

// A number as the reader takes it: decimal, without a leading zero that may be meant as octal.
constexpr std::string_view kNumber =
    R"( *[+-]?(?:(?:0|[1-9][0-9]*)(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)";
// What follows is a unit, and neither the rest of a number nor part of another spelling of one.
constexpr std::string_view kUnit = R"((?![eE][+-]?[0-9])(?: *[^ 0-9.,_']| +1 */).*)";

/// An option as YAML reads it: 1 is a number, fit a text.
Json scalar(const std::string& text) {
  const Json number = Json::parse(text, nullptr, false);
  return number.is_number() || number.is_boolean() ? number : Json(text);
}

/// Makes a schema of forms, and gathers what is shared between keys.
class SchemaMaker {
 public:
  Json schema(const std::string& title, const Section& keys) {
    Json top{{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", title}};
    top.update(map(keys));
    return top;
  }

  /// Enters the properties of a map in the definitions, for references to "GROUP.NAME".
  void share(const std::string& group, const Section& keys) {
    const Json made = map(keys);
    for (const auto& [name, property] : made["properties"].items())
      definitions_[group + "." + name] = property;
  }

  /// To be called last.
  Json with_definitions(Json top) {
    top["definitions"] = definitions_;
    return top;
  }

  static Json reference(const std::string& name) { return {{"$ref", "#/definitions/" + name}}; }

  Json map(const Section& keys) {
    Json properties = Json::object(), required = Json::array();
    for (const Key& key : keys) {
      properties[key.name] = property(key);
      // What not every axis has cannot be required of every axis.
      if (key.is_required && key.used_by.empty()) required.push_back(key.name);
    }
    Json map{{"type", "object"}, {"properties", properties}, {"additionalProperties", false}};
    if (!required.empty()) map["required"] = required;
    return map;
  }

  Json operator()(const Text&) { return {{"type", Json::array({"string", "number"})}}; }
  Json operator()(const Boolean&) { return {{"type", "boolean"}}; }
  Json operator()(const Integer& integer) {
    Json number{{"type", "integer"}, {"minimum", integer.lower}};
    if (integer.upper != Integer().upper) number["maximum"] = integer.upper;
    return number;
  }
  Json operator()(const NumberWithUnit& amount) {
    if (!is_dimensionless(amount.unit)) return quantity();
    Json number{{"type", "number"}};
    if (amount.lower != -kUnlimited) number["minimum"] = amount.lower;
    if (amount.upper != kUnlimited) number["maximum"] = amount.upper;
    const Json percentage{{"type", "string"},
                          {"pattern", fmt::format("^{} *%? *$", kNumber)},
                          {"errorMessage", "must be a number or a percentage, such as 5 %"}};
    return {{"anyOf", Json::array({number, percentage})}};
  }
  Json operator()(const Bounds& bounds) {
    return {{"type", "array"}, {"items", (*this)(bounds.of)}, {"minItems", 2}, {"maxItems", 2}};
  }
  Json operator()(const Choice& choice) {
    Json values = Json::array(), meanings = Json::array();
    for (const Option& option : choice.options) {
      values.push_back(scalar(option.name));
      meanings.push_back(option.meaning);
    }
    Json made{{"enum", values}};
    if (!choice.options.front().meaning.empty()) made["enumDescriptions"] = meanings;
    return made;
  }
  Json operator()(const Map& of) {
    if (!of.schema_name.empty() && definitions_.contains(of.schema_name))
      return reference(of.schema_name);
    Json made = map(of.keys);
    for (const NamedEntry& entry : of.named)
      made["patternProperties"][entry.pattern] = form(entry.form);
    if (of.min_entries > 0) made["minProperties"] = of.min_entries;
    if (of.nullable) made["type"] = Json::array({"object", "null"});
    if (of.schema_name.empty()) return made;
    definitions_[of.schema_name] = made;
    return reference(of.schema_name);
  }
  Json operator()(const List& list) {
    return {{"type", "array"}, {"items", form(list.of.front())}, {"minItems", 1}};
  }
  Json operator()(const AnyOf& alternatives) {
    Json forms = Json::array();
    for (const Form& one : alternatives.forms) forms.push_back(form(one));
    return {{"anyOf", forms}};
  }

 private:
  Json form(const Form& of) { return std::visit(*this, static_cast<const Form::variant&>(of)); }

  Json quantity() {
    definitions_["quantity"] = {{"type", "string"},
                                {"pattern", fmt::format("^{}{}$", kNumber, kUnit)},
                                {"errorMessage", "must be a number with its unit, such as 146 kg"}};
    return reference("quantity");
  }

  Json property(const Key& key) {
    Json of = form(key.form);
    // In draft-07 nothing counts beside a reference. Type and message are for editors, which else
    // do not know what to put behind the key, or have words of their own for what is wrong.
    if (of.contains("$ref")) {
      const Json& target = referred(of);
      Json beside{{"type", target["type"]}};
      if (target.contains("errorMessage")) beside["errorMessage"] = target["errorMessage"];
      beside["allOf"] = Json::array({of});
      of = beside;
    }
    Json property{{"description", description(key)}};
    if (!key.default_value.empty()) property["default"] = scalar(key.default_value);
    property.update(of);
    return property;
  }

  const Json& referred(const Json& reference) const {
    const std::string target = reference["$ref"];
    return definitions_.at(target.substr(target.rfind('/') + 1));
  }

  /// Without Markdown, which editors show as it is.
  static std::string description(const Key& key) {
    std::string text = meaning_text(key) + ".";
    if (const std::string value = value_text(key.form); value != "map")
      text += fmt::format(" Value: {}.", value);
    text += key.is_required ? " Required." : fmt::format(" Default: {}.", default_description(key));
    if (!key.used_by.empty()) text += fmt::format(" Used by {}.", key.used_by);
    std::erase(text, '`');
    return text;
  }

  Json definitions_ = Json::object();
};

/// A constant that a key has without being given is not demanded.
Json when(const Json& constants, const Json& then, const std::string& may_be_missing = "") {
  Json properties, required = Json::array();
  for (const auto& [key, value] : constants.items()) {
    properties[key] = {{"const", value}};
    if (key != may_be_missing) required.push_back(key);
  }
  return {{"if", {{"properties", properties}, {"required", required}}}, {"then", then}};
}

/// The maps of an axis file whose keys depend on the structure.
constexpr std::array<const char*, 3> kPartsOfStructure{"parameters", "effects", "initial"};

/// What such a part holds on the joint, or has otherwise with another command than a voltage or
/// another gearing than a radius.
std::string group_of(const std::string& part, Vocabulary vocabulary) {
  const std::string unit(unit_on(vocabulary, kCommandUnit));
  return part + "." + joint_name(vocabulary.joint) +
         (vocabulary.command == Command::voltage ? "" : "." + unit) +
         (vocabulary.gearing == Gearing::radius ? "" : ".turns");
}

/// That in whose group the key of a quantity, or of the effect with it, stands.
Vocabulary defining(const QuantityEntry& entry, Vocabulary vocabulary) {
  const auto is_same_in = [&](Vocabulary other) {
    const QuantityEntry& there = quantity_list(other)[entry.index];
    return entry.name == there.name && entry.quantity.unit == there.quantity.unit;
  };
  for (const Vocabulary first :
       {Vocabulary(vocabulary.joint),
        Vocabulary(vocabulary.joint, Command::voltage, nullptr, vocabulary.gearing)})
    if (is_same_in(first)) return first;
  return vocabulary;
}

/// Which keys they have, and must have, in an axis of this structure.
Json parts_of(Structure structure) {
  structure.effects.set();
  structure.channels = kept({{"NAME", "1", 0.0}});
  Json parts = Json::object();
  for (const char* part : kPartsOfStructure)
    parts[part] = {{"properties", Json::object()}, {"additionalProperties", false}};
  const Vocabulary vocabulary = vocabulary_of(structure);
  structure.gearing = Gearing::turns;
  const Vocabulary in_turns = vocabulary_of(structure);
  for (const QuantityEntry& entry : quantity_list(vocabulary)) {
    if (!is_used(entry, structure)) continue;
    const auto add = [&](const std::string& part, const std::string& name) {
      parts[part]["properties"][name] =
          SchemaMaker::reference(group_of(part, defining(entry, vocabulary)) + "." + name);
    };
    const std::string symbol(entry.quantity.symbol);
    if (entry.quantity.symbol != quantity_list(in_turns)[entry.index].quantity.symbol) {
      // Either name will do.
      Json either = Json::array();
      for (const Vocabulary v : {vocabulary, in_turns}) {
        const QuantityEntry& named = quantity_list(v)[entry.index];
        const std::string name(named.quantity.symbol);
        parts["parameters"]["properties"][name] =
            SchemaMaker::reference(group_of("parameters", defining(named, v)) + "." + name);
        either.push_back({{"required", {name}}});
      }
      if (Key::of(entry.quantity).is_required)
        parts["parameters"]["oneOf"] = std::move(either);
      else
        parts["parameters"]["not"] = {{"allOf", std::move(either)}};
    } else if (entry.group.empty()) {
      add("parameters", symbol);
      if (Key::of(entry.quantity).is_required) parts["parameters"]["required"].push_back(symbol);
    } else if (entry.group == "initial") {
      add("initial", symbol);
    } else if (entry.effect) {
      add("effects", entry.group);
    }
  }
  return {{"properties", parts}};
}

}  // namespace

nlohmann::ordered_json job_schema() {
  SchemaMaker maker;
  Json top = maker.schema("axisfit job file", job_keys());
  // Or one of several axes.
  const Json axes = maker.map(axes_job_keys());
  top["properties"].update(axes["properties"]);
  top["anyOf"] = {{{"required", top["required"]}}, {{"required", axes["required"]}}};
  top.erase("required");
  return maker.with_definitions(std::move(top));
}

nlohmann::ordered_json axis_schema() {
  SchemaMaker maker;
  Json top = maker.schema("axisfit axis file", axis_keys(kSourceVocabulary));
  for (const char* part : kPartsOfStructure)
    for (const char* shared : {"properties", "additionalProperties", "required"})
      top["properties"][part].erase(shared);
  for (const char* by_joint : {"instruments", "controller"})
    top["properties"][by_joint] = {{"type", "object"}};
  top["properties"]["drive"] = {{"type", "string"}};
  for (const Vocabulary vocabulary : all_vocabularies())
    for (const char* part : kPartsOfStructure) {
      Section keys = keys_below(axis_keys(vocabulary), part);
      if (vocabulary != Vocabulary(vocabulary.joint))
        std::erase_if(keys, [&](const Key& key) {
          return std::ranges::none_of(quantity_list(vocabulary), [&](const QuantityEntry& entry) {
            return (entry.name == key.name || entry.group == key.name) &&
                   defining(entry, vocabulary) == vocabulary;
          });
        });
      maker.share(group_of(part, vocabulary), keys);
    }
  for (const Joint joint : kJoints) {
    const char* without_joint = joint == Joint::prismatic ? "joint" : "";
    Json whole = maker.map(axis_keys(joint));
    Json of_joint{{"properties", Json::object()}};
    for (const char* by_joint : {"drive", "instruments", "controller"})
      of_joint["properties"][by_joint] = whole["properties"][by_joint];
    top["allOf"].push_back(when({{"joint", joint_name(joint)}}, of_joint, without_joint));
    for (std::size_t drive = 0; drive < kDrives; ++drive)
      for (const Transmission transmission : {Transmission::backlash, Transmission::rigid})
        top["allOf"].push_back(when({{"joint", joint_name(joint)},
                                     {"drive", drive_name(static_cast<Drive>(drive), joint)},
                                     {"transmission", transmission_name(transmission)}},
                                    parts_of({static_cast<Drive>(drive), transmission, {}, joint}),
                                    without_joint));
  }
  return maker.with_definitions(std::move(top));
}

nlohmann::ordered_json machine_schema() {
  SchemaMaker maker;
  return maker.with_definitions(maker.schema("axisfit machine file", machine_keys()));
}

nlohmann::ordered_json fleet_schema() {
  SchemaMaker maker;
  return maker.with_definitions(maker.schema("axisfit fleet file", fleet_keys()));
}

nlohmann::ordered_json motion_schema() {
  SchemaMaker maker;
  Json top = maker.schema("axisfit motion file", motion_keys());
  top.erase("additionalProperties");  // they depend on the type
  for (const std::string& type : std::get<Choice>(find_key(motion_keys(), "type").form).names()) {
    Json then = maker.map(motion_keys(type, kSourceVocabulary));
    for (const Key& key : motion_keys()) then["properties"][key.name] = true;
    top["allOf"].push_back(when({{"type", type}}, then));
  }
  return maker.with_definitions(std::move(top));
}

}  // namespace axisfit
