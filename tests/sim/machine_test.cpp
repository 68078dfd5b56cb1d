#include "sim/machine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <string>

#include "sim/controller.h"
#include "tests/sim/axes.h"

namespace axisfit {
namespace {

/// Three masses that forces drive: x and y share inertia because they are not square, z hangs on y,
/// whose place shifts its weight, and its acceleration shakes x.
constexpr double kX = 12.0, kY = 8.0, kZ = 5.0, kShared = 0.9, kWeight = 6.0, kReaction = -0.4;
constexpr double kBx = 30.0, kBy = 15.0, kBz = 25.0;

constexpr Motional kPosition{Motional::Of::position, 0}, kAcceleration{Motional::Of::position, 2};

CoupledAxis driven(const char* name, double mass, double damping, StepMotion step) {
  CoupledAxis axis;
  axis.name = name;
  axis.rig.name = name;
  axis.rig.model = driven_mass(mass);
  axis.rig.model.axis.B_a = damping;
  axis.motion = step;
  return axis;
}

std::vector<CoupledAxis> machine() {
  std::vector<CoupledAxis> axes{driven("x", kX, kBx, {40.0, 0.2}),
                                driven("y", kY, kBy, {-30.0, 0.3}),
                                driven("z", kZ, kBz, {20.0, 0.50003})};
  const auto channels = [](CoupledAxis& axis, ChannelList list,
                           std::vector<ChannelSource> sources) {
    axis.rig.model.structure.channels = kept(list);
    axis.sources = std::move(sources);
  };
  channels(axes[0], {{"y", "m/s^2", 0.0}, {"z", "m/s^2", 0.0}},
           {{1, kAcceleration, 1.0}, {2, kAcceleration, 1.0}});
  channels(axes[1], {{"x", "m/s^2", 0.0}}, {{0, kAcceleration, 1.0}});
  channels(axes[2], {{"y", "mm", 0.0}}, {{1, kPosition, 1e3}});
  add_effect<ChannelForce>(axes[0].rig.model).k = {-kShared, kReaction, 0.0, 0.0};
  add_effect<ChannelForce>(axes[1].rig.model).k[0] = -kShared;
  add_effect<ChannelForce>(axes[2].rig.model).k[0] = kWeight / 1e3;
  return axes;
}

/// The equations of all three at once, by the classical Runge-Kutta method in steps of 10 us.
std::vector<std::array<double, 6>> directly(double duration, double rate) {
  using Vector = std::array<double, 6>;
  constexpr double h = 1e-5;
  const auto rates = [](double t, const Vector& s) -> Vector {
    const double fx = (t > 0.2 ? 40.0 : 0.0) - kBx * s[3];
    const double fy = (t > 0.3 ? -30.0 : 0.0) - kBy * s[4];
    const double fz = (t > 0.50003 ? 20.0 : 0.0) - kBz * s[5] + kWeight * s[1];
    const double az = fz / kZ;
    // kX ax + kShared ay = fx + kReaction az, kShared ax + kY ay = fy
    const double right = fx + kReaction * az, det = kX * kY - kShared * kShared;
    return {s[3], s[4], s[5], (right * kY - kShared * fy) / det, (kX * fy - kShared * right) / det,
            az};
  };
  const auto along = [](Vector s, double by, const Vector& k) {
    for (std::size_t i = 0; i < 6; ++i) s[i] += by * k[i];
    return s;
  };
  std::vector<Vector> path{{}};
  Vector s{};
  const long every = std::lround(1.0 / (rate * h)), steps = std::lround(duration / h);
  for (long n = 0; n < steps; ++n) {
    const double middle = (double(n) + 0.5) * h;  // within the step the forces do not switch
    const Vector a = rates(middle, s), b = rates(middle, along(s, 0.5 * h, a)),
                 c = rates(middle, along(s, 0.5 * h, b)), d = rates(middle, along(s, h, c));
    for (std::size_t i = 0; i < 6; ++i) s[i] += h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]);
    if ((n + 1) % every == 0) path.push_back(s);
  }
  return path;
}

RecordingOptions exactly(double duration, double rate) {
  RecordingOptions options;
  options.duration = duration;
  options.rate = rate;
  options.noise = false;
  options.signals = {Signal::position, Signal::velocity};
  return options;
}

MachineRecording recorded(const std::vector<CoupledAxis>& axes, const RecordingOptions& options) {
  return record_machine(axes, std::vector(axes.size(), options.signals), options);
}

TEST(Machine, MovesAsTheJointEquationsSay) {
  const auto truth = directly(1.5, 500.0);
  const MachineRecording found = recorded(machine(), exactly(1.5, 500.0));
  std::cout << found.sweeps << " sweeps, last change " << found.change << "\n";
  EXPECT_LT(found.change, 1e-9);
  EXPECT_LE(found.sweeps, 10);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t of = 0; of < 2; ++of) {
      const std::vector<double>& values = found.axes[axis][2 + of].values;
      ASSERT_EQ(values.size(), truth.size());
      double range = 0.0, worst = 0.0;
      for (std::size_t i = 0; i < truth.size(); ++i) {
        range = std::max(range, std::abs(truth[i][axis + 3 * of]));
        worst = std::max(worst, std::abs(values[i] - truth[i][axis + 3 * of]));
      }
      std::cout << "xyz"[axis] << (of == 0 ? " position " : " velocity ") << worst / range << "\n";
      EXPECT_LT(worst, 1e-6 * range);
    }
}

TEST(Machine, RecordsTheChannelsOfEveryAxis) {
  const MachineRecording found = recorded(machine(), exactly(1.0, 500.0));
  const std::vector<Column>& z = found.axes[2];
  ASSERT_EQ(z.size(), 5u);
  EXPECT_EQ(z.back().name, "y_mm");
  const std::vector<double>& y = found.axes[1][2].values;
  for (std::size_t i = 0; i < y.size(); ++i) ASSERT_NEAR(z.back().values[i], 1e3 * y[i], 1e-6);
}

TEST(Machine, WithoutCouplingsIsItsAxes) {
  std::vector<CoupledAxis> axes = machine();
  for (CoupledAxis& axis : axes) {
    axis.rig.model.structure.effects.reset();
    axis.rig.model.structure.channels = nullptr;
    axis.sources.clear();
  }
  const RecordingOptions options = exactly(1.0, 500.0);
  const MachineRecording found = recorded(axes, options);
  EXPECT_EQ(found.sweeps, 2);
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const std::vector<Column> alone = record(axes[a].rig, axes[a].motion, options);
    ASSERT_EQ(alone.size(), found.axes[a].size());
    for (std::size_t c = 0; c < alone.size(); ++c)
      for (std::size_t i = 0; i < alone[c].values.size(); ++i)
        ASSERT_NEAR(alone[c].values[i], found.axes[a][c].values[i], 1e-12);
  }
}

TEST(Machine, SaysWhereCouplingsAreTooStrong) {
  std::vector<CoupledAxis> axes = machine();
  for (const std::size_t a : {0u, 1u})
    std::get<ChannelForce<double>>(axes[a].rig.model.effects).k[0] = -15.0;  // above sqrt(12 * 8)
  try {
    recorded(axes, exactly(0.5, 500.0));
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("couplings are too strong"), std::string::npos);
  }
}

TEST(Machine, MovesOfTheControllerShakeANeighbour) {
  // The x axis of the paper moves; the y axis, at rest with dry friction, is shaken.
  std::vector<CoupledAxis> axes(2);
  for (CoupledAxis& axis : axes) axis.rig.model = paper_axis();
  axes[0].name = "x";
  axes[0].motion = MoveMotion{0.3, 0.5, 2.0};
  axes[1].name = "y";
  axes[1].motion = StepMotion{0.0, 0.0};
  axes[1].rig.model.structure.channels = kept({{"x", "m/s^2", 0.0}});
  axes[1].sources = {{0, kAcceleration, 1.0}};
  add_effect<ChannelForce>(axes[1].rig.model).k[0] = -3.0;
  RecordingOptions options = exactly(1.5, 200.0);
  const MachineRecording found = recorded(axes, options);
  EXPECT_LE(found.sweeps, 3);  // y follows, x is not shaken back
  const std::vector<double>& y = found.axes[1][3].values;
  EXPECT_GT(*std::ranges::max_element(y), 1e-5);
}

// A mass that a joint swings on a carriage: with nothing else acting, momentum and inertia stay.
TEST(Machine, AMassThatTurnsPushesAsItsMomentumSays) {
  constexpr double kLever = 0.35;  // kg m
  CoupledAxis carriage = driven("carriage", 5.0, 0.0, {0.0, 0.0}),
              wrist = driven("wrist", 0.02, 0.05, {0.3, 0.1});
  wrist.rig.model.structure.joint = Joint::revolute;
  carriage.rig.model.structure.channels =
      kept({{"swing", "1/s^2", 0.0}, {"place", "1", 0.0}, {"height", "1", 0.0}});
  carriage.sources = {{1, {Motional::Of::sine, 2}, 1.0},
                      {1, {Motional::Of::sine, 0}, 1.0},
                      {1, {Motional::Of::cosine, 0}, 1.0}};
  add_effect<ChannelForce>(carriage.rig.model).k[0] = -kLever;
  const MachineRecording found = recorded({carriage, wrist}, exactly(1.0, 500.0));
  const auto& speed = found.axes[0][3].values;
  const auto &angle = found.axes[1][2].values, &rate = found.axes[1][3].values;
  double worst = 0.0, range = 0.0;
  for (std::size_t i = 0; i < speed.size(); ++i) {
    const double expected = -kLever * std::cos(angle[i]) * rate[i] / 5.0;
    worst = std::max(worst, std::abs(speed[i] - expected));
    range = std::max(range, std::abs(expected));
    ASSERT_NEAR(found.axes[0][5].values[i], std::sin(angle[i]), 1e-12);
    ASSERT_NEAR(found.axes[0][6].values[i], std::cos(angle[i]), 1e-12);
  }
  EXPECT_GT(*std::ranges::max_element(angle), 1.0);
  EXPECT_LT(worst, 1e-9 * range);
}

}  // namespace
}  // namespace axisfit
