// An FMU: the library that all have in common, with the axis as its resource and a description of
// the variables.
#include <fmt/format.h>
#include <zip.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "base/embedded.h"
#include "base/version.h"
#include "exports/fmu/axis_text.h"
#include "exports/fmu/axis_unit.h"
#include "exports/scratch_file.h"
#include "exports/targets.h"
#include "exports/xml.h"

// What all FMUs of a version have: the library, its sources and the licence, as an archive.
AXISFIT_EMBEDDED(fmu2_zip)
AXISFIT_EMBEDDED(fmu3_zip)

namespace axisfit {
namespace {

/// What the libraries are called in the archives.
constexpr const char* kIdentifier = "axisfit";

enum class Causality { time, input, output, parameter, start };

struct Variable {
  std::uint32_t reference;
  std::string name, unit, meaning;
  Causality causality;
  double start = 0.0;               ///< of inputs and parameters
  double lower = 0.0, upper = 0.0;  ///< of parameters
};

struct StateInfo {
  std::string_view name, unit, meaning;
};
constexpr std::array<StateInfo, kStates> kStateTable{{
    {"y0", "m", "arm position"},
    {"y1", "m/s", "arm velocity"},
    {"y2", "rad", "motor angle"},
    {"y3", "rad/s", "motor velocity"},
    {"y4", "V", "preamplifier variable"},
    {"y5", "V/s", "preamplifier rate"},
    {"y6", "A", "motor current"},
    {"y7", "U", "what a lagging drive follows"},
    {"y8", "m", "displacement of the elastic mode"},
    {"y9", "m/s", "rate of the elastic mode"},
}};

bool has_state(std::size_t state, const Structure& structure) {
  const auto has_effect = [&](std::string_view name) {
    return structure.effects[effect_named(name).value()];
  };
  if (state < 4) return true;
  if (state < 6) return capabilities(structure).is_electric;
  if (state == 6) return capabilities(structure).has_voltage_loop;
  return has_effect(state == 7 ? "drive_lag" : "elastic_mode");
}

/// A quantity of an instrument that an FMU has: it reads without lag and delay.
bool is_shown(const QuantityEntry& entry, const Structure& structure) {
  if (entry.group == "controller" || !is_used(entry, structure)) return false;
  if (!entry.signal) return true;
  const std::string_view symbol = entry.quantity.symbol;
  return has_signal(*entry.signal, structure) && (symbol == "gain" || symbol == "bias");
}

std::vector<Variable> variables_of(const Model<double>& model) {
  const Structure& structure = model.structure;
  const Vocabulary vocabulary = vocabulary_of(structure);
  const auto unit = [&](std::string_view text) { return std::string(unit_on(vocabulary, text)); };
  const auto words = [&](std::string_view text) { return std::string(words_on(vocabulary, text)); };
  std::vector<Variable> all{{kTimeVariable, "time", "s", "time", Causality::time},
                            {kCommandVariable, "command", unit(kCommandUnit),
                             "command of the drive, held during a step", Causality::input}};
  for (const SignalInfo& entry : kSignalTable) {
    const SignalInfo on = info(entry.signal, vocabulary);
    if (has_signal(entry.signal, structure))
      all.push_back({kSignalVariables + static_cast<std::uint32_t>(index_of(entry.signal)),
                     std::string(on.name), std::string(on.unit), std::string(on.meaning),
                     Causality::output});
  }
  for (std::size_t i = 0; i < kStates; ++i)
    if (has_state(i, structure))
      all.push_back({kStateVariables + static_cast<std::uint32_t>(i),
                     std::string(kStateTable[i].name), unit(kStateTable[i].unit),
                     words(kStateTable[i].meaning), Causality::output});
  if (structure.channels)
    for (std::size_t j = 0; j < structure.channels->size(); ++j) {
      const Channel& channel = (*structure.channels)[j];
      const bool is_taken = std::ranges::find(all, channel.name, &Variable::name) != all.end();
      all.push_back({kChannelVariables + static_cast<std::uint32_t>(j),
                     (is_taken ? "channel_" : "") + channel.name, channel.unit,
                     "channel, held during a step", Causality::input, channel.zero});
    }
  Model<double> copy = model;
  const std::vector<double*> values = members(copy);
  for (const QuantityEntry& entry : quantity_list(vocabulary))
    if (is_shown(entry, structure))
      all.push_back({kQuantityVariables + static_cast<std::uint32_t>(entry.index), entry.name,
                     std::string(entry.quantity.unit), std::string(entry.quantity.meaning),
                     entry.group == "initial" ? Causality::start : Causality::parameter,
                     *values[entry.index], entry.quantity.lower, entry.quantity.upper});
  return all;
}

/// Powers of kg, m, s, A, rad.
using Dimension = std::array<int, 5>;
constexpr std::array<const char*, 5> kBase{"kg", "m", "s", "A", "rad"};

/// Of a product like "N s/m"; none where a factor is not known.
std::optional<Dimension> dimension_of(std::string_view unit) {
  static const std::map<std::string_view, Dimension> kUnits{
      {"1", {}},
      {"kg", {1, 0, 0, 0, 0}},
      {"m", {0, 1, 0, 0, 0}},
      {"s", {0, 0, 1, 0, 0}},
      {"A", {0, 0, 0, 1, 0}},
      {"rad", {0, 0, 0, 0, 1}},
      {"Hz", {0, 0, -1, 0, 0}},
      {"N", {1, 1, -2, 0, 0}},
      {"V", {1, 2, -3, -1, 0}},
      {"ohm", {1, 2, -3, -2, 0}},
      {"H", {1, 2, -2, -2, 0}},
  };
  Dimension total{};
  int sign = 1;
  while (!unit.empty()) {
    const std::size_t end = std::min(unit.find_first_of(" /"), unit.size());
    std::string_view factor = unit.substr(0, end);
    int power = sign;
    if (const std::size_t caret = factor.find('^'); caret != std::string_view::npos) {
      power *= factor.at(caret + 1) - '0';
      factor = factor.substr(0, caret);
    }
    const auto found = kUnits.find(factor);
    if (found == kUnits.end()) return std::nullopt;
    for (std::size_t i = 0; i < total.size(); ++i) total[i] += power * found->second[i];
    if (end < unit.size() && unit[end] == '/') sign = -1;
    unit.remove_prefix(std::min(end + 1, unit.size()));
  }
  return total;
}

void add_units(pugi::xml_node description, const std::vector<Variable>& variables) {
  std::map<std::string, std::optional<Dimension>> units;
  for (const Variable& v : variables) units.emplace(v.unit, dimension_of(v.unit));
  auto definitions = child(description, "UnitDefinitions");
  for (const auto& [name, dimension] : units) {
    auto unit = child(definitions, "Unit", {{"name", name}});
    if (!dimension) continue;
    auto base = child(unit, "BaseUnit");
    for (std::size_t i = 0; i < dimension->size(); ++i)
      if ((*dimension)[i] != 0) base.append_attribute(kBase[i]) = (*dimension)[i];
  }
}

/// The attributes that both versions call alike.
void describe(pugi::xml_node scalar, pugi::xml_node real, const Variable& v) {
  const auto put = [&](const char* key, const char* value) {
    scalar.append_attribute(key) = value;
  };
  scalar.append_attribute("name") = v.name.c_str();
  scalar.append_attribute("valueReference") = v.reference;
  scalar.append_attribute("description") = v.meaning.c_str();
  const auto put_number = [&](const char* key, double value) {
    real.append_attribute(key) = number(value).c_str();
  };
  switch (v.causality) {
    case Causality::time:
      put("causality", "independent");
      put("variability", "continuous");
      break;
    case Causality::input:
      put("causality", "input");
      put("variability", "continuous");
      put_number("start", v.start);
      break;
    case Causality::output:
      put("causality", "output");
      put("variability", "continuous");
      put("initial", "calculated");
      break;
    case Causality::parameter:
    case Causality::start:
      put("causality", "parameter");
      put("variability", v.causality == Causality::start ? "fixed" : "tunable");
      put("initial", "exact");
      put_number("min", v.lower);
      put_number("max", v.upper);
      put_number("start", v.start);
      break;
  }
  real.append_attribute("unit") = v.unit.c_str();
}

struct Names {
  std::string model, token, origin;
  std::vector<std::string> lost;
};

pugi::xml_node add_root(pugi::xml_document& document, const char* standard, const char* token,
                        const Names& names) {
  auto declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "UTF-8";
  add_comments(document, names.origin, names.lost);
  return child(document, "fmiModelDescription",
               {{"fmiVersion", standard},
                {"modelName", names.model},
                {token, names.token},
                {"description", "a fitted axis"},
                {"license", "Apache-2.0, see documentation/licenses"},
                {"generationTool", std::string("axisfit ") + version()},
                {"variableNamingConvention", "flat"}});
}

constexpr std::array kSourceFiles{"base/linear_algebra.cpp",   "exports/fmu/axis_text.cpp",
                                  "exports/fmu/axis_unit.cpp", "exports/fmu/instance.cpp",
                                  "exports/fmu/fmi2.cpp",      "exports/fmu/fmi3.cpp",
                                  "sim/command.cpp",           "sim/model.cpp",
                                  "sim/propagator.cpp",        "sim/vocabulary.cpp"};

std::string description_2(const std::vector<Variable>& variables, const Names& names) {
  pugi::xml_document document;
  auto root = add_root(document, "2.0", "guid", names);
  auto unit = child(root, "CoSimulation",
                    {{"modelIdentifier", kIdentifier},
                     {"canHandleVariableCommunicationStepSize", "true"},
                     {"canNotUseMemoryManagementFunctions", "true"},
                     {"canGetAndSetFMUstate", "true"},
                     {"canSerializeFMUstate", "true"}});
  auto sources = child(unit, "SourceFiles");
  for (const char* file : kSourceFiles) child(sources, "File", {{"name", file}});
  add_units(root, variables);
  child(child(root, "LogCategories"), "Category", {{"name", "logStatusError"}});
  child(root, "DefaultExperiment", {{"startTime", "0"}, {"stepSize", "0.001"}});
  auto list = child(root, "ModelVariables");
  for (const Variable& v : variables) {
    auto scalar = child(list, "ScalarVariable");
    describe(scalar, child(scalar, "Real"), v);
  }
  auto structure = child(root, "ModelStructure");
  auto outputs = child(structure, "Outputs"), unknowns = child(structure, "InitialUnknowns");
  for (std::size_t i = 0; i < variables.size(); ++i)
    if (variables[i].causality == Causality::output)
      for (auto parent : {outputs, unknowns})
        child(parent, "Unknown", {{"index", std::to_string(i + 1)}});
  return xml_text(document);
}

std::string description_3(const std::vector<Variable>& variables, const Names& names) {
  pugi::xml_document document;
  auto root = add_root(document, "3.0", "instantiationToken", names);
  child(root, "CoSimulation",
        {{"modelIdentifier", kIdentifier},
         {"canGetAndSetFMUState", "true"},
         {"canSerializeFMUState", "true"},
         {"canHandleVariableCommunicationStepSize", "true"}});
  add_units(root, variables);
  child(child(root, "LogCategories"), "Category", {{"name", "logStatusError"}});
  child(root, "DefaultExperiment", {{"startTime", "0"}, {"stepSize", "0.001"}});
  auto list = child(root, "ModelVariables");
  for (const Variable& v : variables) {
    auto real = child(list, "Float64");
    describe(real, real, v);
  }
  auto structure = child(root, "ModelStructure");
  for (const char* kind : {"Output", "InitialUnknown"})
    for (const Variable& v : variables)
      if (v.causality == Causality::output)
        child(structure, kind, {{"valueReference", std::to_string(v.reference)}});
  return xml_text(document);
}

/// How other platforms build the library.
std::string build_description() {
  pugi::xml_document document;
  auto root = child(document, "fmiBuildDescription", {{"fmiVersion", "3.0"}});
  auto build = child(root, "BuildConfiguration", {{"modelIdentifier", kIdentifier}});
  auto files = child(build, "SourceFileSet", {{"language", "C++20"}});
  for (const char* file : kSourceFiles) child(files, "SourceFile", {{"name", file}});
  child(files, "IncludeDirectory", {{"name", "."}});
  child(build, "Library",
        {{"name", "Eigen"},
         {"version", "3.4"},
         {"external", "true"},
         {"description", "headers only"}});
  return xml_text(document);
}

/// An archive with further files, the same to the byte at any time.
std::string archive_with(std::string_view archive, const Files& files) {
  const ScratchFile scratch;
  scratch.write(archive);
  zipFile zip = zipOpen64(scratch.path().c_str(), APPEND_STATUS_ADDINZIP);
  bool done = zip != nullptr;
  for (const auto& [name, contents] : files) {
    zip_fileinfo info{};
    info.tmz_date.tm_year = 1980;
    info.tmz_date.tm_mday = 1;
    done = done &&
           zipOpenNewFileInZip64(zip, name.c_str(), &info, nullptr, 0, nullptr, 0, nullptr,
                                 Z_DEFLATED, Z_DEFAULT_COMPRESSION, 0) == ZIP_OK &&
           zipWriteInFileInZip(zip, contents.data(), static_cast<unsigned>(contents.size())) ==
               ZIP_OK &&
           zipCloseFileInZip(zip) == ZIP_OK;
  }
  if (zip == nullptr || zipClose(zip, nullptr) != ZIP_OK || !done)
    throw std::runtime_error("the FMU cannot be put together");
  return scratch.read();
}

/// As a GUID.
std::string token_of(const std::string& text) {
  const XXH128_hash_t hash = XXH3_128bits(text.data(), text.size());
  const std::string hex = fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
  return fmt::format("{{{}-{}-{}-{}-{}}}", hex.substr(0, 8), hex.substr(8, 4), hex.substr(12, 4),
                     hex.substr(16, 4), hex.substr(20));
}

}  // namespace

Export fmu(const Rig& rig, FmiVersion version, const std::string& name, const std::string& origin) {
  Export made = stepped(rig);
  const Model<double>& model = made.carried.model;
  if (const std::string error = model_error(model); !error.empty()) throw std::runtime_error(error);
  const std::string axis = axis_text(model);
  const std::vector<Variable> variables = variables_of(model);
  const Names names{rig.name.empty() ? name : rig.name, token_of(axis + origin), origin, made.lost};
  Files files{{"resources/axis.txt", names.token + "\n" + axis}};
  std::string_view archive;
  if (version == FmiVersion::v2) {
    archive = embedded_fmu2_zip();
    files.emplace_back("modelDescription.xml", description_2(variables, names));
  } else {
    archive = embedded_fmu3_zip();
    files.emplace_back("modelDescription.xml", description_3(variables, names));
    files.emplace_back("sources/buildDescription.xml", build_description());
  }
  made.files = {{name + ".fmu", archive_with(archive, files)}};
  return made;
}

}  // namespace axisfit
