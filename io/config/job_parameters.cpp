#include "io/config/job_parameters.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/units.h"
#include "io/config/axis_file.h"
#include "io/config/channels.h"
#include "io/config/recording_keys.h"

namespace axisfit {
namespace {

/// In the order of the key's choices.
constexpr Scale kScales[]{Scale::logarithmic, Scale::linear, Scale::from_zero};

/// "0.56 ohm", for messages.
std::string rounded(double value, std::string_view unit) {
  return with_unit(fmt::format("{:g}", value), unit);
}

/// The keys for a free quantity, whose values are such amounts.
Section free_keys(const NumberWithUnit& amount) {
  return {Key::optional("initial", amount, DefaultText{"value in the axis file or job"},
                        "initial value of the fit"),
          Key::optional("bounds", Bounds{amount}, DefaultText{"the range of the quantity"},
                        "bounds of the estimate, within the range of the quantity"),
          Key::optional("scale", Choice{{{"log"}, {"linear"}, {"from_zero"}}},
                        DefaultText{"inferred from the bounds or the kind of quantity"},
                        "the scale on which it is estimated"),
          Key::optional(
              "prior",
              Map{{Key::required("mean", amount, "its expected value"),
                   Key::required("sigma", sigma_form(amount.unit), "its standard deviation")}},
              DefaultText{"none"}, "Gaussian prior"),
          Key::optional("per_recording", AnyOf{{Boolean{}, List{{Text{}}}}}, DefaultText{"`false`"},
                        "`true`: a separate value for each recording with the role `fit`; a list "
                        "of names: for these alone")};
}

/// The recordings with a value of their own; none: all share one.
std::vector<std::size_t> read_own_recordings(const ConfigNode& node, const Job& job) {
  std::vector<std::size_t> fitted;
  for (std::size_t r = 0; r < job.recordings.size(); ++r)
    if (job.recordings[r].role == Role::fit) fitted.push_back(r);
  if (!node.is_sequence())
    return node.as_bool().value_or(false) ? fitted : std::vector<std::size_t>{};
  std::vector<std::size_t> own;
  std::vector<std::string> names;
  for (const std::size_t r : fitted) names.push_back(job.recordings[r].name);
  const std::vector<ConfigNode> entries = *node.as_sequence();
  for (const ConfigNode& entry : entries) {
    const auto name = entry.as_string();
    if (!name) continue;
    const auto found = std::ranges::find(names, *name);
    if (found == names.end())
      entry.error(fmt::format("no recording with the role fit is called '{}': there are {}", *name,
                              fmt::join(names, ", ")));
    else
      own.push_back(fitted[static_cast<std::size_t>(found - names.begin())]);
  }
  if (entries.empty()) node.error("per_recording must name at least one recording");
  return own;
}

void read_free_parameter(const ConfigNode& node, const QuantityEntry& entry, Job& job) {
  const Quantity& quantity = entry.quantity;
  FreeParameter parameter;
  parameter.quantity = entry.index;
  parameter.initial = *members(job.model)[entry.index];
  std::optional<std::pair<double, double>> bounds;
  std::optional<std::size_t> scale;
  std::vector<std::size_t> own_recordings;
  // "M:" alone is as good as "M: {}".
  Diagnostics none;
  const Section keys = free_keys({std::string(quantity.unit), quantity.lower, quantity.upper});
  ConfigMap map(node.is_null() ? *ConfigNode::parse("{}", node.file(), none) : node, keys);
  const bool initial_given = map.read("initial", parameter.initial).has_value();
  if (const auto given = map.optional("bounds"))
    bounds = given->as_bounds(quantity.unit, quantity.lower, quantity.upper);
  map.read("scale", scale);
  if (const auto given = map.optional("per_recording"))
    own_recordings = read_own_recordings(*given, job);
  if (const auto given = map.optional("prior")) {
    ConfigMap prior(*given, keys_below(keys, "prior"));
    parameter.prior.emplace();
    std::optional<double> mean;
    prior.read("mean", mean);
    if (const auto sigma = prior.required("sigma"))
      parameter.prior->sigma = read_sigma(*sigma, quantity.unit);
    prior.finish();
    if (mean && bounds && (*mean < bounds->first || *mean > bounds->second))
      node.error(fmt::format("the prior mean of {}, {}, lies outside its bounds, {} to {}",
                             entry.name, rounded(*mean, quantity.unit),
                             rounded(bounds->first, quantity.unit),
                             rounded(bounds->second, quantity.unit)));
    parameter.prior->mean = mean.value_or(parameter.initial);
  }
  map.finish();

  const auto add = [&](double initial, std::optional<std::size_t> recording) {
    FreeParameter p = parameter;
    p.initial = initial;
    p.recording = recording;
    p.lower = bounds ? bounds->first : quantity.lower;
    p.upper = bounds ? bounds->second : quantity.upper;
    p.scale = scale                           ? kScales[*scale]
              : bounds && bounds->first > 0.0 ? Scale::logarithmic
              : bounds && bounds->first < 0.0 ? Scale::linear
                                              : scale_of(entry, initial);
    // The least of a logarithmic scale, where the quantity has none.
    if (!bounds && p.scale == Scale::logarithmic && !(p.lower > 0.0)) p.lower = initial / 100.0;
    job.free.push_back(p);
  };
  if (own_recordings.empty()) add(parameter.initial, std::nullopt);
  for (const std::size_t r : own_recordings) {
    double initial = parameter.initial;
    if (!initial_given)
      for (const auto& [index, value] : job.recordings[r].overrides)
        if (index == entry.index) initial = value;
    add(initial, r);
  }
}

}  // namespace

Map free_quantities() {
  // Those for a quantity are the same but for its unit and range, which its description tells.
  const Map amount{free_keys({"m", -kUnlimited, kUnlimited, "a value of the quantity"}), 0, true,
                   "free_quantity"};
  const Map number{free_keys({"1", -kUnlimited, kUnlimited, "a value of the quantity"}), 0, true,
                   "free_number"};
  Section keys;
  for (const Key& quantity : quantity_keys()) {
    const bool is_number = is_dimensionless(std::get<NumberWithUnit>(quantity.form).unit);
    Key key = Key::optional(quantity.name, is_number ? number : amount, DefaultText{"not fitted"},
                            fmt::format("{}; {}", quantity.meaning, value_text(quantity.form)));
    key.used_by = quantity.used_by;
    keys.push_back(std::move(key));
  }
  return Map{
      std::move(keys), 1, false, {}, {{std::string(kChannelQuantity), AnyOf{{amount, number}}}}};
}

void read_free(const ConfigNode& node, const Diagnostics& diagnostics, Job& job) {
  ConfigMap map(node);
  for (const auto& [key, value] : map.entries()) {
    const QuantityEntry* entry = quantity_named(key, job.model.structure);
    if (entry == nullptr) continue;
    const std::size_t free = job.free.size(), mistakes = diagnostics.count();
    read_free_parameter(value, *entry, job);
    if (diagnostics.count() > mistakes) job.free.resize(free);
  }
  map.finish();
}

}  // namespace axisfit
