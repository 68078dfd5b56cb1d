// Channels as causes, on axes that are simulated here and not by the project: all axes of a machine
// in one Runge-Kutta integration with steps of 50 us, dry friction as a steep tanh, servo drives.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "base/random.h"
#include "tests/fit/search/selection.h"
#include "tests/sim/axes.h"

namespace axisfit {
namespace {

constexpr int kAxes = 3;
using Three = std::array<double, kAxes>;

/// Three axes with a mass matrix: x and y may share inertia. The supply of all sags.
struct Machine {
  Three mass{14.0, 9.0, 5.0}, viscous{50.0, 35.0, 20.0}, coulomb{9.0, 6.0, 4.0};
  double shared = 0.0;  ///< kg, of x and y
  double sag = 0.0;     ///< relative loss of force per volt
};

/// What was recorded: per sample the force, place, speed and acceleration of all axes, and the
/// voltage of the supply.
struct Log {
  std::vector<double> times, supply;
  std::array<std::vector<double>, kAxes> force, place, speed, acceleration;
};

/// A sum of sines that begins at rest: place, speed and acceleration.
class Path {
 public:
  Path(std::mt19937_64& generator, double reach) {
    for (double& f : frequency_) f = 0.15 + 0.8 * uniform(generator);
    for (double& p : phase_) p = 2.0 * std::numbers::pi * uniform(generator);
    reach_ = reach;
  }
  double at(double t) const {
    const double u = std::min(t / 0.6, 1.0);
    double sum = 0.0;
    for (std::size_t i = 0; i < kWaves; ++i)
      sum += std::sin(2.0 * std::numbers::pi * frequency_[i] * t + phase_[i]) / kWaves;
    return reach_ * sum * u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
  }
  double speed(double t) const {
    return (at(t + kStep) - at(std::max(0.0, t - kStep))) / (2 * kStep);
  }
  double acceleration(double t) const {
    return t < kStep ? 0.0 : (at(t + kStep) - 2.0 * at(t) + at(t - kStep)) / (kStep * kStep);
  }

 private:
  static constexpr std::size_t kWaves = 3;
  static constexpr double kStep = 1e-4;
  std::array<double, kWaves> frequency_{}, phase_{};
  double reach_ = 0.0;
};

Log driven(const Machine& m, std::uint64_t seed) {
  constexpr double kSample = 4e-3, kW = 20.0, h = 5e-5;
  constexpr int kSamples = 2000, kParts = 80;
  std::mt19937_64 generator(seed);
  const std::array<Path, kAxes> path{Path(generator, 0.5), Path(generator, 0.6),
                                     Path(generator, 0.3)};
  const double wave = 0.5 + 0.3 * uniform(generator), wave2 = 1.3 + 0.4 * uniform(generator);
  const auto supply = [&](double t) {
    return -1.5 + 1.2 * std::sin(wave * t) + 0.8 * std::sin(wave2 * t);
  };
  Log log;
  Three y{}, v{}, force{};
  const auto accelerations = [&](double t, const Three& speed, const Three& f) {
    Three push;
    for (std::size_t a = 0; a < kAxes; ++a)
      push[a] = (1.0 + m.sag * supply(t)) * f[a] - m.viscous[a] * speed[a] -
                m.coulomb[a] * std::tanh(speed[a] / 2e-4);
    const double det = m.mass[0] * m.mass[1] - m.shared * m.shared;
    return Three{(push[0] * m.mass[1] - m.shared * push[1]) / det,
                 (m.mass[0] * push[1] - m.shared * push[0]) / det, push[2] / m.mass[2]};
  };
  for (int k = 0; k < kSamples; ++k) {
    const double t = k * kSample;
    Three after;
    for (std::size_t a = 0; a < kAxes; ++a)
      after[a] = m.mass[a] * (path[a].acceleration(t) + kW * kW * (path[a].at(t) - y[a]) +
                              2.0 * kW * (path[a].speed(t) - v[a]));
    const Three now = accelerations(t, v, force);
    log.times.push_back(t);
    log.supply.push_back(supply(t));
    for (std::size_t a = 0; a < kAxes; ++a) {
      log.force[a].push_back(force[a]);
      log.place[a].push_back(y[a]);
      log.speed[a].push_back(v[a]);
      log.acceleration[a].push_back(now[a]);
    }
    for (int part = 0; part < kParts; ++part) {
      const double s = t + part * h;
      const auto ramp = [&](double at) {
        Three f;
        for (std::size_t a = 0; a < kAxes; ++a)
          f[a] = force[a] + (part + at) / kParts * (after[a] - force[a]);
        return f;
      };
      const auto along = [](Three x, double by, const Three& rate) {
        for (std::size_t a = 0; a < kAxes; ++a) x[a] += by * rate[a];
        return x;
      };
      const Three a1 = accelerations(s, v, ramp(0.0)), v2 = along(v, 0.5 * h, a1);
      const Three a2 = accelerations(s + 0.5 * h, v2, ramp(0.5)), v3 = along(v, 0.5 * h, a2);
      const Three a3 = accelerations(s + 0.5 * h, v3, ramp(0.5)), v4 = along(v, h, a3);
      const Three a4 = accelerations(s + h, v4, ramp(1.0));
      for (std::size_t a = 0; a < kAxes; ++a) {
        y[a] += h / 6.0 * (v[a] + 2.0 * (v2[a] + v3[a]) + v4[a]);
        v[a] += h / 6.0 * (a1[a] + 2.0 * (a2[a] + a3[a]) + a4[a]);
      }
    }
    force = after;
  }
  return log;
}

/// The job of one axis, with the accelerations of the other two and the supply as channels.
Job job_of(const Machine& machine, std::size_t axis, std::uint64_t seed) {
  Job job;
  job.model = driven_mass(1.3 * machine.mass[axis]);
  job.model.axis.B_a = 0.7 * machine.viscous[axis];
  add_effect<CoulombFriction>(job.model).F_c = 0.5 * machine.coulomb[axis];
  add_effect<ConstantForce>(job.model).F_0 = 0.0;
  ChannelList channels;
  for (std::size_t a = 0; a < kAxes; ++a)
    if (a != axis) channels.push_back({std::string(1, "xyz"[a]) + "_acceleration", "m/s^2", 0.0});
  channels.push_back({"supply", "V", 0.0});
  job.model.structure.channels = kept(channels);
  std::mt19937_64 noise(seed + 1000);
  for (const std::uint64_t run : {2 * seed, 2 * seed + 1}) {
    const Log log = driven(machine, run);
    Recording r;
    r.name = run % 2 == 0 ? "fit" : "validate";
    r.role = run % 2 == 0 ? Role::fit : Role::validate;
    r.times = log.times;
    r.command = schedule_from_samples(log.times, log.force[axis], Hold::linear);
    const auto with_noise = [&](std::vector<double> values, double sigma) {
      for (double& x : values) x += sigma * normal(noise);
      return values;
    };
    const auto measure = [&](Signal signal, const std::vector<double>& values, double sigma) {
      Measurement m;
      m.signal = signal;
      m.values = with_noise(values, sigma);
      m.sigma = sigma;
      m.noise = NoiseSource::given;
      r.measurements.push_back(std::move(m));
    };
    measure(Signal::position, log.place[axis], 2e-4);
    measure(Signal::velocity, log.speed[axis], 3e-3);
    for (std::size_t a = 0; a < kAxes; ++a)
      if (a != axis) r.channels.emplace_back(with_noise(log.acceleration[a], 0.05));
    r.channels.emplace_back(with_noise(log.supply, 0.05));
    job.recordings.push_back(std::move(r));
  }
  for (const char* name : {"M", "B_a", "coulomb_friction.F_c", "constant_force.F_0"}) {
    const QuantityEntry& entry = quantity_list()[quantity_index(name)];
    job.free.push_back(free_parameter(entry, *members(job.model)[entry.index]));
  }
  return job;
}

using Names = std::set<std::string>;

/// The value of a parameter of the final model, and its standard error.
const ParameterResult& parameter(const EffectSelection& selection, const std::string& name) {
  const auto& list = selection.result.fit.parameters;
  const auto found = std::ranges::find(list, name, [&](const ParameterResult& p) {
    return selection.result.job.entry(p.id.quantity).name;
  });
  if (found == list.end()) throw std::runtime_error("no parameter " + name);
  return *found;
}

TEST(Channels, ACouplingOfTwoPercentIsNamedOnBothAxes) {
  Machine machine;
  machine.shared = 0.02 * std::sqrt(machine.mass[0] * machine.mass[1]);
  for (const auto& [axis, name] : {std::pair<std::size_t, std::string>{0, "y"}, {1, "x"}}) {
    const std::string effect = "channel_force." + name + "_acceleration";
    const EffectSelection selection = close(job_of(machine, axis, 3));
    ASSERT_EQ(accepted(selection), Names{effect});
    const ParameterResult& found = parameter(selection, effect);
    std::cout << effect << " = " << found.value << " +- " << found.uncertainty.standard_error
              << "\n";
    EXPECT_NEAR(found.value, -machine.shared, 4.0 * found.uncertainty.standard_error);
    EXPECT_LT(found.uncertainty.standard_error, 0.2 * machine.shared);
  }
}

TEST(Channels, ASupplyThatSagsIsNamed) {
  Machine machine;
  machine.sag = 0.02;
  const EffectSelection selection = close(job_of(machine, 2, 5));
  ASSERT_EQ(accepted(selection), Names{"channel_gain.supply"});
  EXPECT_NEAR(parameter(selection, "channel_gain.supply").value, 0.02, 0.002);
}

// That friction creeps is no channel's doing, whatever else it is taken for.
TEST(Channels, NoneIsNamedWhereNoneActs) {
  for (const std::uint64_t seed : {11u, 12u, 13u, 14u})
    for (const std::size_t axis : {0u, 1u, 2u})
      for (const std::string& name : accepted(close(job_of(Machine(), axis, seed))))
        EXPECT_FALSE(name.starts_with("channel_")) << name << ", " << axis << ", " << seed;
}

}  // namespace
}  // namespace axisfit
