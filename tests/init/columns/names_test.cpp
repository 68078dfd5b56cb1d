// Names of columns as rigs, drives and people write them.
#include "init/columns/names.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

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
           {"velocityRadPerSec", velocity, "rad/s"},
           {"PositionRad", position, "rad"},
           {"AppliedVolts", motor_voltage, "V"},
           {"CurrentAmps", current, "A"},
           {"speed [rev/s]", velocity, "rev/s"},
           {"angle_turns", position, "rev"},
           {"torque_Nm", force, "N m"},
           {"millis", time, "ms"},
           {"micros", time, "us"},
           {"power", command},
           {"duty", command},
           {"z_act/mm", position, "mm"},
           {"z_set/mm", position, "mm", true},
           {"act [mm/s]", velocity, "mm/s"},
           {"q_des", position, "", true},
           {"goal_current", current, "", true},
           {"present_position", position},
           {"speed [furlong/day]", velocity, "furlong/day"},
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
        "Freigabe Strom", "max speed", "sample", "data(:,2)", "pulses_N", "motor power [W]",
        "power_w", "", "\n", "[mm]", "____"})
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
  EXPECT_EQ(guessed("pressure_bar"), "pressure in bar");
  EXPECT_EQ(guessed("Druck A [mbar]"), "pressure in mbar");
  EXPECT_EQ(guessed("chamber pressure (kPa)"), "pressure in kPa");
  for (const char* other : {"position", "attempt", "tempo", "T_motor", "busy", "velocity [m/s]",
                            "pressure", "pressure_V", "bar"})
    EXPECT_EQ(guessed(other), "") << other;
}

TEST(ColumnGuessTest, MeasuredComesBeforeUnsaid) {
  EXPECT_EQ(guess_column("spindle_turns")->unit, "rev");
  EXPECT_EQ(guess_column("spindle_rpm")->kind, Kind::velocity);
  EXPECT_GT(guess_column("position")->rank, 0);
  EXPECT_GT(guess_column("position_mm")->rank, guess_column("spindle_mm")->rank);
  EXPECT_FALSE(guess_column("spindle_m"));  // as short as that, it may mean anything
  EXPECT_GT(guess_column("actual position [mm]")->rank, guess_column("position [mm]")->rank);
  EXPECT_GT(guess_column("position [mm]")->rank, guess_column("position")->rank);
}

TEST(ColumnGuessTest, TellsTheAxisTheSideAndTheDuty) {
  using Words = std::vector<std::string>;
  EXPECT_EQ(guess_column("Motor 0 Position [mm]")->axis, Words{"0"});
  EXPECT_EQ(guess_column("x_force_N")->axis, Words{"x"});
  EXPECT_EQ(guess_column("/joint_states.position.elbow")->axis, Words{"elbow"});
  EXPECT_EQ(guess_column("dq2")->axis, Words{"2"});
  EXPECT_TRUE(guess_column("actual velocity raw")->axis.empty());
  EXPECT_EQ(guess_column("motor angle [deg]")->side, Side::motor);
  EXPECT_EQ(guess_column("link_position")->side, Side::load);
  EXPECT_EQ(guess_column("position")->side, Side::unsaid);
  EXPECT_TRUE(guess_column("pwm")->is_duty);
  EXPECT_TRUE(guess_column("power [%]")->is_duty);
  EXPECT_FALSE(guess_column("pwm [V]")->is_duty);
  EXPECT_FALSE(guess_column("command")->is_duty);
}

TEST(ColumnGuessTest, ScaledComesBeforeCounts) {
  EXPECT_GT(guess_column("position [mm]")->rank, guess_column("position [counts]")->rank);
  EXPECT_GT(guess_column("position")->rank, guess_column("position raw")->rank);
}

TEST(ColumnGuessTest, NamesAUnitThatIsNone) {
  EXPECT_EQ(guess_column("position [ells]")->unknown_unit, "ells");
  EXPECT_EQ(guess_column("q(:,2)")->unknown_unit, "");
}

}  // namespace
}  // namespace axisfit
