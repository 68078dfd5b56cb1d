#include "init/columns/units.h"

#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <variant>
#include <vector>

#include "base/units.h"

namespace axisfit {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(StoredUnits, HaveTheSizeOfBaseUnitsOnTheirOwnJoint) {
  struct Case {
    Kind kind;
    const char* text;
    std::optional<Joint> joint;
    double size;
  };
  for (const Case& c :
       std::vector<Case>{{Kind::position, "mm", Joint::prismatic, 1e-3},
                         {Kind::position, "inch", Joint::prismatic, 0.0254},
                         {Kind::position, "rad", Joint::revolute, 1.0},
                         {Kind::position, "rev", Joint::revolute, 2.0 * kPi},
                         {Kind::load_position, "deg", Joint::revolute, kPi / 180.0},
                         {Kind::velocity, "rpm", Joint::revolute, kPi / 30.0},
                         {Kind::velocity, "rev/s", Joint::revolute, 2.0 * kPi},
                         {Kind::velocity, "furlong/day", Joint::prismatic, 201.168 / 86400.0},
                         {Kind::acceleration, "g", Joint::prismatic, 9.80665},
                         {Kind::acceleration, "rad/s^2", Joint::revolute, 1.0},
                         {Kind::force, "kN", Joint::prismatic, 1e3},
                         {Kind::force, "N mm", Joint::revolute, 1e-3},
                         {Kind::current, "mA", {}, 1e-3},
                         {Kind::time, "us", {}, 1e-6},
                         {Kind::supply, "mV", {}, 1e-3}}) {
    SCOPED_TRACE(c.text);
    const auto unit = stored_unit(c.kind, c.text);
    ASSERT_TRUE(unit);
    EXPECT_EQ(unit->joint, c.joint);
    EXPECT_NEAR(unit->size / c.size, 1.0, 1e-5);
    EXPECT_FALSE(unit->is_assumed);
    const auto factor = unit_factor(unit->written, si_unit(c.kind, c.joint.value_or(Joint{})));
    ASSERT_TRUE(std::holds_alternative<double>(factor));
    EXPECT_NEAR(std::get<double>(factor) * unit->factor, unit->size, 1e-9 * unit->size);
  }
}

TEST(StoredUnits, OfUnknownSizeSaySo) {
  for (const auto& [kind, text] : {std::pair(Kind::position, "counts"),
                                   {Kind::velocity, "counts/s"},
                                   {Kind::force, "%"},
                                   {Kind::current, "0.1%"},
                                   {Kind::command, "%"}}) {
    const auto unit = stored_unit(kind, text);
    ASSERT_TRUE(unit) << text;
    EXPECT_TRUE(unit->is_assumed) << text;
    EXPECT_FALSE(unit->joint) << text;
  }
  for (const auto& [kind, text] : {std::pair(Kind::position, "V"),
                                   {Kind::velocity, "Hz"},
                                   {Kind::force, "counts"},
                                   {Kind::time, "%"},
                                   {Kind::position, "furlongs per"},
                                   {Kind::position, ""}})
    EXPECT_FALSE(stored_unit(kind, text)) << text;
}

TEST(StoredUnits, ACommandIsTreatedAsVolts) {
  for (const auto& [text, factor] : {std::pair("V", 1.0), {"mA", 1e-3}, {"N", 1.0}, {"N m", 1.0}}) {
    const auto unit = stored_unit(Kind::command, text);
    ASSERT_TRUE(unit) << text;
    EXPECT_EQ(unit->written, "V");
    EXPECT_NEAR(unit->factor, factor, 1e-12);
  }
}

TEST(UnitsOfNames, AreWrittenAsPeopleDo) {
  struct Case {
    Kind kind;
    const char *piece, *unit;
  };
  for (const Case& c : std::vector<Case>{{Kind::velocity, "RadPerSec", "rad/s"},
                                         {Kind::velocity, "rad_per_sec", "rad/s"},
                                         {Kind::velocity, "rad/sec", "rad/s"},
                                         {Kind::velocity, "MetersPerSecond", "m/s"},
                                         {Kind::velocity, "RotationsPerSec", "rev/s"},
                                         {Kind::velocity, "1/min", "rpm"},
                                         {Kind::velocity, "min^-1", "rpm"},
                                         {Kind::velocity, "RPM", "rpm"},
                                         {Kind::velocity, "turns/s", "rev/s"},
                                         {Kind::acceleration, "m/s\u00B2", "m/s^2"},
                                         {Kind::acceleration, "RadPerSecSquared", "rad/s^2"},
                                         {Kind::acceleration, "MetersPerSecPerSec", "m/s^2"},
                                         {Kind::position, "Rad", "rad"},
                                         {Kind::position, "turns", "rev"},
                                         {Kind::position, "\u00B5m", "um"},
                                         {Kind::position, "Ink", "counts"},
                                         {Kind::force, "Nm", "N m"},
                                         {Kind::current, "Amps", "A"},
                                         {Kind::motor_voltage, "Volts", "V"},
                                         {Kind::time, "millis", "ms"},
                                         {Kind::position, "pos", ""},
                                         {Kind::position, "", ""}})
    EXPECT_EQ(unit_in(c.kind, c.piece), c.unit) << c.piece;
}

TEST(UnitsOfNames, AreWhatIsMeant) {
  EXPECT_EQ(unit_meant(Kind::force, "MN"), "MN") << "no millinewton";
  EXPECT_EQ(unit_meant(Kind::force, "nm"), "N m");
  EXPECT_EQ(unit_meant(Kind::velocity, "1/min"), "rpm") << "no radian per minute";
  EXPECT_EQ(unit_meant(Kind::velocity, "furlong/day"), "furlong/day");
  EXPECT_EQ(unit_meant(Kind::position, "MM"), "mm");
  EXPECT_EQ(unit_meant(Kind::position, "V"), "");
}

TEST(UnitsOfSizes, NeedNotBeExactAndAreOfTheJoint) {
  EXPECT_EQ(unit_of_size(Kind::velocity, 0.00103, Joint::prismatic)->text, "mm/s");
  EXPECT_EQ(unit_of_size(Kind::acceleration, 9.7, Joint::prismatic)->text, "g");
  EXPECT_EQ(unit_of_size(Kind::position, 1.0, Joint::revolute)->text, "rad");
  EXPECT_EQ(unit_of_size(Kind::velocity, 0.1047, Joint::revolute)->text, "rpm");
  EXPECT_FALSE(unit_of_size(Kind::position, 0.4, Joint::prismatic));
  EXPECT_FALSE(unit_of_size(Kind::position, -1.0, {}));
}

TEST(WordsOfNames, EndAtSignsCapitalsAndNumbers) {
  using Words = std::vector<std::string>;
  EXPECT_EQ(words_of("Motor 0 Position"), (Words{"motor", "0", "position"}));
  EXPECT_EQ(words_of("actPos_um"), (Words{"act", "pos", "um"}));
  EXPECT_EQ(words_of("dq12"), (Words{"dq", "12"}));
  EXPECT_EQ(words_of("Motor1Position"), (Words{"motor", "1", "position"}));
  EXPECT_EQ(words_of("tau(:,3)"), (Words{"tau", "3"}));
  EXPECT_EQ(words_of("0x6064"), (Words{"0x6064"}));
  EXPECT_EQ(words_of("\u00DCberlast"), (Words{"\u00DCberlast"}));
  EXPECT_TRUE(words_of("[ ]").empty());
}

}  // namespace
}  // namespace axisfit
