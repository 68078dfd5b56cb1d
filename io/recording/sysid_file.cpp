#include "io/recording/sysid_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "base/plain_text.h"
#include "io/recording/text_lines.h"

namespace axisfit {
namespace {

using Json = nlohmann::json;

constexpr std::array<std::string_view, 8> kTests{
    "slow-forward",        "slow-backward",       "fast-forward",    "fast-backward",
    "quasistatic-forward", "quasistatic-reverse", "dynamic-forward", "dynamic-reverse"};

/// How SysId calls a unit, and what becomes of values in it.
struct Unit {
  std::string_view name, position, velocity;
  double of_position, of_velocity;
};
constexpr double kFoot = 0.3048, kInch = 0.0254;
constexpr std::array kUnits{
    Unit{"Meters", "m", "m/s", 1.0, 1.0},      Unit{"Feet", "m", "m/s", kFoot, kFoot},
    Unit{"Inches", "m", "m/s", kInch, kInch},  Unit{"Radians", "rad", "rad/s", 1.0, 1.0},
    Unit{"Degrees", "deg", "deg/s", 1.0, 1.0}, Unit{"Rotations", "rev", "rpm", 1.0, 60.0},
};

enum class Kind { plain, position, velocity };
struct Name {
  std::string_view name, unit;
  Kind kind = Kind::plain;
};
constexpr std::array kMechanism{Name{"time", "s"}, Name{"motor voltage", "V"},
                                Name{"position", "", Kind::position},
                                Name{"velocity", "", Kind::velocity}};
constexpr std::array kDrivetrain{Name{"time", "s"},
                                 Name{"left motor voltage", "V"},
                                 Name{"right motor voltage", "V"},
                                 Name{"left position", "", Kind::position},
                                 Name{"right position", "", Kind::position},
                                 Name{"left velocity", "", Kind::velocity},
                                 Name{"right velocity", "", Kind::velocity},
                                 Name{"gyro angle", ""},
                                 Name{"gyro rate", ""}};

Json parsed(const std::string& path, const std::string& text) {
  // Deeper ones are no files of SysId.
  constexpr int kDeepest = 8;
  try {
    return Json::parse(text, [&](int depth, Json::parse_event_t, Json&) {
      if (depth > kDeepest) throw RecordingError(path, 0, "is no file of SysId: it is too nested");
      return true;
    });
  } catch (const Json::exception&) {
    throw RecordingError(path, 0, "is a file of SysId that is cut off or damaged; copy it again");
  }
}

std::vector<std::string_view> tests_in(const Json& file) {
  std::vector<std::string_view> tests;
  for (const std::string_view test : kTests)
    if (const auto found = file.find(test);
        found != file.end() && found->is_array() && !found->empty())
      tests.push_back(test);
  return tests;
}

std::string_view chosen_test(const std::string& path, const Json& file, const std::string& wanted) {
  const std::vector<std::string_view> tests = tests_in(file);
  if (tests.empty())
    throw RecordingError(path, 0, "is a file of SysId without a test that has rows");
  if (wanted.empty() && tests.size() == 1) return tests.front();
  if (const auto found = std::ranges::find(tests, wanted); found != tests.end()) return *found;
  throw RecordingError(
      path, 0,
      fmt::format(
          "{}the tests {}; name one behind the file, as {}#{}",
          wanted.empty() ? std::string("holds ")
                         : fmt::format("has no test {}, but ", in_quotes(shortened(wanted))),
          fmt::join(tests, ", "), std::filesystem::path(path).filename().string(), tests.front()));
}

/// Values of `file` below the first of these keys that it has.
const Json* first_of(const Json& file, std::initializer_list<const char*> keys) {
  for (const char* key : keys)
    if (const auto found = file.find(key); found != file.end()) return &*found;
  return nullptr;
}

Unit unit_of(const std::string& path, const Json& file) {
  const Json* const named = first_of(file, {"units"});
  const Json* const factor =
      first_of(file, {"unitsPerRotation", "units per rotation", "units_per_rotation"});
  const std::string name = named && named->is_string() ? named->get<std::string>() : "";
  const auto* const found = std::ranges::find(kUnits, name, &Unit::name);
  if (found == kUnits.end() || (factor != nullptr && !factor->is_number()))
    throw RecordingError(
        path, 0,
        fmt::format("{}; open it in SysId, choose a unit there and save it again",
                    found == kUnits.end()
                        ? fmt::format("has the unit {}, which SysId does not know",
                                      in_quotes(shortened(name)))
                        : std::string("has units per rotation that are no number")));
  Unit unit = *found;
  const double size = factor == nullptr ? 1.0 : factor->get<double>();
  unit.of_position *= size;
  unit.of_velocity *= size;
  return unit;
}

/// Appends a row to the columns.
void add_row(const Json& row, Table& table, std::string_view test) {
  const std::size_t number = table.rows() + 1;
  if (!row.is_array() || row.size() != table.columns.size())
    throw RecordingError(table.file, 0,
                         fmt::format("row {} of {} has not {} numbers, as the first has; copy it "
                                     "again",
                                     number, test, table.columns.size()));
  for (std::size_t c = 0; c < row.size(); ++c) {
    if (!row[c].is_number() && !row[c].is_null())
      throw RecordingError(
          table.file, 0,
          fmt::format("row {} of {} has something that is no number; copy it again", number, test));
    table.columns[c].values.push_back(row[c].is_null() ? std::numeric_limits<double>::quiet_NaN()
                                                       : row[c].get<double>());
  }
}

void scale(Column& column, const Name& name, const Unit& unit) {
  column.unit = name.kind == Kind::position   ? unit.position
                : name.kind == Kind::velocity ? unit.velocity
                                              : name.unit;
  if (name.kind == Kind::plain) return;
  for (double& x : column.values)
    x *= name.kind == Kind::position ? unit.of_position : unit.of_velocity;
}

}  // namespace

bool is_sysid(std::string_view beginning) {
  const std::size_t first = beginning.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos || beginning[first] != '{') return false;
  const std::string_view text = beginning.substr(first, 1000);
  return std::ranges::any_of(kTests, [&](std::string_view test) {
    return text.find(fmt::format("\"{}\"", test)) != std::string_view::npos;
  });
}

Table read_sysid(const std::string& path, const std::string& test) {
  const Json file = parsed(path, TextLines(path).rest());
  const std::string_view chosen = chosen_test(path, file, test);
  const Json& rows = *file.find(chosen);
  const Json& first = rows.front();
  std::vector<Name> names;
  if (first.size() == kMechanism.size()) names.assign(kMechanism.begin(), kMechanism.end());
  if (first.size() == kDrivetrain.size()) names.assign(kDrivetrain.begin(), kDrivetrain.end());
  if (names.empty())
    throw RecordingError(
        path, 0,
        fmt::format("{} has rows of {} values, and SysId writes 4, or 9 of a drivetrain; convert "
                    "files of frc-characterization by SysId",
                    chosen, first.size()));
  const Unit unit = unit_of(path, file);
  Table table{path, {}};
  for (const Name& name : names) table.columns.push_back({std::string(name.name), {}});
  for (const Json& row : rows) add_row(row, table, chosen);
  for (std::size_t c = 0; c < names.size(); ++c) scale(table.columns[c], names[c], unit);
  return table;
}

}  // namespace axisfit
