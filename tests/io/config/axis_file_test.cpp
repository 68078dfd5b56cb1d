#include "io/config/axis_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "base/random.h"
#include "tests/apps/files.h"

namespace axisfit {
namespace {

// Lines count: the messages below name them.
constexpr const char* kAxis = R"(name: test axis
drive: current_source
transmission: backlash
parameters:
  K_m: 0.25 N m/A
  J_m: 800 mg m^2
  B_m: 1e-3 N m s/rad
  K_t: 0.07 V s/rad
  r_g: 5 mm
  H: 10 um
  M: 120 kg
  T_z: 7 ms
  T_p: 40 ms
  T_r: 0.2 ms
  K_1: 1000
  K_2: 870
  K_i: 3 A/V
  V_L: 2.5 V
  B_a: 200 N s/m
  b_g: 1.5 kN s/m
  k_g: 5 MN/m
effects:
  coulomb_friction: {F_c: 20 N}
initial:
  y0: 5 cm
instruments:
  velocity: {gain: 101 %, noise: 2 mm/s}
controller:
  period: 4 ms
)";

constexpr const char* kMass = R"(drive: force_source
transmission: rigid
parameters:
  K_f: 35 N/V
  M: 95 kg
  B_a: 200 N s/m
)";

// Reads axis files from their text.
class AxisFileTest : public ::testing::Test {
 protected:
  /// The rig, after the test has failed if there are diagnostics.
  Rig read(const std::string& text) {
    Diagnostics diagnostics;
    const auto rig = read_axis_file(folder_.write("axis.yaml", text), diagnostics);
    std::string all;
    for (const Diagnostic& d : diagnostics.sorted()) all += d.text() + "\n";
    EXPECT_EQ(all, "") << text;
    EXPECT_TRUE(rig.has_value());
    return rig.value_or(Rig());
  }

  /// All diagnostics, one a line. There must not be a rig with them.
  std::string errors(const std::string& text) {
    Diagnostics diagnostics;
    const auto rig = read_axis_file(folder_.write("axis.yaml", text), diagnostics);
    EXPECT_EQ(rig.has_value(), diagnostics.empty());
    std::string all;
    for (const Diagnostic& d : diagnostics.sorted()) all += d.text() + "\n";
    return folder_.without_path(all);
  }

  TempFolder folder_;
};

double value_of(const Rig& rig, const char* name) {
  Model<double> model = rig.model;
  return *members(model)[quantity_index(name)];
}

/// Same value of everything that the structure uses, bit for bit.
void expect_same(const Rig& read, const Rig& written) {
  EXPECT_EQ(read.name, written.name);
  const Structure& structure = written.model.structure;
  EXPECT_EQ(read.model.structure.drive, structure.drive);
  EXPECT_EQ(read.model.structure.transmission, structure.transmission);
  EXPECT_EQ(read.model.structure.effects, structure.effects);
  EXPECT_EQ(read.model.structure.joint, structure.joint);
  Model<double> a = read.model, b = written.model;
  const auto in_a = members(a), in_b = members(b);
  for (const QuantityEntry& entry : quantity_list()) {
    if (!is_used(entry, structure)) continue;
    EXPECT_EQ(*in_a[entry.index], *in_b[entry.index]) << entry.name;
  }
  EXPECT_EQ(read.noise, written.noise);
  std::vector<double> settings;
  visit_settings(read.model.controller, [&](const Quantity&, double x) { settings.push_back(x); });
  std::size_t i = 0;
  visit_settings(written.model.controller, [&](const Quantity& setting, double x) {
    EXPECT_EQ(settings[i++], x) << setting.symbol;
  });
}

TEST_F(AxisFileTest, EveryShippedAxisReadsAndSurvivesWriting) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(AXISFIT_CONFIGS "/axes")) {
    SCOPED_TRACE(entry.path().filename().string());
    Diagnostics diagnostics;
    const auto rig = read_axis_file(entry.path().string(), diagnostics);
    ASSERT_NO_THROW(diagnostics.throw_if_any());
    ASSERT_TRUE(rig.has_value());
    EXPECT_NE(rig->name, "");
    EXPECT_EQ(model_error(rig->model), "");
    expect_same(read(format_axis_file(*rig, "")), *rig);
    ++count;
  }
  EXPECT_GE(count, 4);
}

TEST_F(AxisFileTest, ReadsEveryPartInSiUnits) {
  const Rig rig = read(kAxis);
  EXPECT_EQ(rig.name, "test axis");
  EXPECT_EQ(rig.model.structure.drive, Drive::current_source);
  EXPECT_EQ(rig.model.structure.transmission, Transmission::backlash);
  EXPECT_DOUBLE_EQ(value_of(rig, "J_m"), 8e-4);
  EXPECT_DOUBLE_EQ(value_of(rig, "H"), 1e-5);
  EXPECT_DOUBLE_EQ(value_of(rig, "k_g"), 5e6);
  EXPECT_DOUBLE_EQ(value_of(rig, "coulomb_friction.F_c"), 20.0);
  EXPECT_DOUBLE_EQ(value_of(rig, "initial.y0"), 0.05);
  EXPECT_DOUBLE_EQ(value_of(rig, "velocity.gain"), 1.01);
  EXPECT_DOUBLE_EQ(rig.noise[index_of(Signal::velocity)], 0.002);
  EXPECT_DOUBLE_EQ(rig.model.controller.timing.period, 0.004);
  // What is not written keeps its standard value.
  EXPECT_EQ(value_of(rig, "F_s"), 0.0);
  EXPECT_EQ(value_of(rig, "w"), 0.002);
  EXPECT_EQ(value_of(rig, "T_d"), 0.0);
  EXPECT_EQ(value_of(rig, "velocity.bias"), 0.0);
  EXPECT_EQ(rig.noise[index_of(Signal::position)], 0.0);
  EXPECT_EQ(rig.model.controller.gains.limit, 10.0);
}

TEST_F(AxisFileTest, PartsThatAVariantLacksAreLeftOutOfItsEquations) {
  const Rig rig = read(kMass);
  EXPECT_EQ(value_of(rig, "r_g"), 1.0);
  for (const char* name : {"J_m", "B_m", "R", "H", "b_g", "k_g", "K_t"})
    EXPECT_EQ(value_of(rig, name), 0.0) << name;
  EXPECT_TRUE(rig.model.structure.effects.none());
}

// A value within the limits, with digits to the last place.
double random_value(std::mt19937_64& generator, double lower, double upper) {
  const double z = uniform(generator);
  if (lower > 0.0) return lower * std::pow(upper / lower, z);
  return lower + (upper - lower) * z;
}

Rig random_rig(std::mt19937_64& generator, const Structure& structure) {
  Rig rig;
  rig.name = "rig " + structure.effects.to_string();
  rig.model.structure = structure;
  const auto member = members(rig.model);
  for (const QuantityEntry& entry : quantity_list(vocabulary_of(structure)))
    *member[entry.index] = random_value(generator, entry.quantity.lower, entry.quantity.upper);
  for (double& noise : rig.noise) noise = random_value(generator, 1e-9, 1e6);
  visit_settings(rig.model.controller, [&](const Quantity& setting, double& value) {
    value = random_value(generator, setting.lower, setting.upper);
  });
  Controller<double>& controller = rig.model.controller;
  controller.timing.velocity_samples = std::round(controller.timing.velocity_samples);
  controller.gains.notch_frequency =
      std::clamp(0.3 / controller.timing.command_period(), 1e-2, 1e5);
  return rig;
}

EffectSet usable_effects(Structure structure) {
  EffectSet usable;
  structure.effects.set();
  const Effects<double> effects{};
  visit_effects(effects, [&](std::size_t index, const auto& effect) {
    for (const QuantityEntry& entry : quantity_list())
      if (entry.group == effect.name && is_used(entry, structure)) usable.set(index);
  });
  return usable;
}

TEST_F(AxisFileTest, EveryVariantSurvivesWritingDigitForDigit) {
  std::mt19937_64 generator(7);
  std::vector<Structure> structures;
  for (const Joint joint : kJoints)
    for (std::size_t drive = 0; drive < kDrives; ++drive)
      for (const Transmission transmission : {Transmission::backlash, Transmission::rigid})
        structures.push_back({static_cast<Drive>(drive), transmission, {}, joint});
  for (Structure structure : structures) {
    // None, each alone, and all, of those that have a part in the axis.
    const EffectSet all = usable_effects(structure);
    std::vector<EffectSet> sets{{}, all};
    for (std::size_t i = 0; i < kEffects; ++i)
      if (all[i]) sets.push_back(EffectSet().set(i));
    for (const EffectSet& effects : sets) {
      structure.effects = effects;
      const Rig rig = random_rig(generator, structure);
      const std::string text = format_axis_file(rig, "written by a test");
      SCOPED_TRACE(text);
      expect_same(read(text), rig);
      if (HasFailure()) return;
    }
  }
}

TEST_F(AxisFileTest, ReadsARevoluteJointInItsOwnWords) {
  const Rig rig = read(
      "joint: revolute\ndrive: torque_source\ntransmission: rigid\n"
      "parameters: {K_f: 50 N mm/V, J: 24 g m^2, B_a: 50 N mm s/rad, w: 1 deg/s}\n"
      "effects: {coulomb_friction: {T_c: 0.08 Nm}, constant_torque: {T_0: 0 N m}}\n"
      "instruments: {drive_torque: {}, position: {noise: 0.1 deg}}\n"
      "initial: {y0: 90 deg}\n");
  EXPECT_EQ(rig.model.structure.joint, Joint::revolute);
  EXPECT_DOUBLE_EQ(value_of(rig, "K_f"), 0.05);
  EXPECT_DOUBLE_EQ(value_of(rig, "M"), 0.024);
  EXPECT_DOUBLE_EQ(value_of(rig, "coulomb_friction.F_c"), 0.08);
  EXPECT_NEAR(value_of(rig, "initial.y0"), 1.5707963267948966, 1e-15);
  EXPECT_NE(errors("joint: revolute\ndrive: torque_source\ntransmission: rigid\n"
                   "parameters: {K_f: 1 N/V, M: 24 kg, B_a: 1 N m s/rad}\n"
                   "effects: {constant_force: {F_0: 0 N}}\n")
                .find("did you mean 'constant_torque'"),
            std::string::npos);
}

TEST_F(AxisFileTest, ReadsALeadOrAGearRatioInsteadOfARadius) {
  const std::string motor = "K_m: 0.1 N m/A, R: 1 ohm, J_m: 1e-4 kg m^2, B_a: 0 ";
  const Rig screw = read("drive: motor_voltage\ntransmission: rigid\nparameters: {" + motor +
                         "N s/m, M: 20 kg, lead: 10 mm}\n");
  EXPECT_DOUBLE_EQ(motor_radius(screw.model), 0.01 / (2.0 * std::numbers::pi));
  const std::string written = format_axis_file(screw, "");
  EXPECT_NE(written.find("lead: 0.01 m\n"), std::string::npos) << written;
  EXPECT_EQ(value_of(read(written), "r_g"), 0.01);
  const Rig joint = read(
      "joint: revolute\ndrive: motor_voltage\ntransmission: rigid\n"
      "parameters: {" +
      motor + "N m s/rad, J: 1 kg m^2, gear_ratio: 50}\n");
  EXPECT_DOUBLE_EQ(motor_radius(joint.model), 0.02);
}

TEST_F(AxisFileTest, ValuesOnTheirLimitsSurviveWriting) {
  for (const bool upper : {false, true}) {
    Rig rig;
    for (const QuantityEntry& entry : quantity_list())
      if (const auto effect = entry.effect)
        if (is_used(entry, rig.model.structure)) rig.model.structure.effects.set(*effect);
    const auto member = members(rig.model);
    for (const QuantityEntry& entry : quantity_list())
      *member[entry.index] = upper ? entry.quantity.upper : entry.quantity.lower;
    rig.model.axis.J_m = std::max(rig.model.axis.J_m, std::numeric_limits<double>::min());
    rig.model.controller.gains.notch_frequency = 1e-2;  // below half of the sampling frequency
    expect_same(read(format_axis_file(rig, "")), rig);
  }
}

TEST_F(AxisFileTest, QuantitiesOfAnEffectMayHaveAStandardValue) {
  const Rig rig = read(std::string(kMass) + R"(effects:
  elastic_mode: {m_e: 1 kg, f_e: 30 Hz}
  periodic_force: {F_s1: 2 N, F_c1: 0 N, period: 36 mm, F_c2: -1 N}
  force_over_position: {from: -1 m, to: 2 m, c16: 3 N}
)");
  EXPECT_EQ(value_of(rig, "elastic_mode.zeta_e"), 0.02);
  EXPECT_EQ(value_of(rig, "periodic_force.F_s2"), 0.0);
  EXPECT_EQ(value_of(rig, "periodic_force.F_c2"), -1.0);
  EXPECT_EQ(value_of(rig, "force_over_position.c1"), 0.0);
  EXPECT_EQ(value_of(rig, "force_over_position.c16"), 3.0);
  expect_same(read(format_axis_file(rig, "")), rig);
  EXPECT_EQ(errors(std::string(kMass) + R"(effects:
  elastic_mode: {m_e: 1 kg}
  torque_droop: {c_i: 0 1/A}
  force_over_motor_angle: {}
)"),
            "axis.yaml:8:17: key 'f_e' is missing in elastic_mode\naxis.yaml:9:17: torque_droop is "
            "not used by an axis with drive force_source and transmission rigid: remove "
            "it\naxis.yaml:10:27: force_over_motor_angle is not used by an axis with drive "
            "force_source and transmission rigid: remove it\n");
}

TEST_F(AxisFileTest, GuessesSurviveWriting) {
  const Rig rig = read(std::string(kMass) + "guessed: [K_f, coulomb_friction.F_c]\n" +
                       "effects: {coulomb_friction: {F_c: 2 N}}\n");
  EXPECT_EQ(rig.guessed, (std::vector<std::size_t>{quantity_index("K_f"),
                                                   quantity_index("coulomb_friction.F_c")}));
  EXPECT_EQ(read(format_axis_file(rig, "")).guessed, rig.guessed);
}

TEST_F(AxisFileTest, UncertaintySurvivesWriting) {
  Rig rig = read(kMass);
  EXPECT_FALSE(rig.uncertainty);
  AxisUncertainty& known = rig.uncertainty.emplace();
  known.quantities = {{quantity_index("M"), true, 0.00125, 0.0625, 3.5},
                      {quantity_index("B_a"), false, 2.5, 0.0, 1.0}};
  known.correlation = {1.0, -0.75, -0.75, 1.0};
  known.missing_force = MissingForceProcess{0.0125, 1.5, 0.5, {0.75, -0.125}};
  const AxisUncertainty found = read(format_axis_file(rig, "")).uncertainty.value();
  ASSERT_EQ(found.quantities.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const UncertainQuantity &a = found.quantities[i], &b = known.quantities[i];
    EXPECT_EQ(std::tie(a.quantity, a.logarithmic, a.error, a.scatter, a.freedom),
              std::tie(b.quantity, b.logarithmic, b.error, b.scatter, b.freedom));
  }
  EXPECT_EQ(found.correlation, known.correlation);
  ASSERT_TRUE(found.missing_force);
  EXPECT_EQ(found.missing_force->interval, 0.0125);
  EXPECT_EQ(found.missing_force->deviation, 1.5);
  EXPECT_EQ(found.missing_force->innovation, 0.5);
  EXPECT_EQ(found.missing_force->coefficients, known.missing_force->coefficients);

  EXPECT_EQ(errors(std::string(kMass) + R"(uncertainty:
  parameters:
    - {name: M, scale: logarithmic, error: 1 %}
    - {name: Mass, scale: round, error: -1}
  correlation: [[1, 0, 0], [0, 1]]
)"),
            "axis.yaml:10:14: unknown quantity 'Mass'; valid names are parameters of the axis, "
            "EFFECT.PARAMETER, SIGNAL.gain, .bias, .lag, .delay and .drift, and initial.y0 ... "
            "initial.y6\naxis.yaml:10:27: scale must be one of linear, logarithmic, not "
            "'round'\naxis.yaml:10:41: error must lie between 0 and 1e+12, not "
            "-1\naxis.yaml:11:16: correlation must have 2 rows of 2 numbers, one for each of the "
            "parameters\n");
}

TEST_F(AxisFileTest, InstrumentsMayLagAndBeLate) {
  const Rig rig = read(std::string(kMass) +
                       "instruments: {velocity: {lag: 3 ms, delay: -200 us}, "
                       "acceleration: {bias: 2 cm/s^2}}\n");
  EXPECT_EQ(value_of(rig, "velocity.lag"), 0.003);
  EXPECT_DOUBLE_EQ(value_of(rig, "velocity.delay"), -0.0002);
  EXPECT_EQ(value_of(rig, "acceleration.lag"), 0.0);
  expect_same(read(format_axis_file(rig, "")), rig);
  EXPECT_EQ(errors(std::string(kMass) + "instruments: {velocity: {lag: -1 ms, delay: 2}}\n"),
            "axis.yaml:7:31: lag must lie between 0 s and 1 s, not -1 ms\n"
            "axis.yaml:7:45: delay needs a unit, for example '2 s'\n");
}

TEST_F(AxisFileTest, AnyNameAndCommentSurviveWriting) {
  Rig rig = read(kMass);
  for (const char* name : {"null", "~", "true", "1e5", "# not a comment", "a: b", " blanks ", "'",
                           "\"", "x: {y", "- z", "Größe", "---"}) {
    rig.name = name;
    const std::string text = format_axis_file(rig, "first line\n  second: line\n\nlast");
    EXPECT_EQ(text.substr(0, text.find("drive:")).substr(0, 45),
              "# first line\n#   second: line\n# \n# last\nname:");
    EXPECT_EQ(read(text).name, name);
  }
  EXPECT_EQ(read(format_axis_file(rig, "a\x1B\xFF")).name, rig.name);
}

TEST_F(AxisFileTest, JmMayBeZeroOnlyWithoutBacklash) {
  const std::string zero = replaced(kAxis, "800 mg m^2", "0 kg m^2");
  EXPECT_EQ(errors(zero),
            "axis.yaml:5:3: J_m must be above zero with backlash: while the teeth are apart, the "
            "motor torque acts on J_m alone\n");
  std::string rigid = replaced(zero, "transmission: backlash", "transmission: rigid");
  for (const char* line : {"  H: 10 um\n", "  b_g: 1.5 kN s/m\n", "  k_g: 5 MN/m\n"})
    rigid = replaced(rigid, line, "");
  EXPECT_EQ(read(rigid).model.axis.J_m, 0.0);
}

struct Mistake {
  const char* from;
  const char* to;
  const char* message;
};

TEST_F(AxisFileTest, EveryMistakeIsNamedWithItsPlace) {
  for (
      const auto& [from, to, message] : std::vector<Mistake>{
          // Keys.
          {"drive: current_source\n", "", "1:1: key 'drive' is missing in the file"},
          {"name: test axis", "nmae: test axis", "1:1: unknown key 'nmae'; did you mean 'name'?"},
          {"  M: 120 kg\n", "", "5:3: key 'M' is missing in parameters"},
          {"  M: 120 kg\n", "  M: 120 kg\n  m: 1 kg\n", "12:3: unknown key 'm'; did you mean 'M'?"},
          {"  M: 120 kg\n", "  M: 120 kg\n  M: 1 kg\n",
           "12:3: duplicate key 'M', first given on line 11"},
          {"coulomb_friction:", "coulomb_frction:",
           "23:3: unknown key 'coulomb_frction'; did you mean 'coulomb_friction'?"},
          {"{F_c: 20 N}", "{}", "23:21: key 'F_c' is missing in coulomb_friction"},
          {"{F_c: 20 N}", "{F_c: 20 N, F_k: 3 N}", "23:33: unknown key 'F_k'; did you mean 'F_c'?"},
          {"  y0: 5 cm", "  y6: 5 A",
           "25:3: unknown key 'y6'; did you mean 'y0'?"},  // no inductance, no current to start
          {"  velocity: {", "  speed: {",
           "27:3: unknown key 'speed'; known keys: position, velocity, acceleration, tachometer, "
           "motor_current, V_c, V_m, drive_force, load_position"},
          {"gain: 101 %", "scale: 101 %",
           "27:14: unknown key 'scale'; known keys: gain, bias, lag, delay, drift, noise"},
          {"  period: 4 ms", "  perod: 4 ms", "29:3: unknown key 'perod'; did you mean 'period'?"},
          // Kinds of values.
          {"name: test axis", "name:", "1:1: name must be text, not empty"},
          {"current_source", "curent_source",
           "2:8: drive must be one of velocity_loop, current_source, force_source, motor_current, "
           "rated_force, motor_voltage, not "
           "'curent_source'; did you mean 'current_source'?"},
          {"transmission: backlash", "transmission: belt",
           "3:15: transmission must be one of backlash, rigid, not 'belt'"},
          {"M: 120 kg", "M: heavy",
           "11:6: M must be a number with a unit, for example '1 kg', not 'heavy'"},
          {"M: 120 kg", "M: [120 kg]",
           "11:6: M must be a number with a unit, for example '1 kg', not a list"},
          {"M: 120 kg",
           "M:", "11:3: M must be a number with a unit, for example '1 kg', not empty"},
          {"M: 120 kg", "M: .nan kg",
           "11:6: M must be a number with a unit, for example '1 kg', not '.nan kg'"},
          {"{F_c: 20 N}", "20 N",
           "23:21: coulomb_friction must be a map of keys and values, not '20 N'"},
          {"{gain: 101 %, noise: 2 mm/s}", "2 mm/s",
           "27:13: velocity must be a map of keys and values, not '2 mm/s'"},
          // Units.
          {"M: 120 kg", "M: 120", "11:6: M needs a unit, for example '120 kg'"},
          {"M: 120 kg", "M: 120 m",
           "11:6: M: 'm' cannot be converted to 'kg'; use for example 'kg'"},
          {"K_2: 870", "K_2: 870 V",
           "16:8: K_2: 'V' cannot be used for a dimensionless quantity; use a plain number or '%'"},
          {"noise: 2 mm/s", "noise: 2", "27:34: noise needs a unit, for example '2 m/s'"},
          {"period: 4 ms", "period: 4", "29:11: period needs a unit, for example '4 s'"},
          // Ranges.
          {"M: 120 kg", "M: 0 kg", "11:6: M must lie between 0.001 kg and 1e+05 kg, not 0 kg"},
          {"H: 10 um", "H: -10 um", "10:6: H must lie between 0 m and 0.1 m, not -10 um"},
          {"F_c: 20 N", "F_c: -1 N", "23:27: F_c must lie between 0 N and 1e+05 N, not -1 N"},
          {"noise: 2 mm/s", "noise: -2 mm/s",
           "27:34: noise must lie between 0 m/s and 1e+06 m/s, not -2 mm/s"},
          {"period: 4 ms", "period: 0 s",
           "29:11: period must lie between 1e-05 s and 1 s, not 0 s"},
          // Parts that the variant lacks.
          {"  M: 120 kg\n", "  M: 120 kg\n  R: 0.5 ohm\n",
           "12:6: R is not used by an axis with drive current_source and transmission backlash: "
           "remove it"},
          {"  M: 120 kg\n", "  M: 120 kg\n  K_f: 3 N/V\n",
           "12:8: K_f is not used by an axis with drive current_source and transmission backlash: "
           "remove it"},
      }) {
    EXPECT_EQ(errors(replaced(kAxis, from, to)), "axis.yaml:" + std::string(message) + "\n");
  }
}

TEST_F(AxisFileTest, AllMistakesAreNamedAtOnce) {
  EXPECT_EQ(errors(R"(drive: force_source
transmission: rigid
colour: red
parameters:
  K_f: 35 N
  M: 95
  r_g: 3 mm
effects:
  constant_force: {F_0: up}
instruments:
  position: {noise: 1 s}
controller: {limit: 0 V}
)"),
            "axis.yaml:3:1: unknown key 'colour'; known keys: joint, name, channels, drive, "
            "transmission, "
            "parameters, effects, initial, guessed, uncertainty, instruments, "
            "controller\naxis.yaml:5:3: key 'B_a' is "
            "missing in "
            "parameters\naxis.yaml:5:8: K_f: 'N' cannot be converted to 'N/V'; use for example "
            "'N/V'\naxis.yaml:6:6: M needs a unit, for example '95 kg'\naxis.yaml:7:8: r_g is not "
            "used by an axis with drive force_source and transmission rigid: remove "
            "it\naxis.yaml:9:25: F_0 must be a number with a unit, for example '1 N', not "
            "'up'\naxis.yaml:11:21: noise: 's' cannot be converted to 'm'; use for example "
            "'m'\naxis.yaml:12:21: limit must lie between 0.001 V and 10000 V, not 0 V\n");
}

TEST_F(AxisFileTest, FilesThatAreNoAxisAreRefused) {
  EXPECT_EQ(errors(""), "axis.yaml:1:1: the file must be a map of keys and values, not empty\n");
  EXPECT_EQ(errors("drive: [\n").substr(0, 33), "axis.yaml:2:1: not valid YAML: en");
  Diagnostics diagnostics;
  EXPECT_FALSE(read_axis_file(folder_.path("none.yaml"), diagnostics).has_value());
  EXPECT_FALSE(read_axis_file(folder_.path(), diagnostics).has_value());
  ASSERT_EQ(diagnostics.sorted().size(), 2u);
  EXPECT_EQ(diagnostics.sorted()[0].message, "cannot be opened: No such file or directory");
  EXPECT_EQ(diagnostics.sorted()[1].message, "not a file");
}

TEST_F(AxisFileTest, WithMoreMistakesThanAreKeptIsStillRefused) {
  std::string text = "drive: none\ntransmission: rigid\n";
  for (int i = 0; i < 1500; ++i) text += "name: a\n";
  Diagnostics diagnostics;
  EXPECT_FALSE(read_axis_file(folder_.write("axis.yaml", text), diagnostics).has_value());
  EXPECT_TRUE(diagnostics.full());
}

TEST_F(AxisFileTest, MistakesOfOtherFilesDoNotCount) {
  Diagnostics diagnostics;
  diagnostics.add({"job.yaml", 1, 1, "something else"});
  EXPECT_TRUE(read_axis_file(folder_.write("axis.yaml", kMass), diagnostics).has_value());
}

}  // namespace
}  // namespace axisfit
