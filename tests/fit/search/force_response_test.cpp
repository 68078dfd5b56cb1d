#include "fit/search/force_response.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

/// A recording of position, velocity and acceleration with zeros.
Recording recording_of_zeros(std::size_t samples, double interval) {
  Recording recording;
  recording.times = instants(samples - 1, interval);
  for (const auto& [signal, sigma] : {std::pair{Signal::position, 1e-4},
                                      {Signal::velocity, 2e-3},
                                      {Signal::acceleration, 0.05}}) {
    Measurement& m = recording.measurements.emplace_back();
    m.signal = signal;
    m.sigma = sigma;
    m.values.edit().assign(samples, 0.0);
  }
  return recording;
}

std::vector<double> wavy(std::size_t samples, double rate) {
  std::vector<double> values(samples);
  for (std::size_t i = 0; i < samples; ++i)
    values[i] = std::sin(rate * static_cast<double>(i)) + 0.3;
  return values;
}

constexpr Observer kObserver{.velocity = 40.0, .position = 20.0, .acceleration = 400.0};

// Without an observer, an even force moves 1 kg by F t^2 / 2.
TEST(ForceResponse, OfAnEvenForceIsThatOfAFreeMass) {
  const Recording recording = recording_of_zeros(101, 1e-3);
  const Eigen::VectorXd shown = response_to(recording, std::vector<double>(101, 2.0), Observer{});
  EXPECT_NEAR(shown[100] * 1e-4, 2.0 * 0.1 * 0.1 / 2.0, 1e-12);
  EXPECT_NEAR(shown[201] * 2e-3, 2.0 * 0.1, 1e-12);
  EXPECT_NEAR(shown[302] * 0.05, 2.0, 1e-12);
}

TEST(ForceResponse, OfAComplexForceIsThatOfItsParts) {
  const Recording recording = recording_of_zeros(200, 1e-3);
  const std::vector<double> real = wavy(200, 0.1), imaginary = wavy(200, 0.03);
  std::vector<std::complex<double>> force;
  for (std::size_t i = 0; i < 200; ++i) force.emplace_back(real[i], imaginary[i]);
  const Eigen::VectorXcd shown = response_to(recording, force, kObserver);
  EXPECT_LT((shown.real() - response_to(recording, real, kObserver)).norm(), 1e-9);
  EXPECT_LT((shown.imag() - response_to(recording, imaginary, kObserver)).norm(), 1e-9);
}

TEST(ForceResponse, AndItsAdjointGiveTheSameProduct) {
  Recording recording = recording_of_zeros(200, 1e-3);
  recording.times.edit().back() += 3e-3;  // intervals may differ
  const std::vector<double> force = wavy(200, 0.1);
  const Eigen::VectorXd rows = Eigen::VectorXd::LinSpaced(600, -2.0, 5.0);
  for (const Observer& observer : {Observer{}, kObserver}) {
    const std::vector<double> adjoint = adjoint_response(recording, rows, observer);
    double product = 0.0;
    for (std::size_t i = 0; i < 200; ++i) product += force[i] * adjoint[i];
    const double expected = response_to(recording, force, observer).dot(rows);
    EXPECT_NEAR(product, expected, 1e-9 * std::abs(expected));
  }
}

}  // namespace
}  // namespace axisfit
