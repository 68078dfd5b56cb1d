#include "base/units.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>
#include <numbers>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <variant>
#include <vector>

namespace axisfit {
namespace {

constexpr double kPi = std::numbers::pi;

void expect_factor(std::string_view unit, std::string_view si_unit, double factor) {
  const auto result = unit_factor(unit, si_unit);
  if (const auto* error = std::get_if<UnitError>(&result)) {
    ADD_FAILURE() << unit << ": " << error->message;
    return;
  }
  EXPECT_DOUBLE_EQ(std::get<double>(result), factor) << unit;
}

void expect_problem(std::string_view unit, std::string_view si_unit, UnitProblem problem) {
  const auto result = unit_factor(unit, si_unit);
  const auto* error = std::get_if<UnitError>(&result);
  ASSERT_NE(error, nullptr) << unit << " was accepted: " << std::get<double>(result);
  EXPECT_EQ(error->problem, problem) << unit << ": " << error->message;
}

std::string message(std::string_view unit, std::string_view si_unit) {
  const auto result = unit_factor(unit, si_unit);
  const auto* error = std::get_if<UnitError>(&result);
  return error == nullptr ? "accepted" : error->message;
}

TEST(UnitFactor, ConvertsPrefixes) {
  expect_factor("mm/s", "m/s", 1e-3);
  expect_factor("um", "m", 1e-6);
  expect_factor("µm", "m", 1e-6);       // micro sign
  expect_factor("\u03BCm", "m", 1e-6);  // Greek letter
  expect_factor("ms", "s", 1e-3);
  expect_factor("us", "s", 1e-6);
  expect_factor("min", "s", 60);
  expect_factor("kN/m", "N/m", 1e3);
  expect_factor("kN s/m", "N s/m", 1e3);
  expect_factor("mV", "V", 1e-3);
  expect_factor("A/V", "A/V", 1);
  expect_factor("g", "kg", 1e-3);
  expect_factor("mH", "H", 1e-3);
}

TEST(UnitFactor, AcceptsTheWritingsOfEngineers) {
  for (const char* unit : {"kg m^2", "kg*m^2", "kg * m^2", "kg·m²", "kg m2", "kg.m2", "kg-m^2",
                           " kg m² ", "kg\u00A0m²", "kg⋅m^2"}) {
    expect_factor(unit, "kg m^2", 1);
  }
  for (const char* unit : {"N s/m", "N·s/m", "N s m^-1", "N s m-1", "N s m⁻¹", "(N s)/m", "N/(m/s)",
                           "N s / m", "Ns/m", "kg/s"}) {
    expect_factor(unit, "N s/m", 1);
  }
  for (const char* unit : {"Vs/rad", "V s/rad", "V·s/rad", "V/(rad/s)", "V s"}) {
    expect_factor(unit, "V s/rad", 1);
  }
  for (const char* unit : {"Nm/A", "N·m/A", "N m/A", "N*m/A"}) expect_factor(unit, "N m/A", 1);
  for (const char* unit : {"ohm", "Ohm", "\u03A9", "\u2126"}) expect_factor(unit, "ohm", 1);
  expect_factor("kΩ", "ohm", 1e3);
}

TEST(UnitFactor, ReadsNewtonMetresAndNanometresApart) {
  expect_factor("Nm", "N m", 1);
  expect_factor("kNm", "N m", 1e3);
  expect_factor("mNm", "N m", 1e-3);
  expect_factor("Nmm", "N m", 1e-3);
  expect_factor("Nms/rad", "N m s/rad", 1);
  expect_factor("nm", "m", 1e-9);
  expect_problem("nm", "N m", UnitProblem::wrong_dimension);
}

TEST(UnitFactor, ConvertsAngles) {
  expect_factor("deg", "rad", kPi / 180);
  expect_factor("°", "rad", kPi / 180);
  expect_factor("rev", "rad", 2 * kPi);
  expect_factor("rpm", "rad/s", kPi / 30);
  expect_factor("rev/min", "rad/s", kPi / 30);
  expect_factor("1/s", "rad/s", 1);
  expect_factor("V s/deg", "V s/rad", 180 / kPi);
}

TEST(UnitFactor, DoesNotTakeCyclesForRadians) {
  expect_problem("Hz", "rad/s", UnitProblem::wrong_dimension);
  expect_problem("kHz", "rad/s", UnitProblem::wrong_dimension);
  expect_problem("rpm", "Hz", UnitProblem::wrong_dimension);
  expect_problem("1", "rad", UnitProblem::wrong_dimension);
  expect_problem("%", "rad", UnitProblem::wrong_dimension);
  expect_problem("deg", "1", UnitProblem::wrong_dimension);
  expect_problem("N m/deg", "N m", UnitProblem::wrong_dimension);
  expect_problem("V s rad", "V s/rad", UnitProblem::wrong_dimension);
}

TEST(UnitFactor, ConvertsDimensionlessUnits) {
  expect_factor("1", "1", 1);
  expect_factor("%", "1", 0.01);
  expect_factor("V/V", "1", 1);
  expect_factor("V/mV", "V/V", 1e3);
}

TEST(UnitFactor, RefusesWhatIsNotAUnit) {
  for (const char* unit : {"",      " ",      "furlongz",   "Kg",         "m/",
                           "/s",    "m//s",   "(m",         "m^",         "m'",
                           "10 mm", "2 kg",   "m 2",        "m/0",        "1000",
                           "0",     "-1",     "m^0.5",      "m^10",       "m^99999999",
                           "s1/2",  "m s -1", "K @ 273.15", "K from 273", "s since 1990-01-01",
                           ",5 m",  "m\n"}) {
    expect_problem(unit, "m", UnitProblem::unknown);
  }
  expect_problem(std::string(100'000, '('), "m", UnitProblem::unknown);
  expect_problem(std::string_view("m\0s", 3), "m", UnitProblem::unknown);
}

TEST(UnitFactor, RefusesScalesThatAreNotProportional) {
  expect_problem("degC", "K", UnitProblem::not_proportional);
  expect_problem("°C", "K", UnitProblem::not_proportional);
  expect_problem("K from 1", "K", UnitProblem::not_proportional);
  expect_problem("lg(re 1 W)", "W", UnitProblem::not_proportional);
}

TEST(UnitFactor, TellsWhatToWrite) {
  EXPECT_EQ(message("furlongz", "m/s"), "unknown unit 'furlongz'; use for example 'm/s'");
  EXPECT_EQ(message("kg", "m/s"), "'kg' cannot be converted to 'm/s'; use for example 'm/s'");
  EXPECT_EQ(message("kg", "1"),
            "'kg' cannot be used for a dimensionless quantity; use a plain number or '%'");
  EXPECT_EQ(message("degC", "K"), "'degC' is not proportional to it; use for example 'K'");
}

TEST(UnitFactor, ThrowsWhenTheWantedUnitIsWrong) {
  EXPECT_THROW(unit_factor("m", "furlongz"), std::invalid_argument);
  EXPECT_THROW(is_dimensionless("furlongz"), std::invalid_argument);
}

TEST(UnitFactor, IsSafeToCallFromSeveralThreads) {
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([] {
      for (int round = 0; round < 200; ++round) {
        expect_factor("kN s/m", "N s/m", 1e3);
        expect_problem("furlongz", "m", UnitProblem::unknown);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

TEST(IsDimensionless, TellsPlainNumbersFromAngles) {
  EXPECT_TRUE(is_dimensionless("1"));
  EXPECT_TRUE(is_dimensionless("V/V"));
  EXPECT_FALSE(is_dimensionless("rad"));
  EXPECT_FALSE(is_dimensionless("1/s"));
}

// In a process of its own, because the database is loaded only once.
TEST(UnitDatabaseDeathTest, NamesThePackageWhenItIsMissing) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto run = [] {
    setenv("UDUNITS2_XML_PATH", "/nonexistent/udunits2.xml", 1);
    try {
      unit_factor("m", "m");
    } catch (const std::runtime_error& error) {
      std::cerr << error.what();
      std::_Exit(3);
    }
    std::_Exit(0);
  };
  EXPECT_EXIT(run(), testing::ExitedWithCode(3), "^cannot load .* libudunits2-data");
}

}  // namespace
}  // namespace axisfit
