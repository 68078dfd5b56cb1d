// Names of columns as rigs, drives and people write them.
#include "init/column_guess.h"

#include <gtest/gtest.h>

#include <string>
#include <variant>
#include <vector>

#include "base/units.h"

namespace axisfit {
namespace {

TEST(ColumnGuessTest, UnderstandsTheNamesOfTheTrade) {
  struct Case {
    std::string name;
    Kind kind;
    std::string unit = {};
    bool is_setpoint = false;
  };
  using enum Kind;
  for (const Case& c : std::vector<Case>{
           {"time_s", time, "s"},
           {"t", time},
           {"Time [ms]", time, "ms"},
           {"timestamp (s)", time, "s"},
           {"t_us", time, "us"},
           {"Zeit / ms", time, "ms"},
           {"qm", position},
           {"pos_mm", position, "mm"},
           {"position [mm]", position, "mm"},
           {"x", position},
           {"Weg", position},
           {"Istposition", position},
           {"actualPosition_um", position, "um"},
           {"motor angle [deg]", position, "deg"},
           {"axis.x.pos", position},
           {"Geber [inc]", position, "counts"},
           {"Geber [Ink]", position, "counts"},
           {"Lageistwert", position},
           {"Lage-Ist [mm]", position, "mm"},
           {"Lagesollwert", position, "", true},
           {"PL.FB", position},
           {"VL.FB", velocity},
           {"VL.CMD", velocity, "", true},
           {"IL.FB", current},
           {"ActPos", position},
           {"ActVelo", velocity},
           {"TorqueActual [%]", force, "%"},
           {"Drehmoment [Promille]", force, "0.1%"},
           {"0x6064", position},
           {"0x606C", velocity},
           {"0x6077", force},
           {"0x60FF", velocity, "", true},
           {"tau", force},
           {"q", position},
           {"dq", velocity},
           {"Motor speed [r/min]", velocity, "rpm"},
           {"angle [rev]", position, "rev"},
           {"planned acceleration [m/s^2]", acceleration, "m/s^2", true},
           {"Sollposition", position, "", true},
           {"reference_position_m", position, "m", true},
           {"qg", position, "", true},
           {"vel", velocity},
           {"v (mm/s)", velocity, "mm/s"},
           {"velocity_mps", velocity, "m/s"},
           {"vel_mm_s", velocity, "mm/s"},
           {"actual velocity", velocity},
           {"Geschwindigkeit", velocity},
           {"speed [rpm]", velocity, "rpm"},
           {"velocity setpoint (mm/s)", velocity, "mm/s", true},
           {"acc_g", acceleration, "g"},
           {"acceleration_mps2", acceleration, "m/s^2"},
           {"a (m/s\u00B2)", acceleration, "m/s^2"},
           {"iq", current},
           {"current_A", current, "A"},
           {"motor_current_a", current, "A"},
           {"Motorstrom [mA]", current, "mA"},
           {"iq_ref", current, "", true},
           {"tachometer_v", tachometer, "V"},
           {"V_c_v", preamplifier_voltage, "V"},
           {"V_m", motor_voltage},
           {"v [V]", motor_voltage, "V"},
           {"force_N", force, "N"},
           {"torque_Nm", force, "N m"},
           {"Kraft", force},
           {"set_velocity_v", set_velocity, "V", true},
           {"command_v", command, "V", true},
           {"cmd", command, "", true},
           {"u", command},
           {"vir", command},
       }) {
    SCOPED_TRACE(c.name);
    const auto guess = guess_column(c.name);
    ASSERT_TRUE(guess);
    EXPECT_EQ(static_cast<int>(guess->kind), static_cast<int>(c.kind));
    EXPECT_EQ(guess->unit, c.unit);
    EXPECT_EQ(guess->is_setpoint, c.is_setpoint);
  }
}

TEST(ColumnGuessTest, SaysNothingOfOtherNames) {
  for (const std::string name :
       {"Temperatur", "status", "position error [mm]", "Schleppabweichung", "torque_enable",
        "Freigabe Strom", "max speed", "sample", "data(:,2)", "pulses_N", "", "\n", "[mm]", "____"})
    EXPECT_FALSE(guess_column(name)) << name;
}

TEST(ColumnGuessTest, KnowsWhatMayActOnAnAxisBesideIt) {
  const auto guessed = [](const char* name) {
    const auto guess = guess_channel(name);
    return guess ? guess->name + " in " + guess->unit : "";
  };
  EXPECT_EQ(guessed("motor temperature"), "temperature in degC");
  EXPECT_EQ(guessed("temp_K"), "temperature in K");
  EXPECT_EQ(guessed("Temperatur (K)"), "temperature in K");
  EXPECT_EQ(guessed("T2 [\u00B0C]"), "temperature in degC");
  EXPECT_EQ(guessed("temperature_degc"), "temperature in degC");
  EXPECT_EQ(guessed("BusVoltage [mV]"), "supply in mV");
  EXPECT_EQ(guessed("supply_v"), "supply in V");
  for (const char* other : {"position", "attempt", "tempo", "T_motor", "busy", "velocity [m/s]"})
    EXPECT_EQ(guessed(other), "") << other;
}

TEST(ColumnGuessTest, MeasuredComesBeforeUnsaid) {
  EXPECT_GT(guess_column("actual position [mm]")->rank, guess_column("position [mm]")->rank);
  EXPECT_GT(guess_column("position [mm]")->rank, guess_column("position")->rank);
}

TEST(ColumnGuessTest, JobsCanWriteEveryUnitWithItsSize) {
  for (int k = 0; k <= static_cast<int>(Kind::force); ++k) {
    const Kind kind = static_cast<Kind>(k);
    for (const StoredUnit& unit : stored_units(kind)) {
      SCOPED_TRACE(unit.text);
      const auto factor = unit_factor(unit.written, si_unit(kind));
      ASSERT_TRUE(std::holds_alternative<double>(factor));
      EXPECT_NEAR(std::get<double>(factor) * unit.factor / unit.size, 1.0, 1e-9);
      EXPECT_EQ(stored_unit(kind, unit.text), &unit);
    }
  }
}

TEST(ColumnGuessTest, SizesNeedNotBeExact) {
  ASSERT_NE(unit_of_size(Kind::velocity, 0.00103), nullptr);
  EXPECT_EQ(unit_of_size(Kind::velocity, 0.00103)->text, "mm/s");
  EXPECT_EQ(unit_of_size(Kind::acceleration, 9.7)->text, "g");
  EXPECT_EQ(unit_of_size(Kind::position, 0.4), nullptr);
  EXPECT_EQ(unit_of_size(Kind::position, -1.0), nullptr);
}

}  // namespace
}  // namespace axisfit
