// Exported C: compiled, run and compared with our simulation.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <map>

#include "exports/export.h"
#include "tests/apps/files.h"
#include "tests/exports/axes.h"

namespace axisfit {
namespace {

constexpr double kStep = 1e-3, kDuration = 1.2;

double command_at(std::size_t k) {
  const std::size_t level = k / 40;
  return level % 9 >= 7 ? 0.0 : 6.0 * std::sin(1.0 + 0.9 * static_cast<double>(level));
}
double channel_at(std::size_t k, std::size_t j) {
  return k < 300 ? 1.0 : 2.0 - static_cast<double>(j);
}

std::size_t samples() { return static_cast<std::size_t>(std::lround(kDuration / kStep)) + 1; }

std::vector<Signal> signals_of(const Structure& structure) {
  std::vector<Signal> signals;
  for (const SignalInfo& entry : kSignalTable)
    if (has_signal(entry.signal, structure)) signals.push_back(entry.signal);
  return signals;
}

/// By signals and samples.
using Readings = std::vector<std::vector<double>>;

Readings by_us(const Rig& rig, double step = 0.5e-3) {
  const std::vector<Signal> signals = signals_of(rig.model.structure);
  std::vector<double> times;
  Schedule commands;
  const std::size_t channel_count =
      rig.model.structure.channels ? rig.model.structure.channels->size() : 0;
  std::vector<ChannelSeries> channels(channel_count);
  for (std::size_t k = 0; k < samples(); ++k) {
    times.push_back(kStep * static_cast<double>(k));
    if (k == 0 || command_at(k) != command_at(k - 1)) commands.append(times[k], command_at(k));
    for (std::size_t j = 0; j < channel_count; ++j) {
      channels[j].hold = Hold::zero_order;
      channels[j].values.push_back(channel_at(k, j) - (*rig.model.structure.channels)[j].zero);
    }
  }
  Readings all(signals.size());
  IntegratorOptions options;
  options.step = step;
  EXPECT_TRUE(simulate<double>(
                  rig.model, commands, times,
                  [&](std::size_t, const Integrator<double>& axis) {
                    for (std::size_t s = 0; s < signals.size(); ++s)
                      all[s].push_back(reading(axis.equations(), signals[s], axis.mode(),
                                               axis.state(), axis.input()));
                  },
                  {}, {{}, {}, channels}, options)
                  .finished);
  return all;
}

int run(const std::string& command) { return std::system(command.c_str()); }

const char* const kDriver = R"(
#include <stdio.h>
#include "an_axis.h"
int main(void) {
  static an_axis_axis a;
  double u, dt;
#ifdef AN_AXIS_CHANNELS
  double c;
  an_axis_real channels[AN_AXIS_CHANNELS];
#endif
  int s;
  an_axis_init(&a);
  if (scanf("%lf", &dt) != 1) return 1;
  while (scanf("%lf", &u) == 1) {
    for (s = 0; s < AN_AXIS_SIGNALS; ++s)
      printf("%.17g ", (double)an_axis_read(&a, (an_axis_signal)s));
    printf("\n");
#ifdef AN_AXIS_CHANNELS
    for (s = 0; s < AN_AXIS_CHANNELS; ++s) {
      if (scanf("%lf", &c) != 1) return 1;
      channels[s] = (an_axis_real)c;
    }
    an_axis_step(&a, (an_axis_real)u, channels, (an_axis_real)dt);
#else
    an_axis_step(&a, (an_axis_real)u, (an_axis_real)dt);
#endif
  }
  return 0;
}
)";

Readings by_c(const Rig& rig, const std::string& flags) {
  TempFolder folder;
  for (const auto& [name, contents] :
       export_axis(rig, ExportTarget::c, "an axis", "By a test").files)
    folder.write(name, contents);
  folder.write("main.c", kDriver);
  std::ostringstream input;
  input << kStep << '\n';
  input.precision(17);
  for (std::size_t k = 0; k < samples(); ++k) {
    input << command_at(k);
    if (rig.model.structure.channels)
      for (std::size_t j = 0; j < rig.model.structure.channels->size(); ++j)
        input << ' ' << channel_at(k, j);
    input << '\n';
  }
  folder.write("input", input.str());
  const std::string in = "cd " + folder.path() + " && ";
  // Warnings of the code are errors; the driver is not part of it.
  EXPECT_EQ(run(in +
                "cc -std=c99 -O1 -Wall -Wextra -Wconversion -Wdouble-promotion -Wshadow "
                "-Wstrict-prototypes -pedantic -Werror " +
                flags + " main.c an_axis.c -lm -o axis"),
            0);
  EXPECT_EQ(run(in + "./axis < input > output"), 0);
  Readings all(signals_of(rig.model.structure).size());
  std::ifstream output(folder.path() + "/output");
  for (double value = 0.0; output >> value;) {
    for (std::size_t s = 0; s < all.size(); ++s) {
      if (s > 0) output >> value;
      all[s].push_back(value);
    }
  }
  return all;
}

/// Largest difference of a signal per its range: of those that do not jump at events, and of any.
struct Difference {
  double smooth = 0.0, any = 0.0;
};

Difference difference(const Rig& rig, const Readings& ours, const Readings& theirs) {
  const std::vector<Signal> signals = signals_of(rig.model.structure);
  Difference worst;
  for (std::size_t s = 0; s < signals.size(); ++s) {
    EXPECT_EQ(theirs[s].size(), samples());
    if (theirs[s].size() != samples()) return {1.0, 1.0};
    const auto [low, high] = std::ranges::minmax(ours[s]);
    const double range = std::max(high - low, 1e-12);
    double own = 0.0;
    for (std::size_t k = 1; k < samples(); ++k)  // at first the channels act on ours alone
      own = std::max(own, std::abs(theirs[s][k] - ours[s][k]) / range);
    worst.any = std::max(worst.any, own);
    if (signals[s] == Signal::position || signals[s] == Signal::velocity ||
        signals[s] == Signal::load_position)
      worst.smooth = std::max(worst.smooth, own);
  }
  return worst;
}

Rig base(Drive drive, Transmission transmission) {
  Rig rig;
  rig.model = paper_axis();
  rig.model.structure.drive = drive;
  rig.model.structure.transmission = transmission;
  rig.model.axis.F_s = 20.0;
  rig.model.axis.K_f = 40.0;
  normalize(rig.model);
  return rig;
}

TEST(CCode, MovesAsOurSimulationWithAllDrives) {
  double worst = 0.0;
  for (const Drive drive : every_drive())
    for (const Transmission transmission : {Transmission::backlash, Transmission::rigid}) {
      const Rig rig = base(drive, transmission);
      const Difference found = difference(rig, by_us(rig), by_c(rig, ""));
      EXPECT_LT(found.any, 1e-9);
      worst = std::max(worst, found.any);
    }
  std::cout << "all drives: " << worst << '\n';
}

TEST(CCode, MovesAsOurSimulationWithEveryEffect) {
  double worst = 0.0;
  for (std::size_t e = 0; e < kEffects; ++e) {
    const std::string name(kEffectTable[e].name);
    Rig rig = base(name == "supply_resistance" ? Drive::velocity_loop
                   : name == "force_droop"     ? Drive::force_source
                                               : Drive::motor_voltage,
                   Transmission::rigid);
    rig.model.structure.effects.set(e);
    if (name.starts_with("channel"))
      rig.model.structure.channels = kept({{"temperature", "K", 0.5}, {"neighbour", "m", 0.0}});
    const std::vector<double*> values = members(rig.model);
    for (const QuantityEntry& entry : quantity_list())
      if (entry.effect == e && is_used(entry, rig.model.structure))
        *values[entry.index] = entry.quantity.typical;
    const Readings ours = by_us(rig, 0.5e-4);
    const Difference found = difference(rig, ours, by_c(rig, ""));
    Rig without = rig;
    without.model.structure.effects.reset();
    EXPECT_GT(difference(rig, by_us(without), ours).any, 1e-6) << name << " does nothing";
    EXPECT_LT(found.any, 1e-9) << name;
    worst = std::max(worst, found.any);
  }
  std::cout << "every effect: " << worst << '\n';
}

TEST(CCode, MovesAsOurSimulationWithFloatAndFixedSteps) {
  for (auto [name, rig] : axes()) {
    rig.name = "an axis */ #error /* of a comment";
    const Readings ours = by_us(rig, 0.5e-4);
    // Events that are late by up to an inner step: where nothing is fast, a shorter one than usual.
    std::string at_step_ends = "-DAN_AXIS_LOCATE_EVENTS=0";
    if (capabilities(rig.model.structure).is_direct()) at_step_ends += " -DAN_AXIS_INNER_STEP=1e-5";
    const Difference exact = difference(rig, ours, by_c(rig, "")),
                     single = difference(rig, ours, by_c(rig, "-DAN_AXIS_FLOAT=1")),
                     fixed = difference(rig, ours, by_c(rig, at_step_ends));
    EXPECT_LT(exact.any, 1e-9) << name;
    EXPECT_LT(single.smooth, 1e-4) << name;
    std::cout << name << ": " << exact.any << ", float " << single.smooth << '\n';
    EXPECT_LT(fixed.smooth, 1e-3) << name;
  }
}

}  // namespace
}  // namespace axisfit
