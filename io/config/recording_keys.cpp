#include "io/config/recording_keys.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/units.h"
#include "io/config/axis_file.h"
#include "io/config/channels.h"
#include "io/config/recording_column.h"

namespace axisfit {
namespace {

/// Every quantity of the list, as a value that differs from the axis file's.
Section override_keys() {
  Section keys = quantity_keys();
  for (Key& key : keys) {
    key.is_required = false;
    key.default_value.clear();
    key.default_text = "value in the axis file or job";
  }
  return keys;
}

/// What a recorder did to a signal.
Section filter_keys() {
  const Filter none;
  return {Key::optional("moving_average", Integer{2, 100000}, DefaultText{"none"},
                        "mean of so many samples; odd with `zero_phase`"),
          Key::optional("butterworth",
                        Map{{Key::required("order", Integer{1, kHighestFilterOrder}, "order"),
                             Key::required("cutoff", NumberWithUnit{"Hz", 1e-6, 1e9},
                                           "where the amplitude of one pass is 1/sqrt(2)")}},
                        DefaultText{"none"}, "a Butterworth low-pass"),
          Key::optional("zero_phase", Boolean{}, none.zero_phase,
                        "`true`: without delay; the mean about each sample, or the Butterworth "
                        "filter forwards and backwards (filtfilt)")};
}

/// A column whose values may have times, or a file, of their own.
Section series_keys() {
  Section keys = column_keys();
  keys.push_back(Key::optional("file", Text{}, DefaultText{"that of the recording"},
                               "file of the column, where signals are in several"));
  keys.push_back(Key::optional("time", Map{column_keys(), 0, false, "column"},
                               DefaultText{"that of the recording"},
                               "column of the times of these values, where they have their own"));
  keys.push_back(Key::optional("offset", NumberWithUnit{"s"}, 0.0, "added to these times"));
  return keys;
}

/// What the input does between its samples.
Key input_hold_key() {
  return Key::optional("hold",
                       Choice{{{"zero_order", "keeps the first: as what is commanded"},
                               {"linear", "goes straight to the second: as what is measured"}}},
                       DefaultText{"`zero_order`; of a drive_force `linear`"},
                       "what it does between two samples");
}

/// The position that a controller was asked for.
Section reference_keys() {
  Section keys = series_keys();
  keys.push_back(input_hold_key());
  keys.push_back(Key::optional("delay", NumberWithUnit{"s", 0.0, 1.0}, 0.0,
                               "by which the drive delays it before its controller follows it"));
  keys.push_back(Key::optional("filter", Map{filter_keys(), 1, false, "filter"},
                               DefaultText{"none"},
                               "digital filter by which the drive smooths it before, such as a "
                               "jerk filter, which is a moving average"));
  keys.push_back(Key::optional(
      "loop",
      Choice{{{"computed", "the command is computed from it and the recorded position"},
              {"simulated", "the controller is simulated with the axis"}}},
      DefaultText{"`computed` for a velocity loop, else `simulated`"}, "how the loop is closed"));
  return keys;
}

/// All signals, first those of a prismatic joint, under each name once.
std::vector<SignalInfo> signals_of_both() {
  std::vector<SignalInfo> list;
  for (const Joint joint : kJoints)
    for (const SignalInfo& of_sliding : kSignalTable) {
      const SignalInfo signal = info(of_sliding.signal, joint);
      if (std::ranges::find(list, signal.name, &SignalInfo::name) == list.end())
        list.push_back(signal);
    }
  return list;
}

/// "m or rad"
std::string units_of_both(const SignalInfo& signal) {
  const std::string_view turning = info(signal.signal, Joint::revolute).unit;
  const bool is_called_so = info(signal.signal, Joint::revolute).name == signal.name;
  return turning == signal.unit || !is_called_so ? std::string(signal.unit)
                                                 : fmt::format("{} or {}", signal.unit, turning);
}

/// The input and all that can be measured.
Section signal_keys() {
  Section input = series_keys();
  input.push_back(Key::optional("sigma", NumberWithUnit{"V", 0.0},
                                DefaultText{"estimated from the samples; 0 V for a velocity loop"},
                                "standard deviation of the noise; 0 V: the axis received exactly "
                                "these values"));
  input.push_back(input_hold_key());
  input.push_back(Key::optional(
      "supply",
      AnyOf{
          {NumberWithUnit{"V", kLeastSupply, kMostSupply}, Map{column_keys(), 0, false, "column"}}},
      DefaultText{"the column is the command itself"},
      "the column is a duty, such as 40 %, of this voltage: a number, or a column of its own"));
  Section keys{Key::optional("command", Map{std::move(input), 0, false, "input_column"},
                             DefaultText{"none if another input is given"},
                             "set-velocity voltage U, or the input of a force source, in V"),
               Key::optional("position_reference", Map{reference_keys(), 0, false, "reference"},
                             DefaultText{"not used with a command"},
                             "in m or rad, in place of the command, which the controller of the "
                             "axis file makes of it")};
  for (const SignalInfo& signal : signals_of_both()) {
    Section measured = series_keys();
    measured.push_back(Key::optional(
        "sigma",
        AnyOf{
            {sigma_form(signal.unit), Choice{{{"standstill", "scatter of the signal at standstill"},
                                              {"fit", "estimated jointly with the parameters"}}}}},
        DefaultText{"estimated from the samples"}, "standard deviation of the noise"));
    measured.push_back(Key::optional("fit", Boolean{}, Measurement().fitted,
                                     "`false`: compare and report, do not fit"));
    measured.push_back(Key::optional("filter", Map{filter_keys(), 1, false, "filter"},
                                     DefaultText{"none"},
                                     "digital filter that the samples went through before they "
                                     "were recorded; the simulated ones go through it too"));
    const Integer times{1, kMostHeld};
    constexpr const char* kMeaning =
        "how often each value is recorded (sample and hold); only the first of each counts";
    if (signal.signal == Signal::drive_force)
      measured.push_back(Key::optional("hold", AnyOf{{times, input_hold_key().form}},
                                       DefaultText{"`1`; of an input `linear`"},
                                       std::string(kMeaning) + "; of an input as of `command`"));
    else
      measured.push_back(
          Key::optional("hold", times, static_cast<double>(Measurement().hold), kMeaning));
    keys.push_back(Key::optional(std::string(signal.name),
                                 Map{std::move(measured), 0, false, "measured_column"},
                                 DefaultText{"not measured"},
                                 fmt::format("{}, in {}", signal.meaning, units_of_both(signal))));
  }
  return keys;
}

/// Columns by the names of channels.
const Map& keys_of_channels() {
  static const Map keys = [] {
    Section of_channel = series_keys();
    of_channel.push_back(Key::optional(
        "derivative", Integer{1, 2}, DefaultText{"the values themselves"},
        "the channel is the first or second derivative of the column by time, without a delay; "
        "`unit` is that of the column"));
    return Map{{},
               0,
               false,
               {},
               {{std::string(kChannelName), Map{std::move(of_channel), 0, false, "channel"}}}};
  }();
  return keys;
}

}  // namespace

const Section& recording_keys() {
  const Recording defaults;
  static const Section keys{
      Key::required(
          "file", Text{},
          "recording: text (CSV, also `.gz`), JSON, `.mat`, `.mcap`, `.xlsx`, `.wpilog` or "
          "`.trace`; of several in one file `FILE#NAME`"),
      Key::optional("name", Text{}, DefaultText{"file name without folder and extension"},
                    "name in reports; unique within the job"),
      Key::optional(
          "role",
          Choice{{{"fit", "its residuals are minimised"}, {"validate", "for validation only"}}},
          defaults.role, "how it is used"),
      Key::optional("time", Map{column_keys(), 0, false, "column"},
                    DefaultText{"required without a rate"},
                    "column of the sample times, which must increase; a row that repeats the one "
                    "before counts once"),
      Key::optional("rate", NumberWithUnit{"Hz", 1e-3, 1e8}, DefaultText{"the time has a column"},
                    "in place of `time`: the rows are samples at this rate, the first at 0 s"),
      Key::required("signals", Map{signal_keys()}, "columns of the input and the measured signals"),
      Key::optional("channels", keys_of_channels(), DefaultText{"none"},
                    "columns of what else was recorded and may act on the axis, such as "
                    "`{temperature: {column: T_motor, unit: degC}}`"),
      Key::optional("trim",
                    Map{{Key::optional("from", NumberWithUnit{"s"}, DefaultText{"the first sample"},
                                       "start of the part to keep, inclusive"),
                         Key::optional("to", NumberWithUnit{"s"}, DefaultText{"the last sample"},
                                       "end of the part to keep, inclusive")}},
                    DefaultText{"all samples"}, "part to keep, in recorded time"),
      Key::optional("initial_state",
                    Choice{{{"given", "as in the axis file"}, {"data", "from the first samples"}}},
                    defaults.initial_state, "initial state"),
      Key::optional("initial_samples", Integer{4, 1000000}, defaults.initial_samples,
                    "number of samples that `initial_state: data` uses"),
      Key::optional("score_initial_samples", Boolean{}, defaults.score_initial_samples,
                    "`false`: exclude the initial samples from the reported errors"),
      Key::optional("acceleration_at_standstill",
                    Choice{{{"exclude", "not used"}, {"keep", "used"}}},
                    defaults.acceleration_at_standstill, "recorded acceleration at standstill"),
      Key::optional("set",
                    Map{override_keys(),
                        0,
                        false,
                        {},
                        {{std::string(kChannelQuantity), amount_per_channel()}}},
                    DefaultText{"none"},
                    "quantities that differ in this recording, such as "
                    "`{M: 161 kg, initial.y0: 20 mm}`")};
  return keys;
}

const Section& measurement_keys(std::string_view signal) {
  return keys_below(keys_below(recording_keys(), "signals"), signal);
}

const Section& channel_column_keys() {
  return std::get<Map>(keys_of_channels().named.front().form).keys;
}

NumberWithUnit sigma_form(std::string_view unit) {
  return {std::string(unit), 0.0, kUnlimited,
          is_dimensionless(unit) ? "number above 0" : "above 0, with its unit"};
}

double read_sigma(const ConfigNode& node, std::string_view unit) {
  return node.as_number_with_unit(sigma_form(unit)).value_or(1.0);
}

}  // namespace axisfit
