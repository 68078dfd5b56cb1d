#include "io/config/axis_uncertainty.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "io/config/axis_file.h"

namespace axisfit {
namespace {

constexpr double kMost = 1e12;

Section parameter_keys() {
  return {Key::required("name", Text{}, "the quantity that was estimated"),
          Key::required("scale",
                        Choice{{{"linear", "errors are in the quantity's SI unit"},
                                {"logarithmic", "they are relative"}}},
                        "of its errors"),
          Key::required("error", NumberWithUnit{"1", 0.0, kMost}, "standard error of the estimate"),
          Key::optional("scatter", NumberWithUnit{"1", 0.0, kMost}, 0.0,
                        "standard deviation of a further recording's about the estimate, beyond"),
          Key::optional("freedom", NumberWithUnit{"1", 1.0, kMost}, 1.0,
                        "degrees of freedom of the scatter")};
}

Section missing_force_keys(Vocabulary vocabulary) {
  const NumberWithUnit force{std::string(unit_on(vocabulary, "N")), 0.0, kMost};
  return {Key::required("interval", NumberWithUnit{"s", 1e-6, 1e3},
                        "from one value of the process to the next"),
          Key::required("deviation", force, "its standard deviation"),
          Key::required("innovation", force, "that of what is new in each value"),
          Key::optional("coefficients", List{{NumberWithUnit{"1", -kMost, kMost}}},
                        DefaultText{"none"}, "of the last value, the one before, ...")};
}

Section section_keys(Vocabulary vocabulary) {
  return {Key::optional("parameters", List{{Map{parameter_keys()}}}, DefaultText{"none"},
                        "what was estimated"),
          Key::optional("correlation", List{{List{{NumberWithUnit{"1", -1.0, 1.0}}}}},
                        DefaultText{"none"}, "of their errors, a row for each"),
          Key::optional(
              "missing_force", Map{missing_force_keys(vocabulary)}, DefaultText{"none"},
              std::string(words_on(vocabulary, "the force that the model lacks, as a process")))};
}

std::optional<UncertainQuantity> read_quantity(const ConfigNode& node, const Section& keys,
                                               const Structure& structure) {
  UncertainQuantity q;
  ConfigMap map(node, keys);
  std::string name;
  const auto named = map.read("name", name);
  int scale = 0;
  map.read("scale", scale);
  map.read("error", q.error);
  map.read("scatter", q.scatter);
  map.read("freedom", q.freedom);
  if (!map.finish() || !named || name.empty()) return std::nullopt;
  const QuantityEntry* entry = quantity_named(*named, structure);
  if (entry == nullptr) return std::nullopt;
  q.logarithmic = scale == 1;
  q.quantity = entry->index;
  return q;
}

std::vector<double> read_numbers(const ConfigNode& node, double lower, double upper) {
  std::vector<double> numbers;
  if (const auto entries = node.as_sequence())
    for (const ConfigNode& entry : *entries)
      numbers.push_back(entry.as_number(lower, upper).value_or(0.0));
  return numbers;
}

}  // namespace

Key axis_uncertainty_key(Vocabulary vocabulary) {
  return Key::optional("uncertainty", Map{section_keys(vocabulary)}, DefaultText{"not known"},
                       "what a fit leaves open; `simulate-axis --band` needs it");
}

std::optional<AxisUncertainty> read_axis_uncertainty(const ConfigNode& node,
                                                     const Structure& structure) {
  AxisUncertainty found;
  const Section& keys = keys_below(axis_keys(vocabulary_of(structure)), "uncertainty");
  ConfigMap map(node, keys);
  std::size_t n = 0;
  if (const auto parameters = map.optional("parameters"))
    if (const auto entries = parameters->as_sequence()) {
      const Section of_parameter = parameter_keys();
      n = entries->size();
      for (const ConfigNode& entry : *entries)
        if (const auto q = read_quantity(entry, of_parameter, structure))
          found.quantities.push_back(*q);
    }
  if (const auto correlation = map.optional("correlation")) {
    bool is_square = false;
    if (const auto rows = correlation->as_sequence()) {
      is_square = rows->size() == n;
      for (const ConfigNode& row : *rows) {
        const std::vector<double> numbers = read_numbers(row, -1.0, 1.0);
        is_square = is_square && numbers.size() == n;
        found.correlation.insert(found.correlation.end(), numbers.begin(), numbers.end());
      }
    }
    if (!is_square)
      correlation->error(
          fmt::format("correlation must have {0} rows of {0} numbers, one for each "
                      "of the parameters",
                      n));
  } else {
    found.correlation.assign(n * n, 0.0);
    for (std::size_t i = 0; i < n; ++i) found.correlation[i * n + i] = 1.0;
  }
  if (const auto force = map.optional("missing_force")) {
    MissingForceProcess& process = found.missing_force.emplace();
    ConfigMap of_force(*force, keys_below(keys, "missing_force"));
    of_force.read("interval", process.interval);
    of_force.read("deviation", process.deviation);
    of_force.read("innovation", process.innovation);
    if (const auto coefficients = of_force.optional("coefficients"))
      process.coefficients = read_numbers(*coefficients, -kMost, kMost);
    of_force.finish();
  }
  if (!map.finish()) return std::nullopt;
  return found;
}

void write_axis_uncertainty(YAML::Emitter& out, const AxisUncertainty& uncertainty,
                            Vocabulary vocabulary) {
  const auto number = [](double x) { return fmt::format("{:.6g}", x); };
  const auto entry = [&](const char* key, const std::string& value) {
    out << YAML::Key << key << YAML::Value << value;
  };
  const auto row = [&](auto begin, auto end) {
    out << YAML::Flow << YAML::BeginSeq;
    for (; begin != end; ++begin) out << number(*begin);
    out << YAML::EndSeq;
  };
  out << YAML::Key << "uncertainty" << YAML::Value << YAML::BeginMap;
  const std::vector<QuantityEntry>& list = quantity_list(vocabulary);
  if (const auto n = static_cast<std::ptrdiff_t>(uncertainty.quantities.size()); n > 0) {
    out << YAML::Key << "parameters" << YAML::Value << YAML::BeginSeq;
    for (const UncertainQuantity& q : uncertainty.quantities) {
      out << YAML::Flow << YAML::BeginMap;
      entry("name", list[q.quantity].name);
      entry("scale", q.logarithmic ? "logarithmic" : "linear");
      entry("error", number(q.error));
      if (q.scatter > 0.0) {
        entry("scatter", number(q.scatter));
        entry("freedom", number(q.freedom));
      }
      out << YAML::EndMap;
    }
    out << YAML::EndSeq << YAML::Key << "correlation" << YAML::Value << YAML::BeginSeq;
    for (std::ptrdiff_t i = 0; i < n; ++i)
      row(uncertainty.correlation.begin() + i * n, uncertainty.correlation.begin() + (i + 1) * n);
    out << YAML::EndSeq;
  }
  if (uncertainty.missing_force) {
    const MissingForceProcess& process = *uncertainty.missing_force;
    const std::string_view unit = unit_on(vocabulary, "N");
    out << YAML::Key << "missing_force" << YAML::Value << YAML::BeginMap;
    entry("interval", with_unit(process.interval, "s"));
    entry("deviation", with_unit(process.deviation, unit));
    entry("innovation", with_unit(process.innovation, unit));
    if (!process.coefficients.empty()) {
      out << YAML::Key << "coefficients" << YAML::Value;
      row(process.coefficients.begin(), process.coefficients.end());
    }
    out << YAML::EndMap;
  }
  out << YAML::EndMap;
}

}  // namespace axisfit
