#include "sim/rig.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <stdexcept>

#include "base/random.h"
#include "sim/controller.h"
#include "sim/recorder.h"
#include "sim/rig_run.h"

namespace axisfit {
namespace {

/// Normal numbers of one named stream, the same on every machine (Box and Muller 1958; standard
/// library distributions differ).
class NormalStream {
 public:
  NormalStream(std::uint64_t seed, std::string_view name) {
    std::vector<std::uint32_t> words{static_cast<std::uint32_t>(seed),
                                     static_cast<std::uint32_t>(seed >> 32)};
    for (const char c : name) words.push_back(static_cast<unsigned char>(c));
    std::seed_seq sequence(words.begin(), words.end());
    generator_.seed(sequence);
  }
  double next() { return normal(generator_); }

 private:
  std::mt19937_64 generator_;
};

}  // namespace

std::vector<double> sampling_times(const RecordingOptions& options) {
  const auto last = static_cast<std::size_t>(std::llround(options.duration * options.rate));
  std::vector<double> times;
  for (std::size_t i = 0; i <= last; ++i) times.push_back(static_cast<double>(i) / options.rate);
  return times;
}

std::vector<double> sampling_times(const RecordingOptions& options, double parts) {
  RecordingOptions fine = options;
  fine.rate *= parts;
  fine.duration = std::round(options.duration * options.rate) / options.rate;
  return sampling_times(fine);
}

Schedule run_rig(const Rig& rig, const Motion& motion, const RecordingOptions& options,
                 std::span<const double> instants, std::span<const ChannelSeries> channels,
                 const std::function<void(std::size_t, const Integrator<double>&)>& read) {
  std::size_t reached = 0;
  const auto note = [&](std::size_t i, const Integrator<double>& axis) {
    read(i, axis);
    reached = i;
  };
  IntegratorOptions integrator;
  integrator.step = options.step;
  Schedule command;
  if (const auto* move = std::get_if<MoveMotion>(&motion)) {
    Model<double> model = rig.model;
    if (!options.noise) model.controller.timing.counts_per_revolution = 0.0;
    command = simulate_move(model, reference_of(*move), instants, note, integrator, channels);
  } else {
    command = schedule_of(motion, options.duration, rig.model.controller.timing.period);
    simulate<double>(rig.model, command, instants, note, {}, {{}, {}, channels}, integrator);
  }
  if (reached + 1 != instants.size())
    throw std::runtime_error("the motion cannot be simulated beyond " +
                             std::to_string(instants[reached]) +
                             " s: the state is not finite, oscillates too fast to be resolved, or "
                             "events accumulate without end");
  return command;
}

std::string column_name(std::string_view name, std::string_view unit) {
  std::string text(name);
  text += '_';
  for (const char c : unit) {
    if (c == '/') text += 'p';
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return text;
}

std::string column_name(Signal signal, Vocabulary vocabulary) {
  const SignalInfo on = info(signal, vocabulary);
  return column_name(on.name, on.unit);
}

std::vector<Column> record(const Rig& rig, const Motion& motion, const RecordingOptions& options,
                           const ChannelsOverTime& channels) {
  const std::vector<double> times = sampling_times(options);
  Recorder<double> recorder(rig.model.instruments, options.signals, times);
  const std::vector<double>& read_at = recorder.instants();
  const std::span<const double> instants =
      channels.instants.empty() ? std::span(read_at) : channels.instants;
  const std::size_t stride = std::max<std::size_t>(
      1, (instants.size() - 1) / std::max<std::size_t>(1, read_at.size() - 1));
  const Schedule command = run_rig(rig, motion, options, instants, channels.series,
                                   [&](std::size_t i, const Integrator<double>& axis) {
                                     if (i % stride == 0) recorder.read(axis);
                                   });

  std::vector<Column> columns;
  columns.push_back({"time_s", times});
  // The command in force from each instant on.
  Column& written = columns.emplace_back(Column{
      column_name("command", unit_on(vocabulary_of(rig.model.structure), kCommandUnit)), {}});
  std::size_t next = 0;
  for (const double t : times) {
    // An instant and a sample that are the same may differ by rounding.
    while (next < command.times.size() && command.times[next] <= t + 1e-9 / options.rate) ++next;
    written.values.push_back(next == 0 ? 0.0 : command.values[next - 1]);
  }
  for (std::size_t s = 0; s < options.signals.size(); ++s) {
    const Signal signal = options.signals[s];
    Column column{column_name(signal, vocabulary_of(rig.model.structure)), recorder.readings(s)};
    NormalStream stream(options.seed, info(signal).name);
    for (double& x : column.values) {
      if (!options.noise) break;
      x += rig.noise[index_of(signal)] * stream.next();
      if (signal == Signal::position)
        x = encoder_reading(x, motor_radius(rig.model),
                            rig.model.controller.timing.counts_per_revolution);
    }
    columns.push_back(std::move(column));
  }
  return columns;
}

}  // namespace axisfit
