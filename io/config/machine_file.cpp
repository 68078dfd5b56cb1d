#include "io/config/machine_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/units.h"
#include "io/config/axis_file.h"
#include "io/config/channels.h"
#include "io/config/motion_file.h"
#include "io/config/recording_series.h"

namespace axisfit {
namespace {

/// What of a neighbour can be a channel. Of one that slides the first three.
struct NamedMotional {
  std::string_view name;
  Motional what;
  std::string_view unit;
};
constexpr std::size_t kOfSliding = 3;
constexpr auto kMotional = [] {
  using enum Motional::Of;
  return std::to_array<NamedMotional>({
      {"position", {position, 0}, "m"},
      {"velocity", {position, 1}, "m/s"},
      {"acceleration", {position, 2}, "m/s^2"},
      {"sine", {sine, 0}, "1"},
      {"cosine", {cosine, 0}, "1"},
      {"sine_acceleration", {sine, 2}, "1/s^2"},
      {"cosine_acceleration", {cosine, 2}, "1/s^2"},
  });
}();

/// An axis, and what it says of the others, which can only be read when all are known.
struct Draft {
  CoupledAxis axis;
  std::optional<ConfigNode> channels, effects, motion;
};

class MachineReader {
 public:
  explicit MachineReader(const std::string& path) { file_.files.push_back(path); }

  MachineFile read() {
    if (const auto root = ConfigNode::load(file_.files.front(), diagnostics_)) {
      ConfigMap map(*root, machine_keys());
      if (const auto axes = map.required("axes")) read_axes(*axes);
      map.finish();
    }
    diagnostics_.throw_if_any();
    for (Draft& draft : drafts_) connect(draft);
    diagnostics_.throw_if_any();
    for (Draft& draft : drafts_) {
      read_motion(draft);
      file_.axes.push_back(std::move(draft.axis));
    }
    diagnostics_.throw_if_any();
    return std::move(file_);
  }

 private:
  void read_axes(const ConfigNode& node) {
    ConfigMap map(node);
    for (const auto& [key, value] : map.entries()) {
      Draft draft;
      is_plain_name(key, "an axis");  // it becomes that of a file
      draft.axis.name = key.text();
      ConfigMap entry(value, machine_axis_keys());
      const auto axis = entry.required("axis");
      draft.motion = entry.required("motion");
      draft.channels = entry.optional("channels");
      draft.effects = entry.optional("effects");
      entry.finish();
      if (const auto path = axis ? axis->as_string() : std::nullopt) {
        file_.files.push_back(resolved(*axis, *path, {}));
        if (auto rig = read_axis_file(file_.files.back(), diagnostics_))
          draft.axis.rig = std::move(*rig);
      }
      drafts_.push_back(std::move(draft));
    }
    map.finish();
    if (node.is_map() && drafts_.size() < 2)
      node.error("a machine has at least two axes; for one: simulate-axis AXIS.yaml MOTION.yaml");
  }

  /// The channels of an axis, with what they bring about.
  void connect(Draft& draft) {
    Structure& structure = draft.axis.rig.model.structure;
    ChannelList channels = channels_of(structure);
    draft.axis.sources.resize(channels.size());
    if (draft.channels) {
      ConfigMap map(*draft.channels);
      for (const auto& [key, value] : map.entries()) read_source(key, value, draft, channels);
      map.finish();
    }
    structure.channels = kept(channels);
    if (draft.effects) read_effects(*draft.effects, draft.axis.rig.model);
  }

  void read_source(const ConfigNode& key, const ConfigNode& value, Draft& draft,
                   ChannelList& channels) {
    const auto text = value.as_string();
    if (!text) return;
    const std::size_t dot = text->find('.');
    const std::string of = text->substr(0, dot);
    const std::string what = dot == std::string::npos ? "" : text->substr(dot + 1);
    const auto neighbour =
        std::ranges::find(drafts_, of, [](const Draft& d) { return d.axis.name; });
    const auto motional = std::ranges::find(kMotional, what, &NamedMotional::name);
    if (neighbour == drafts_.end() || motional == kMotional.end() || of == draft.axis.name) {
      value.error(
          fmt::format("'{}' is no motion of another axis: write AXIS.position, AXIS.velocity or "
                      "AXIS.acceleration, or of a joint that turns AXIS.sine, AXIS.cosine, "
                      "AXIS.sine_acceleration or AXIS.cosine_acceleration, with an axis of this "
                      "machine",
                      *text));
      return;
    }
    const Joint joint = neighbour->axis.rig.model.structure.joint;
    if (joint == Joint::prismatic && motional - kMotional.begin() >= std::ptrdiff_t(kOfSliding)) {
      value.error(fmt::format("'{}' needs a joint that turns, and {} slides", *text, of));
      return;
    }
    const std::string si(unit_on(joint, motional->unit));
    auto channel = std::ranges::find(channels, key.text(), &Channel::name);
    if (channel == channels.end()) {
      if (!add_channel(key, si, channels)) return;
      channel = channels.end() - 1;
      draft.axis.sources.emplace_back();
    }
    const auto factor = unit_factor(channel->unit, si);
    if (std::holds_alternative<UnitError>(factor)) {
      value.error(fmt::format("the channel '{}' is in {}, and {} in {}", channel->name,
                              channel->unit, *text, si));
      return;
    }
    draft.axis.sources[static_cast<std::size_t>(channel - channels.begin())] = {
        static_cast<std::size_t>(neighbour - drafts_.begin()), motional->what,
        1.0 / std::get<double>(factor)};
  }

  void read_motion(Draft& draft) {
    const auto path = draft.motion->as_string();
    if (!path) return;
    file_.files.push_back(resolved(*draft.motion, *path, {}));
    MotionFile motion = read_motion_file(file_.files.back(), draft.axis.rig);
    if (!motion.recording.empty()) file_.files.push_back(motion.recording);
    file_.duration = std::max(file_.duration, motion.duration);
    draft.axis.motion = std::move(motion.motion);
  }

  Diagnostics diagnostics_;
  MachineFile file_;
  std::vector<Draft> drafts_;
};

}  // namespace

const Section& machine_axis_keys() {
  static const Section keys{
      Key::required("axis", Text{}, "its axis file"),
      Key::required("motion", Text{}, "its motion file"),
      Key::optional("channels", Map{{}, 0, false, {}, {{std::string(kChannelName), Text{}}}},
                    DefaultText{"none"},
                    "motions of other axes that are channels of this one, such as "
                    "`{y_acceleration: y.acceleration}`"),
      Key::optional(
          "effects", Map{effect_keys()}, DefaultText{"none"},
          "effects that are added to those of the axis file or replace them; same syntax")};
  return keys;
}

const Section& machine_keys() {
  static const Section keys{Key::required(
      "axes", Map{{}, 2, false, {}, {{std::string(kChannelName), Map{machine_axis_keys()}}}},
      "the axes by name; at least two")};
  return keys;
}

bool is_machine_file(const std::string& path) {
  Diagnostics unheard;
  const auto root = ConfigNode::load(path, unheard);
  return root && root->is_map() && ConfigMap(*root).optional("axes").has_value();
}

MachineFile read_machine_file(const std::string& path) { return MachineReader(path).read(); }

}  // namespace axisfit
