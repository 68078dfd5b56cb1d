// The linear case of the paper (its Fig. 3) against its transfer function.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <complex>
#include <iostream>

#include "tests/sim/axes.h"

namespace axisfit {
namespace {

/// Velocity after a step of U volts, by partial fractions of
///   J s w + B w = K_m K_i (1 + T_z s) / ((1 + T_p s)(1 + T_r s)) (K_1 U - K_2 K_t w),  v = r_g w.
class StepResponse {
 public:
  StepResponse(const Axis<double>& a, double U) {
    const double J = a.J_m + a.r_g * a.r_g * a.M, B = a.B_m + a.r_g * a.r_g * a.B_a;
    const double g = a.K_m * a.K_i, selection = g * a.K_2 * a.K_t;
    const double p2 = a.T_p * a.T_r, p1 = a.T_p + a.T_r;
    // Denominator d3 s^3 + d2 s^2 + d1 s + d0, numerator n (1 + T_z s).
    const double d3 = J * p2, d2 = J * p1 + B * p2, d1 = J + B * p1 + selection * a.T_z,
                 d0 = B + selection;
    const double n = a.r_g * g * a.K_1 * U;
    final_ = n / d0;
    Eigen::Matrix3d companion;
    companion << 0, 1, 0, 0, 0, 1, -d0 / d3, -d1 / d3, -d2 / d3;
    const Eigen::Vector3cd roots = companion.eigenvalues();
    for (int i = 0; i < 3; ++i) {
      std::complex<double> s = roots[i];
      const auto slope = [&] { return (3.0 * d3 * s + 2.0 * d2) * s + d1; };
      for (int k = 0; k < 3; ++k) s -= (((d3 * s + d2) * s + d1) * s + d0) / slope();
      terms_.push_back({s, n * (1.0 + a.T_z * s) / (s * slope())});
    }
  }
  double final_value() const { return final_; }
  double operator()(double t) const {
    std::complex<double> v = final_;
    for (const auto& [s, amplitude] : terms_) v += amplitude * std::exp(s * t);
    return v.real();
  }

 private:
  double final_;
  std::vector<std::pair<std::complex<double>, std::complex<double>>> terms_;
};

Model<double> linear_axis(double T_p) {
  Model<double> model = paper_axis();
  model.structure.drive = Drive::current_source;
  model.structure.transmission = Transmission::rigid;
  model.axis.T_p = T_p;
  model.axis.V_L = 1e6;
  return model;
}

TEST(LinearCase, EqualsTheAnalyticStepResponse) {  // statement 1 of the paper
  const auto times = instants(2000, 1e-3);
  for (const double T_p : {0.195, 0.04, 0.0071}) {
    const Model<double> model = linear_axis(T_p);
    const StepResponse exact(model.axis, 10.0);
    EXPECT_NEAR(exact.final_value(), 1.0, 1e-3);
    const auto result = run(model, step_command(), times);
    ASSERT_TRUE(result.finished);
    EXPECT_EQ(result.events.back(), 0);
    double worst = 0.0;
    for (std::size_t k = 0; k < times.size(); ++k)
      worst = std::max(worst, std::abs(result.states[k][1] - exact(times[k])));
    std::cout << "T_p " << T_p << ": " << worst / exact.final_value() << "\n";
    EXPECT_LT(worst / exact.final_value(), 1e-10);
  }
}

// A motor at a constant voltage: its speed rises to where the back EMF leaves what friction takes,
//   v' = (K_m (U - K_m v / r_g) / (R r_g) - (B_a + B_m / r_g^2) v) / (M + J_m / r_g^2).
TEST(MotorAtAVoltage, ReachesItsSpeedLikeAFirstOrderLag) {
  Model<double> model = paper_axis();
  model.structure = {Drive::motor_voltage, Transmission::rigid};
  const Axis<double>& a = model.axis;
  const double U = 12.0, r2 = a.r_g * a.r_g;
  const double rate = (a.K_m * a.K_m / (a.R * r2) + a.B_a + a.B_m / r2) / (a.M + a.J_m / r2);
  const double speed = a.K_m * U / (a.R * a.r_g) / (a.M + a.J_m / r2) / rate;
  const auto times = instants(500, 2e-3);
  const auto result = run(model, {{0.0}, {U}}, times);
  ASSERT_TRUE(result.finished);
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double v = speed * (1.0 - std::exp(-rate * times[k]));
    EXPECT_NEAR(result.states[k][1], v, 1e-12 * speed);
  }
  const Equations<double> equations(model);
  Input<double> input;
  input.command = U;
  State<double> y{};
  y[3] = 2.0;
  EXPECT_DOUBLE_EQ(equations.current({}, y, input), (U - a.K_m * 2.0) / a.R);
}

/// Largest difference in velocity to the linear case, of the whole model with its limits out of the
/// way, no backlash, and the given stiffness and gain.
double distance_to_linear(double k_g, double K_v) {
  Model<double> model = paper_axis();
  model.axis.T_p = 0.195;
  model.axis.H = 0.0;
  model.axis.V_L = 1e6;
  model.axis.V_s = 1e5;
  model.axis.k_g = k_g;
  model.axis.b_g = 1500.0 * std::sqrt(k_g / 5e6);  // the same damping ratio of the gear
  model.axis.K_v = K_v;
  // A command of a millivolt: what is linear does not depend on its size, and no limit is met.
  const Schedule command{{0.0}, {1e-3}};
  const StepResponse exact(model.axis, 1e-3);
  const auto times = instants(1000, 1e-3);
  const auto result = run(model, command, times);
  EXPECT_TRUE(result.finished);
  double worst = 0.0;
  for (std::size_t k = 0; k < result.states.size(); ++k)
    worst = std::max(worst, std::abs(result.states[k][1] - exact(times[k])));
  return worst / exact.final_value();
}

TEST(LinearCase, IsWhatAStiffGearAndAHighGainLeadTo) {
  const double soft = distance_to_linear(5e8, 1e4);
  const double stiffer = distance_to_linear(5e9, 1e5);
  const double stiffest = distance_to_linear(5e10, 1e6);
  std::cout << soft << " " << stiffer << " " << stiffest << "\n";
  EXPECT_LT(stiffer, 0.5 * soft);
  EXPECT_LT(stiffest, 0.5 * stiffer);
  EXPECT_LT(stiffest, 1e-3);
}

}  // namespace
}  // namespace axisfit
