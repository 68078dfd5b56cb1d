// The configurations of the analysis test of WPILib's SysId (wpilibsuite/allwpilib,
// FeedforwardAnalysisTest): a slow ramp and a step of the voltage, both ways, or some of them, of
//   V = kS sign(v) + kV v + kA a + kG, or kG cos(position + offset) of an arm.
// It asks for every gain to 0.008 and for the offset to 0.03. Its drivetrains are its simple motors
// again. Its acceleration is exact; here nothing is, but noise there is none. From --init, with the
// machines integrated by this file.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/init/made_job.h"

namespace axisfit {
namespace {

struct Gains {
  double kS, kV, kA, kG, offset = 0.0;
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
                                                           : gains.kG * std::cos(x + gains.offset);
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
  std::string name;
  Machine machine;
  Gains gains;
  std::vector<std::string> tests{"slow-forward", "slow-backward", "fast-forward", "fast-backward"};
};

class PeersTest : public InitJobTest, public ::testing::WithParamInterface<Peer> {};

TEST_P(PeersTest, EveryGainIsFound) {
  const auto& [name, machine, gains, tests] = GetParam();
  std::vector<std::string> files;
  for (const std::string& test : tests) {
    files.push_back(test + ".csv");
    folder_.write(files.back(), recorded(gains, machine, test.starts_with("fast"),
                                         test.ends_with("forward") ? 1.0 : -1.0));
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
  const double weight = machine == Machine::arm ? gains.kG : 0.0;
  truth["pendulum_gravity.G_c"] = weight * std::cos(gains.offset);
  truth["pendulum_gravity.G_s"] = -weight * std::sin(gains.offset);
  std::map<std::string, double> found;
  for (const ParameterResult& p : fit.parameters) {
    const std::string& quantity = job.entry(p.id.quantity).name;
    if (!truth.contains(quantity)) continue;
    found[quantity] = p.value;
    EXPECT_NEAR(p.value, truth.at(quantity), 0.003) << quantity;
    EXPECT_LT(p.uncertainty.standard_error, 0.003) << quantity;
  }
  EXPECT_GE(found.size(), 3u);
  if (machine != Machine::arm) return;
  EXPECT_NEAR(std::atan2(-found["pendulum_gravity.G_s"], found["pendulum_gravity.G_c"]),
              gains.offset, 0.007);
}

std::vector<Peer> peers() {
  std::vector<Peer> all;
  for (const Gains& gains :
       {Gains{1.01, 3.060, 0.327, 0.211}, Gains{0.547, 0.0693, 0.1170, 0.122}}) {
    const char set = gains.kS > 1.0 ? '1' : '2';
    Gains lifted = gains;
    lifted.kG = -gains.kG;
    all.push_back({fmt::format("Simple{}", set), Machine::simple, gains});
    all.push_back({fmt::format("Elevator{}", set), Machine::elevator, lifted});
    for (const double offset : {-2.0, -1.0, 0.0, 1.0, 2.0}) {
      Gains turned = gains;
      turned.offset = offset;
      all.push_back({fmt::format("Arm{}At{}{}", set, offset < 0.0 ? "Minus" : "", std::abs(offset)),
                     Machine::arm, turned});
    }
    // What is left determines all gains; those of an arm take its full turn and both slow ramps.
    const std::vector<std::string> two{"slow-forward", "fast-backward"},
        three{"slow-forward", "slow-backward", "fast-forward"};
    all.push_back({fmt::format("Simple{}OfTwo", set), Machine::simple, gains, two});
    all.push_back({fmt::format("Elevator{}OfTwo", set), Machine::elevator, lifted, two});
    all.push_back({fmt::format("Arm{}OfThree", set), Machine::arm, gains, three});
  }
  return all;
}
INSTANTIATE_TEST_SUITE_P(SysId, PeersTest, ::testing::ValuesIn(peers()),
                         [](const auto& peer) { return peer.param.name; });

}  // namespace
}  // namespace axisfit
