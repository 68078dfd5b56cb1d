// Exported FMUs, loaded and run by what a tool would use of the standard.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <unzip.h>

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <iostream>
#include <map>
#include <memory>
#include <pugixml.hpp>
#include <set>
#include <variant>

#include "base/units.h"
#include "exports/export.h"
#include "exports/fmu/fmi2.h"
#include "exports/fmu/fmi3.h"
#include "tests/apps/files.h"
#include "tests/exports/axes.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;

/// The files of an archive, in a folder.
void unpack(const std::string& archive, const fs::path& folder) {
  unzFile zip = unzOpen64(archive.c_str());
  ASSERT_NE(zip, nullptr);
  for (int more = unzGoToFirstFile(zip); more == UNZ_OK; more = unzGoToNextFile(zip)) {
    std::array<char, 1000> name{};
    unz_file_info64 entry{};
    ASSERT_EQ(
        unzGetCurrentFileInfo64(zip, &entry, name.data(), name.size(), nullptr, 0, nullptr, 0),
        UNZ_OK);
    std::string contents(entry.uncompressed_size, '\0');
    ASSERT_EQ(unzOpenCurrentFile(zip), UNZ_OK);
    ASSERT_EQ(unzReadCurrentFile(zip, contents.data(), static_cast<unsigned>(contents.size())),
              static_cast<int>(contents.size()));
    ASSERT_EQ(unzCloseCurrentFile(zip), UNZ_OK);
    const fs::path path = folder / name.data();
    fs::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << contents;
  }
  unzClose(zip);
}

/// An exported and unpacked FMU of either version, which calls its functions.
class Fmu {
 public:
  Fmu(const Rig& rig, int version) : version_(version) {
    const Export made = export_axis(rig, version == 2 ? ExportTarget::fmu2 : ExportTarget::fmu3,
                                    "a b", "By a test");
    EXPECT_EQ(made.files.size(), 1u);
    EXPECT_EQ(made.files.front().first, "a b.fmu");
    lost = made.lost;
    // With a blank in its name, which URIs write as %20.
    root = fs::path(folder_.path()) / "un packed";
    unpack(folder_.write("a.fmu", made.files.front().second), root);
    EXPECT_TRUE(description.load_file((root / "modelDescription.xml").c_str()));
    for (const auto& variable : model().child("ModelVariables").children())
      references_[variable.attribute("name").value()] =
          variable.attribute("valueReference").as_uint();
    library = root / "binaries" / (version == 2 ? "linux64" : "x86_64-linux") / "axisfit.so";
    handle_ = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
    EXPECT_NE(handle_, nullptr) << dlerror();
    token = model().attribute(version == 2 ? "guid" : "instantiationToken").value();
  }
  ~Fmu() {
    if (handle_ != nullptr) dlclose(handle_);
  }
  Fmu(const Fmu&) = delete;
  Fmu& operator=(const Fmu&) = delete;

  template <class Function>
  Function* function(const std::string& name) const {
    void* found = dlsym(handle_, name.c_str());
    if (found == nullptr) throw std::runtime_error("no function " + name);
    return reinterpret_cast<Function*>(found);
  }
  pugi::xml_node model() const { return description.child("fmiModelDescription"); }
  unsigned reference(const std::string& name) const {
    const auto found = references_.find(name);
    if (found == references_.end()) throw std::runtime_error("no variable " + name);
    return found->second;
  }
  int version() const { return version_; }

  pugi::xml_document description;
  fs::path root, library;
  std::string token;
  std::vector<std::string> lost;

 private:
  int version_;
  TempFolder folder_;
  void* handle_ = nullptr;
  std::map<std::string, unsigned> references_;
};

/// One instance of it.
class Instance {
 public:
  explicit Instance(const Fmu& fmu) : Instance(fmu, fmu.token) {}
  Instance(const Fmu& fmu, const std::string& token) : fmu_(fmu) {
    if (is_2()) {
      std::string uri = "file://" + (fmu.root / "resources").string();
      uri.replace(uri.find(' '), 1, "%20");
      functions_ = {&log_2, nullptr, nullptr, nullptr, this};
      instance_ =
          fmu_.function<fmi2Component(fmi2String, fmi2Type, fmi2String, fmi2String,
                                      const fmi2CallbackFunctions*, int, int)>("fmi2Instantiate")(
              "one", fmi2CoSimulation, token.c_str(), uri.c_str(), &functions_, 0, 1);
    } else {
      instance_ = fmu_.function<fmi3Instance(
          fmi3String, fmi3String, fmi3String, bool, bool, bool, bool, const fmi3ValueReference*,
          std::size_t, void*, fmi3LogMessageCallback, fmi3IntermediateUpdateCallback)>(
          "fmi3InstantiateCoSimulation")("one", token.c_str(), (fmu.root / "resources").c_str(),
                                         false, true, false, false, nullptr, 0, this, &log_3,
                                         nullptr);
    }
  }
  ~Instance() {
    if (instance_ != nullptr) call_free("FreeInstance");
  }
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  bool exists() const { return instance_ != nullptr; }
  void start(double time = 0.0) {
    if (is_2()) {
      EXPECT_EQ((fmu_.function<int(void*, int, double, double, int, double)>("fmi2SetupExperiment")(
                    instance_, 0, 0.0, time, 0, 0.0)),
                0);
      EXPECT_EQ(plain("EnterInitializationMode"), 0);
    } else {
      EXPECT_EQ((fmu_.function<int(void*, bool, double, double, bool, double)>(
                    "fmi3EnterInitializationMode")(instance_, false, 0.0, time, false, 0.0)),
                0);
    }
    EXPECT_EQ(plain("ExitInitializationMode"), 0);
  }
  /// Functions of nothing but an instance: the status.
  int plain(const std::string& name) const {
    return fmu_.function<int(void*)>(prefix() + name)(instance_);
  }
  int try_set(const std::string& name, double value) {
    const unsigned reference = fmu_.reference(name);
    return is_2() ? fmu_.function<int(void*, const unsigned*, std::size_t, const double*)>(
                        "fmi2SetReal")(instance_, &reference, 1, &value)
                  : fmu_.function<int(void*, const unsigned*, std::size_t, const double*,
                                      std::size_t)>("fmi3SetFloat64")(instance_, &reference, 1,
                                                                      &value, 1);
  }
  void set(const std::string& name, double value) { EXPECT_EQ(try_set(name, value), 0) << said; }
  int try_get(unsigned reference, double& value) const {
    return is_2() ? fmu_.function<int(void*, const unsigned*, std::size_t, double*)>("fmi2GetReal")(
                        instance_, &reference, 1, &value)
                  : fmu_.function<int(void*, const unsigned*, std::size_t, double*, std::size_t)>(
                        "fmi3GetFloat64")(instance_, &reference, 1, &value, 1);
  }
  double get(const std::string& name) const {
    double value = std::nan("");
    EXPECT_EQ(try_get(fmu_.reference(name), value), 0) << name << ' ' << said;
    return value;
  }
  int try_step(double time, double length) {
    if (is_2())
      return fmu_.function<int(void*, double, double, int)>("fmi2DoStep")(instance_, time, length,
                                                                          1);
    bool event = true, terminate = true, early = true;
    double last = 0.0;
    const int status =
        fmu_.function<int(void*, double, double, bool, bool*, bool*, bool*, double*)>("fmi3DoStep")(
            instance_, time, length, true, &event, &terminate, &early, &last);
    if (status == 0) {
      EXPECT_FALSE(event || terminate || early);
      EXPECT_EQ(last, time + length);
    }
    return status;
  }
  void step(double time, double length) { EXPECT_EQ(try_step(time, length), 0) << said; }

  void take(void*& state) {
    EXPECT_EQ(fmu_.function<int(void*, void**)>(prefix() + state_name("Get"))(instance_, &state),
              0);
  }
  void restore(void* state) {
    EXPECT_EQ(fmu_.function<int(void*, void*)>(prefix() + state_name("Set"))(instance_, state), 0);
  }
  void free(void*& state) {
    EXPECT_EQ(fmu_.function<int(void*, void**)>(prefix() + state_name("Free"))(instance_, &state),
              0);
    EXPECT_EQ(state, nullptr);
  }
  std::string bytes_of(void* state) {
    std::size_t size = 0;
    const std::string stem = is_2() ? "FMUstate" : "FMUState";
    EXPECT_EQ((fmu_.function<int(void*, void*, std::size_t*)>(prefix() + "Serialized" + stem +
                                                              "Size")(instance_, state, &size)),
              0);
    std::string bytes(size, '\0');
    const auto write =
        fmu_.function<int(void*, void*, char*, std::size_t)>(prefix() + "Serialize" + stem);
    EXPECT_NE(write(instance_, state, bytes.data(), size - 1), 0);
    EXPECT_EQ(write(instance_, state, bytes.data(), size), 0);
    return bytes;
  }
  int try_read(const std::string& bytes, void*& state) {
    return fmu_.function<int(void*, const char*, std::size_t, void**)>(
        is_2() ? "fmi2DeSerializeFMUstate" : "fmi3DeserializeFMUState")(instance_, bytes.data(),
                                                                        bytes.size(), &state);
  }

  std::string said;  ///< the last message

 private:
  bool is_2() const { return fmu_.version() == 2; }
  std::string prefix() const { return is_2() ? "fmi2" : "fmi3"; }
  std::string state_name(const std::string& verb) const {
    return verb + (is_2() ? "FMUstate" : "FMUState");
  }
  void call_free(const std::string& name) {
    fmu_.function<void(void*)>(prefix() + name)(instance_);
  }
  static void log_2(void* self, fmi2String instance, fmi2Status, fmi2String, fmi2String message,
                    ...) {
    EXPECT_EQ(std::string(instance), "one");
    std::va_list arguments;
    va_start(arguments, message);
    std::array<char, 1000> text{};
    std::vsnprintf(text.data(), text.size(), message, arguments);
    va_end(arguments);
    static_cast<Instance*>(self)->said = text.data();
  }
  static void log_3(void* self, fmi3Status, fmi3String, fmi3String message) {
    static_cast<Instance*>(self)->said = message;
  }

  const Fmu& fmu_;
  fmi2CallbackFunctions functions_{};
  void* instance_ = nullptr;
};

/// Largest difference of any signal per its range, between an FMU that is stepped so and our
/// simulation.
double worst_difference(const Rig& rig, int version, double step) {
  const Structure& structure = rig.model.structure;
  constexpr double kDuration = 1.2;
  const auto command_at = [](double t) {
    const int level = static_cast<int>(std::lround(std::floor(t / 0.04 + 1e-6)));
    return level % 9 >= 7 ? 0.0 : 6.0 * std::sin(1.0 + 0.9 * level);
  };
  std::vector<double> times{0.0};
  Schedule commands;
  for (std::size_t k = 1; times.back() < kDuration - 1e-9; ++k) {
    const double now = times.back(), u = command_at(now);
    if (commands.values.empty() || commands.values[commands.values.size() - 1] != u)
      commands.append(now, u);
    times.push_back(step > 0.0 ? static_cast<double>(k) * step
                               : now + 1e-3 * (1.0 + static_cast<double>(k % 7) / 3.0));
  }
  std::vector<Signal> signals;
  for (const SignalInfo& entry : kSignalTable)
    if (has_signal(entry.signal, structure)) signals.push_back(entry.signal);
  std::vector<std::vector<double>> ours(signals.size()), theirs = ours;
  const auto result = simulate<double>(
      rig.model, commands, times, [&](std::size_t, const Integrator<double>& axis) {
        for (std::size_t s = 0; s < signals.size(); ++s)
          ours[s].push_back(
              reading(axis.equations(), signals[s], axis.mode(), axis.state(), axis.input()));
      });
  EXPECT_TRUE(result.finished);
  const Fmu fmu(rig, version);
  EXPECT_TRUE(fmu.lost.empty());
  Instance instance(fmu);
  EXPECT_TRUE(instance.exists()) << instance.said;
  instance.start();
  for (std::size_t k = 0; k < times.size(); ++k) {
    for (std::size_t s = 0; s < signals.size(); ++s)
      theirs[s].push_back(
          instance.get(std::string(info(signals[s], vocabulary_of(structure)).name)));
    if (k + 1 == times.size()) break;
    instance.set("command", command_at(times[k]));
    instance.step(times[k], times[k + 1] - times[k]);
  }
  double worst = 0.0;
  for (std::size_t s = 0; s < signals.size(); ++s) {
    const auto [low, high] = std::ranges::minmax(ours[s]);
    EXPECT_GT(high, low);
    for (std::size_t k = 0; k < times.size(); ++k)
      worst = std::max(worst, std::abs(theirs[s][k] - ours[s][k]) / (high - low));
  }
  return worst;
}

TEST(Fmu, MovesAsOurSimulationAtAnySteps) {
  for (const auto& [name, rig] : axes()) {
    double worst = 0.0;
    for (const double step : {1e-4, 1e-3, 1e-2, 0.0}) {
      const int version = step == 1e-3 ? 3 : 2;
      const double found = worst_difference(rig, version, step);
      EXPECT_LT(found, 1e-9) << name << ", steps of " << step << " s";
      worst = std::max(worst, found);
    }
    std::cout << name << ": " << worst << '\n';
  }
}

class FmuOfVersion : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Both, FmuOfVersion, ::testing::Values(2, 3));

/// Steps through a second and returns what the signals read.
std::vector<double> readings(Instance& instance, double from, double to) {
  std::vector<double> all;
  for (int k = static_cast<int>(std::lround(from / 5e-3)); k < std::lround(to / 5e-3); ++k) {
    instance.set("command", 5.0 * std::sin(0.1 * k));
    instance.step(5e-3 * k, 5e-3);
    for (const char* name : {"position", "velocity", "acceleration", "V_m", "y6"})
      all.push_back(instance.get(name));
  }
  return all;
}

/// Not to the digit: lengths of steps that recur are computed another way than new ones.
void expect_near(const std::vector<double>& found, const std::vector<double>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found[i], expected[i], 1e-11 * (1.0 + std::abs(expected[i]))) << i;
}

TEST_P(FmuOfVersion, StatesCanBeTakenAndGoneBackTo) {
  const Fmu fmu(axes().at("late and elastic"), GetParam());
  Instance instance(fmu), other(fmu);
  instance.start();
  readings(instance, 0.0, 0.3);
  void* state = nullptr;
  instance.take(state);
  const std::vector<double> first = readings(instance, 0.3, 0.6);
  instance.restore(state);
  expect_near(readings(instance, 0.3, 0.6), first);
  // In another instance, which has not even started.
  const std::string bytes = instance.bytes_of(state);
  void* read = nullptr;
  ASSERT_EQ(other.try_read(bytes, read), 0) << other.said;
  other.restore(read);
  expect_near(readings(other, 0.3, 0.6), first);
  other.free(read);
  // Into a state that there is.
  instance.take(state);
  instance.restore(state);
  instance.free(state);
  EXPECT_NE(other.try_read("", read), 0);
  EXPECT_NE(other.said.find("no state of the axis"), std::string::npos) << other.said;
}

TEST_P(FmuOfVersion, ResetGoesBackToTheStart) {
  const Fmu fmu(axes().at("paper"), GetParam());
  Instance instance(fmu);
  instance.set("M", 100.0);
  instance.start();
  const std::vector<double> other = readings(instance, 0.0, 0.1);
  EXPECT_EQ(instance.plain("Terminate"), 0);
  EXPECT_EQ(instance.plain("Reset"), 0);
  instance.start();
  EXPECT_EQ(instance.get("M"), 146.0);
  const std::vector<double> first = readings(instance, 0.0, 0.1);
  Instance fresh(fmu);
  fresh.start();
  EXPECT_EQ(readings(fresh, 0.0, 0.1), first);
  EXPECT_NE(first, other);
}

TEST_P(FmuOfVersion, ParametersCanChangeInMotion) {
  Rig rig = of_model(driven_mass(20.0));
  rig.model.axis.K_f = 10.0;
  add_effect<DriveLag>(rig.model).T_l = 0.0;
  const Fmu fmu(rig, GetParam());
  Instance instance(fmu);
  instance.set("initial.y0", 0.5);
  instance.set("initial.y1", 0.25);
  instance.start(2.0);
  EXPECT_EQ(instance.get("time"), 2.0);
  EXPECT_EQ(instance.get("position"), 0.5);
  instance.set("command", 4.0);
  instance.step(2.0, 0.1);
  EXPECT_NEAR(instance.get("velocity"), 0.25 + 0.1 * 2.0, 1e-12);
  instance.set("M", 40.0);
  EXPECT_NEAR(instance.get("velocity"), 0.25 + 0.1 * 2.0, 1e-12);  // goes on from there
  instance.step(2.1, 0.1);
  EXPECT_NEAR(instance.get("velocity"), 0.45 + 0.1 * 1.0, 1e-12);
  // A drive that lags from now on has followed the command so far.
  instance.set("drive_lag.T_l", 0.02);
  instance.step(2.2, 0.1);
  EXPECT_NEAR(instance.get("velocity"), 0.55 + 0.1 * 1.0, 1e-12);
  instance.set("command", 0.0);
  instance.step(2.3, 0.5);
  EXPECT_NEAR(instance.get("velocity"), 0.65 + 0.02 * 1.0, 1e-9);
  EXPECT_NE(instance.try_set("initial.y0", 0.0), 0);
  EXPECT_NE(instance.said.find("initial.y0 cannot be set any more"), std::string::npos);
}

TEST_P(FmuOfVersion, ErrorsAreSaid) {
  const Fmu fmu(axes().at("mass"), GetParam());
  Instance stranger(fmu, "{0}");
  EXPECT_FALSE(stranger.exists());
  EXPECT_NE(stranger.said.find("the token {0} is not that of this FMU"), std::string::npos)
      << stranger.said;
  Instance instance(fmu);
  const auto says = [&](const std::string& text) {
    EXPECT_NE(instance.said.find(text), std::string::npos) << instance.said;
  };
  double value = 0.0;
  EXPECT_NE(instance.try_get(fmu.reference("position"), value), 0);
  says("must not be called now");
  EXPECT_NE(instance.try_step(0.0, 1e-3), 0);
  says("DoStep: it must not be called now");
  instance.start();
  EXPECT_NE(instance.try_set("M", -1.0), 0);
  says("M must be from 0.001 to 100000 kg, not -1");
  EXPECT_NE(instance.try_set("command", std::nan("")), 0);
  says("not finite");
  EXPECT_NE(instance.try_get(77, value), 0);
  says("no variable has the value reference 77");
  EXPECT_NE(instance.try_step(0.5, 1e-3), 0);
  says("since the axis is at 0 s");
  EXPECT_NE(instance.try_step(0.0, -1.0), 0);
  says("a step of -1 s");
  EXPECT_EQ(fmu.function<int(void*, const unsigned*, std::size_t, int*)>(
                GetParam() == 2 ? "fmi2GetInteger" : "fmi3GetInt32")(nullptr, nullptr, 0, nullptr),
            0);
  EXPECT_NE(instance.plain("EnterEventMode"), 0);
  says("EnterEventMode: this is a unit for co-simulation");
}

TEST_P(FmuOfVersion, ChannelsAreInputs) {
  Rig rig = of_model(driven_mass(20.0));
  rig.model.structure.channels = kept({{"temperature", "K", 293.0}, {"neighbour", "m", 0.0}});
  add_effect<ChannelForce>(rig.model).k = {0.5, 0.0, 0.0, 0.0};
  const Fmu fmu(rig, GetParam());
  Instance instance(fmu);
  instance.start();
  EXPECT_EQ(instance.get("temperature"), 293.0);
  instance.step(0.0, 1.0);
  EXPECT_EQ(instance.get("velocity"), 0.0);
  instance.set("temperature", 303.0);
  instance.step(1.0, 1.0);
  EXPECT_NEAR(instance.get("velocity"), 0.5 * 10.0 / 20.0, 1e-12);
}

/// What the standard demands of a description, as far as ours uses it.
void check_description(const Fmu& fmu, bool has_channels) {
  const bool is_2 = fmu.version() == 2;
  const pugi::xml_node model = fmu.model();
  EXPECT_EQ(std::string(model.attribute("fmiVersion").value()), is_2 ? "2.0" : "3.0");
  EXPECT_EQ(std::string(model.attribute("modelName").value()), "an axis");
  EXPECT_EQ(fmu.library.stem(), model.child("CoSimulation").attribute("modelIdentifier").value());
  std::string first;
  std::ifstream resource(fmu.root / "resources" / "axis.txt");
  std::getline(resource, first);
  EXPECT_EQ(first, fmu.token);
  EXPECT_TRUE(fs::exists(fmu.root / "documentation" / "licenses" / "LICENSE"));

  // Elements in the order of the schema.
  std::vector<std::string> order;
  for (const auto& element : model.children()) order.emplace_back(element.name());
  EXPECT_EQ(order,
            (std::vector<std::string>{"CoSimulation", "UnitDefinitions", "LogCategories",
                                      "DefaultExperiment", "ModelVariables", "ModelStructure"}));

  std::set<std::string> units;
  for (const auto& unit : model.child("UnitDefinitions").children()) {
    const std::string name = unit.attribute("name").value();
    EXPECT_TRUE(units.insert(name).second) << name;
    std::string product;
    for (const auto& power : unit.child("BaseUnit").attributes())
      product += std::string(product.empty() ? "" : " ") + power.name() + "^" + power.value();
    if (!unit.child("BaseUnit")) {
      EXPECT_TRUE(has_channels) << name;
      continue;
    }
    if (product.empty()) product = "1";
    if (name.find('K') != std::string::npos) continue;
    const auto factor = unit_factor(product, name);
    ASSERT_TRUE(std::holds_alternative<double>(factor)) << name << ": " << product;
    EXPECT_NEAR(std::get<double>(factor), 1.0, 1e-12) << name << ": " << product;
  }

  std::set<std::string> names, references, outputs, unknowns, listed;
  int independent = 0, index = 0;
  std::map<std::string, std::string> by_index;
  for (const auto& variable : model.child("ModelVariables").children()) {
    const pugi::xml_node real = is_2 ? variable.child("Real") : variable;
    const std::string name = variable.attribute("name").value(),
                      reference = variable.attribute("valueReference").value(),
                      causality = variable.attribute("causality").value(),
                      variability = variable.attribute("variability").value(),
                      initial = variable.attribute("initial").value();
    by_index[std::to_string(++index)] = reference;
    EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_TRUE(references.insert(reference).second) << name;
    EXPECT_EQ(units.count(real.attribute("unit").value()), 1u) << name;
    EXPECT_FALSE(std::string(variable.attribute("description").value()).empty()) << name;
    const bool has_start = !real.attribute("start").empty();
    if (causality == "input") {
      EXPECT_TRUE(has_start && initial.empty() && variability == "continuous") << name;
    } else if (causality == "output") {
      EXPECT_TRUE(!has_start && initial == "calculated") << name;
      outputs.insert(reference);
    } else if (causality == "parameter") {
      EXPECT_TRUE(has_start && initial == "exact") << name;
      EXPECT_TRUE(variability == "tunable" || variability == "fixed") << name;
      EXPECT_LE(real.attribute("min").as_double(), real.attribute("start").as_double()) << name;
      EXPECT_GE(real.attribute("max").as_double(), real.attribute("start").as_double()) << name;
    } else {
      EXPECT_EQ(causality, "independent");
      EXPECT_TRUE(!has_start && initial.empty() && variability == "continuous");
      ++independent;
    }
  }
  EXPECT_EQ(independent, 1);
  if (is_2) {
    for (const char* kind : {"Outputs", "InitialUnknowns"})
      for (const auto& unknown : model.child("ModelStructure").child(kind).children())
        (kind == std::string("Outputs") ? listed : unknowns)
            .insert(by_index.at(unknown.attribute("index").value()));
    for (const auto& file : model.child("CoSimulation").child("SourceFiles").children())
      EXPECT_TRUE(fs::exists(fmu.root / "sources" / file.attribute("name").value()));
  } else {
    for (const auto& unknown : model.child("ModelStructure").children())
      (unknown.name() == std::string("Output") ? listed : unknowns)
          .insert(unknown.attribute("valueReference").value());
    pugi::xml_document build;
    ASSERT_TRUE(build.load_file((fmu.root / "sources" / "buildDescription.xml").c_str()));
    int sources = 0;
    for (const auto& file : build.select_nodes("//SourceFile")) {
      EXPECT_TRUE(fs::exists(fmu.root / "sources" / file.node().attribute("name").value()));
      ++sources;
    }
    EXPECT_GE(sources, 10);
  }
  EXPECT_EQ(listed, outputs);
  EXPECT_EQ(unknowns, outputs);
}

TEST_P(FmuOfVersion, DescriptionsKeepTheRules) {
  for (const auto& [name, rig] : axes()) check_description(Fmu(rig, GetParam()), false);
  Rig all = axes().at("paper");
  all.model.structure.effects.set();
  const std::vector<double*> values = members(all.model);
  for (const QuantityEntry& entry : quantity_list())
    if (entry.effect) *values[entry.index] = entry.quantity.typical;
  all.model.structure.channels = kept({{"temperature", "K", 293.0}, {"command", "V", 0.0}});
  check_description(Fmu(all, GetParam()), true);
  all.model.structure.transmission = Transmission::rigid;
  all.model.structure.drive = Drive::motor_current;
  all.model.axis.K_f = 25.0;
  all.model.structure.joint = Joint::revolute;
  all.model.structure.gearing = Gearing::turns;
  check_description(Fmu(all, GetParam()), true);
}

TEST(Fmu, OnlyTheStandardsFunctionsLeaveTheLibrary) {
  const Fmu fmu(axes().at("mass"), 2);
  TempFolder folder;
  const std::string list = folder.path() + "/symbols";
  if (std::system(
          ("nm --dynamic --defined-only '" + fmu.library.string() + "' > " + list + " 2>/dev/null")
              .c_str()) != 0)
    GTEST_SKIP() << "nm (binutils) is not installed";
  std::ifstream in(list);
  int of_2 = 0, of_3 = 0;
  for (std::string address, kind, name; in >> address >> kind >> name;) {
    const bool is_2 = name.starts_with("fmi2"), is_3 = name.starts_with("fmi3");
    EXPECT_TRUE(is_2 || is_3) << name;
    of_2 += is_2;
    of_3 += is_3;
  }
  EXPECT_EQ(of_2, 44);  // fmi2Functions.h of FMI 2.0.4
  EXPECT_EQ(of_3, 75);  // fmi3Functions.h of FMI 3.0
}

TEST(Fmu, IsTheSameToTheByte) {
  const auto made = [] {
    return export_axis(axes().at("mass"), ExportTarget::fmu3, "a", "By a test").files.front();
  };
  EXPECT_EQ(made(), made());
}

TEST(Fmu, SaysWhatIsLost) {
  Rig rig = axes().at("mass");
  rig.model.axis.T_d = -1e-3;
  rig.model.instruments[index_of(Signal::velocity)].lag = 1e-3;
  rig.uncertainty.emplace();
  const Export made = export_axis(rig, ExportTarget::fmu2, "a", "By a test");
  ASSERT_EQ(made.lost.size(), 3u);
  EXPECT_EQ(made.carried.model.axis.T_d, 0.0);
  EXPECT_EQ(made.lost[1], "Lag and delay of the instrument of velocity are left out.");
}

}  // namespace
}  // namespace axisfit
