#include "fleet/factory.h"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>
#include <sstream>
#include <stdexcept>

#include "base/parallel.h"
#include "base/plain_text.h"
#include "base/random.h"
#include "io/recording/csv.h"
#include "sim/rig.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;

constexpr double kRate = 250.0;  // Hz

constexpr const char* kAxis = R"(# An axis of the factory, as its data sheets have it.
name: slide of the factory
drive: motor_current
transmission: rigid
channels: {temperature: {unit: degC, zero: 20 degC}}
parameters: {K_f: 25 N/A, M: 18 kg, B_a: 50 N s/m}
effects:
  coulomb_friction: {F_c: 12 N}
  constant_force: {F_0: 0 N}
  soft_transmission: {c_g: 1e-7 m/N, H_g: 3 um}
)";

constexpr const char* kJob = R"(# What is fitted to each axis on each night.
axis: axis.yaml
recordings:
  - name: night
    file: recordings/{axis}/{night}.csv
    time: {column: time_s, unit: s}
    signals:
      command: {column: command_a, unit: A}
      position: {column: position_m, unit: m, sigma: 1 um}
      load_position: {column: load_position_m, unit: m, sigma: 1 um}
    channels:
      temperature: {column: temperature_degc, unit: degC}
free:
  M: {}
  B_a: {}
  coulomb_friction.F_c: {}
  constant_force.F_0: {bounds: [-20 N, 20 N]}
  soft_transmission.c_g: {}
  soft_transmission.H_g: {}
  load_position.gain: {bounds: [0.9, 1.1]}
)";

constexpr const char* kFleet = R"(job: night.yaml
items: recordings/{axis}/{night}.csv
)";

/// Numbers of one axis on one night, the same whatever else is drawn.
std::mt19937_64 generator_of(std::uint64_t seed, std::size_t axis, std::size_t night) {
  std::seed_seq words{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                      static_cast<std::uint32_t>(axis), static_cast<std::uint32_t>(night)};
  return std::mt19937_64(words);
}

template <template <class> class Effect>
Effect<double>& effect_of(Model<double>& model) {
  model.structure.effects.set(effect_named(Effect<double>::name).value());
  return std::get<Effect<double>>(model.effects);
}

std::string night_name(std::size_t night) {
  using namespace std::chrono;
  const year_month_day date{sys_days(year(2026) / September / 1) + days(night)};
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()));
}

/// An axis on a night, and how warm it is, degC.
std::pair<Rig, double> rig_of(const FactoryOptions& options, const AxisTruth& truth,
                              std::size_t axis, std::size_t night) {
  std::mt19937_64 own = generator_of(options.seed, axis, 1'000'000),
                  now = generator_of(options.seed, axis, night);
  Rig rig;
  Model<double>& model = rig.model;
  model.structure.drive = Drive::motor_current;
  model.structure.transmission = Transmission::rigid;
  const double mass = 20.0 * (1.0 + 0.03 * normal(own)), viscous = 60.0 * (1.0 + 0.1 * normal(own)),
               coulomb = 15.0 * (1.0 + 0.1 * normal(own));
  // A hall that is warmer in some weeks, and friction that falls by 1 % per kelvin.
  const double warm = 3.0 * std::sin(2.0 * std::numbers::pi * static_cast<double>(night) / 17.0) +
                      0.5 * normal(now);
  model.axis.K_f = 25.0;
  model.axis.r_g = 1.0;
  model.axis.M = mass;
  model.axis.B_a = viscous * (1.0 - 0.01 * warm) * (1.0 + 0.005 * normal(now));
  effect_of<CoulombFriction>(model).F_c = coulomb * (1.0 + 0.005 * normal(now));
  effect_of<ConstantForce>(model).F_0 = 0.5 * normal(own) + 0.1 * normal(now);
  SoftTransmission<double>& soft = effect_of<SoftTransmission>(model);
  soft.c_g = 1e-7 * (1.0 + 0.1 * normal(own));
  soft.H_g = 3e-6 * (1.0 + 0.1 * normal(own));
  if (truth.wear != Wear::none && night >= truth.since) {
    const double nights = static_cast<double>(night - truth.since + 1);
    switch (truth.wear) {
      case Wear::friction:
        model.axis.B_a *= 1.05;
        effect_of<CoulombFriction>(model).F_c *= 1.05;
        break;
      case Wear::grease:
        model.axis.B_a *= 1.0 + 0.01 * nights;
        break;
      case Wear::play:
        soft.H_g += 10e-6;
        break;
      case Wear::bearing: {
        PeriodicForce<double>& force = effect_of<PeriodicForce>(model);
        force = {};  // no other harmonic
        force.F_s1 = 3.0;
        force.F_c1 = 1.0;
        force.period = 0.04;
        break;
      }
      case Wear::belt:
        soft.c_g *= 2.0;
        break;
      case Wear::sensor:
        model.instruments[index_of(Signal::load_position)].gain = 1.001;
        break;
      case Wear::none:
        break;
    }
  }
  model.controller.timing.period = 1.0 / kRate;         // of the command
  model.controller.timing.counts_per_revolution = 0.0;  // as fine as its noise
  rig.noise[index_of(Signal::position)] = rig.noise[index_of(Signal::load_position)] = 1e-6;
  return {std::move(rig), 20.0 + warm};
}

void write_text(const fs::path& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text;
  if (!out.flush()) throw std::runtime_error(in_quotes(path.string()) + " cannot be written");
}

void write_night(const fs::path& folder, const FactoryOptions& options, const AxisTruth& truth,
                 std::size_t axis, std::size_t night) {
  std::mt19937_64 fate = generator_of(options.seed, axis, 2'000'000 + night);
  if (uniform(fate) < options.missing) return;
  const auto [rig, temperature] = rig_of(options, truth, axis, night);
  RecordingOptions recording;
  recording.duration = 3.0;
  recording.rate = kRate;
  recording.seed = generator_of(options.seed, axis, 3'000'000 + night)();
  recording.signals = {Signal::position, Signal::load_position};
  std::vector<Column> columns = record(rig, SineMotion{5.0, 0.7, 4.0, 0.0}, recording);
  columns.push_back(
      {"temperature_degc", std::vector<double>(columns.front().values.size(), temperature)});
  std::ostringstream text;
  write_csv(text, columns, 9);
  std::string contents = text.str();
  if (uniform(fate) < options.wrong) contents.resize(contents.size() / 2 + 3);  // the disk was full
  write_text(folder / "recordings" / truth.axis / (night_name(night) + ".csv"), contents);
}

}  // namespace

std::vector<AxisTruth> write_factory(const std::string& folder, const FactoryOptions& options) {
  if (fs::exists(folder) && !fs::is_empty(folder))
    throw std::runtime_error(in_quotes(folder) + " is not empty");
  std::vector<AxisTruth> truths;
  std::string table = "axis,wear,since\n";
  for (std::size_t a = 0; a < options.axes; ++a) {
    std::mt19937_64 fate = generator_of(options.seed, a, 4'000'000);
    AxisTruth truth{fmt::format("axis-{:04}", a + 1), Wear::none, 0};
    if (uniform(fate) < options.worn) {
      truth.wear =
          static_cast<Wear>(1 + static_cast<int>(uniform(fate) * (std::size(kWearNames) - 1)));
      truth.since =
          options.nights / 2 +
          static_cast<std::size_t>(uniform(fate) * 0.3 * static_cast<double>(options.nights));
    }
    table += fmt::format("{},{},{}\n", truth.axis, kWearNames[static_cast<int>(truth.wear)],
                         truth.wear == Wear::none ? "" : night_name(truth.since));
    fs::create_directories(fs::path(folder) / "recordings" / truth.axis);
    truths.push_back(std::move(truth));
  }
  write_text(fs::path(folder) / "axis.yaml", kAxis);
  write_text(fs::path(folder) / "night.yaml", kJob);
  write_text(fs::path(folder) / "fleet.yaml", kFleet);
  write_text(fs::path(folder) / "truth.csv", table);
  parallel_for(options.axes * options.nights, [&](std::size_t k) {
    write_night(folder, options, truths[k / options.nights], k / options.nights,
                k % options.nights);
  });
  return truths;
}

}  // namespace axisfit
