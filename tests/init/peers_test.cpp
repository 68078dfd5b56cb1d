// The configurations of the analysis test of WPILib's SysId (wpilibsuite/sysid,
// FeedforwardAnalysisTest): a slow ramp and a step of the voltage, both ways, of
//   V = kS sign(v) + kV v + kA a + kG, or kG cos(position) of an arm.
// It asks for every gain to 0.003. Its acceleration is exact; here nothing is, but noise there is
// none. From --init, with the machines integrated by this file.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/init/made_job.h"

namespace axisfit {
namespace {

struct Gains {
  double kS, kV, kA, kG;
};
enum class Machine { simple, elevator, arm };

double sign_of(double x) { return double(x > 0.0) - double(x < 0.0); }

/// One test of five seconds at 5 ms. The voltage holds for a sample.
std::string recorded(const Gains& gains, Machine machine, bool is_step, double direction) {
  constexpr double kSample = 5e-3, kRamp = 0.25, kStep = 7.0;
  constexpr int kSamples = 1000, kParts = 500;
  const bool turns = machine != Machine::elevator;
  std::string text = turns ? "timestamp (s),voltage (V),position (rad),velocity (rad/s)\n"
                           : "timestamp (s),voltage (V),position (m),velocity (m/s)\n";
  double x = 0.0, v = 0.0, voltage = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    text += fmt::format("{:.6f},{:.6f},{:.9f},{:.9f}\n", kSample * i, voltage, x, v);
    for (int part = 0; part < kParts; ++part) {
      constexpr double h = kSample / kParts;
      const double weight = machine == Machine::simple     ? 0.0
                            : machine == Machine::elevator ? gains.kG
                                                           : gains.kG * std::cos(x);
      const double load = voltage - gains.kV * v - weight;
      const bool sticks = v == 0.0 && std::abs(load) <= gains.kS;
      const double friction = gains.kS * (v == 0.0 ? sign_of(load) : sign_of(v));
      const double a = sticks ? 0.0 : (load - friction) / gains.kA;
      // The mean of the speeds before and after; a step that reverses ends at rest.
      const double after = v * (v + h * a) < 0.0 ? 0.0 : v + h * a;
      x += 0.5 * h * (v + after);
      v = after;
    }
    voltage = is_step ? direction * kStep : voltage + direction * kRamp * kSample;
  }
  return text;
}

struct Peer {
  const char* name;
  Machine machine;
  Gains gains;
};

class PeersTest : public InitJobTest, public ::testing::WithParamInterface<Peer> {};

TEST_P(PeersTest, EveryGainIsFound) {
  const auto& [name, machine, gains] = GetParam();
  std::vector<std::string> files;
  for (const auto& [file, is_step, direction] :
       {std::tuple("slow-forward.csv", false, 1.0), std::tuple("slow-backward.csv", false, -1.0),
        std::tuple("fast-forward.csv", true, 1.0), std::tuple("fast-backward.csv", true, -1.0)}) {
    folder_.write(file, recorded(gains, machine, is_step, direction));
    files.emplace_back(file);
  }
  make(files, {}, 1.0);
  Job job = read().job;
  for (Recording& r : job.recordings) r.role = Role::fit;
  const FitResult fit = estimate(job);
  ASSERT_TRUE(fit.is_usable()) << fit.message;
  std::map<std::string, double> truth{{"M", gains.kA},
                                      {"J", gains.kA},
                                      {"B_a", gains.kV},
                                      {"coulomb_friction.F_c", gains.kS},
                                      {"coulomb_friction.T_c", gains.kS}};
  const double constant = machine == Machine::elevator ? -gains.kG : 0.0;
  truth["constant_force.F_0"] = truth["constant_torque.T_0"] = constant;
  truth["pendulum_gravity.G_c"] = machine == Machine::arm ? gains.kG : 0.0;
  truth["pendulum_gravity.G_s"] = 0.0;
  std::size_t found = 0;
  for (const ParameterResult& p : fit.parameters) {
    const std::string& quantity = job.entry(p.id.quantity).name;
    if (!truth.contains(quantity)) continue;
    ++found;
    EXPECT_NEAR(p.value, truth.at(quantity), 0.003) << quantity;
    EXPECT_LT(p.uncertainty.standard_error, 0.003) << quantity;
  }
  EXPECT_GE(found, 3u);
}

constexpr Gains kOne{1.01, 3.060, 0.327, -0.211}, kTwo{0.547, 0.0693, 0.1170, -0.122};
INSTANTIATE_TEST_SUITE_P(SysId, PeersTest,
                         ::testing::Values(Peer{"Simple1", Machine::simple, kOne},
                                           Peer{"Simple2", Machine::simple, kTwo},
                                           Peer{"Elevator1", Machine::elevator, kOne},
                                           Peer{"Elevator2", Machine::elevator, kTwo},
                                           Peer{"Arm1", Machine::arm, kOne},
                                           Peer{"Arm2", Machine::arm, kTwo}),
                         [](const auto& peer) { return std::string(peer.param.name); });

}  // namespace
}  // namespace axisfit
