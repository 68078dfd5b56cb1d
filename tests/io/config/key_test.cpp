#include "io/config/key.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "io/config/axis_file.h"
#include "io/config/channels.h"
#include "io/config/config.h"
#include "io/config/job_file.h"
#include "io/config/motion_file.h"
#include "tests/apps/files.h"

namespace axisfit {
namespace {

using Json = nlohmann::ordered_json;

TEST(Key, ValuesAreToldInUnitAndRange) {
  for (const auto& [form, text] : std::vector<std::pair<Form, std::string>>{
           {Text{}, "text"},
           {Boolean{}, "`true` or `false`"},
           {Integer{4, 1000000}, "whole number, 4 .. 1000000"},
           {Integer{}, "whole number from 0"},
           {NumberWithUnit{"s", 1e-5, 0.1}, "s, 1e-5 .. 0.1"},
           {NumberWithUnit{"N", -1.5e6, 1.5e6}, "N, +-1.5e6"},
           {NumberWithUnit{"N", 0.0, kUnlimited}, "N, >= 0"},
           {NumberWithUnit{"1", 10, 1e6}, "number, 10 .. 1e6"},
           {NumberWithUnit{"V", -kUnlimited, kUnlimited, "V, +-limit"}, "V, +-limit"},
           {Bounds{{"m"}}, "[lower, upper], m"},
           {Choice{{{"a"}, {"b"}, {"c"}}}, "`a`, `b` or `c`"},
           {AnyOf{{Choice{{{"none"}}}, Map{{Key::required("rate", NumberWithUnit{"1/s"}, "")}}}},
            "`none`; or {rate: 1/s}"},
           {List{{NumberWithUnit{"V"}}}, "list, each V"},
       })
    EXPECT_EQ(value_text(form), text);
}

TEST(Key, StandardValuesAreWrittenAsAUserWould) {
  const auto default_of = [](Form form, auto value) {
    return default_description(Key::optional("key", std::move(form), value, "meaning"));
  };
  EXPECT_EQ(default_of(NumberWithUnit{"s"}, 0.5e-3), "0.5 ms");
  EXPECT_EQ(default_of(NumberWithUnit{"s"}, 0.0), "0 s");
  EXPECT_EQ(default_of(NumberWithUnit{"m/s"}, 0.002), "2 mm/s");
  EXPECT_EQ(default_of(NumberWithUnit{"V s/m"}, 10.0), "10 V s/m");
  EXPECT_EQ(default_of(NumberWithUnit{"1"}, 4000.0), "4000");
  EXPECT_EQ(default_of(Integer{}, 20), "20");
  EXPECT_EQ(default_of(Boolean{}, true), "true");
  EXPECT_EQ(default_of(Choice{{{"first"}, {"second"}}}, 1), "second");
  EXPECT_EQ(default_description(Key::required("key", Text{}, "meaning")), "required");
}

TEST(Key, AReaderCannotAskForWhatIsNotDescribed) {
  Diagnostics diagnostics;
  const auto root = ConfigNode::parse("step: 1 ms\n", "job.yaml", diagnostics);
  const Section keys{Key::required("step", NumberWithUnit{"s", 0.0, 1.0}, "step")};
  ConfigMap map(*root, keys);
  double step = 0.0;
  EXPECT_TRUE(map.read("step", step));
  EXPECT_EQ(step, 1e-3);
  EXPECT_THROW(map.optional("stop"), std::logic_error);
  EXPECT_THROW(map.read("stop", step), std::logic_error);
}

// A value that a key takes.
Json example(const Form& form);

// A map with all its keys.
Json example(const Section& keys) {
  Json map = Json::object();
  for (const Key& key : keys) map[key.name] = example(key.form);
  return map;
}

// A name that an entry may have.
std::string name_of(const NamedEntry& entry) {
  return entry.pattern == kChannelQuantity ? "channel_force.oil" : "oil";
}

struct Example {
  Json operator()(const Text&) const { return "data.csv"; }
  Json operator()(const Boolean&) const { return true; }
  Json operator()(const Integer& whole) const { return whole.lower; }
  Json operator()(const NumberWithUnit& amount) const {
    return std::to_string(std::min(std::max(1.0, amount.lower), amount.upper)) + " " +
           (amount.unit == "1" ? "" : amount.unit);
  }
  Json operator()(const Bounds& bounds) const {
    return Json::array({"0 " + bounds.of.unit, "1 " + bounds.of.unit});
  }
  Json operator()(const Choice& choice) const { return choice.options.front().name; }
  Json operator()(const Map& map) const {
    Json made = example(map.keys);
    for (const NamedEntry& entry : map.named) made[name_of(entry)] = example(entry.form);
    return made;
  }
  Json operator()(const List& list) const { return Json::array({example(list.of.front())}); }
  Json operator()(const AnyOf& either) const { return example(either.forms.back()); }
};

Json example(const Form& form) {
  return std::visit(Example(), static_cast<const Form::variant&>(form));
}

// Calls visit(pointer, form) for the file and everything in it.
using FormVisitor = std::function<void(const Json::json_pointer&, const Form&)>;
void walk(const Json::json_pointer& at, const Form& form, const FormVisitor& visit) {
  visit(at, form);
  if (const auto* map = std::get_if<Map>(&form)) {
    for (const Key& key : map->keys) walk(at / key.name, key.form, visit);
    for (const NamedEntry& entry : map->named) walk(at / name_of(entry), entry.form, visit);
  }
  if (const auto* list = std::get_if<List>(&form)) walk(at / 0, list->of.front(), visit);
  if (const auto* either = std::get_if<AnyOf>(&form)) walk(at, either->forms.back(), visit);
}

// Descriptions and readers agree: a file with every key that is described has no key that is
// unknown; a key that is not described is refused in every map; and so are values beyond the
// limits. Other faults of such a file do not matter.
class KeyAgreement : public ::testing::Test {
 protected:
  using Reader = std::function<void(const std::string& path)>;

  /// The messages of reading the file, one a line.
  std::string messages(const Json& file, const Reader& read) {
    const std::string path = folder_.write("file.yaml", file.dump(1));
    try {
      read(path);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }

  /// `is_read` tells which parts of the file the reader comes to.
  void expect_agreement(
      const Json& file, const Section& keys, const Reader& read,
      const std::function<bool(const std::string&)>& is_read = [](const std::string&) {
        return true;
      }) {
    const std::string all = messages(file, read);
    EXPECT_EQ(all.find("unknown key"), std::string::npos) << all;
    EXPECT_EQ(all.find("is missing"), std::string::npos) << all;
    int maps = 0, limits = 0;
    walk(Json::json_pointer(), Map{keys}, [&](const Json::json_pointer& at, const Form& form) {
      if (!is_read(at.to_string()) || !file.contains(at)) return;
      SCOPED_TRACE(at.to_string());
      Json wrong = file;
      const auto refused = [&] { return messages(wrong, read) != all; };
      if (const auto* map = std::get_if<Map>(&form)) {
        // Where users give names, it is none of these.
        const char* name = map->named.empty() ? "no_such_key" : "no such key";
        wrong[at / name] = map->named.empty() ? Json(1) : file[at / name_of(map->named.front())];
        EXPECT_NE(messages(wrong, read).find(fmt::format("'{}'", name)), std::string::npos)
            << messages(wrong, read);
        ++maps;
      } else if (const auto* amount = std::get_if<NumberWithUnit>(&form)) {
        for (const double limit : {amount->lower, amount->upper}) {
          if (std::isinf(limit)) continue;
          const auto text = [&](double value) {
            return fmt::format("{} {}", value, amount->unit == "1" ? "" : amount->unit);
          };
          wrong[at] = text(limit + (limit == amount->lower ? -1.0 : 1.0) *
                                       (1e-9 * std::abs(limit) + 1e-30));
          EXPECT_TRUE(refused()) << wrong[at];
          ++limits;
        }
      } else if (const auto* whole = std::get_if<Integer>(&form)) {
        wrong[at] = whole->lower - 1;
        EXPECT_TRUE(refused()) << wrong[at];
        ++limits;
      }
    });
    EXPECT_GT(maps, 0);
    EXPECT_GT(limits, 0);
  }

  TempFolder folder_;
};

TEST_F(KeyAgreement, AxisFile) {
  const Reader read = [](const std::string& path) {
    Diagnostics diagnostics;
    read_axis_file(path, diagnostics);
    diagnostics.throw_if_any();
  };
  for (const Joint joint : kJoints) {
    Json axis = example(axis_keys(joint));
    axis["uncertainty"]["parameters"][0]["name"] = "initial.y0";
    axis["joint"] = joint_name(joint);
    axis["channels"]["oil"]["unit"] = "V";
    expect_agreement(axis, axis_keys(joint), read, [](const std::string& at) {
      return at != "/parameters/K_f";  // has no part in a velocity loop, whatever its value
    });
  }
}

TEST_F(KeyAgreement, JobFile) {
  const Reader read = [](const std::string& path) { read_job_file(path); };
  Json axis = example(axis_keys(kSourceVocabulary));
  axis["parameters"].erase("K_f");
  axis.erase("guessed");  // names quantities
  axis.erase("uncertainty");
  axis["channels"]["oil"] = {{"unit", "V"}, {"zero", "1 V"}};
  for (const auto& [effect, unit] :
       {std::pair("force", "N"), std::pair("friction", "N"), std::pair("damping", "N s/m"),
        std::pair("gain", "1"), std::pair("mass", "kg")})
    axis["effects"][std::string("channel_") + effect]["oil"] = fmt::format("1 {}/V", unit);
  // Of axes without backlash.
  for (const char* effect : {"soft_transmission", "force_droop"}) axis["effects"].erase(effect);
  folder_.write("axis.yaml", axis.dump(1));
  folder_.write("data.csv", "data.csv\n1\n2\n");
  Json file = example(job_keys());
  file["axis"] = "axis.yaml";
  file["recordings"][0]["channels"]["oil"]["unit"] = "V";
  // Of axes that turn.
  const Json effects = file["effects"];
  for (const auto& [name, effect] : effects.items())
    if (!axis["effects"].contains(name)) file["effects"].erase(name);
  file["recordings"][0]["signals"].erase("drive_torque");
  file["fit"]["loss"] = "huber";
  file["recordings"][0]["signals"].erase("position_reference");  // the command takes its place
  // All free quantities have the same keys, in lengths or in numbers; and a few to set are enough.
  const Json free = file["free"];
  file["free"] = {{"H", free["H"]}, {"K_v", free["K_v"]}};
  file["free"]["channel_force.oil"] = free["channel_force.oil"];
  const Json set = file["recordings"][0]["set"];
  file["recordings"][0]["set"].clear();
  for (const char* name :
       {"M", "K_v", "drive_lag.T_l", "V_c.bias", "initial.y1", "channel_force.oil"})
    file["recordings"][0]["set"][name] = set[name];
  expect_agreement(file, job_keys(), read);
}

TEST_F(KeyAgreement, MotionFile) {
  Rig rig;
  rig.model.controller.gains.limit = 5.0;
  const Reader read = [&](const std::string& path) { read_motion_file(path, rig); };
  folder_.write("data.csv", "data.csv\n1\n2\n");
  for (const std::string& type : std::get<Choice>(find_key(motion_keys(), "type").form).names()) {
    SCOPED_TRACE(type);
    Section keys = motion_keys();
    for (const Key& key : motion_keys(type, kSourceVocabulary)) keys.push_back(key);
    Json file = example(keys);
    file["type"] = type;
    expect_agreement(file, keys, read);
  }
}

}  // namespace
}  // namespace axisfit
