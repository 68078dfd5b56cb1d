#include "io/config/config.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace axisfit {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The diagnostics, one a line, after `read` has gone through the file.
std::string errors(
    const std::string& contents,
    const std::function<void(const ConfigNode&)>& read = [](const ConfigNode&) {}) {
  Diagnostics diagnostics;
  if (const auto root = ConfigNode::parse(contents, "job.yaml", diagnostics)) read(*root);
  try {
    diagnostics.throw_if_any();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

// What `read` makes of the only value of the file; fails the test when there are diagnostics.
template <typename Read>
auto value_of(const std::string& contents, const Read& read) {
  decltype(read(std::declval<const ConfigNode&>())) result;
  EXPECT_EQ(errors(contents, [&](const ConfigNode& node) { result = read(node); }), "") << contents;
  return result;
}

// The message of the only diagnostic when `read` is applied to the value of "x: ...".
std::string complaint(const std::string& value,
                      const std::function<void(const ConfigNode&)>& read) {
  const std::string all = errors("x: " + value + "\n", [&](const ConfigNode& root) {
    ConfigMap map(root);
    read(*map.required("x"));
  });
  const std::string place = "job.yaml:1:4: ";
  EXPECT_EQ(all.find('\n'), std::string::npos) << all;
  return all.starts_with(place) ? all.substr(place.size()) : all;
}

auto quantity(std::string_view unit, double lower = -kInfinity, double upper = kInfinity) {
  return [=](const ConfigNode& node) { return node.as_quantity(unit, lower, upper); };
}
auto number(double lower = -kInfinity, double upper = kInfinity) {
  return [=](const ConfigNode& node) { return node.as_number(lower, upper); };
}
auto integer(std::int64_t lower, std::int64_t upper) {
  return [=](const ConfigNode& node) { return node.as_integer(lower, upper); };
}
auto bounds(std::string_view unit, double lower = -kInfinity, double upper = kInfinity) {
  return [=](const ConfigNode& node) { return node.as_bounds(unit, lower, upper); };
}
std::optional<bool> boolean(const ConfigNode& node) { return node.as_bool(); }
std::optional<std::string> string(const ConfigNode& node) { return node.as_string(); }
std::optional<std::size_t> drive(const ConfigNode& node) {
  return node.as_choice(std::vector<std::string>{"velocity_loop", "force_source"});
}

TEST(Config, ReportsAllErrorsAtOnceWithTheirPlaces) {
  const std::string contents =
      "# a job\n"
      "axis:\n"
      "  M: 146\n"
      "  B_a: 40 kg\n"
      "  drive: velocty_loop\n"
      "  V_L: 500 V\n"
      "recrodings: [a.csv]\n"
      "rigid: yes\n";
  const std::string all = errors(contents, [](const ConfigNode& root) {
    ConfigMap map(root);
    // Not in the order of the file.
    map.required("rigid")->as_bool();
    EXPECT_FALSE(map.required("recordings"));
    ConfigMap axis(*map.required("axis"));
    axis.required("V_L")->as_quantity("V", 0.01, 100);
    axis.required("M")->as_quantity("kg", 1e-3, 1e5);
    axis.required("B_a")->as_quantity("N s/m", 0, 1e6);
    drive(*axis.required("drive"));
    EXPECT_FALSE(axis.required("r_g"));
    EXPECT_FALSE(axis.optional("H"));
    axis.finish();
    map.finish();
  });
  EXPECT_EQ(all,
            "job.yaml:2:1: key 'recordings' is missing in the file\njob.yaml:3:3: key 'r_g' is "
            "missing in axis\njob.yaml:3:6: M needs a unit, for example '146 kg'\njob.yaml:4:8: "
            "B_a: 'kg' cannot be converted to 'N s/m'; use for example 'N s/m'\njob.yaml:5:10: "
            "drive must be one of velocity_loop, force_source, not 'velocty_loop'; did you mean "
            "'velocity_loop'?\njob.yaml:6:8: V_L must lie between 0.01 V and 100 V, not 500 "
            "V\njob.yaml:7:1: unknown key 'recrodings'; did you mean 'recordings'?\njob.yaml:8:8: "
            "rigid must be true or false, not 'yes'");
}

TEST(Config, CountsColumnsInCharacters) {
  EXPECT_EQ(errors("{µ: 1 kg·m², b: no}",
                   [](const ConfigNode& root) { ConfigMap(root).required("b")->as_bool(); }),
            "job.yaml:1:17: b must be true or false, not 'no'");
  EXPECT_EQ(errors("\xEF\xBB\xBF{a: 1, b: no}\r\n",
                   [](const ConfigNode& root) { ConfigMap(root).required("b")->as_bool(); }),
            "job.yaml:1:11: b must be true or false, not 'no'");
}

TEST(ConfigLoad, ReadsAFileAndKnowsItsFolder) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "axisfit_config_test";
  std::filesystem::create_directories(folder);
  const std::string path = (folder / "job.yaml").string();
  std::ofstream(path) << "mass: 146 kg\n";

  Diagnostics diagnostics;
  const auto root = ConfigNode::load(path, diagnostics);
  ASSERT_TRUE(root);
  EXPECT_EQ(root->file(), path);
  EXPECT_EQ(root->directory(), folder);
  EXPECT_EQ(ConfigMap(*root).required("mass")->as_quantity("kg", 0, 1e3), 146.0);
  EXPECT_TRUE(diagnostics.empty());

  EXPECT_FALSE(ConfigNode::load((folder / "none.yaml").string(), diagnostics));
  EXPECT_FALSE(ConfigNode::load(folder.string(), diagnostics));
  std::ofstream(path) << std::string(1 << 20, '#') << '\n';
  EXPECT_FALSE(ConfigNode::load(path, diagnostics));
  std::vector<std::string> texts;
  for (const Diagnostic& diagnostic : diagnostics.sorted()) texts.push_back(diagnostic.text());
  EXPECT_EQ(texts, (std::vector<std::string>{
                       (folder / "none.yaml").string() +
                           ":1:1: cannot be opened: No such file or directory",
                       folder.string() + ":1:1: not a file", path + ":1:1: larger than 1 MiB"}));
  std::filesystem::remove_all(folder);
}

TEST(ConfigLoad, RelativePathsOfABareFileNameReferToTheWorkingDirectory) {
  Diagnostics diagnostics;
  EXPECT_EQ(ConfigNode::parse("a: 1", "job.yaml", diagnostics)->directory() / "x", "x");
}

TEST(ConfigLoad, LocatesSyntaxErrors) {
  EXPECT_EQ(errors("a: 1\nb: [1,\n"),
            "job.yaml:3:1: not valid YAML: end of sequence flow not found");
  EXPECT_EQ(errors("a: b: c\n"), "job.yaml:1:5: not valid YAML: illegal map value");
  EXPECT_EQ(errors("a: 1\nb: *x\n"),
            "job.yaml:2:4: not valid YAML: the referenced anchor is not defined");
  EXPECT_EQ(errors("a: 1\nb: kg m\xB2\n"), "job.yaml:2:8: not valid UTF-8; save the file as UTF-8");
  EXPECT_EQ(errors("a: 1\nb: \x04\n"), "job.yaml:2:4: control character; is this a text file?");
}

TEST(ConfigLoad, RefusesWrongUtf8) {
  for (const std::string bad : {"\x80", "\xC0\x80", "\xC3", "\xE0\x80\x80", "\xED\xA0\x80",
                                "\xE2\x82", "\xF0\x80\x80\x80", "\xF4\x90\x80\x80", "\xFF"}) {
    EXPECT_EQ(errors("ab" + bad), "job.yaml:1:3: not valid UTF-8; save the file as UTF-8");
  }
  for (const char* good :
       {"\u0080", "\u07FF", "\u0800", "\uD7FF", "\uFFFD", "\U00010000", "\U0010FFFF"}) {
    EXPECT_EQ(errors(good).find("UTF-8"), std::string::npos);
  }
}

TEST(ConfigLoad, ReportsWhatYamlAcceptsInSilence) {
  EXPECT_EQ(errors("a: 1\nb: {c: 1, c: 2}\n\"a\": 3\n"),
            "job.yaml:2:11: duplicate key 'c', first given on line 2\njob.yaml:3:1: duplicate key "
            "'a', first given on line 1");
  EXPECT_EQ(errors("a: &a {k: 1}\nb:\n  <<: *a\n"),
            "job.yaml:3:3: merge keys ('<<') are not supported; write the entries out");
  EXPECT_EQ(errors("a: !!int 5\nb: !path x\n"),
            "job.yaml:1:4: tags are not supported: 'tag:yaml.org,2002:int'\n"
            "job.yaml:2:4: tags are not supported: '!path'");
  EXPECT_EQ(errors("? [a]\n: 1\n~: 2\n"),
            "job.yaml:1:3: a key must be text\njob.yaml:3:1: a key must be text");
  EXPECT_EQ(errors("a: 1\n---\nb: 2\n---\nc: 3\n"),
            "job.yaml:3:1: only one document is allowed; remove the '---' above and what follows "
            "it");
}

TEST(ConfigLoad, DuplicateInASharedNodeIsReportedOnce) {
  EXPECT_EQ(errors("a: &a {c: 1, c: 2}\nb: *a\nd: *a\n"),
            "job.yaml:1:14: duplicate key 'c', first given on line 1");
}

TEST(ConfigLoad, AcceptsAliasesButNoBombs) {
  EXPECT_EQ(errors("a: &a {k: 1 kg}\nb: *a\n",
                   [](const ConfigNode& root) {
                     const auto b = ConfigMap(root).required("b");
                     EXPECT_EQ(ConfigMap(*b).required("k")->as_quantity("kg", 0, 2), 1.0);
                   }),
            "");
  std::string bomb = "a0: &a0 x\n";
  for (int i = 1; i <= 12; ++i) {
    const std::string alias = "*a" + std::to_string(i - 1);
    const std::string name = "a" + std::to_string(i);
    bomb += name + ": &" + name + " [" + alias;
    for (int k = 1; k < 10; ++k) bomb += ", " + alias;
    bomb += "]\n";
  }
  EXPECT_NE(errors(bomb).find("more than 100000 values, with aliases expanded"), std::string::npos);
  EXPECT_EQ(errors("a: &a [*a]\n"), "job.yaml:1:4: nested more than 32 levels deep");
  EXPECT_EQ(errors(std::string(33, '[') + std::string(33, ']')),
            "job.yaml:1:33: nested more than 32 levels deep");
  EXPECT_EQ(errors(std::string(32, '[') + "x" + std::string(32, ']')), "");
  EXPECT_EQ(errors(std::string(2000, '[')), "job.yaml:1:2001: nested more than 32 levels deep");
  EXPECT_NE(errors(std::string(1 << 20, '{')).find("levels deep"), std::string::npos);
}

TEST(ConfigLoad, AnEmptyFileIsNotAMap) {
  for (const char* contents : {"", "# nothing\n", "\n\n"}) {
    EXPECT_EQ(errors(contents, [](const ConfigNode& root) { ConfigMap{root}; }),
              "job.yaml:1:1: the file must be a map of keys and values, not empty");
  }
}

TEST(ConfigNode, ReadsQuantitiesWithUnits) {
  EXPECT_EQ(value_of("146 kg", quantity("kg")), 146.0);
  EXPECT_EQ(value_of("146kg", quantity("kg")), 146.0);
  EXPECT_EQ(value_of("'146  kg'", quantity("kg")), 146.0);
  EXPECT_EQ(value_of("2 mm/s", quantity("m/s")), 0.002);
  EXPECT_EQ(value_of("-1.5e3 N", quantity("N")), -1500.0);
  EXPECT_EQ(value_of("+.5 N", quantity("N")), 0.5);
  EXPECT_EQ(value_of("40 N s/m", quantity("N s/m")), 40.0);
  EXPECT_EQ(value_of("3e-4 kg·m²", quantity("kg m^2")), 3e-4);
  EXPECT_EQ(value_of("0 1/s", quantity("1/s")), 0.0);
}

TEST(ConfigNode, ReadsNumbersAndPercentages) {
  EXPECT_EQ(value_of("0.25", number()), 0.25);
  EXPECT_EQ(value_of("5 %", number()), 0.05);
  EXPECT_EQ(value_of("5%", number()), 0.05);
  EXPECT_EQ(value_of("1e3", number()), 1e3);
  EXPECT_EQ(value_of("1000", quantity("V/V")), 1e3);
  EXPECT_EQ(value_of("1 V/mV", quantity("V/V")), 1e3);
  EXPECT_EQ(complaint("5 kg", number()),
            "x: 'kg' cannot be used for a dimensionless quantity; use a plain number or '%'");
}

TEST(ConfigNode, RefusesWhatIsNoDecimalNumber) {
  for (const std::string text :
       {"abc", "nan",   ".nan",   "inf",      "-inf",  ".inf", "0x10", "010",
        "-01", "0o7",   "1_000",  "0,5",      "1.2.3", "--1",  "+-1",  "+",
        ".",   "1e999", "1e-999", "'1''000'", "5 e3",  "1:30"}) {
    EXPECT_NE(complaint(text, number()), "") << text;
    EXPECT_NE(complaint(text + " kg", quantity("kg")), "") << text;
  }
  EXPECT_EQ(complaint("0,5", number()), "x must be a number, not '0,5'");
  EXPECT_EQ(complaint("0,5 m", quantity("m")),
            "x must be a number with a unit, for example '1 m', not '0,5 m'");
  EXPECT_EQ(complaint("[1 m]", quantity("m")),
            "x must be a number with a unit, for example '1 m', not a list");
  EXPECT_EQ(complaint("{a: 1}", number()), "x must be a number, not a map");
  EXPECT_EQ(complaint("''", number()), "x must be a number, not empty");
}

TEST(ConfigNode, RefusesMissingAndWrongUnits) {
  EXPECT_EQ(complaint("146", quantity("kg")), "x needs a unit, for example '146 kg'");
  EXPECT_EQ(complaint("0", quantity("N")), "x needs a unit, for example '0 N'");
  EXPECT_EQ(complaint("146 kgg", quantity("kg")), "x: unknown unit 'kgg'; use for example 'kg'");
  EXPECT_EQ(complaint("1 m", quantity("kg")),
            "x: 'm' cannot be converted to 'kg'; use for example 'kg'");
  EXPECT_EQ(complaint("5 2 kg", quantity("kg")), "x: unknown unit '2 kg'; use for example 'kg'");
  EXPECT_EQ(complaint("\"1 k\\e\\n\"", quantity("kg")),
            "x: unknown unit 'k?\?'; use for example 'kg'");
}

TEST(ConfigNode, NamesTheLimits) {
  EXPECT_EQ(complaint("500 V", quantity("V", 0.01, 100)),
            "x must lie between 0.01 V and 100 V, not 500 V");
  EXPECT_EQ(complaint("1 mV", quantity("V", 0.01, 100)),
            "x must lie between 0.01 V and 100 V, not 1 mV");
  EXPECT_EQ(complaint("-1 kg", quantity("kg", 0, kInfinity)), "x must be at least 0 kg, not -1 kg");
  EXPECT_EQ(complaint("2 kg", quantity("kg", -kInfinity, 1)), "x must be at most 1 kg, not 2 kg");
  EXPECT_EQ(complaint("120 %", number(0, 1)), "x must lie between 0 and 1, not 120 %");
  EXPECT_EQ(complaint("1e308 km", quantity("m")), "x is too large: 1e308 km");
}

TEST(ConfigNode, LimitsAreInclusiveInAnyUnit) {
  for (const char* text : {"0.003 m", "3 mm", "3000 um", "0.3 cm", "3e6 nm"}) {
    EXPECT_EQ(value_of(text, quantity("m", 0.003, 1)), 0.003) << text;
    EXPECT_EQ(value_of(text, quantity("m", 0, 0.003)), 0.003) << text;
  }
  EXPECT_EQ(value_of("0 m", quantity("m", 0, 1)), 0.0);
  EXPECT_NE(complaint("2.999999 mm", quantity("m", 0.003, 1)), "");
}

TEST(ConfigNode, ReadsIntegers) {
  EXPECT_EQ(value_of("12", integer(1, 64)), 12);
  EXPECT_EQ(value_of("-3", integer(-5, 5)), -3);
  for (const char* text :
       {"0", "65", "1.5", "1e1", "010", "0x10", "12 kg", "abc", "1_0", "99999999999999999999"}) {
    EXPECT_EQ(complaint(text, integer(1, 64)),
              "x must be a whole number between 1 and 64, not '" + std::string(text) + "'");
  }
}

TEST(ConfigNode, ReadsBooleans) {
  EXPECT_EQ(value_of("true", boolean), true);
  EXPECT_EQ(value_of("false", boolean), false);
  for (const char* text : {"yes", "on", "y", "True", "1"}) {
    EXPECT_EQ(complaint(text, boolean), "x must be true or false, not '" + std::string(text) + "'");
  }
}

TEST(ConfigNode, ReadsTexts) {
  EXPECT_EQ(value_of("abc", string), "abc");
  EXPECT_EQ(value_of("'null'", string), "null");
  EXPECT_EQ(value_of("12", string), "12");
  EXPECT_EQ(complaint("''", string), "x must be text, not empty");
  EXPECT_EQ(complaint("[a]", string), "x must be text, not a list");
}

TEST(ConfigNode, ReadsChoices) {
  EXPECT_EQ(value_of("force_source", drive), 1U);
  EXPECT_EQ(complaint("hydraulic", drive),
            "x must be one of velocity_loop, force_source, not 'hydraulic'");
  EXPECT_EQ(complaint("[]", drive), "x must be one of velocity_loop, force_source, not a list");
}

TEST(ConfigNode, ReadsLists) {
  const std::string all = errors("x:\n- 1 kg\n- 2\n- 3 kg\n", [](const ConfigNode& root) {
    const auto values = ConfigMap(root).required("x")->as_sequence();
    ASSERT_TRUE(values);
    ASSERT_EQ(values->size(), 3U);
    EXPECT_EQ((*values)[0].as_quantity("kg", 0, 10), 1.0);
    EXPECT_EQ((*values)[1].as_quantity("kg", 0, 10), std::nullopt);
    EXPECT_EQ((*values)[2].as_quantity("kg", 0, 10), 3.0);
  });
  EXPECT_EQ(all, "job.yaml:3:3: entry 2 of x needs a unit, for example '2 kg'");
  EXPECT_EQ(complaint("5", [](const ConfigNode& node) { node.as_sequence(); }),
            "x must be a list, not '5'");
}

TEST(ConfigNode, ReadsBounds) {
  EXPECT_EQ(value_of("[40 N s/m, 1 kN s/m]", bounds("N s/m")), std::pair(40.0, 1000.0));
  EXPECT_EQ(complaint("[1 kg]", bounds("kg")), "x must be a list of two values: [lower, upper]");
  EXPECT_EQ(complaint("5 kg", bounds("kg")), "x must be a list of two values: [lower, upper]");
  EXPECT_EQ(complaint("[2 kg, 1000 g]", bounds("kg")),
            "x must be given as [lower, upper], but 2 kg is not less than 1000 g");
  EXPECT_EQ(errors("[1, 200 kg]", bounds("kg", 0, 100)),
            "job.yaml:1:2: entry 1 of the file needs a unit, for example '1 kg'\n"
            "job.yaml:1:5: entry 2 of the file must lie between 0 kg and 100 kg, not 200 kg");
}

TEST(ConfigNode, ShortensLongTextsBetweenCharacters) {
  std::string text = "a";
  for (int i = 0; i < 100; ++i) text += "µ";
  std::string kept = "a";
  for (int i = 0; i < 29; ++i) kept += "µ";
  EXPECT_EQ(complaint(text, boolean), "x must be true or false, not '" + kept + "...'");
}

TEST(ConfigMap, ReportsUnknownKeys) {
  const auto read = [](const ConfigNode& root) {
    ConfigMap map(root);
    map.required("mass");
    map.optional("drag");
    map.optional("mass");
    map.finish();
  };
  EXPECT_EQ(errors("mass: 1\ndrga: 2\nhydraulics: 3\n", read),
            "job.yaml:2:1: unknown key 'drga'; did you mean 'drag'?\n"
            "job.yaml:3:1: unknown key 'hydraulics'; known keys: mass, drag");
  EXPECT_EQ(errors("a: 1\n", [](const ConfigNode& root) { ConfigMap(root).finish(); }),
            "job.yaml:1:1: unknown key 'a'");
}

TEST(ConfigMap, KeepsTheFirstOfDuplicates) {
  EXPECT_EQ(errors("a: 1\na: 2\n",
                   [](const ConfigNode& root) {
                     ConfigMap map(root);
                     EXPECT_EQ(map.required("a")->text(), "1");
                     map.finish();
                   }),
            "job.yaml:2:1: duplicate key 'a', first given on line 1");
}

TEST(ConfigMap, PlacesEmptyValuesAtTheirKey) {
  EXPECT_EQ(errors("a:\n  M:\n\n\nb: 1\n",
                   [](const ConfigNode& root) {
                     const auto a = ConfigMap(root).required("a");
                     ConfigMap(*a).required("M")->as_quantity("kg", 0, 1);
                   }),
            "job.yaml:2:3: M must be a number with a unit, for example '1 kg', not empty");
}

TEST(ConfigMap, ReportsOnceWhatIsNotAMap) {
  EXPECT_EQ(errors("axis: 5\n",
                   [](const ConfigNode& root) {
                     ConfigMap axis(*ConfigMap(root).required("axis"));
                     EXPECT_FALSE(axis.required("mass"));
                     EXPECT_FALSE(axis.optional("drag"));
                     EXPECT_TRUE(axis.entries().empty());
                     axis.finish();
                   }),
            "job.yaml:1:7: axis must be a map of keys and values, not '5'");
}

TEST(ConfigMap, GivesTheEntriesOfMapsWithFreeKeys) {
  EXPECT_EQ(errors("b: 1 kg\na: 2\n",
                   [](const ConfigNode& root) {
                     ConfigMap map(root);
                     std::string names;
                     for (const auto& [key, value] : map.entries()) {
                       names += key.text();
                       if (key.text() == "a") key.error("no effect is called a");
                       value.as_quantity("kg", 0, 5);
                     }
                     EXPECT_EQ(names, "ba");
                     map.finish();
                   }),
            "job.yaml:2:1: no effect is called a\n"
            "job.yaml:2:4: a needs a unit, for example '2 kg'");
}

}  // namespace
}  // namespace axisfit
