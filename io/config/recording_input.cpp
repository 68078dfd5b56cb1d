#include "io/config/recording_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fit/data/filter.h"
#include "fit/data/noise.h"
#include "io/config/axis_file.h"
#include "io/config/recording_column.h"
#include "io/config/recording_keys.h"
#include "io/config/recording_measurement.h"
#include "sim/controller.h"

namespace axisfit {
namespace {

class InputReader {
 public:
  InputReader(const Rig& rig, SeriesReader& series, Recording& recording)
      : rig_(rig), series_(series), recording_(recording) {}

  std::optional<Series> read(const ConfigNode& signals_node, ConfigMap& signals) {
    const bool force_source = capabilities(rig_.model.structure).is_force_driven;
    const auto command = signals.optional("command");
    const SignalInfo drive_force = info(Signal::drive_force, vocabulary());
    const auto force = force_source ? signals.optional(drive_force.name) : std::nullopt;
    const auto reference = signals.optional("position_reference");
    if (command && force)
      force->error(fmt::format("give either the command or the {}, not both: each drives the axis",
                               words_on(vocabulary(), "drive force")));
    if (command && reference)
      reference->error("the recorded command drives the axis: remove position_reference");
    if (!command && !force && !reference)
      signals_node.error(
          force_source
              ? fmt::format("the axis is driven by a command or a {}: name one of them, or "
                            "the position_reference that its controller follows",
                            drive_force.name)
              : "the axis is driven by the command: name its column, or that of the "
                "position_reference that its controller follows");
    if (force && reference)
      reference->error(fmt::format("the recorded {} drives the axis: remove position_reference",
                                   words_on(vocabulary(), "force")));
    if (command && force) return std::nullopt;
    if (reference && !command) return read_reference(*reference, signals);
    std::optional<Series> input;
    if (force) {
      recording_.command.hold = Hold::linear;
      input = read_noisy_input(*force, drive_force.unit);
      // The source turns U into the force K_f U; a force needs no gain.
      const std::size_t gain = quantity_index("K_f");
      if (std::ranges::any_of(recording_.overrides, [&](const auto& o) { return o.first == gain; }))
        force->error(fmt::format("a {} acts as it is: remove K_f from 'set'", drive_force.name));
      recording_.overrides.emplace_back(gain, 1.0);
    } else if (command) {
      input = read_noisy_input(*command, unit_on(vocabulary(), kCommandUnit));
    }
    return input;
  }

 private:
  /// Its noise is taken from its samples where it was measured, as is what drives a force source.
  std::optional<Series> read_noisy_input(const ConfigNode& node, std::string_view unit) {
    ConfigMap map(node, measurement_keys("command"));
    const auto supply_node = map.optional("supply");
    std::optional<Schedule> supply;
    if (supply_node) {
      supply = read_supply(*supply_node);
      if (unit != "V")
        supply_node->error(
            "a duty of a supply makes a voltage: the drive must be one that takes V");
    }
    auto input = series_.read(node, map, supply_node ? "1" : unit);
    if (supply_node && !supply) input.reset();
    if (supply && input)
      for (std::size_t i = 0; i < input->values.size(); ++i)
        input->values[i] *= supply->value_at(input->times[i]);
    if (const auto sigma = map.optional("sigma")) {
      recording_.command_sigma = sigma->as_number_with_unit({std::string(unit), 0.0}).value_or(0.0);
    } else if (input && capabilities(rig_.model.structure).is_direct()) {
      recording_.command_sigma = noise_of_input(input->values);
      recording_.command_noise = NoiseSource::differences;
    }
    map.read("hold", recording_.command.hold);
    map.finish();
    return input;
  }

  /// The voltage of a supply over the time. Nothing, with diagnostics, where it is not known.
  std::optional<Schedule> read_supply(const ConfigNode& node) const {
    Schedule supply;
    supply.hold = Hold::linear;
    if (!node.is_map()) {
      const auto volts = node.as_quantity("V", kLeastSupply, kMostSupply);
      if (!volts) return std::nullopt;
      supply.append(0.0, *volts);
      return supply;
    }
    ConfigMap map(node, column_keys());
    const auto volts = read_column(series_.file(), map, "V");
    map.finish();
    if (!volts || !series_.times() || !has_value_for_each(*series_.times(), node, *volts))
      return std::nullopt;
    for (std::size_t i = 0; i < volts->size(); ++i)
      if (!std::isnan((*volts)[i]) && !std::isnan((*series_.times())[i]))
        supply.append((*series_.times())[i], (*volts)[i]);
    if (!supply.times.empty()) return supply;
    node.error("the supply has no values");
    return std::nullopt;
  }

  /// What was there before it begins stays.
  static void delay_by(double delay, Series& series) {
    if (delay == 0.0 || series.times.empty()) return;
    const double begin = series.times.front();
    for (double& t : series.times) t += delay;
    series.times.insert(series.times.begin(), begin);
    series.values.insert(series.values.begin(), series.values.front());
  }

  /// The reference for the controller of the axis file, or the command that this makes of it.
  std::optional<Series> read_reference(const ConfigNode& node, ConfigMap& signals) const {
    const std::string_view unit = info(Signal::position, vocabulary()).unit;
    ConfigMap map(node, measurement_keys("position_reference"));
    std::optional<Series> reference = series_.read(node, map, unit);
    double delay = 0.0;
    map.read("delay", delay);
    if (const auto given = map.optional("filter"); given && reference)
      reference->values =
          filtered(read_filter(*given, sampling(reference->times)), std::move(reference->values));
    std::optional<Loop> loop;
    map.read("loop", loop);
    Hold hold = Hold::zero_order;
    map.read("hold", hold);
    map.finish();
    const bool is_direct = capabilities(rig_.model.structure).is_direct();
    if (!reference || !series_.times()) return std::nullopt;
    const auto is_missing = [](double x) { return std::isnan(x); };
    const bool has_all_times = std::ranges::none_of(*series_.times(), is_missing);
    const auto say_incomplete = [](const ConfigNode& of, const char* what) {
      of.error(fmt::format(
          "the controller needs the {} at every sample, and some are missing: trim the recording "
          "or fill the gaps",
          what));
      return std::nullopt;
    };
    if (reference->missing > 0 || !has_all_times) return say_incomplete(node, "reference");
    delay_by(delay, *reference);
    if (loop.value_or(is_direct ? Loop::simulated : Loop::computed) == Loop::simulated) {
      recording_.command.meaning = Meaning::reference;
      recording_.command.hold = hold;
      return reference;
    }
    const auto position_node = signals.optional("position");
    if (!position_node) {
      node.error(
          "to compute the command of a position_reference the controller reads the encoder: name "
          "its column under position, or say 'loop: simulated'");
      return std::nullopt;
    }
    ConfigMap position_map(*position_node, measurement_keys("position"));
    const auto position = read_column(series_.file(), position_map, unit);
    if (!position || !has_value_for_each(*series_.times(), *position_node, *position))
      return std::nullopt;
    if (std::ranges::any_of(*position, is_missing))
      return say_incomplete(*position_node, "position");
    const Controller<double>& controller = rig_.model.controller;
    const Schedule track{reference->times, reference->values, Hold::linear};
    const auto at = [&](double t) { return track.value_at(series_.times()->front() + t); };
    return Series{*series_.times(),
                  command_from_reference(controller, *series_.times(),
                                         track_points(controller.timing, at), *position)};
  }

  Vocabulary vocabulary() const { return vocabulary_of(rig_.model.structure); }

  const Rig& rig_;
  SeriesReader& series_;
  Recording& recording_;
};

}  // namespace

std::optional<Series> read_input(const ConfigNode& signals_node, ConfigMap& signals, const Rig& rig,
                                 SeriesReader& series, Recording& recording) {
  return InputReader(rig, series, recording).read(signals_node, signals);
}

}  // namespace axisfit
