#include "fleet/items.h"

#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/stat.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <regex>
#include <sstream>
#include <stdexcept>

#include "base/plain_text.h"
#include "io/config/config.h"
#include "io/recording/text_lines.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;

/// A part of a path with names in braces, as a regular expression with a group for each.
struct PartPattern {
  std::regex form;
  std::vector<std::string> names;
};

PartPattern part_pattern(const std::string& part) {
  static const std::regex kName("\\{([A-Za-z_][A-Za-z0-9_]*)\\}");
  PartPattern found;
  std::string form;
  const auto add_plain = [&](const std::string& plain) {
    for (const char c : plain) {
      if (std::string_view("\\^$.|?*+()[]{}").find(c) != std::string_view::npos) form += '\\';
      form += c;
    }
  };
  std::string rest = part;
  for (std::smatch match; std::regex_search(rest, match, kName);) {
    add_plain(match.prefix());
    form += "(.+)";
    found.names.push_back(match[1]);
    rest = match.suffix();
  }
  add_plain(rest);
  found.form = std::regex(form);
  return found;
}

/// Calls found(values) for every file that a pattern names.
void visit_files(const fs::path& folder, fs::path::iterator part, const fs::path::iterator& end,
                 const std::map<std::string, std::string>& values,
                 const std::function<void(const std::map<std::string, std::string>&)>& found) {
  if (part == end) {
    found(values);
    return;
  }
  const auto next = std::next(part);
  const PartPattern pattern = part_pattern(part->string());
  if (pattern.names.empty()) {
    if (fs::exists(folder / *part)) visit_files(folder / *part, next, end, values, found);
    return;
  }
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    std::smatch match;
    if (!std::regex_match(name, match, pattern.form)) continue;
    auto own = values;
    bool agree = true;
    for (std::size_t i = 0; i < pattern.names.size(); ++i) {
      const auto [known, is_new] = own.emplace(pattern.names[i], match[i + 1]);
      agree = agree && (is_new || known->second == match[i + 1]);
    }
    if (agree && (next == end ? entry.is_regular_file() : entry.is_directory()))
      visit_files(entry.path(), next, end, own, found);
  }
}

/// The rows of a list: names in the first, values in the others.
std::vector<std::map<std::string, std::string>> rows_of_manifest(const std::string& path) {
  TextLines lines(path);
  std::vector<std::string> names;
  std::vector<std::map<std::string, std::string>> rows;
  for (std::string_view line; lines.next(line);) {
    if (line.empty()) continue;
    std::vector<std::string> fields;
    std::istringstream text{std::string(line)};
    for (std::string field; std::getline(text, field, ',');) {
      const std::size_t from = field.find_first_not_of(" \t"), to = field.find_last_not_of(" \t");
      fields.push_back(from == std::string::npos ? "" : field.substr(from, to - from + 1));
    }
    if (names.empty()) {
      names = fields;
      for (const char* needed : {"axis", "night"})
        if (std::ranges::find(names, needed) == names.end())
          throw std::runtime_error(
              fmt::format("{}: the first row has no column '{}'", path, needed));
      continue;
    }
    if (fields.size() != names.size())
      throw std::runtime_error(fmt::format("{}, line {}: {} fields, where the first row has {}",
                                           path, lines.number(), fields.size(), names.size()));
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (i == 0) rows.emplace_back();
      rows.back()[names[i]] = fields[i];
    }
  }
  return rows;
}

/// The rows of the table `items` of a database.
std::vector<std::map<std::string, std::string>> rows_of_database(const std::string& path) {
  sqlite3* database = nullptr;
  const int opened = sqlite3_open_v2(path.c_str(), &database, SQLITE_OPEN_READONLY, nullptr);
  const std::unique_ptr<sqlite3, int (*)(sqlite3*)> owned(database, &sqlite3_close);
  std::vector<std::map<std::string, std::string>> rows;
  const auto add = [](void* all, int n, char** values, char** names) {
    auto& row = static_cast<decltype(rows)*>(all)->emplace_back();
    for (int i = 0; i < n; ++i) row[names[i]] = values[i] != nullptr ? values[i] : "";
    return 0;
  };
  if (opened != SQLITE_OK ||
      sqlite3_exec(database, "SELECT * FROM items", add, &rows, nullptr) != SQLITE_OK)
    throw std::runtime_error(
        fmt::format("manifest {}: {}", in_quotes(path), sqlite3_errmsg(database)));
  for (const char* needed : {"axis", "night"})
    if (!rows.empty() && !rows.front().contains(needed))
      throw std::runtime_error(fmt::format("{}: its items have no column '{}'", path, needed));
  return rows;
}

/// What a job reads: its axis file and its recordings, with these names in braces.
std::vector<std::string> files_of_job(const FleetFile& file,
                                      const std::map<std::string, std::string>& names) {
  // In YAML a text that begins with a brace would be a map: so the names are marked otherwise.
  std::map<std::string, std::string> marks;
  for (const auto& [name, value] : names) marks[name] = "axisfit." + name + ".name";
  const auto with_braces = [&](std::string text) {
    for (const auto& [name, mark] : marks)
      for (std::size_t at = 0; (at = text.find(mark, at)) != std::string::npos;)
        text.replace(at, mark.size(), "{" + name + "}");
    return text;
  };
  Diagnostics diagnostics;
  const std::string path = (fs::path(file.folder) / file.job_name).string();
  const auto root = ConfigNode::parse(filled_in(file.job_text, marks), path, diagnostics);
  diagnostics.throw_if_any();
  std::vector<std::string> files;
  if (!root || !root->is_map()) return files;
  ConfigMap map(*root);
  if (const auto axis = map.optional("axis"); axis && axis->is_scalar())
    files.push_back(with_braces(axis->text()));
  const auto recordings = map.optional("recordings");
  const auto entries = recordings ? recordings->as_sequence() : std::nullopt;
  for (const ConfigNode& entry : entries.value_or(std::vector<ConfigNode>{}))
    if (entry.is_map())
      if (const auto name = ConfigMap(entry).optional("file"); name && name->is_scalar())
        files.push_back(with_braces(name->text()));
  return files;
}

std::string hash_of(const std::string& text) {
  const XXH128_hash_t hash = XXH3_128bits(text.data(), text.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::string fingerprint_of(const FleetFile& file, const FleetItem& item,
                           const std::vector<std::string>& files) {
  std::string all =
      filled_in(file.job_text, item.values) + std::to_string(static_cast<int>(file.close_loop));
  for (const std::string& name : files) {
    const std::string path = (fs::path(file.folder) / filled_in(name, item.values)).string();
    struct stat status {};
    const bool exists = ::stat(path.c_str(), &status) == 0;
    all += fmt::format("\n{} {} {}.{:09}", path, exists ? status.st_size : -1,
                       exists ? status.st_mtim.tv_sec : 0, exists ? status.st_mtim.tv_nsec : 0);
  }
  return hash_of(all);
}

}  // namespace

std::string filled_in(std::string text, const std::map<std::string, std::string>& values) {
  for (const auto& [name, value] : values) {
    const std::string mark = "{" + name + "}";
    for (std::size_t at = 0; (at = text.find(mark, at)) != std::string::npos; at += value.size())
      text.replace(at, mark.size(), value);
  }
  return text;
}

std::vector<FleetItem> find_items(const FleetFile& file) {
  std::vector<FleetItem> items;
  const auto add = [&](const std::map<std::string, std::string>& values) {
    items.push_back({values.at("axis"), values.at("night"), values, {}});
  };
  if (!file.manifest.empty()) {
    const std::string ending = fs::path(file.manifest).extension().string();
    const bool is_database = ending == ".sqlite" || ending == ".db";
    for (const auto& row :
         is_database ? rows_of_database(file.manifest) : rows_of_manifest(file.manifest))
      add(row);
  } else {
    const fs::path pattern(file.items);
    visit_files(pattern.root_path(), std::next(pattern.begin()), pattern.end(), {}, add);
  }
  const std::string from = file.manifest.empty() ? file.items : file.manifest;
  if (items.empty()) throw std::runtime_error(fmt::format("{}: there are no such axes", from));
  std::ranges::sort(items, {}, [](const FleetItem& i) { return std::pair(i.axis, i.night); });
  const std::vector<std::string> files = files_of_job(file, items.front().values);
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0 && items[i].axis == items[i - 1].axis && items[i].night == items[i - 1].night)
      throw std::runtime_error(
          fmt::format("{}: axis {} has night {} twice", from, items[i].axis, items[i].night));
    for (const std::string* name : {&items[i].axis, &items[i].night})
      if (!is_sanitized(*name) || name->empty())
        throw std::runtime_error(
            fmt::format("{}: {} cannot be a name: use plain text", from, in_quotes(*name)));
    items[i].fingerprint = fingerprint_of(file, items[i], files);
  }
  return items;
}

}  // namespace axisfit
