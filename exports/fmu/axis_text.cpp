#include "exports/fmu/axis_text.h"

#include <array>
#include <charconv>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace axisfit {
namespace {

constexpr const char* kTitle = "axisfit axis 1";

std::string number(double value) {
  std::array<char, 32> digits;
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr};
}

[[noreturn]] void refuse(const std::string& line) {
  throw std::runtime_error("the axis of the FMU cannot be read: \"" + line + "\"");
}

double number_in(const std::string& text, const std::string& line) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  if (const auto read = std::from_chars(text.data(), end, value);
      read.ec != std::errc() || read.ptr != end)
    refuse(line);
  return value;
}

template <class Choice>
Choice choice_in(const std::string& text, const std::string& line, std::size_t choices) {
  const double value = number_in(text, line);
  if (!(value >= 0.0 && value < static_cast<double>(choices))) refuse(line);
  return static_cast<Choice>(static_cast<int>(value));
}

}  // namespace

std::string axis_text(const Model<double>& model) {
  const Structure& structure = model.structure;
  std::ostringstream out;
  out << kTitle << "\ndrive " << static_cast<int>(structure.drive) << "\ntransmission "
      << static_cast<int>(structure.transmission) << "\njoint " << static_cast<int>(structure.joint)
      << "\ngearing " << static_cast<int>(structure.gearing) << '\n';
  for (std::size_t e = 0; e < kEffects; ++e)
    if (structure.effects[e]) out << "effect " << kEffectTable[e].name << '\n';
  if (structure.channels)
    for (const Channel& channel : *structure.channels)
      out << "channel " << number(channel.zero) << ' ' << channel.name << ' ' << channel.unit
          << '\n';
  Model<double> copy = model;
  const std::vector<double*> values = members(copy);
  for (const QuantityEntry& entry : quantity_list())
    if (entry.group != "controller" && is_used(entry, structure))
      out << "quantity " << entry.name << ' ' << number(*values[entry.index]) << '\n';
  return out.str();
}

Model<double> read_axis_text(std::istream& in) {
  Model<double> model;
  Structure& structure = model.structure;
  ChannelList channels;
  const std::vector<double*> values = members(model);
  // What is not used is not written.
  for (const QuantityEntry& entry : quantity_list())
    *values[entry.index] =
        std::isnan(entry.quantity.default_value) ? 0.0 : entry.quantity.default_value;
  std::string line;
  if (!std::getline(in, line) || line != kTitle) refuse(line);
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::string key, word, rest;
    words >> key >> word >> std::ws;
    std::getline(words, rest);
    if (key == "drive") {
      structure.drive = choice_in<Drive>(word, line, kDrives);
    } else if (key == "transmission") {
      structure.transmission = choice_in<Transmission>(word, line, 2);
    } else if (key == "joint") {
      structure.joint = choice_in<Joint>(word, line, std::size(kJoints));
    } else if (key == "gearing") {
      structure.gearing = choice_in<Gearing>(word, line, std::size(kGearings));
    } else if (key == "effect") {
      const auto place = effect_named(word);
      if (!place) refuse(line);
      structure.effects.set(*place);
    } else if (key == "channel" && channels.size() < kChannels) {
      const std::size_t space = rest.find(' ');
      if (space == std::string::npos) refuse(line);
      channels.push_back({rest.substr(0, space), rest.substr(space + 1), number_in(word, line)});
    } else if (const QuantityEntry* entry = find_quantity(word, kSourceVocabulary);
               key == "quantity" && entry) {
      *values[entry->index] = number_in(rest, line);
    } else {
      refuse(line);
    }
  }
  if (!channels.empty()) structure.channels = kept(channels);
  normalize(model);
  return model;
}

}  // namespace axisfit
