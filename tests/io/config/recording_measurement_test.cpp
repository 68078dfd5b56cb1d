#include "io/config/recording_measurement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/io/config/recording_reader.h"

namespace axisfit {
namespace {

/// A velocity that moves, and the same held ten times.
std::vector<Column> columns() {
  Column time{"t", {}}, held{"held", {}}, plain{"v", {}};
  for (int i = 0; i < 200; ++i) {
    time.values.push_back(1e-3 * i);
    plain.values.push_back(std::sin(0.05 * i) + 1e-3 * std::cos(2.1 * i));
    held.values.push_back(plain.values[static_cast<std::size_t>(i - i % 10)]);
  }
  return {time, held, plain};
}

/// Reads the signals of a recording of 200 samples at 1 kHz.
class MeasurementTest : public RecordingReaderTest {
 protected:
  MeasurementTest() : RecordingReaderTest(columns()) {}

  /// Reads signals from YAML; how many there are.
  std::size_t read(const std::string& yaml, Drive drive = Drive::force_source) {
    measured_.clear();
    read_signals(yaml, [&](const ConfigNode& node, SeriesReader& reader) {
      ConfigMap signals(node);
      const Structure structure{drive, Transmission::rigid, {}, Joint::prismatic};
      read_measurements(signals, structure, {}, reader, measured_);
      times_ = *reader.times();
    });
    return measured_.size();
  }
  /// The only one, at the times of the recording.
  Measurement only(const std::string& yaml) {
    EXPECT_EQ(read("velocity: {column: v, unit: m/s, " + yaml + "}"), 1u);
    EXPECT_EQ(measured_.size(), 1u);
    return on_times(measured_.front(), times_);
  }

  std::vector<Measured> measured_;
  std::vector<double> times_;
};

TEST_F(MeasurementTest, HasItsNoiseFromWhereTheJobSays) {
  Measurement m = only("sigma: 2 mm/s");
  EXPECT_EQ(m.sigma, 2e-3);
  EXPECT_EQ(m.noise, NoiseSource::given);
  EXPECT_TRUE(m.fitted);
  m = only("sigma: standstill, fit: false");
  EXPECT_EQ(m.noise, NoiseSource::standstill);
  EXPECT_FALSE(m.fitted);
  EXPECT_EQ(only("sigma: fit").noise, NoiseSource::fit);
  m = only("fit: true");
  EXPECT_EQ(m.noise, NoiseSource::differences);
  EXPECT_NEAR(m.sigma, 1e-3 / std::numbers::sqrt2, 5e-4);
  EXPECT_EQ(said(), "");
}

TEST_F(MeasurementTest, OfANoiseThatIsNotToBeSeenSaysSo) {
  for (double& x : sources_.tables["a.csv"].columns[2].values) x = 1.0;
  only("fit: true");
  EXPECT_EQ(said(),
            "the noise of velocity cannot be estimated from these samples: give its sigma, for "
            "example 'sigma: 0.01 m/s'\n");
}

TEST_F(MeasurementTest, AFilterIsOneOfTwo) {
  EXPECT_EQ(only("filter: {moving_average: 21}").filter.length, 21u);
  const Filter filter = only("filter: {butterworth: {order: 2, cutoff: 100 Hz}}").filter;
  EXPECT_EQ(filter.order, 2);
  EXPECT_NEAR(filter.cutoff, 0.1, 1e-12);  // per sample
  only("filter: {zero_phase: true}");
  EXPECT_EQ(said(), "give either a moving_average or a butterworth filter\n");
  only("filter: {moving_average: 20, zero_phase: true}");
  EXPECT_EQ(said(),
            "an average of 20 samples has none in the middle: with zero_phase give an odd "
            "number\n");
  only("filter: {butterworth: {order: 2, cutoff: 500 Hz}}");
  EXPECT_EQ(said(), "the cutoff must be below 500 Hz, half the sampling rate\n");
  only("sigma: 2 mm/s, filter: {moving_average: 195}");
  EXPECT_EQ(said(),
            "this leaves fewer than 10 samples of the velocity that do not depend on what was "
            "before the recording or only repeat: at least 10 are needed\n");
}

TEST_F(MeasurementTest, AHoldLeavesTheFreshSamples) {
  read("velocity: {column: held, unit: m/s, hold: 10}");
  const Measurement m = on_times(measured_.at(0), times_);
  EXPECT_EQ(std::ranges::count(m.uninformative, false), 20);
  EXPECT_TRUE(m.counts(10));
  EXPECT_FALSE(m.counts(11));
  only("hold: 10");
  EXPECT_EQ(said(), "the values of velocity do not repeat 10 times: correct or remove the hold\n");
}

TEST_F(MeasurementTest, CountsOnlyWhereThereIsAValue) {
  sources_.tables["a.csv"].columns[2].values[50] = NAN;
  const Measurement m = only("sigma: 2 mm/s");
  EXPECT_EQ(m.missing, 1u);
  EXPECT_FALSE(m.counts(50));
  EXPECT_EQ(std::ranges::count(m.uninformative, true), 1);
  EXPECT_NEAR(m.values[50], std::sin(2.5), 0.01) << "a curve through the others";
  only("sigma: 2 mm/s, hold: 2");
  EXPECT_EQ(
      said(),
      "a filter or hold needs a value of the velocity at every sample time, and at some there "
      "is none: fit the unfiltered samples, or remove it\n");
}

TEST_F(MeasurementTest, IsNotTheInput) {
  EXPECT_EQ(read("motor_current: {column: v, unit: A}", Drive::velocity_loop), 1u);
  EXPECT_EQ(said(), "");
  EXPECT_EQ(read("drive_force: {column: v, unit: N}"), 0u);
}

}  // namespace
}  // namespace axisfit
