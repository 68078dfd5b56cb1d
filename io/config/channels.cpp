#include "io/config/channels.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <regex>
#include <string>

#include "base/units.h"

namespace axisfit {
namespace {

const Section& channel_keys() {
  static const Section keys{
      Key::required("unit", Text{}, "unit of its values, such as degC or V"),
      Key::optional("zero", AnyOf{{NumberWithUnit{"m"}, NumberWithUnit{"1"}}}, DefaultText{"0"},
                    "value at which it does nothing: all other parameters are those there")};
  return keys;
}

/// "1" of whatever has no dimension; nothing, with a diagnostic, where it is no unit.
std::optional<std::string> unit_of(const ConfigNode& node) {
  const auto text = node.as_string();
  if (!text) return std::nullopt;
  const auto factor = unit_factor(*text, "1");
  const auto* problem = std::get_if<UnitError>(&factor);
  if (problem == nullptr) return "1";
  if (problem->problem != UnitProblem::unknown) return text;
  node.error(fmt::format("unknown unit '{}'; use for example 'degC', 'V' or 'm/s^2'", *text));
  return std::nullopt;
}

}  // namespace

bool is_plain_name(const ConfigNode& key, std::string_view what) {
  static const std::regex is_name{std::string(kChannelName)};
  const std::string name = key.text();
  if (std::regex_match(name, is_name)) return true;
  key.error(
      fmt::format("'{}' cannot be the name of {}: use letters, digits and _, and "
                  "begin with a letter",
                  name, what));
  return false;
}

ChannelList channels_of(const Structure& structure) {
  return structure.channels == nullptr ? ChannelList() : *structure.channels;
}

Form amount_per_channel() {
  const char* text = "its unit per unit of the channel";
  return AnyOf{{NumberWithUnit{"N", -kUnlimited, kUnlimited, text},
                NumberWithUnit{"1", -kUnlimited, kUnlimited, "a number"}}};
}

Key axis_channels_key() {
  return Key::optional("channels",
                       Map{{}, 0, false, {}, {{std::string(kChannelName), Map{channel_keys()}}}},
                       DefaultText{"none"},
                       "what is recorded beside the axis and acts on it, by name, such as "
                       "`{temperature: {unit: degC, zero: 25 degC}}`");
}

std::string differentiated(const std::string& unit, int order) {
  if (order == 0) return unit;
  const bool is_plain = unit.find_first_of("/ *") == std::string::npos;
  return (is_plain ? unit : "(" + unit + ")") + (order == 1 ? "/s" : "/s^2");
}

std::string integrated(const std::string& unit, int order) {
  const std::string per = order == 1 ? "/s" : "/s^2";
  if (order == 0) return unit;
  if (unit.ends_with(per)) return unit.substr(0, unit.size() - per.size());
  return "(" + unit + (order == 1 ? ") s" : ") s^2");
}

bool add_channel(const ConfigNode& key, std::string unit, ChannelList& channels) {
  if (!is_plain_name(key, "a channel")) return false;
  if (channels.size() == kChannels) {
    key.error(fmt::format("an axis has at most {} channels: leave out those that cannot act on it",
                          kChannels));
    return false;
  }
  channels.push_back({key.text(), std::move(unit), 0.0});
  return true;
}

void read_channels(const ConfigNode& node, Structure& structure) {
  ChannelList channels = channels_of(structure);
  ConfigMap map(node);
  for (const auto& [key, value] : map.entries()) {
    ConfigMap of_channel(value, channel_keys());
    const auto unit_node = of_channel.required("unit");
    const auto unit = unit_node ? unit_of(*unit_node) : std::nullopt;
    double zero = 0.0;
    if (const auto given = of_channel.optional("zero"); given && unit)
      zero = given->as_quantity(*unit, -kUnlimited, kUnlimited).value_or(0.0);
    of_channel.finish();
    if (unit && add_channel(key, *unit, channels)) channels.back().zero = zero;
  }
  map.finish();
  structure.channels = kept(channels);
}

void add_channels_of(const std::vector<ConfigNode>& recordings, Structure& structure) {
  ChannelList channels = channels_of(structure);
  for (const ConfigNode& recording : recordings) {
    // What is no map is told where the recording is read.
    if (!recording.is_map()) continue;
    const auto given = ConfigMap(recording).optional("channels");
    if (!given || !given->is_map()) continue;
    ConfigMap map(*given);
    for (const auto& [key, value] : map.entries()) {
      if (std::ranges::count(channels, key.text(), &Channel::name) > 0 || !value.is_map()) continue;
      ConfigMap of_channel(value);
      int order = 0;
      if (const auto derivative = of_channel.optional("derivative"))
        order = derivative->text() == "1" ? 1 : derivative->text() == "2" ? 2 : 0;
      const auto unit_node = of_channel.optional("unit");
      if (const auto unit = unit_node ? unit_of(*unit_node) : std::nullopt)
        add_channel(key, differentiated(*unit, order), channels);
    }
  }
  structure.channels = kept(channels);
}

void set_channel_zeros(std::size_t declared, Job& job) {
  ChannelList channels = channels_of(job.model.structure);
  for (std::size_t j = declared; j < channels.size(); ++j) {
    double sum = 0.0, count = 0.0, least = INFINITY, most = -INFINITY;
    for (const Recording& r : job.recordings) {
      if (r.role != Role::fit || r.channels.size() <= j) continue;
      for (const double x : r.channels[j]) {
        sum += x;
        count += 1.0;
        least = std::min(least, x);
        most = std::max(most, x);
      }
    }
    if (!(least > 0.0 || most < 0.0) || count == 0.0) continue;
    const double zero = std::strtod(fmt::format("{:.3g}", sum / count).c_str(), nullptr);
    channels[j].zero = zero;
    for (Recording& r : job.recordings)
      if (r.channels.size() > j)
        for (double& x : r.channels[j].edit()) x -= zero;
  }
  job.model.structure.channels = kept(channels);
}

}  // namespace axisfit
